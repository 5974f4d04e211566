"""Jobs within capacities.

Generalised assignment: each job to one agent, none beyond its capacity. [Generalised assignment](../formulations/generalised-assignment.md)
"""

import waybound as wb

problem = wb.generate("generalised-assignment", agents=5, jobs=25)
solution = wb.solve(problem, "highs")
solution.plot()
