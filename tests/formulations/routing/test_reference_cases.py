import heapq
import math
from dataclasses import replace

import numpy as np
import pytest
from oracles import ASYM_5, GAP_5, MIN_COST, OCTO_8, SQUARE_4, agrees
from truth.routing import RoutingTruth, best_values

import waybound as wb
from waybound import Energy, LatestReturn, Makespan, Objective, Reward, Route, Routes, Sites, TotalCost, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

REFUEL = np.array([(0, 0), (8, 0), (2, 3), (5, 4), (9, 4), (11, 0), (6, -3)], dtype=float)
DATA = {
    "SQUARE-4": (Travel("euclidean", SQUARE_4), [0, 4, 10, 5, 3]),
    "GAP-5": (Travel("manhattan", GAP_5), [0, 3, 1, 4, 1, 5]),
    "ASYM-5": (Travel(EXPLICIT, matrix=ASYM_5), [0, 6, 9, 4, 7, 5]),
}


def sites(name):
    travel, reward = DATA[name]
    return Sites.of(range(len(travel)), reward=reward), travel


@pytest.mark.parametrize(("name", "vehicles", "limit", "best"), MIN_COST)
def test_least_cost(name, vehicles, limit, best):
    problem = wb.min_cost_vrp(*sites(name), vehicles=vehicles, max_duration=limit)
    assert best_values(problem) == (None if best is None else pytest.approx((best,)))


@pytest.mark.parametrize(
    ("name", "vehicles", "best"),
    [
        ("SQUARE-4", 1, 18), ("SQUARE-4", 2, 12), ("SQUARE-4", 3, 12), ("SQUARE-4", 4, 10), ("GAP-5", 1, 28), ("GAP-5", 2, 20),
        ("GAP-5", 3, 16), ("GAP-5", 4, 16), ("GAP-5", 5, 16), ("ASYM-5", 1, 16), ("ASYM-5", 2, 14), ("ASYM-5", 3, 13),
    ],
)  # fmt: skip
def test_least_makespan(name, vehicles, best):
    assert best_values(wb.min_makespan_vrp(*sites(name), vehicles=vehicles)) == pytest.approx((best,))


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("name", "vehicles", "limit", "reward", "makespan", "mixed"),
    [
        ("SQUARE-4", 1, 6, 4, 6, 1), ("SQUARE-4", 1, 8, 5, 8, 2), ("SQUARE-4", 1, 10, 10, 10, 7), ("SQUARE-4", 1, 12, 15, 12, 12),
        ("SQUARE-4", 1, 16, 19, 14, 16.375), ("SQUARE-4", 2, 8, 9, 8, 6), ("SQUARE-4", 2, 14, 22, 12, 19.4285714286),
        ("GAP-5", 2, 14, 9, 14, None), ("GAP-5", 2, 16, 13, 16, None), ("GAP-5", 3, 16, 14, 16, None), ("ASYM-5", 1, 14, 19, 14, 15),
        ("ASYM-5", 2, 12, 24, 12, 20), ("ASYM-5", 1, 10, 9, 9, 5.4), ("SQUARE-4", 1, 14, 19, 14, 16), ("SQUARE-4", 1, 18, 22, 18, 19),
        ("SQUARE-4", 2, 6, 7, 6, 4), ("SQUARE-4", 2, 10, 15, 10, 12), ("SQUARE-4", 2, 12, 22, 12, 19), ("SQUARE-4", 2, 16, 22, 12, 19.75),
        ("GAP-5", 2, 20, 14, 20, None), ("GAP-5", 2, 28, 14, 20, None), ("ASYM-5", 2, 10, 15, 9, 11.4),
    ],
)  # fmt: skip
def test_orienteering(name, vehicles, limit, reward, makespan, mixed):
    fleet = {"vehicles": vehicles, "max_duration": limit}
    assert best_values(wb.team_orienteering(*sites(name), **fleet)) == pytest.approx((reward,))
    assert best_values(wb.makespan_orienteering(*sites(name), **fleet)) == pytest.approx((reward, makespan))
    if mixed is not None:
        assert best_values(wb.makespan_orienteering(*sites(name), weight="printed", **fleet)) == pytest.approx((mixed,))


