"""A bare program, and its search.

Arrays of any origin: answers and bounds over time, whoever searches. [Bare programs](../formulations/arrays.md)
"""

import waybound as wb

program = wb.read("demo-tiny").compile("three-index").program
solution = wb.solve(program, "highs", time_limit=10)
solution.plot(view="history")
