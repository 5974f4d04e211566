"""A day in the orchard.

Robots bring empty bins to pickers and fetch the full ones. [A day in the orchard](../formulations/orchard-day.md)
"""

import waybound as wb

problem = wb.generate("orchard-day", rows=3, columns=5, robots=2)
solution = wb.solve(problem, time_limit=10)
solution.plot()
