"""Six sets that cover most.

Lazy greedy, at least 1 - 1/e of the best, and a bound that says how near it is. [Selection](../selection.md)
"""

import waybound as wb

problem = wb.read("cover-30")
solution = wb.solve(problem, heuristic="lazy-greedy")
solution.plot()
