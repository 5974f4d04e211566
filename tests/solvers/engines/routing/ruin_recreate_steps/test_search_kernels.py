import itertools
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, small, varied

from waybound.formulations.routing.problem import RoutingProblem
from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import Arrays, arrays
from waybound.solvers.engines.routing.ruin_recreate_steps.search_kernels import anneal

KINDS = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "limited-fleet", "heterogeneous-fleet",
    "multiple-depots", "open-routes", "separate-durations", "vehicles", "prizes", "reward", "reward-then-cost", "pickups", "overtime",
    "shipments", "groups", "reloads", "committed-vehicles", "several-windows", "closing-moves", "windows", "recharging",
    "groups without a visit",
)  # fmt: skip


def picking(seed: int, convention: str) -> RoutingProblem:
    """Loads are brought, others taken away, and a vehicle is full of both together."""
    problem, rng = small("capacity", seed, convention), np.random.default_rng(seed)
    pickup = np.where(problem.sites.depot, 0.0, rng.integers(0, 1 + int(problem.sites.demand.max()), len(problem.sites)))
    return replace(problem, sites=replace(problem.sites, pickup=pickup))


def drawn(kind: str, seed: int, convention: str) -> RoutingProblem:
    if kind == "pickups":
        return picking(seed, convention)
    if kind not in WHOLE_FAMILY and kind != "groups without a visit":
        return small(kind, seed, convention)
    every = (varied(kind.partition(" ")[0], number, 7) for number in itertools.count(100 * seed))
    usual = (one for one in every if not RuinRecreate().missing(one) and not RuinRecreate().bisects(one))
    return next(one for one in usual if kind in WHOLE_FAMILY or not one.sites.groups[0].required)


def searched(problem: RoutingProblem, steps: int, warmth: float, seed: int = 1) -> tuple[Arrays, np.ndarray]:
    """The state after some steps, and the best answer on the way."""
    held = arrays(problem, with_slope(problem, integer_routing(problem)), 60, seed)
    best = np.zeros(1 + len(held.node), dtype=np.int64)
    best[0] = np.iinfo(np.int64).max
    anneal(np.zeros(1, np.int64), *held.parts, best, np.array([10.0, 3.0, 0.0, 0.0]), steps, warmth, held.flags)
    return held, best


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("convention", "warmth"), [("exact", 1e4), ("trunc1", 1e4), ("exact", 10.0)])  # hot: nothing is put back
def test_what_is_kept_of_routes_is_what_they_are(kind: str, convention: str, warmth: float) -> None:
    for seed in range(3):
        problem = drawn(kind, seed, convention)
        held, best = searched(problem, 400, warmth, seed)
        following = held.node[:, k.FOLLOWING]
        routes = held.routes(following)
        again = arrays(problem, with_slope(problem, integer_routing(problem)), 60, seed)
        assert again.begin(routes)
        visited = sorted(site for route in routes for site in route.visits if not problem.sites.depot[site])
        left_out = sorted(held.absent[: held.sums[k.ABSENT]].tolist())
        assert sorted([*visited, *left_out]) == problem.customers.tolist()
        for c in problem.customers.tolist():
            assert (held.node[c, k.ROUTE] < 0) == (c in left_out)
        assert held.sums[: k.STEPS].tolist() == again.sums[: k.STEPS].tolist()
        kept = [(row[k.KIND], *row[k.VISITS : k.SOUND], *row[k.ROOM :]) for row in held.route.tolist() if row[k.VISITS]]
        anew = [(row[k.KIND], *row[k.VISITS : k.SOUND], *row[k.ROOM :]) for row in again.route.tolist() if row[k.VISITS]]
        assert sorted(kept) == sorted(anew)
        assert all(held.node[following[c], k.PREVIOUS] == c for c in visited)
        judged = problem.evaluate(held.routes(best[1:]))
        assert {v.check for v in judged.violations} <= {"visits"} or judged.feasible


def test_the_same_seed_takes_the_same_way_and_another_one_another() -> None:
    problem = small("capacity", 0, "round")
    (one, _), (again, _), (other, _) = (searched(problem, 200, 50.0, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.node, again.node) and np.array_equal(one.random, again.random)
    assert not np.array_equal(one.random, other.random)


def test_a_wish_to_end_is_heard_at_the_next_look() -> None:
    problem = small("capacity", 0, "round")
    held, best = searched(problem, 10, 1.0)
    done = int(held.sums[k.STEPS])
    anneal(np.ones(1, np.int64), *held.parts, best, np.array([10.0, 3.0, 0.0, 0.0]), 10**6, 1.0, held.flags)
    assert done <= held.sums[k.STEPS] <= done + 256
