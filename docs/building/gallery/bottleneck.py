"""The worst-covered target.

Each robot takes one action; the target that is seen least counts. [Bottleneck](../formulations/bottleneck.md)
"""

import waybound as wb

problem = wb.generate("sata", robots=30, targets=40, phi=25, problem="bottleneck")
solution = wb.solve(problem, "highs", time_limit=10)
solution.plot()
