"""The largest of all routes by bisection: optima are proved at any scale, no lie is, and both ends stand whenever it stops."""

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from draws import draws
from small_routing import plane, small
from truth.routing import best_values

from waybound import Evidence, InputError, Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.routing.objective import PEAKS, Objective
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds.routing import largest_limits
from waybound.solvers.bounds.routing.choice_of_routes import largest_route_bound
from waybound.solvers.bounds.routing.largest_limits import LimitSearch, LimitTree, stated

pytestmark = pytest.mark.usefixtures("compiled_pricing")


def tight(feature: str, seed: int, term: str, convention: str = "exact") -> RoutingProblem:
    """A small problem with few vehicles, so that the farthest site alone does not tell the largest route."""
    problem = small(feature, seed, convention)
    fleet = tuple(replace(v, count=1 if len(problem.fleet) > 1 else 2, capacity=2.0 * v.capacity) for v in problem.fleet)
    return replace(problem, objective=Objective.of(term), fleet=fleet)


def spread(seed: int, term: str = "longest-route", vehicles: int = 2) -> RoutingProblem:
    """One whose largest route is more than the farthest round trip."""
    return replace(plane((5, 6, 7, 4)[seed], 6, 100.0, vehicles), objective=Objective.of(term))


def proof(problem: RoutingProblem) -> tuple[float, Evidence]:
    """The best value, and a tree that proves it."""
    (best,), evidence = best_values(problem), largest_route_bound(problem, Stop(200.0), target=None)
    assert evidence is not None and evidence.kind == "branching-tree" and verified_bound(problem, evidence) == pytest.approx(float(best))
    return float(best), evidence


@cache
def spread_proof(seed: int) -> tuple[float, Evidence]:
    """The same for all lies about one problem."""
    return proof(spread(seed))


@pytest.mark.share(3)
@pytest.mark.parametrize("term", PEAKS)
@pytest.mark.parametrize("feature", ["capacity", "time-windows", "elapsed", "heterogeneous-fleet", "open-routes", "max-distance"])
def test_nothing_but_the_optimum_is_proved(feature: str, term: str) -> None:
    for seed in range(draws(3)):
        problem = tight(feature, seed, term, ("round", "exact", "trunc1")[seed % 3])
        best, evidence = best_values(problem), largest_route_bound(problem, Stop(60.0))
        if evidence is None:  # the farthest site says as much
            other = verified_bound(problem, Evidence("farthest-round-trip", "", 0.0, {}))
            assert best is not None and other == pytest.approx(float(best[0]))
        elif best is None:
            assert verified_bound(problem, evidence) == math.inf
        else:
            assert verified_bound(problem, evidence) == pytest.approx(float(best[0]), rel=1e-9) == evidence.value


@pytest.mark.parametrize("factor", [2.0**-60, 1.0 / 3.0, 2.0**70])
@pytest.mark.parametrize("term", PEAKS)
def test_the_optimum_is_proved_at_any_scale(term: str, factor: float) -> None:
    plain = spread(1, term)
    travel = Travel(EXPLICIT, matrix=factor * plain.travel.distances, convention="exact")
    best, _ = proof(replace(plain, travel=travel))
    assert best == pytest.approx(factor * float(best_values(plain)[0]), rel=1e-12)


def test_times_far_from_zero_and_whole_numbers_are_proved_too() -> None:
    plain = spread(3, "latest-return")
    whole = Travel(EXPLICIT, matrix=np.round(plain.travel.distances))
    for opens in (0.0, 1e6):
        sites = replace(plain.sites, ready=np.where(plain.sites.depot, opens, 0.0))
        problem = replace(plain, sites=sites, travel=whole)
        best, evidence = proof(problem)
        assert best > opens and verified_bound(problem, evidence) == best  # lifted to the whole number


Nodes = list[dict[str, Any]]


def lower(nodes: Nodes) -> None:
    """A limit that the best answer keeps, said to be ruled out by the same leaves."""
    nodes[0]["branch"]["at_most"] *= 1.02


def far(nodes: Nodes) -> None:
    nodes[0]["branch"]["at_most"] = 1e9


def swapped(nodes: Nodes) -> None:
    nodes[1:] = [nodes[-1], *nodes[1:-1]]


def unproved(nodes: Nodes) -> None:
    nodes[1:-1] = [{}]


def farthest_twice(nodes: Nodes) -> None:
    nodes[1:-1] = [nodes[-1]]


def free(nodes: Nodes) -> None:
    for node in nodes[1:-1]:
        if "kind" in node:
            data = node["data"].get("data", node["data"])
            data["visits"] = [0.0 for _ in range(7)]
            data.pop("rows", None), data.pop("loads", None)


