"""Schedules of vehicles over the day.

Thin lines are driving, bars service, the line below a visit its window. [Pictures](../pictures.md)
"""

import waybound as wb

problem = wb.read("demo-r25", convention="trunc1", customers=12)
solution = wb.solve(problem, "branch-price-cut")
solution.plot(view="schedule")