REWARDS = [
    *(("SQUARE-4", k, 5.9, 0) for k in (1, 2, 3)), ("GAP-5", 1, 14, 6), ("GAP-5", 1, 16, 9), ("GAP-5", 1, 18, 10), ("GAP-5", 1, 20, 13),
    ("GAP-5", 1, 28, 14), ("ASYM-5", 1, 8, 4), ("ASYM-5", 1, 12, 15),
]  # fmt: skip


@pytest.mark.parametrize(("name", "vehicles", "limit", "reward"), REWARDS)
def test_rewards(name, vehicles, limit, reward):
    assert best_values(wb.team_orienteering(*sites(name), vehicles=vehicles, max_duration=limit)) == pytest.approx((reward,))


@pytest.mark.parametrize(("vehicles", "limit", "mixed"), [(1, 8, 1), (1, 12, 11), (2, 8, 1)])
def test_the_printed_weight_where_the_triangle_inequality_fails(vehicles, limit, mixed):
    problem = wb.makespan_orienteering(*sites("ASYM-5"), vehicles=vehicles, max_duration=limit, weight="printed")
    assert best_values(problem) == pytest.approx((mixed,))


OCTO = (Sites.of(range(9), reward=[0, 5, 3, 8, 4, 6, 2, 7, 5]), Travel("euclidean", OCTO_8))

THROUGH_FORMS = {
    **{f"{name}, makespan, {k}": (wb.min_makespan_vrp(*sites(name), vehicles=k), best) for name, k, best in (
        ("SQUARE-4", 2, 12), ("SQUARE-4", 4, 10), ("GAP-5", 3, 16), ("ASYM-5", 2, 14))},
    **{f"{name}, reward, {k}, {limit}": (wb.team_orienteering(*sites(name), vehicles=k, max_duration=limit), best)
       for name, k, limit, best in (
           ("SQUARE-4", 2, 5.9, 0), ("SQUARE-4", 2, 12, 22), ("GAP-5", 1, 18, 10), ("GAP-5", 2, 16, 13), ("ASYM-5", 1, 12, 15))},
    **{f"{name}, mixed, {k}, {limit}": (
        wb.makespan_orienteering(*sites(name), vehicles=k, max_duration=limit, weight="printed"), best)
       for name, k, limit, best in (("SQUARE-4", 1, 16, 16.375), ("SQUARE-4", 2, 14, 19.4285714286), ("ASYM-5", 1, 10, 5.4))},
    **{f"OCTO-8, reward, 1, {limit}": (wb.orienteering(*OCTO, max_duration=limit), best)
       for limit, best in ((20, 8), (25, 13), (30, 18))},
    **{f"OCTO-8, reward, {k}, {limit}": (wb.team_orienteering(*OCTO, vehicles=k, max_duration=limit), best)
       for k, limit, best in ((2, 20, 15), (2, 25, 25), (3, 20, 21))},
}  # fmt: skip


@pytest.mark.share(2)
@pytest.mark.parametrize("case", THROUGH_FORMS)
def test_every_form_finds_it(case):
    problem, best = THROUGH_FORMS[case]
    forms = problem.forms()
    assert "three-index" in forms
    for form in forms if not case.startswith("OCTO") else forms[:1]:
        agrees(problem, form, best)


@pytest.mark.parametrize(("store", "best"), [(9.5, None), (10, 22)])
@pytest.mark.parametrize("form", ["three-index", "set-partitioning"])
def test_forms_keep_a_walk_between_stations_together(store, best, form):
    travel = Travel("euclidean", np.array([(0, 0), (10, 0), (1, 0), (11, 0)], dtype=float))
    problem = wb.recharging_vrp(Sites.of(range(4), depot=[True, True, False, False]), travel, energy=store, homes=[0])
    agrees(problem, form, best)


LONG = pytest.mark.long


@pytest.mark.parametrize(
    ("limit", "reward", "makespan"),
    [(20, 8, 18.111062), pytest.param(25, 13, 24.676581, marks=LONG), pytest.param(30, 18, 29.815734, marks=LONG)],
)
def test_the_printed_weight_on_eight_sites(limit, reward, makespan):
    problem = wb.makespan_orienteering(*OCTO, vehicles=1, max_duration=limit, weight="printed")
    agrees(problem, "three-index", reward - 2.0 / limit * makespan)


