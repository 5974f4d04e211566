# %% [markdown]
# # A bin auction, and an orchard day
#
# Robots bid for bins: each announces what a bin costs it, and the lowest bid wins. What does the team lose against the assignment that a
# central planner would make?

# %%
import waybound as wb

problem = wb.generate("assignment", robots=12, bins=12, costs="orchard", seed=5)
problem

# %%
compared = wb.compare(problem, ["online-greedy", "auction", "bertsekas", "lapjv"])
compared

# %% [markdown]
# What each rule promises of every instance:

# %%
[compared[name].certificate.guarantee for name in ("online-greedy", "auction", "bertsekas")]

# %%
best = compared["lapjv"]
_ = best.plot()

# %% [markdown]
# Prices are the evidence: no assignment is cheaper than what they add up to, and anybody can add them up.

# %%
best.certificate

# %% [markdown]
# ## A day in the orchard
#
# Robots bring empty bins to pickers and fetch full ones. The rule takes bins as they fill; the schedule plans the whole day.

# %%
day = wb.generate("orchard-day", rows=2, columns=6, robots=2, groups=2, seed=1)
rule, schedule = wb.solve(day, heuristic="list-schedule"), wb.solve(day, time_limit=20)
rule.objective, schedule.objective, schedule.certificate.bound

# %%
_ = schedule.plot()

# %% [markdown]
# A world that unfolds step by step, with an assignment whenever robots are idle:

# %%
log = wb.run("orchard", solver="lapjv", steps=60, seed=1)
log[["step", "returned", "objective", "status"]].iloc[::12]
