# %% [markdown]
# # Bring your own solver
#
# A heuristic of your own is a function. Registered, it is judged like any other: its answers are priced from the data, its claims are
# checked, and bounds stand beside it. This one is the nearest neighbour rule.

# %%

import waybound as wb
from waybound.extending import HEURISTICS, Context, Heuristic, Outcome


def nearest_neighbour(problem: wb.RoutingProblem, context: Context) -> Outcome:
    """Always to the nearest site that is left."""
    distances, at, left, tour = problem.travel.distances, problem.fleet[0].start, set(problem.customers.tolist()), []
    while left:
        at = min(left, key=lambda k: distances[at, k])
        left.remove(at)
        tour.append(at)
    return Outcome(wb.Routes.of([tour]))


_ = HEURISTICS.add(
    "nearest-neighbour",
    Heuristic(
        name="nearest-neighbour",
        families=("routing",),
        features=frozenset({"objective:total-cost", "limited-fleet"}),
        run=nearest_neighbour,
        summary="always to the nearest site that is left",
    ),
)

# %%
tour = wb.generate("random", customers=30, vehicles=1, capacity=0, seed=5)
mine = wb.solve(tour, heuristic="nearest-neighbour", bound_time=10)
mine

# %%
_ = mine.plot()

# %% [markdown]
# It can be improved by any engine, from where it ended. Before, after, and what is needed at least:

# %%
better = wb.solve(tour, "pyvrp", start=mine, time_limit=2, bound_time=10)
mine.objective, better.objective, better.certificate.bound

# %% [markdown]
# ## A solver that lies
#
# This one forgets half of the sites. The judge does not take it: there is no answer, and the message says why.


# %%
def forgetful(problem: wb.RoutingProblem, context: Context) -> Outcome:
    """Leaves out every other site."""
    return Outcome(wb.Routes.of([problem.customers[::2].tolist()]))


with HEURISTICS.temporary(
    "forgetful", Heuristic("forgetful", ("routing",), frozenset({"objective:total-cost", "limited-fleet"}), forgetful, "")
):
    try:
        wb.solve(tour, heuristic="forgetful")
    except wb.CheckFailedError as refusal:
        print(refusal)

# %% [markdown]
# In a package of your own it is [one module and an entry point](../adding-a-heuristic.md); [solvers](../adding-a-solver.md),
# [engines](../adding-an-engine.md), [forms](../adding-a-form.md) and whole [problems](../adding-a-problem.md) work the same way.
