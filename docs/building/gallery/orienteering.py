"""Choosing the sites worth a visit.

The most reward on one route of limited length: what is far stays out. [Orienteering](../formulations/routing.md#orienteering)
"""

import numpy as np
import pandas as pd

import waybound as wb

sites = pd.DataFrame(np.random.default_rng(3).integers(0, 90, (25, 3)), columns=["x", "y", "reward"]).assign(required=False)
problem = wb.RoutingProblem.from_frame(sites, vehicles=1, max_distance=200, objective="reward")
solution = wb.solve(problem, time_limit=3, bound_time=5)
solution.plot(labels=False)
