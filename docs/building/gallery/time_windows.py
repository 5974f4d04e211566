"""Deliveries in time windows.

Fifty customers, each to be served within its window. [Routing](../formulations/routing.md)
"""

import waybound as wb

problem = wb.read("demo-rc50", convention="trunc1")
solution = wb.solve(problem, "branch-price-cut", time_limit=30)
solution.plot()
