# %% [markdown]
# # Your own data frame on a map
#
# Fifty deliveries in a town, with time windows in hours of the day, from a table as one has it. From `import waybound` to the picture
# are six lines.

# %%
import numpy as np
import pandas as pd

rng = np.random.default_rng(4)
n = 51
orders = pd.DataFrame(
    {
        "customer": ["warehouse", *(f"order {k}" for k in range(1, n))],
        "km east": np.r_[0.0, rng.normal(0, 6, n - 1)].round(2),
        "km north": np.r_[0.0, rng.normal(0, 5, n - 1)].round(2),
        "parcels": np.r_[0, rng.integers(1, 9, n - 1)],
        "from": np.r_[8.0, rng.choice([8, 8, 10, 13], n - 1)],
        "until": np.r_[18.0, rng.choice([12, 16, 18, 18], n - 1)],
    }
)
orders["until"] = np.maximum(orders["until"], orders["from"] + 2)
orders.head()

# %% [markdown]
# Names of columns are those of the field: `id, x, y, demand, ready, due, service`. Distances are kilometres; at 30 km an hour,
# durations are hours.

# %%
import waybound as wb

names = {"customer": "id", "km east": "x", "km north": "y", "parcels": "demand", "from": "ready", "until": "due"}
van = {"name": "van", "capacity": 60, "count": 6, "speed": 30}
problem = wb.RoutingProblem.from_frame(orders.rename(columns=names).assign(service=[0.0] + [0.1] * (n - 1)), fleet=[van], name="town")
solution = wb.solve(problem, "pyvrp", time_limit=2, bound_time=2)
_ = solution.plot()

# %%
solution

# %% [markdown]
# When is which van where? Waiting is time before a window opens.

# %%
visits = solution.to_frame()
visits[visits["vehicle"] == "van 1"]

# %%
visits.groupby("vehicle", sort=False).agg(stops=("site", "size"), back=("arrival", "last")).round(2)

# %% [markdown]
# ## Distances from elsewhere
#
# A matrix of road distances or of minutes goes in as `travel=` (and `durations=`), as a frame with the ids as labels or as an array in
# the order of the sites.

# %%
xy = orders[["km east", "km north"]].to_numpy()[:12]
streets = np.abs(xy[:, None] - xy[None]).sum(axis=2)  # along a grid of streets
some = orders.rename(columns=names)[["id", "demand"]].head(12)
wb.solve(wb.RoutingProblem.from_frame(some, travel=streets, vehicles=2, capacity=40, name="streets"), time_limit=5)
