"""A path around obstacles, at a risk.

One risk for the whole path, shared out among its steps. [Risk allocation](../formulations/risk-allocation.md)
"""

import waybound as wb

problem = wb.generate("risk-allocation", family="obstacles")
solution = wb.solve(problem, time_limit=20)
solution.plot(view="trajectory")
