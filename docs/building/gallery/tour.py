"""A tour with a guarantee.

Christofides: at most 3/2 of the shortest tour, here far less. [Approximations](../formulations/routing.md#approximations)
"""

import numpy as np
import pandas as pd

import waybound as wb

points = pd.DataFrame(np.random.default_rng(7).uniform(0, 100, (60, 2)), columns=["x", "y"])
problem = wb.RoutingProblem.from_frame(points, vehicles=1)
solution = wb.solve(problem, heuristic="christofides", bound_time=3)
solution.plot(labels=False)
