import itertools
import math
import pickle
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from draws import draws
from routing_answers import drawn_limit, holds
from small_routing import small

from waybound import Evidence, InputError, Route, Routes, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.objective import PEAKS, Objective
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT, Travel

FEATURES = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "travel", "limited-fleet",
    "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes", "separate-durations",
)  # fmt: skip


def few(feature: str, seed: int, customers: int = 4) -> RoutingProblem:
    """A small problem with fewer customers still: all its answers can be judged one by one."""
    whole = small(feature, seed, "exact")
    kept = np.concatenate([whole.sites.depots, whole.customers[:customers]])
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


def some_moves(problem: RoutingProblem, rng: np.random.Generator) -> dict[str, Any]:
    """A statement on a set of moves, of a few or of many."""
    ids, share = problem.sites.ids, rng.choice([0.1, 0.4, 0.8])
    found = {a: [b for b in ids if a != b and rng.random() < share] for a in ids}
    return {"moves": {a: heads for a, heads in found.items() if heads} or {ids[-1]: [ids[0]]}}


def drawn(problem: RoutingProblem, rng: np.random.Generator) -> list[tuple[dict[str, Any], bool]]:
    """Some decisions on moves, and often one on the number of routes or on sets of moves."""
    pairs = [(a, b) for a in problem.sites.ids for b in problem.sites.ids if a != b]
    some = rng.choice(len(pairs), int(rng.integers(1, 7)), replace=False)
    numbers = [({"routes": int(rng.integers(1, 5))}, bool(rng.random() < 0.5)) for _ in range(int(rng.integers(0, 3)))]
    sets = [(some_moves(problem, rng), bool(rng.random() < 0.6)) for _ in range(int(rng.integers(0, 3)))]
    visits = [(some_visit(problem, rng), bool(rng.random() < 0.7)) for _ in range(int(rng.integers(0, 3)))]
    limits = [(drawn_limit(problem, rng), bool(rng.random() < 0.6)) for _ in range(int(rng.integers(0, 2)))]
    return [*(({"arc": list(pairs[k])}, bool(rng.random() < 0.35)) for k in some), *numbers, *sets, *visits, *limits]


def some_visit(problem: RoutingProblem, rng: np.random.Generator) -> dict[str, Any]:
    """A statement on a visit, mostly by some types of vehicle."""
    site, kinds = problem.sites.ids[rng.choice(problem.customers)], rng.permutation(len(problem.fleet)).tolist()
    return {"visited": site, "by": kinds[: int(rng.integers(1, len(kinds) + 1))]} if rng.random() < 0.8 else {"visited": site}


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
        problem = whole.restricted(decisions[: len(decisions) // 2]).restricted(decisions[len(decisions) // 2 :])
        left = [(answer, e) for answer, _, e in judged if all(holds(whole, answer, s) is truth for s, truth in decisions)]
        assert all(problem.evaluate(answer).feasible for answer, _ in left)
        if not problem.needed and not problem.exceeded:  # the judge does not look whether needed moves are made
            left = [(answer, e) for answer, _, e in judged if problem.evaluate(answer).feasible]
        best = min((e.values[0] for _, e in left), default=math.inf)
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
        yield Evidence("set-partitioning-duals", "", 0.0, {**routes, "apart": True})
        yield Evidence("set-partitioning-duals", "", 0.0, {**_priced_rows(problem, scale, rng), "visits": some(scale), "apart": True})
        yield Evidence("set-partitioning-duals", "", 0.0, {**routes, "apart": True, "ray": True})
        yield Evidence("state-space", "", 0.0, {"prices": some(scale), "resource": "order", "step": 1.0})
        yield Evidence("cut-multipliers", "", 0.0, {"out": some(scale), "in": some(scale)})
        for ray in (False, True):
            yield Evidence("set-partitioning-duals", "", 0.0, {**_priced_rows(problem, scale, rng), "visits": some(scale), "ray": ray})
        yield Evidence("spanning-tree", "", 0.0, {"multipliers": some(scale), "depot": float(rng.normal() * scale)})
    for site in problem.customers.tolist():
        yield Evidence("infeasible-site", "", 0.0, {"site": problem.sites.ids[site]})
    ids = [problem.sites.ids[k] for k in problem.customers]
    yield Evidence("sites-beyond-fleet", "", 0.0, {"sites": ids})
    yield Evidence("sites-apart", "", 0.0, {"sites": ids[:2]})


def _priced_rows(problem: RoutingProblem, scale: float, rng: np.random.Generator) -> dict[str, Any]:
    """Lists of who is remembered, subset rows, loads, and perhaps something claimed of the least walks."""
    customers = problem.customers

    def some(least: int) -> list[int]:
        return rng.choice(customers, int(rng.integers(least, len(customers) + 1)), replace=False).tolist()

    rows, loads = [], [{"sites": some(1), "price": abs(float(rng.normal())) * scale} for _ in range(int(rng.integers(0, 3)))]
    for _ in range(int(rng.integers(0, 4))):
        sites = rng.choice(customers, 3, replace=False).tolist()
        rows.append({"sites": sites, "memory": sorted({*sites, *some(0)}), "price": -abs(float(rng.normal())) * scale})
    remembered = [[] if problem.sites.depot[k] else some(0) for k in range(len(problem.sites))]
    claimed = {key: float(rng.normal()) * scale for key in ("least", "least_needed") if rng.random() < 0.3}
    return {"remembered": remembered, "rows": rows, "loads": loads, **claimed}


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
                  {"routes": 2, "arc": ["1", "2"]}, {"moves": {}}, {"moves": []}, {"moves": None}, {"moves": {"1": []}},
                  {"moves": {"1": "2"}}, {"moves": {"1": ["2", "2"]}}, {"moves": {"1": ["1"]}}, {"moves": {"1": ["2"]}, "arc": ["1", "2"]},
                  {"by": [0]}, {"visited": "1", "arc": ["1", "2"]}, {"visited": "1", "by": [0], "routes": 1}, {"visited": "1", "times": 1}]
)  # fmt: skip
def test_what_is_no_statement_on_a_move_is_refused(statement: object) -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        few("capacity", 0).restricted([(statement, True)])


