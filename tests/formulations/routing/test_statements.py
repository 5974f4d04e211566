"""Statements on moves and on the number of routes: no evidence on what they leave proves more than the best answer."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from coded import coded
from draws import draws
from small_routing import small

from waybound.formulations.evidence import Evidence
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import InputError

FEATURES = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "travel", "limited-fleet",
    "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes", "separate-durations",
)  # fmt: skip


def few(feature: str, seed: int, customers: int = 4) -> RoutingProblem:
    """A small problem with fewer customers still: all its answers can be judged one by one."""
    whole = small(feature, seed, "exact")
    kept = np.concatenate([whole.sites.depots, whole.customers[:customers]])
    from waybound.instances.routing.instance import Sites
    from waybound.instances.routing.travel import EXPLICIT, Travel

    s = whole.sites
    sites = Sites.of(
        [s.ids[k] for k in kept], depot=s.depot[kept], demand=s.demand[kept], ready=s.ready[kept], due=s.due[kept], service=s.service[kept]
    )
    grid = np.ix_(kept, kept)
    travel = Travel(EXPLICIT, matrix=whole.travel.distances[grid], duration_matrix=whole.travel.durations[grid])
    return RoutingProblem(sites, travel, whole.fleet, whole.objective, name=whole.name)


def answers(problem: RoutingProblem) -> Iterator[Routes]:
    """All ways to order the customers and to cut the order into routes, by all types of vehicle."""
    customers = problem.customers.tolist()
    for order in itertools.permutations(customers):
        for cuts in itertools.product((False, True), repeat=len(order) - 1):
            ends = [0, *(k + 1 for k, cut in enumerate(cuts) if cut), len(order)]
            parts = [order[a:b] for a, b in itertools.pairwise(ends)]
            if all(a[0] < b[0] for a, b in itertools.pairwise(parts)):
                for kinds in itertools.product(range(len(problem.fleet)), repeat=len(parts)):
                    yield Routes(tuple(Route(tuple(p), k) for p, k in zip(parts, kinds, strict=True)))


def moves(problem: RoutingProblem, answer: Routes) -> set[tuple[str, str]]:
    ids = problem.sites.ids
    made = set()
    for route in answer:
        stops = [problem.fleet[route.vehicle].start, *route.visits, problem.fleet[route.vehicle].end]
        made |= {(ids[a], ids[b]) for a, b in itertools.pairwise(stops)}
    return made


def drawn(problem: RoutingProblem, rng: np.random.Generator) -> list[tuple[dict[str, Any], bool]]:
    """Some decisions on moves, and often one on the number of routes."""
    pairs = [(a, b) for a in problem.sites.ids for b in problem.sites.ids if a != b]
    some = rng.choice(len(pairs), int(rng.integers(1, 7)), replace=False)
    numbers = [({"routes": int(rng.integers(1, 5))}, bool(rng.random() < 0.5)) for _ in range(int(rng.integers(0, 3)))]
    return [*(({"arc": list(pairs[k])}, bool(rng.random() < 0.35)) for k in some), *numbers]


def holds_as_decided(answer: Routes, made: set[tuple[str, str]], decision: tuple[dict[str, Any], bool]) -> bool:
    statement, holds = decision
    truth = len(answer) <= statement["routes"] if "routes" in statement else tuple(statement["arc"]) in made
    return truth is holds


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 6))])
def test_restricted_problems_keep_every_answer_of_their_decisions_and_no_evidence_beats_the_best(feature: str, seed: int) -> None:
    whole, rng = few(feature, seed), np.random.default_rng([seed, *feature.encode()])
    judged = [(answer, moves(whole, answer), whole.evaluate(answer)) for answer in answers(whole)]
    judged = [(answer, made, e) for answer, made, e in judged if e.feasible]
    n = len(whole.sites)
    for _ in range(draws(12)):
        decisions = drawn(whole, rng)
        problem = whole.restricted(decisions)
        for answer, made, _ in judged:
            if all(holds_as_decided(answer, made, decision) for decision in decisions):
                assert problem.evaluate(answer).feasible
        best = min((e.values[0] for answer, _, e in judged if problem.evaluate(answer).feasible), default=math.inf)
        for evidence in _attempts(whole, n, rng):
            assert verified_bound(problem, evidence) <= best + 1e-9 * abs(best), evidence.kind


def _attempts(problem: RoutingProblem, n: int, rng: np.random.Generator) -> Iterator[Evidence]:
    def some(scale: float) -> list[float]:
        return (rng.normal(size=n) * scale).tolist()

    for scale in (1.0, 30.0):
        resources = {name: np.abs(some(scale)).tolist() for name in ("time", "load", "order", "distance") if rng.random() < 0.5}
        data: dict[str, Any] = {"out": some(scale), "in": some(scale), "fleet": float(rng.normal() * scale), "resources": resources}
        yield Evidence("arc-multipliers", "", 0.0, data)
        yield Evidence("arc-multipliers", "", 0.0, {**data, "ray": True})
        routes = {"visits": some(scale), "memory": int(rng.integers(0, n))}
        yield Evidence("set-partitioning-duals", "", 0.0, routes)
        yield Evidence("set-partitioning-duals", "", 0.0, {**routes, "ray": True})
        yield Evidence("spanning-tree", "", 0.0, {"multipliers": some(scale), "depot": float(rng.normal() * scale)})
    for site in problem.customers.tolist():
        yield Evidence("infeasible-site", "", 0.0, {"site": problem.sites.ids[site]})
    ids = [problem.sites.ids[k] for k in problem.customers]
    yield Evidence("sites-beyond-fleet", "", 0.0, {"sites": ids})
    yield Evidence("sites-apart", "", 0.0, {"sites": ids[:2]})


def test_where_all_moves_are_decided_the_bound_is_the_answer() -> None:
    problem = few("capacity", 1)
    zeros = [0.0] * len(problem.sites)
    nothing = Evidence("arc-multipliers", "", 0.0, {"out": zeros, "in": zeros})
    pairs = [[a, b] for a in problem.sites.ids for b in problem.sites.ids if a != b]
    feasible = [answer for answer in answers(problem) if problem.evaluate(answer).feasible]
    for answer in feasible[:10]:
        made = moves(problem, answer)
        decided = problem.restricted([({"arc": pair}, tuple(pair) in made) for pair in pairs])
        assert verified_bound(decided, nothing) == pytest.approx(problem.evaluate(answer).values[0])


def test_a_site_that_is_entered_by_no_move_is_out_of_reach() -> None:
    problem = few("time-windows", 0)
    ids = problem.sites.ids
    alone = problem.restricted([({"arc": [a, ids[2]]}, False) for a in ids])
    assert verified_bound(alone, Evidence("infeasible-site", "", 0.0, {"site": ids[2]})) == math.inf
    assert verified_bound(alone, Evidence("infeasible-site", "", 0.0, {"site": ids[1]})) == -math.inf
    zeros = [0.0] * len(ids)
    assert verified_bound(alone, Evidence("arc-multipliers", "", 0.0, {"out": zeros, "in": zeros})) == math.inf


def test_a_forbidden_move_breaks_an_answer_in_words() -> None:
    problem = few("capacity", 0)
    ids, customers = problem.sites.ids, problem.customers.tolist()
    part = problem.restricted([({"arc": [ids[customers[0]], ids[customers[1]]]}, False)])
    judged = part.evaluate(Routes.of([customers[:2], *([c] for c in customers[2:])]))
    assert [v.message for v in judged.violations if v.check == "moves"] == [
        f"{part.fleet[0].name} 1 goes from {ids[customers[0]]} to {ids[customers[1]]}, which is forbidden"
    ]
    assert part.digest() != problem.digest() and part.features() - problem.features() == {"forbidden-moves"}
    assert (
        "set-partitioning" not in part.forms()
        and part.compile("three-index").program.num_variables < problem.compile("three-index").program.num_variables
    )


@pytest.mark.parametrize(
    "statement", [None, "1-2", {"arc": ["1"]}, {"arc": ["1", "nobody"]}, {"arc": [1, 2]}, {"arc": ["1", "2", "3"]}, {"arc": ["1", ["2"]]},
                  {"arc": ["1", "2"], "used": True}, {"arc": {"1": "2"}}, {"routes": 0}, {"routes": 1.0}, {"routes": True}, {"routes": 99},
                  {"routes": 2, "arc": ["1", "2"]}]
)  # fmt: skip
def test_what_is_no_statement_on_a_move_is_refused(statement: object) -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        few("capacity", 0).restricted([(statement, True)])


@pytest.mark.parametrize(
    ("statement", "words", "opposite"),
    [
        ({"arc": ["1", "2"]}, "some route goes from 1 straight to 2", "no route goes from 1 straight to 2"),
        ({"routes": 1}, "there is at most 1 route", "there are at least 2 routes"),
        ({"routes": 2}, "there are at most 2 routes", "there are at least 3 routes"),
    ],
)
def test_every_statement_can_be_said_in_words(statement: dict[str, Any], words: str, opposite: str) -> None:
    problem = few("capacity", 0)
    problem.check_statement(statement)
    assert (problem.in_words(statement, True), problem.in_words(statement, False)) == (words, opposite)


def test_forbidden_moves_must_fit_the_sites() -> None:
    problem = few("capacity", 0)
    with pytest.raises(InputError, match="one for each pair of sites"):
        RoutingProblem(problem.sites, problem.travel, problem.fleet, forbidden=np.zeros((2, 2), dtype=bool))
