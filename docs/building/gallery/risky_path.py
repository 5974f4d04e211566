"""The least risky way.

Through a grid of obstacles, where each step may be the last one. [Risky paths](../formulations/risky-path.md)
"""

import waybound as wb

problem = wb.generate("risky-grid", rows=12, columns=16, seed=3)
solution = wb.solve(problem, time_limit=10)
solution.plot()
