"""Exploring together.

Robots go through rooms, map and search, and stay in contact. [Room exploration](../formulations/room-exploration.md)
"""

import waybound as wb

problem = wb.generate("exploration-map", rooms=9, robots=2, steps=5)
solution = wb.solve(problem, time_limit=10)
solution.plot()
