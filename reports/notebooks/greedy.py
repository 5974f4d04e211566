# %% [markdown]
# # Greedy against optimal, with certificates
#
# Forty robots choose one of two actions each; each target is credited to the robot that sees it best (winner takes all). Greedy methods
# promise half of the optimum. How good are they really, and who can prove it?

# %%
import waybound as wb

problem = wb.generate("sata", robots=40, targets=60, phi=8, weights="uniform", seed=3, problem="winner-takes-all")
problem

# %%
compared = wb.compare(problem, ["random", "sequential-greedy", "greedy", "lp-rounding", "highs"], time_limit=20)
compared

# %% [markdown]
# A ratio of 2 is what the theorem says for every instance; beside it stands what holds for this one, against a bound that a checker
# derived from prices or marginal gains. Nobody has to believe the solver.

# %%
compared["greedy"].certificate

# %%
_ = compared["greedy"].plot()

# %% [markdown]
# ## Where greedy is as bad as it may be
#
# Two robots, two targets. The first robot is nearer to what only the second one can... and takes it.

# %%
trap = wb.SensingGraph.from_edges(robot_of_action=[0, 0, 1], action=[0, 1, 2], target=[0, 1, 0], weight=[1.0, 0.99, 1.0])
greedy = wb.solve(wb.WinnerTakesAllSATA(trap), heuristic="sequential-greedy")
best = wb.solve(wb.WinnerTakesAllSATA(trap), "highs")
greedy.objective, best.objective, greedy.certificate.observed_ratio

# %% [markdown]
# The ratio suite plays thousands of such games: `waybound ratio winner-takes-all`, and [its page](../ratios.md) has the figures.