@pytest.mark.parametrize(
    ("statement", "words", "opposite"),
    [
        ({"arc": ["1", "2"]}, "some route goes from 1 straight to 2", "no route goes from 1 straight to 2"),
        ({"moves": {"1": ["2"]}}, "some route goes from 1 straight to 2", "no route goes from 1 straight to 2"),
        ({"moves": {"1": ["2", "3"], "0": ["4"]}}, "some route makes one of 3 moves", "no route makes any of 3 moves"),
        ({"routes": 1}, "there is at most 1 route", "there are at least 2 routes"),
        ({"routes": 2}, "there are at most 2 routes", "there are at least 3 routes"),
        ({"visited": "2"}, "2 is visited", "2 is not visited"),
        ({"visited": "2", "by": [0]}, "2 is visited by vehicle", "2 is not visited by vehicle"),
    ],
)
def test_every_statement_can_be_said_in_words(statement: dict[str, Any], words: str, opposite: str) -> None:
    problem = few("capacity", 0)
    problem.check_statement(statement)
    assert (problem.in_words(statement, True), problem.in_words(statement, False)) == (words, opposite)


@pytest.mark.parametrize("moves", [{"1": ["nobody"]}, {"nobody": ["1"]}, {"1": [2]}, {"1": [["2"]]}, {1: ["2"]}])
def test_a_set_of_moves_between_sites_that_do_not_exist_is_refused(moves: object) -> None:
    with pytest.raises(InputError, match="names a site that does not exist", check=coded("unknown-name")):
        few("capacity", 0).check_statement({"moves": moves})


@pytest.mark.parametrize("site", ["nobody", "0", "", 1, None, True, ["1"], {"1": 1}, 1.0])
def test_a_visit_to_somebody_who_is_no_customer_is_refused(site: object) -> None:
    with pytest.raises(InputError, match="names no customer", check=coded("unknown-name")):
        few("capacity", 0).check_statement({"visited": site})


@pytest.mark.parametrize("kinds", [[], [3], [-1], [0, 0], [0.0], ["0"], [True], [None], None, 0, "0", {"0": 0}, [10**30], [[0]]])
def test_a_visit_by_types_that_do_not_exist_is_refused(kinds: object) -> None:
    problem = few("heterogeneous-fleet", 0)
    problem.check_statement({"visited": "1", "by": [2, 0]})
    with pytest.raises(InputError, match="does not say by which types", check=coded("unknown-name")):
        problem.restricted([({"visited": "1", "by": kinds}, True)])


def optional(problem: RoutingProblem, *ids: str) -> RoutingProblem:
    """The same problem, in which these may be left out."""
    required = problem.sites.required & ~np.isin(problem.sites.ids, ids)
    return replace(problem, sites=replace(problem.sites, required=required))


