# %% [markdown]
# # Your own data frame on a map
#
# Fifty deliveries in a town, from a table as one has it: latitude and longitude, timestamps, and columns that no solver knows. From
# `import waybound` to the picture are six lines.

# %%
import numpy as np
import pandas as pd

rng = np.random.default_rng(4)
n = 51
day = pd.Timestamp("2026-05-04")
orders = pd.DataFrame(
    {
        "customer": ["warehouse", *(f"order {k}" for k in range(1, n))],
        "lat": 45.81 + np.r_[0.0, rng.normal(0, 0.04, n - 1)].round(4),
        "lon": 15.98 + np.r_[0.0, rng.normal(0, 0.08, n - 1)].round(4),
        "parcels": np.r_[0, rng.integers(1, 9, n - 1)],
        "from": day + pd.to_timedelta(np.r_[7, rng.choice([8, 8, 10, 13], n - 1)], unit="h"),
        "until": day + pd.to_timedelta(np.r_[19, rng.choice([15, 16, 18, 18], n - 1)], unit="h"),
        "at the door": pd.to_timedelta([0] + [6] * (n - 1), unit="min"),
        "phone": [f"555-{k:04d}" for k in range(n)],
    }
)
orders.head()

# %% [markdown]
# `columns` tells which is which; the phone number is kept and shown, and never computed with. Distances are great circles in km, a van
# drives 30 km in an hour, and times are counted in minutes.

# %%
import waybound as wb

names = {"customer": "id", "parcels": "demand", "from": "ready", "until": "due", "at the door": "service"}
problem = wb.RoutingProblem.from_frame(orders, columns=names, vehicles=6, capacity=60, speed=30, time_unit="min", name="town")
solution = wb.solve(problem, "pyvrp", time_limit=2, bound_time=2)
_ = solution.plot()

# %%
solution

# %% [markdown]
# ## Who is where, when
#
# One row a visit, in moments of that day, with the columns that were kept; or one row a route.

# %%
visits = solution.to_frame()
visits[visits["vehicle"] == "vehicle 1"]

# %%
solution.to_frame("routes")

# %%
_ = solution.plot(view="schedule")

# %%
_ = solution.plot(view="loads")

# %% [markdown]
# ## Keep it, change it, judge it
#
# Answers are saved by suffix: `.json`, `.csv`, `.xlsx`, `.geojson` for any map. Whatever comes back, edited or from
# somebody else, is judged from the data.

# %%
import tempfile
from pathlib import Path

folder = Path(tempfile.mkdtemp())
problem.save(folder / "town.json")
for name in ("plan.json", "plan.csv", "plan.geojson"):
    solution.save(folder / name)
again = wb.read(folder / "town.json")
wb.judge(again, folder / "plan.csv").objective, solution.objective

# %%
mine = [list(route) for route in solution.routes]
mine[0], mine[1] = mine[0][1:], mine[0][:1] + mine[1]  # the first customer of the first van goes first in the second one
verdict = wb.judge(again, mine)
verdict.feasible, verdict.objective, [broken.message for broken in verdict.violations][:3]

# %% [markdown]
# ## Distances from elsewhere
#
# Road distances go in as `travel=`: a matrix or a frame, a list of moves, a networkx graph, or the table of a routing service (OSRM,
# Valhalla) as its JSON. A move that cannot be made is `inf`.

# %%
some = orders[["customer", "lat", "lon", "parcels"]].head(9)
km = 111.2 * (abs(some.lat.values[:, None] - some.lat.values) + abs(some.lon.values[:, None] - some.lon.values) * 0.7)
km[1, 2] = np.inf  # a bridge is closed
closed = wb.RoutingProblem.from_frame(
    some, columns={"customer": "id", "parcels": "demand"}, travel=km, vehicles=2, capacity=40, name="streets"
)
wb.solve(closed, "highs", time_limit=5).routes
