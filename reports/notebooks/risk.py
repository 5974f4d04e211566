# %% [markdown]
# # Sharing out a risk
#
# A vehicle follows a plan above a sea floor, twenty steps long, its position uncertain. All chance constraints together may fail with a
# probability of 5 %: who gets how much of it?

# %%
import pandas as pd

import waybound as wb

problem = wb.generate("risk-allocation")
problem

# %% [markdown]
# Equal shares are the usual rule; they are not the best one.

# %%
asked = {
    "equal shares": {"solver": "highs", "form": "uniform"},
    "iterative": {"heuristic": "iterative"},
    "optimal": {"solver": "convex-allocation"},
}
plans = {name: wb.solve(problem, **keywords) for name, keywords in asked.items()}
rows = [(name, p.objective, p.certificate.bound, p.evaluation.quantities["joint_risk"]) for name, p in plans.items()]
pd.DataFrame(rows, columns=["method", "cost", "verified bound", "probability that anything fails"]).set_index("method")

# %%
plans["optimal"]

# %%
_ = plans["optimal"].plot()

# %% [markdown]
# Where the risk went:

# %%
_ = plans["optimal"].plot(view="risks")

# %% [markdown]
# ## A path of uncertain cost
#
# From one vertex to another so that the probability of exceeding a budget is small: mean and variance pull in different directions.

# %%
graph = wb.generate("prm-graph", vertices=60, seed=2)
least_mean = wb.solve(graph, heuristic="least-mean")
careful = wb.solve(graph)
least_mean.objective, careful.objective, careful.status, careful.bound_kind

# %%
_ = careful.plot()