def test_who_is_visited_is_so_by_a_needed_move() -> None:
    whole = few("capacity", 0)
    problem, n = optional(whole, "2", "3"), len(whole.sites)
    (into,) = problem.restricted([({"visited": "2"}, True)]).needed
    assert np.argwhere(into).tolist() == [[k, 2] for k in range(n) if k != 2]
    assert problem.restricted([({"visited": "1"}, True)]).needed == ()  # he is required
    without = problem.restricted([({"visited": "2"}, False)])
    assert without.forbidden is not None and not without.needed
    assert np.argwhere(without.forbidden).tolist() == [[a, b] for a in range(n) for b in range(n) if 2 in (a, b)]
    for arc, kept in ((["2", "3"], 1), (["1", "2"], 1), (["2", "4"], 1), (["0", "3"], 1), (["1", "4"], 0), (["4", "0"], 0)):
        part = problem.restricted([({"arc": arc}, True)])
        assert [np.argwhere(moves).tolist() for moves in part.needed] == [[[int(arc[0]), int(arc[1])]]] * kept
        assert problem.restricted([({"arc": arc}, False)]).needed == () == whole.restricted([({"arc": arc}, True)]).needed


def test_types_that_do_not_visit_a_site_lack_a_skill() -> None:
    problem = few("heterogeneous-fleet", 0)
    site = {"visited": "2", "by": [0, 2]}
    held, other = problem.restricted([(site, True)]), problem.restricted([(site, False)])
    assert held.needed == () and (held.forbidden is None or not held.forbidden.any())

    def able(part: RoutingProblem) -> list[int]:
        index = part.site_index["2"]
        verdicts = [part.evaluate(Routes((Route((index,), kind),))) for kind in range(len(part.fleet))]
        return [kind for kind, verdict in enumerate(verdicts) if not any(v.check == "skills" for v in verdict.violations)]

    assert (able(held), able(other)) == ([0, 2], [1])
    assert able(held.restricted([({"visited": "2", "by": [1, 2]}, True)])) == [2]
    assert able(problem.restricted([(site, True), ({"visited": "2", "by": [2]}, False)])) == [0]
    assert able(problem.restricted([({"visited": "3", "by": [1]}, True)])) == [0, 1, 2]
    every = problem.restricted([({"visited": "2", "by": [0, 1, 2]}, True)])
    assert not every.sites.skills and every.restricted([(site, True)]).restricted([(site, True)]).sites.skills[2] == {
        "statement 1",
        "statement 2",
    }
    nobody = problem.restricted([({"visited": "2", "by": [1, 0, 2]}, False)])
    assert nobody.forbidden is not None and nobody.forbidden[2].all() and nobody.forbidden[:, 2].all()
    assert problem.in_words(site, True) == "2 is visited by small or hired"
    assert len({part.digest() for part in (problem, held, other, nobody)}) == 4


def test_made_up_skills_are_not_those_of_the_data() -> None:
    problem = few("heterogeneous-fleet", 0)
    skills = (frozenset[str](), frozenset({"statement 1"}), *[frozenset[str]()] * (len(problem.sites) - 2))
    fleet = (problem.fleet[0], replace(problem.fleet[1], skills=frozenset({"statement 1", "statement 2"})), problem.fleet[2])
    part = replace(problem, sites=replace(problem.sites, skills=skills), fleet=fleet).restricted([({"visited": "1", "by": [0]}, True)])
    assert part.sites.skills[1] == {"statement 1", "statement 3"} and part.fleet[0].skills == {"statement 3"}


