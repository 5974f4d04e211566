# %% [markdown]
# # Variants, one short cell each
#
# Seventeen corners of a city (the blocks are 114 m by 80 m; the data are those of the routing guide of OR-Tools and of PyVRP's tutorial,
# so that the answers can be compared). Every answer is checked, and every bound below is verified unless it says otherwise.

# %%
import numpy as np
import pandas as pd

import waybound as wb

# fmt: off
X = [456, 228, 912, 0, 114, 570, 798, 342, 684, 570, 912, 114, 228, 342, 684, 0, 798]
Y = [320, 0, 0, 80, 80, 160, 160, 240, 240, 400, 400, 480, 480, 560, 560, 640, 640]
DEMAND = [0, 1, 1, 2, 4, 2, 4, 8, 8, 1, 2, 1, 2, 4, 4, 8, 8]
READY = [0, 7, 10, 16, 10, 0, 5, 0, 5, 0, 10, 10, 0, 5, 7, 10, 11]
DUE = [999, 12, 15, 18, 13, 5, 10, 4, 10, 3, 16, 15, 5, 10, 8, 15, 15]
PRIZE = [0, 0, 334, 413, 295, 471, 399, 484, 369, 410, 471, 382, 347, 380, 409, 302, 411]
# fmt: on
city = pd.DataFrame({"id": range(17), "x": X, "y": Y})
blocks = np.abs(city.x.values[:, None] - city.x.values) + np.abs(city.y.values[:, None] - city.y.values)
minutes = blocks / 97.0


def plan(sites: pd.DataFrame = city, solver: str | None = None, time: float = 4, **asked: object) -> wb.Solution:
    """Solve a variant, draw it, and say what came out."""
    problem = wb.RoutingProblem.from_frame(sites, travel=blocks, **asked)
    solution = wb.solve(problem, solver, time_limit=time, bound_time=4)
    solution.plot()
    return solution


# %% [markdown]
# ## Capacities

# %%
plan(city.assign(demand=DEMAND), "pyvrp", vehicles=4, capacity=15)

# %% [markdown]
# ## Time windows
#
# `durations` are minutes, windows are minutes too.

# %%
plan(city.assign(ready=READY, due=[d + 4 for d in DUE]), durations=minutes, vehicles=5)

# %% [markdown]
# ## Few vehicles first, then short ways
#
# What Solomon's tables rank by; each level has a bound of its own.

# %%
plan(city.assign(demand=DEMAND), "pyvrp", capacity=15, objective="vehicles then total-cost")

# %% [markdown]
# ## Several depots
#
# Each vehicle returns to where it began; `vehicles` are at each depot.

# %%
plan(city.assign(depot=[True, True] + [False] * 15, demand=[0, 0, *DEMAND[2:]]), "pyvrp", vehicles=2, capacity=20)

# %% [markdown]
# ## A mixed fleet

# %%
fleet = [
    {"name": "bike", "capacity": 8, "count": 3, "unit_cost": 1},
    {"name": "truck", "capacity": 40, "count": 2, "unit_cost": 2, "fixed_cost": 500},
]
plan(city.assign(demand=DEMAND), "pyvrp", fleet=fleet)

# %% [markdown]
# ## Prizes
#
# Sites are optional; a prize is worth its value in metres. What is left out is listed with the reason.

# %%
optional = city.assign(reward=PRIZE, required=[True] + [False] * 16, demand=DEMAND)
plan(optional, "pyvrp", vehicles=4, capacity=15, objective="total-cost - reward")

# %% [markdown]
# ## Pickups and deliveries
#
# What is picked up at the one site is delivered at the other, by the same vehicle.

# %%
pairs = [(1, 6, 1), (2, 10, 1), (4, 3, 1), (5, 9, 1), (7, 8, 1), (15, 11, 1), (13, 12, 1), (16, 14, 1)]
plan(solver="ortools", time=2, shipments=pairs, vehicles=4, capacity=2, objective="total-cost")

# %% [markdown]
# ## Reloads
#
# Two vehicles return to a depot to load again.

# %%
loads = {"capacity": 15, "count": 2, "start": 0, "end": 0, "reloads": [0, 1], "max_reloads": 2}
plan(city.assign(depot=[True, True] + [False] * 15, demand=[0, 0, *DEMAND[2:]]), "pyvrp", fleet=[loads])

# %% [markdown]
# ## The longest route as short as possible
#
# A metre of the longest route counts as much as a hundred of the others, so that these are short too.

# %%
plan(solver="cpsat", vehicles=4, objective="total-cost + 100*longest-route")

# %% [markdown]
# ## Orienteering
#
# One route of at most 3 km that collects as much as it can.

# %%
trip = [{"count": 1, "max_distance": 3000}]
plan(optional.drop(columns="demand"), "highs", time=20, fleet=trip, objective="reward")

# %% [markdown]
# ## Energy
#
# Each route uses at most what its battery holds: 0.01 a metre.

# %%
drone = [{"name": "drone", "count": 5, "energy": {"capacity": 22, "rate": 0.01}}]
plan(solver="highs", time=20, fleet=drone)

# %% [markdown]
# ## Alternatives
#
# Of each group one site is enough.

# %%
corners = [(1, 4, 3), (2, 6, 8), (11, 12, 15), (14, 16, 10)]
free = [k not in {i for group in corners for i in group} for k in range(17)]
plan(city.assign(required=free), "pyvrp", groups=corners, vehicles=2)
