"""A path of uncertain cost.

The cost that is exceeded once in twenty times, as low as possible. [Uncertain paths](../formulations/uncertain-path.md)
"""

import waybound as wb

problem = wb.generate("prm-graph", vertices=30, seed=2)
solution = wb.solve(problem)
solution.plot()
