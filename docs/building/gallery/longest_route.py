"""The longest route as short as possible.

Four vehicles share the work, so that the last one is back early. [Objectives](../objectives.md)
"""

import waybound as wb

problem = wb.read("demo-c25", vehicles=4, capacity=9999, objective="longest-route")
solution = wb.solve(problem, time_limit=4, bound_time=4)
solution.plot()