@pytest.mark.parametrize("term", PEAKS)
@pytest.mark.parametrize("feature", ["capacity", "time-windows", "depot-windows", "service-times", "heterogeneous-fleet", "open-routes"])
def test_a_limit_of_the_largest_route_keeps_those_that_meet_it_exactly_and_the_others_are_longer(feature: str, term: str) -> None:
    whole = few(feature, 2)
    whole = replace(whole, objective=Objective.of(term), fleet=tuple(replace(v, count=2) for v in whole.fleet))
    judged = [(answer, e.values[0]) for answer in answers(whole) if (e := whole.evaluate(answer)).feasible]
    for limit in sorted({value for _, value in judged})[:: 1 + len(judged) // 8]:
        statement = {"term": term, "at_most": limit}
        held, other = (whole.restricted([(statement, truth)]) for truth in (True, False))
        kept = {a for a, _ in judged if held.evaluate(a).feasible}
        assert kept >= {a for a, value in judged if value <= limit}
        assert all(value <= limit * (1.0 + 1e-9) for a, value in judged if a in kept)
        assert all(other.evaluate(a).feasible for a, _ in judged) and other.exceeded == {term: limit}
        beyond = min((value for _, value in judged if value > limit), default=math.inf)
        bound = verified_bound(other, Evidence("farthest-round-trip", "", 0.0, {}))
        assert limit * (1.0 - 1e-14) <= bound <= beyond * (1.0 + 1e-14)
        prices = Evidence("set-partitioning-duals", "", 0.0, {"visits": [1.0] * len(whole.sites), "memory": 9, "ray": True, "apart": True})
        assert verified_bound(held, prices) == -math.inf


def test_the_larger_of_two_numbers_is_exceeded_and_a_bound_is_the_next_multiple() -> None:
    sites = Sites.of("abc")
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=0.1 * (np.ones((3, 3)) - np.eye(3))), (VehicleType(2),), "2*longest-route")
    nothing = Evidence("farthest-round-trip", "", 0.0, {})
    part = problem.restricted([({"term": "longest-route", "at_most": 0.21}, False), ({"term": "longest-route", "at_most": 0.1}, False)])
    assert part.exceeded == {"longest-route": 0.21} and verified_bound(part, nothing) == 0.6
    assert verified_bound(problem, nothing) == pytest.approx(0.4) and verified_bound(part, nothing) == 0.6
    uneven = np.array([[0.0, 0.1, 0.1], [0.1, 0.0, math.pi / 30.0], [0.1, math.pi / 30.0, 0.0]])  # multiples of nothing
    plain = replace(problem, travel=Travel(EXPLICIT, matrix=uneven))
    part = plain.restricted([({"term": "longest-route", "at_most": 0.21}, False)])
    assert verified_bound(part, nothing) == pytest.approx(0.42)
    assert part.digest() != plain.restricted([]).digest()
    assert replace(part, min_vehicles=1).exceeded == part.exceeded and pickle.loads(pickle.dumps(part)).exceeded == part.exceeded
    assert part.continue_from(Routes.of([[1], [2]]), 0.0).exceeded == {}


def test_a_longest_duration_on_which_a_risk_hangs_stays_as_it_is() -> None:
    matrix = np.ones((3, 3)) - np.eye(3)
    travel = Travel(EXPLICIT, matrix=matrix, variances=0.1 * matrix)
    fleet = (VehicleType(1, max_duration=9.0, risk=0.1), VehicleType(1, max_duration=9.0, name="certain"))
    problem = RoutingProblem(Sites.of("abc"), travel, fleet, "makespan")
    statement = {"term": "makespan", "at_most": 3.0}
    assert [v.max_duration for v in problem.restricted([(statement, True)]).fleet] == [9.0, 3.0]
    team = replace(problem, team_risk=0.1)
    assert [v.max_duration for v in team.restricted([(statement, True)]).fleet] == [9.0, 9.0]
    answer = Routes((Route((1, 2), 0),))  # takes 3, and may take longer with more than its risk
    assert problem.restricted([(statement, True)]).evaluate(answer).feasible


@pytest.mark.parametrize("term", ["total-cost", "", None, 1, ["makespan"]])
def test_a_limit_of_no_largest_route_is_refused(term: object) -> None:
    with pytest.raises(InputError, match="names no such term", check=coded("unknown-name")):
        few("capacity", 0).check_statement({"term": term, "at_most": 1.0})


@pytest.mark.parametrize("most", [math.inf, math.nan, None, "1", True, [1.0]])
def test_a_limit_that_is_no_number_is_refused(most: object) -> None:
    with pytest.raises(InputError, match="no finite number"):
        few("capacity", 0).check_statement({"term": "makespan", "at_most": most})


def test_limits_in_words() -> None:
    problem, statement = few("capacity", 0), {"term": "latest-return", "at_most": 12.5}
    problem.check_statement(statement)
    problem.check_statement({"term": "makespan", "at_most": -3})
    assert problem.in_words(statement, True) == "the latest return is at most 12.5"
    assert problem.in_words(statement, False) == "the latest return is more than 12.5"


def test_sets_of_moves_are_forbidden_or_kept_with_the_problem() -> None:
    problem = few("capacity", 0)
    many, few_moves = {"moves": {"1": ["2", "3"], "0": ["1"]}}, {"moves": {"2": ["3"]}}
    apart = problem.restricted([({"arc": [a, b]}, False) for a, heads in many["moves"].items() for b in heads])
    without = problem.restricted([(many, False)])
    assert without.forbidden is not None and (without.forbidden == apart.forbidden).all() and not without.needed
    kept = problem.restricted([(many, True)]).restricted([(few_moves, True), ({"routes": 2}, True)])
    assert [np.argwhere(moves).tolist() for moves in kept.needed] == [[[0, 1], [1, 2], [1, 3]], [[2, 3]]]
    digests = {p.digest() for p in (problem, without, kept, problem.restricted([(many, True)]))}
    assert len(digests) == 4 and problem.digest() == replace(problem, needed=()).digest()
    assert len(replace(kept, min_vehicles=1).needed) == 2 and pickle.loads(pickle.dumps(kept)).needed[1][2, 3]
    assert kept.given(problem.evaluate(Routes.of([[1]])).values) is None  # there is one level
    assert all(kept.evaluate(answer).feasible for answer in answers(problem) if problem.evaluate(answer).feasible and len(answer) <= 2)


