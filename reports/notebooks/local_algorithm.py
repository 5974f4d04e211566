# %% [markdown]
# # The local algorithm, and h
#
# Robots share out their time among actions so that the worst-covered target is covered as well as possible. In the local algorithm a
# robot knows only what is within `3h - 2` hops: more layers `h`, more of the network, and a better guarantee.

# %%
import matplotlib.pyplot as plt
import pandas as pd

import waybound as wb

problem = wb.generate("sata", robots=40, targets=50, seed=11, problem="bottleneck-lp")
problem

# %%
rows = []
for h in (1, 2, 4, 8, 16, 32):
    solution = wb.solve(problem, heuristic="local", h=h)
    proved = solution.certificate
    rows.append((h, solution.objective, proved.bound, proved.guarantee.ratio, proved.observed_ratio))
table = pd.DataFrame(rows, columns=["h", "value", "verified bound", "stated ratio", "observed ratio"])
table.round(4)

# %%
exact = wb.solve(problem, "highs")
fig, ax = plt.subplots(figsize=(7, 3.2))
ax.semilogx(table.h, table.value, "o-", color="#00897b", label="local algorithm")
ax.axhline(exact.objective, color="#d84315", label="optimum of the linear program")
ax.set(xlabel="h", ylabel="least coverage of a target", xticks=table.h, xticklabels=table.h)
ax.minorticks_off()
ax.legend()
fig.tight_layout()

# %% [markdown]
# The guarantee, with what was checked on this instance:

# %%
solution.certificate.guarantee

# %% [markdown]
# ## As messages
#
# With `messages=True` every robot is an object that knows its own actions and what its neighbours sent, to the same bits; rounds and
# messages are counted.

# %%
told = wb.solve(problem, heuristic="local", h=3, messages=True)
{key: value for key, value in told.statistics.items() if isinstance(value, int | float)}

# %% [markdown]
# ## Whole actions
#
# If robots cannot divide themselves, the largest share becomes whole, and nothing is guaranteed any more. The certificate says so.

# %%
wb.solve(wb.generate("sata", robots=40, targets=50, seed=11, problem="bottleneck"), heuristic="local", h=8)
