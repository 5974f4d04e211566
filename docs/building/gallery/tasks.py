"""Tasks by auction.

Robots bid for one task a round: at most twice the shortest paths. [Task allocation](../formulations/task-allocation.md)
"""

import waybound as wb

problem = wb.generate("robot-tasks", robots=5, tasks=30, problem="task-allocation")
solution = wb.solve(problem, heuristic="sequential-single-item")
solution.plot()