@pytest.mark.long
@pytest.mark.parametrize(("store", "best"), [(12, None), (14, 56), (16, 44), (20, 38), (40, 36)])
def test_refuelling_of_one_vehicle_through_a_form(store, best):
    places = Sites.of(range(7), depot=[True, True, *[False] * 5])
    problem = wb.recharging_vrp(places, Travel("manhattan", REFUEL), energy=store, homes=[0])
    agrees(problem, "three-index", best)


def test_the_printed_weight_may_prefer_a_smaller_reward():
    places = Sites.of("oab", reward=[0, 10, 9])
    travel = Travel("euclidean", np.array([(0, 0), (5, 0), (-0.5, 0)], dtype=float))
    printed = wb.makespan_orienteering(places, travel, vehicles=1, max_duration=10, weight="printed")
    found = RoutingTruth(printed)
    assert found.best is not None and float(found.best[0]) == pytest.approx(8.1)
    assert printed.evaluate(found.samples[0]).quantities["reward"] == 9
    assert best_values(wb.makespan_orienteering(places, travel, vehicles=1, max_duration=10)) == pytest.approx((10, 10))


def test_the_printed_weight_does_not_tell_a_visit_from_none():
    places, travel = Sites.of("oa", reward=[0, 4]), Travel("euclidean", np.array([(0, 0), (5, 0)], dtype=float))
    problem = wb.makespan_orienteering(places, travel, vehicles=1, max_duration=10, weight="printed")
    assert problem.evaluate(Routes.of([[1]])).values == problem.evaluate(Routes.of([])).values == (0.0,)


@pytest.mark.parametrize(
    ("store", "best"), [(12, (None, None, None)), (14, (56, 28, 36)), (16, (44, 24, 30)), (20, (38, 24, 28)), (40, (36, 24, 28))]
)
def test_refuelling(store, best):
    places = Sites.of(range(7), depot=[True, True, *[False] * 5])
    for homes, value in zip(([0], [0, 1], [0, 0]), best, strict=True):
        problem = wb.recharging_vrp(places, Travel("manhattan", REFUEL), energy=store, homes=homes)
        assert refuelled(problem) == (None if value is None else pytest.approx(value)), homes


@pytest.mark.parametrize(("store", "best"), [(9, None), (9.5, None), (10, 22), (12, 22)])
def test_a_walk_between_stations_must_hang_together(store, best):
    """Without connectivity rows the target beside the far station would be served by nobody who gets there."""
    places = Sites.of(range(4), depot=[True, True, False, False])
    travel = Travel("euclidean", np.array([(0, 0), (10, 0), (1, 0), (11, 0)], dtype=float))
    problem = wb.recharging_vrp(places, travel, energy=store, homes=[0])
    assert best_values(problem) == (None if best is None else pytest.approx((best,)))


def refuelled(problem):
    """Least makespan of a recharging problem: for each vehicle and set of sites the shortest walk, as the judge measures it."""
    move, store = problem.travel.distances.tolist(), problem.fleet[0].energy.capacity
    stations, targets = problem.sites.depots.tolist(), problem.customers.tolist()
    homes = [v.start for v in problem.fleet for _ in range(v.count)]
    kinds = [k for k, v in enumerate(problem.fleet) for _ in range(v.count)]
    walks = {}
    for home in set(homes):
        heap, seen = [(0.0, home, frozenset(), store, ())], {}
        while heap:
            cost, at, done, left, path = heapq.heappop(heap)
            if at == home:
                walks.setdefault((home, done), (cost, path))
            if any(c <= cost and r >= left for c, r in seen.setdefault((at, done), [])):
                continue
            seen[at, done].append((cost, left))
            for to in [*targets, *stations]:
                if to != at and to not in done and move[at][to] <= left:
                    rest = store if to in stations else left - move[at][to]
                    served = done | {to} if to in targets else done
                    heapq.heappush(heap, (cost + move[at][to], to, served, rest, (*path, to)))
    best, answer = math.inf, None
    for choice in np.ndindex(*[len(homes)] * len(targets)):
        sets = [frozenset(t for t, k in zip(targets, choice, strict=True) if k == q) for q in range(len(homes))]
        if all((home, s) in walks for home, s in zip(homes, sets, strict=True)):
            value = max(walks[home, s][0] for home, s in zip(homes, sets, strict=True))
            if value < best:
                best, answer = value, [(walks[home, s][1][:-1], k) for home, s, k in zip(homes, sets, kinds, strict=True) if s]
    if answer is None:
        return None
    verdict = problem.evaluate(Routes(tuple(Route(path, kind) for path, kind in answer)))
    assert verdict.feasible and verdict.values == pytest.approx((best,)), verdict.violations
    return best


