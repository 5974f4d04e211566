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
# The routes by the names of their sites, and one row a visit:

# %%
solution.routes

# %%
solution.to_frame().head(6)

# %% [markdown]
# ## What is proved
#
# The certificate holds verified facts only: which checks passed and by how much, the objective priced from the data, and a bound with where
# it comes from. Whoever is sent three files verifies all of it again, without any solver:

# %%
import tempfile
from pathlib import Path

folder = Path(tempfile.mkdtemp())
problem.save(folder / "valley.json")
solution.save(folder / "answer.json")
solution.certificate.save(folder / "proof.json")
wb.check(wb.read(folder / "valley.json"), folder / "answer.json", folder / "proof.json")

# %% [markdown]
# Anything else is judged too: the routes of a colleague, as lists.

# %%
theirs = wb.judge(problem, [["mill", "quarry"], ["farm", "abbey", "forge"], ["port", "lake"], ["inn", "school"]])
theirs.feasible, theirs.objective, solution.objective

# %% [markdown]
# ## The search, while it runs and afterwards
#
# `log=True` shows what was found when, and what was proved at the end.

# %%
seen = wb.solve(problem, heuristic="savings", bound_time=3, log=True)

# %%
seen.history[["seconds", "phase", "objective", "bound", "bound_kind", "found_by"]]

# %% [markdown]
# ## The same problem, other methods
#
# Every answer is checked by the same judge, and set against the best bound that was verified in any of the runs.

# %%
compared = wb.compare(problem, ["savings", "ortools", "pyvrp", "highs"], time_limit=2, bound_time=2)
compared

# %%
_ = wb.plot_history(compared)

# %% [markdown]
# Who else can take it, and what do the others lack?

# %%
[info.name for info in wb.solvers(problem) if info.installed and not info.missing]

# %%
wb.heuristics(problem)

# %% [markdown]
# ## What matters first
#
# Objectives are terms, or their text; levels of priority have a bound each.

# %%
wb.solve(wb.RoutingProblem.from_frame(sites, capacity=10, objective="vehicles then total-cost", name="valley"), time_limit=3)

# %% [markdown]
# ## When there is no answer
#
# Three vehicles carry 30, and 32 is asked for.

# %%
wb.explain(wb.RoutingProblem.from_frame(sites, vehicles=3, capacity=10, name="valley"))