def another_term(nodes: Nodes) -> None:
    nodes[0]["branch"]["term"] = "latest-return"


def only_that_side(nodes: Nodes) -> None:
    nodes[:] = nodes[1:-1]


def twice(nodes: Nodes) -> None:
    nodes[:] = [{"branch": {"term": "longest-route", "at_most": 1e9}}, *nodes, nodes[-1]]


LIES = (lower, far, swapped, unproved, farthest_twice, free, another_term, only_that_side, twice)


@pytest.mark.parametrize("lie", LIES)
@pytest.mark.parametrize("seed", range(2))
def test_planted_lies_prove_no_more_than_the_best(lie: Callable[[Nodes], None], seed: int) -> None:
    problem = spread(seed)
    best, evidence = spread_proof(seed)
    data = copy.deepcopy(evidence.data)
    lie(data["nodes"])
    try:
        bound = verified_bound(problem, replace(evidence, data=data))
    except InputError:
        return
    assert bound <= best * (1.0 + 1e-9)
    if lie in (unproved, free, far):
        assert bound < 0.9 * best


@pytest.mark.parametrize("at", [slice(0, -1), slice(1, None), slice(0, 1)])
def test_a_side_that_is_missing_is_refused(at: slice) -> None:
    problem = spread(0)
    _, evidence = spread_proof(0)
    with pytest.raises(InputError, match="branching tree"):
        verified_bound(problem, replace(evidence, data={"nodes": [*evidence.data["nodes"][at], *([{}] * (at.start or 0) * 2)]}))


def test_whenever_it_is_asked_to_end_both_ends_stand() -> None:
    problem, steps = spread(2, vehicles=3), []
    best = float(best_values(problem)[0])
    for last in range(0, 9, 2):
        stop, steps = Stop(60.0), list[float]()

        def told(most: int = last, end: Stop = stop, heard: list[float] = steps) -> None:
            heard.append(0.0)
            if len(heard) > most:
                end.ask()

        search = LimitSearch(problem, stop, 1, on_step=told)
        search.run()
        assert verified_bound(problem, search.evidence()) == search.bound <= best * (1.0 + 1e-9)
        assert search.answer is None or problem.evaluate(search.answer).values[0] == search.value >= best * (1.0 - 1e-9)


def test_without_a_first_answer_it_finds_them_all_itself() -> None:
    problem = spread(1, "makespan", 3)
    heard: list[float] = []
    search = LimitSearch(problem, Stop(60.0), 1, on_answer=lambda answer, value: heard.append(value))
    search.run()
    assert (
        search.done and heard == sorted(heard, reverse=True) and heard[-1] == search.value == pytest.approx(float(best_values(problem)[0]))
    )


def test_routes_beyond_the_limit_and_of_waiting_vehicles_are_not_taken_over() -> None:
    problem, every = spread(0), Routes.of([[1, 2, 3, 4], [5, 6], [1]])
    lengths = [problem.travel.distances[np.array([0, *r.visits]), np.array([*r.visits, 0])].sum() for r in every]
    former = LimitTree.of(problem, "longest-route", math.inf, Stop(60.0), 1, {})
    former.take(every, None)
    assert len(former.columns.pool) == 3
    tree = LimitTree.of(problem, "longest-route", float(np.mean(sorted(lengths)[:2])), Stop(60.0), 1, {})
    tree.take(None, former)
    assert [route.tolist() for route in tree.columns.pool.routes] == [[1]]
    late = replace(problem, objective=Objective.of("latest-return"), sites=replace(problem.sites, ready=np.arange(7.0)))
    tree = LimitTree.of(late, "latest-return", 1e3, Stop(60.0), 1, {})
    tree.take(every, None)
    assert not len(tree.columns.pool)


def test_a_problem_without_an_answer_is_proved_to_have_none() -> None:
    sites = Sites.of(range(4), demand=[0, 2, 2, 2])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(2, 3.0),), "makespan")
    evidence = largest_route_bound(problem, Stop(60.0))
    assert evidence is not None and verified_bound(problem, evidence) == math.inf


def test_a_limit_below_all_departures_leaves_nothing() -> None:
    problem = replace(spread(0, "latest-return"), sites=replace(spread(0).sites, ready=np.full(7, 50.0)))
    part = problem.restricted([(stated("latest-return", 10.0), True)])
    tree = LimitTree.of(problem, "latest-return", 10.0, Stop(60.0), 1, {})
    assert tree is not None and part.fleet[0].shift[1] == 10.0
    tree.work(5)
    assert tree.refuted and largest_limits.stated("latest-return", 10.0) == {"term": "latest-return", "at_most": 10.0}
