# %% [markdown]
# # Forms, and their bounds at the root
#
# A problem can be written down in several ways. All exact forms have the same optimum; what differs is how close their linear relaxations
# come to it, and how fast a solver closes the rest.

# %%
import pandas as pd

import waybound as wb

problem = wb.generate("random", customers=7, windows=True, capacity=20, seed=2)
problem.forms()

# %%
rows = []
for form in ("two-index-mtz", "two-index-time-flow", "two-index-load-flow", "three-index", "set-partitioning"):
    compiled = problem.compile(form)
    root = wb.solve(problem.compile(form, relax=True), "highs", time_limit=20, bound_time=0)
    rows.append((form, compiled.program.num_variables, compiled.program.num_rows, root.bound))
best = wb.solve(problem, "highs", time_limit=30)
table = pd.DataFrame(rows, columns=["form", "variables", "rows", "root bound"])
table["of the optimum"] = (table["root bound"].astype(float) / best.objective).map("{:.1%}".format)
table

# %% [markdown]
# The optimum, and on whose word:

# %%
best

# %% [markdown]
# The root bounds as a picture:

# %%
ax = table.plot.barh(x="form", y="root bound", legend=False, color="#00897b", figsize=(8, 3))
ax.axvline(best.objective, color="#d84315")
ax.set(xlabel="objective (the line is the optimum)", ylabel="")
_ = ax.figure.tight_layout()

# %% [markdown]
# A form is plain arrays, and goes to any modelling tool, or to a file:

# %%
compiled = problem.compile("two-index-load-flow")
compiled

# %%
model = compiled.to_pulp()
len(model.variables()), len(model.constraints)

# %% [markdown]
# ## What was done on the way to the solver
#
# Every step says whether it is exact, a relaxation or a restriction; together they decide whose bounds count.

# %%
[(link.name, link.exactness.value) for link in best.chain]
