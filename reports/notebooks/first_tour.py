# %% [markdown]
# # A first tour
#
# From a data frame to routes on a map, and to what is proved about them.

# %%
import pandas as pd

import waybound as wb

# %% [markdown]
# ## A problem
#
# One row a site; the first one is the depot. Coordinates and demands are enough, everything else has a default.

# %%
sites = pd.DataFrame(
    {
        "id": ["depot", "mill", "farm", "port", "inn", "school", "lake", "abbey", "quarry", "forge"],
        "x": [0, 30, 10, -20, -15, 22, -30, 5, 38, -8],
        "y": [0, 10, 25, 5, -20, -18, -12, 40, -5, 18],
        "demand": [0, 4, 3, 5, 2, 3, 4, 2, 6, 3],
    }
)
problem = wb.RoutingProblem.from_frame(sites, vehicles=4, capacity=10, name="valley")
problem

# %% [markdown]
# ## An answer
#
# `solve` chooses a method, judges what it returns, and looks for a bound that a checker can derive again.

# %%
solution = wb.solve(problem, time_limit=3)
solution

# %%
_ = solution.plot()

# %% [markdown]
# ## What is proved
#
# The certificate holds verified facts only: which checks passed and by how much, the objective priced from the data, and a bound with
# where it
# comes from. Somebody without any solver can check it: `wb.check(problem, solution, certificate)`.

# %%
wb.check(problem, solution, solution.certificate)

# %% [markdown]
# The answer as a table, one row a visit:

# %%
solution.to_frame().head(8)

# %% [markdown]
# ## The same problem, another method
#
# A heuristic takes milliseconds; the bound says how far off it is at most.

# %%
quick = wb.solve(problem, heuristic="savings")
quick

# %% [markdown]
# Who else can take it, and what do the others lack?

# %%
[info.name for info in wb.solvers(problem) if info.installed and not info.missing]

# %%
wb.heuristics(problem)

# %% [markdown]
# ## When there is no answer
#
# Three vehicles carry 30, and 32 is asked for.

# %%
wb.explain(wb.RoutingProblem.from_frame(sites, vehicles=3, capacity=10, name="valley"))
