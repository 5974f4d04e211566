"""Each target by its best robot.

Winner takes all: sensors on a plane, each credited with what it sees best. [Winner takes all](../formulations/winner-takes-all.md)
"""

import waybound as wb

problem = wb.generate("sensing-geometric", robots=25, problem="winner-takes-all")
solution = wb.solve(problem, heuristic="greedy")
solution.plot()