@pytest.mark.parametrize("seed", range(4))
def test_a_tree_of_sets_of_moves_proves_no_more_than_the_best(seed: int) -> None:
    problem, rng = few("capacity", seed), np.random.default_rng(seed)
    best = min(e.values[0] for e in map(problem.evaluate, answers(problem)) if e.feasible)
    far, n = problem.travel.distances, len(problem.sites)
    for _ in range(draws(40)):
        prices = {"visits": (2.0 * far[0] * rng.uniform(0.5, 1.0, n)).tolist(), **_priced_rows(problem, 3.0, rng)}
        leaf = {"kind": "set-partitioning-duals", "data": prices}
        # A set that some route makes a move of, and within the others the same again.
        nodes = [{"branch": some_moves(problem, rng)}, leaf, {"branch": some_moves(problem, rng), **leaf}, {}, leaf]
        assert verified_bound(problem, Evidence("branching-tree", "", 0.0, {"nodes": nodes})) <= best + 1e-9 * best


def test_moves_that_cost_too_much_are_ruled_out_all_at_once() -> None:
    """As by reduced costs: no route makes any of them, for one that does is too dear."""
    problem = few("capacity", 3)
    judged = [(moves(problem, answer), problem.evaluate(answer)) for answer in answers(problem)]
    best, made = min((e.values[0], made) for made, e in judged if e.feasible)
    ids = problem.sites.ids
    others = {a: heads for a in ids if (heads := [b for b in ids if a != b and (a, b) not in made and (b, a) not in made])}
    second = min(e.values[0] for used, e in judged if e.feasible and any(b in others.get(a, ()) for a, b in used))
    zero = {"kind": "set-partitioning-duals", "data": {"visits": [0.0] * len(ids), "memory": 9}}
    found = verified_bound(problem, Evidence("branching-tree", "", 0.0, {"nodes": [{"branch": {"moves": others}}, zero, zero]}))
    assert found <= best < second
    part = problem.restricted([({"moves": others}, True)])
    shares = [Evidence("set-partitioning-duals", "", 0.0, {"visits": [best / 4 * k for _ in ids], "memory": 9}) for k in (0.8, 0.9, 1.0)]
    whole = [verified_bound(problem, share) for share in shares]
    assert all(through >= bound for through, bound in zip((verified_bound(part, share) for share in shares), whole, strict=True))


def test_what_is_left_to_drive_needs_none_of_the_moves() -> None:
    problem = few("capacity", 0).restricted([({"moves": {"1": ["2"]}}, True)])
    plan = Routes.of([[site] for site in problem.customers.tolist()])
    assert problem.continue_from(plan, 0.0).needed == ()


def test_a_large_set_that_is_stated_once_is_read_once() -> None:
    n = 101
    sites = Sites.of(range(n), demand=[0, *np.ones(n - 1)])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((n, n))), (VehicleType(capacity=5.0),))
    statement = {"moves": {str(a): [str(b) for b in range(n) if a != b] for a in range(n)}}
    began = time.process_time()
    for _ in range(300):
        part = problem.restricted([(statement, True)])
    assert time.process_time() - began < 5.0  # 300 x 10,100 moves
    assert part.needed[0].sum() == n * (n - 1)
    assert problem.restricted([({"moves": {"1": ["2"]}}, True)]).needed[0].sum() == 1
    del statement["moves"]["1"][:50]
    assert problem.restricted([(statement, True)]).needed[0].sum() == n * (n - 1) - 50


@pytest.mark.parametrize("moves", [{"forbidden": np.zeros((2, 2), dtype=bool)}, {"needed": (np.zeros((2, 2), dtype=bool),)}])
def test_sets_of_moves_must_fit_the_sites(moves: dict[str, Any]) -> None:
    problem = few("capacity", 0)
    with pytest.raises(InputError, match="one for each pair of sites"):
        RoutingProblem(problem.sites, problem.travel, problem.fleet, **moves)