# -- virtual nodes -----------------------------------------------------------------------------------------------------


def under_way(places, starts, **rest):
    """A problem in which vehicles start where they are, with what they have left; ``starts`` holds (site, energy left, since when)."""
    coordinates = np.array(places, dtype=float)
    depot = [True] + [k in [s for s, _, _ in starts] for k in range(1, len(places))]
    fleet = [
        VehicleType(1, start=site, end=0, energy=Energy(left), shift=(since, math.inf), committed=True, name=f"robot {site}")
        for site, left, since in starts
    ]
    travel = Travel("euclidean", coordinates)
    return wb.min_cost_vrp(Sites.of(range(len(places)), depot=depot), travel, fleet=[*fleet, *rest.get("fresh", [])])


def test_no_vehicle_under_way_collects_another():
    problem = under_way([(0, 0), (3, 4), (0, 4), (-3, 0)], [(1, 14, 0.0), (2, 9, 0.0)])
    assert best_values(problem) == pytest.approx((13,))


@pytest.mark.parametrize(
    ("left", "fresh", "best"),
    [((14, 9), 0, 19), ((14, 8), 0, 19), ((10.9, 8), 0, None), ((10.9, 8), 1, 24.2111025509), ((14, 7.9), 0, None), ((14, 7.9), 1, 21)],
)
def test_what_vehicles_under_way_have_left(left, fresh, best):
    more = [VehicleType(fresh, energy=Energy(20), name="fresh")] if fresh else []
    problem = under_way([(0, 0), (3, 4), (0, 4), (3, 0), (6, 4), (-3, 0)], [(1, left[0], 0.0), (2, left[1], 0.0)], fresh=more)
    assert best_values(problem) == (None if best is None else pytest.approx((best,)))


@pytest.mark.parametrize(("since", "best"), [((0, 0), 11), ((6, 0), 16.2111025509), ((0, 6), 14)])
def test_the_makespan_of_a_horizon_counts_from_its_start(since, best):
    problem = under_way([(0, 0), (3, 4), (0, 4), (3, 0), (6, 4), (-3, 0)], [(1, 30, since[0]), (2, 30, since[1])])
    assert best_values(replace(problem, objective=Objective.of(LatestReturn()))) == pytest.approx((best,))


def test_closing_moves_and_the_way_round():
    """Cell (1, 2) of a 3 x 5 grid closes: the way from (1, 0) to (1, 4) is 4 while it is open, and 6 round it."""
    for closes, allowed in ((2.5, True), (1.5, False)):
        travel = Travel(
            EXPLICIT, matrix=np.array([[0.0, 2, 4], [2, 0, 2], [4, 2, 0]]), closing=np.array([[9, 9, 9], [9, 9, closes], [9.0, 9, 9]])
        )
        problem = wb.min_cost_vrp(Sites.of("sab"), travel, vehicles=1)
        assert problem.evaluate(Routes.of([[1, 2]])).feasible == allowed
        assert best_values(problem) == pytest.approx((8,))


def test_terms_of_time_agree_where_nobody_waits():
    problem = wb.min_makespan_vrp(*sites("SQUARE-4"), vehicles=2)
    answer = Routes.of([[1, 2], [4, 3]])
    values = [
        replace(problem, objective=Objective.of(term)).evaluate(answer).values[0] for term in (Makespan(), LatestReturn(), TotalCost())
    ]
    assert values == pytest.approx([12, 12, 24])
    assert replace(problem, objective=Reward().then(Makespan())).evaluate(answer).values == pytest.approx((22, 12))
