from dataclasses import replace

import numpy as np
import pytest
from oracles import routing
from small_routing import WHOLE_FAMILY, few, varied
from truth.routing import RoutingTruth

from waybound import Makespan, Objective, Route, Routes, TotalCost
from waybound.formulations.routing.checking.all_routes import check_all_routes
from waybound.formulations.routing.forms._all_routes import Walk
from waybound.instances.routing.travel import EXPLICIT, Travel

SEEDS = range(6)


def drawn(feature, seed):
    return varied(feature, seed, few(feature, 4))


def answers(problem, truth, rng):
    """The optimum and other answers of brute force, and these spoilt in many ways."""
    n, kinds = len(problem.sites), len(problem.fleet)
    found = [*truth.samples[:6]]
    for _ in range(40):
        if found and rng.random() < 0.6:
            routes = [list(r.visits) for r in found[int(rng.integers(len(found)))]]
        else:
            routes = [list(part) for part in np.array_split(rng.permutation(n), int(rng.integers(1, 4)))]
        for route in routes:
            change = rng.integers(4)
            if change == 0 and route:
                del route[int(rng.integers(len(route)))]
            elif change == 1:
                route.insert(int(rng.integers(len(route) + 1)), int(rng.integers(n)))
            elif change == 2:
                rng.shuffle(route)
        found.append(Routes.of(Route(tuple(int(k) for k in r), int(rng.integers(kinds))) for r in routes))
    return found


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_the_judge_says_what_brute_force_says(feature):
    rng, feasible, infeasible = np.random.default_rng(3), 0, 0
    for seed in SEEDS:
        problem = drawn(feature, seed)
        truth = RoutingTruth(problem)
        for answer in answers(problem, truth, rng):
            verdict, exact = problem.evaluate(answer), truth.value(answer)
            assert verdict.feasible == (exact is not None), (seed, answer, verdict.violations)
            if exact is None:
                infeasible += 1
            else:
                feasible += 1
                assert np.allclose(verdict.values, [float(v) for v in exact], rtol=1e-9, atol=1e-9), (seed, answer)
    assert feasible > 20 and infeasible > 20


@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_the_feature_is_declared_where_it_matters(feature):
    asked = {"several-depots": "multiple-depots", "penalties": "objective:penalties"}
    assert all(asked.get(feature, feature) in drawn(feature, seed).features() for seed in SEEDS if feature != "pickups")
    assert any(RoutingTruth(drawn(feature, seed)).lenient is not None for seed in SEEDS)


@pytest.mark.parametrize("seed", range(12))
def test_several_windows_before_moves_that_close_within_a_limited_duration(seed):
    """Departures that keep the one and not the other: judge, routes that the checker walks, and bounds against brute force."""
    rng, drawn_ = np.random.default_rng(seed + 100), varied("several-windows", seed, 3)
    n = len(drawn_.sites)
    closes = np.where(rng.random((n, n)) < 0.5, rng.integers(5, 60, (n, n)), np.inf)
    fleet = tuple(replace(v, max_duration=float(rng.integers(20, 70)), unit_duration_cost=1.0) for v in drawn_.fleet)
    objective = Objective.of(Makespan() if seed % 3 else TotalCost())
    travel = Travel(EXPLICIT, matrix=drawn_.travel.distances, closing=closes)
    problem = replace(drawn_, travel=travel, fleet=fleet, objective=objective)
    truth = RoutingTruth(problem)
    walks = [Walk(problem, kind) for kind in range(len(fleet))]
    for answer in answers(problem, truth, rng):
        verdict, exact = problem.evaluate(answer), truth.value(answer)
        assert verdict.feasible == (exact is not None), (answer, verdict.violations)
        if exact is not None:
            assert np.allclose(verdict.values, [float(v) for v in exact], rtol=1e-9, atol=1e-9), answer
        for route in (r for r in answer if len(set(r.visits)) == len(r.visits)):
            known, found = truth.roads.drive(route.vehicle, route.visits), walks[route.vehicle].given(route.visits)
            assert (known is None) == (found is None)
            assert found is None or found.duration == known.duration / truth.unit
    if truth.best is not None:
        assert check_all_routes(problem, {}) == pytest.approx(float(truth.best[0]), rel=1e-9)


def test_decimals_that_add_up_to_the_same_decide_no_level_but_the_last():
    """The longest of two routes takes 9.9 + 16.1 + 26 or 26 + 26: the same makespan, at a cost of 65.6 or 79.4."""
    matrix = np.array([[0, 6.8, 26, 9.9], [6.8, 0, 26.6, 10.7], [26, 26.6, 0, 16.1], [9.9, 10.7, 16.1, 0]])
    problem = routing(matrix=matrix, objective=Makespan().then(TotalCost()))
    truth = RoutingTruth(problem)
    assert [float(v) for v in truth.lenient] == pytest.approx([52.0, 65.6])
    assert problem.evaluate(truth.samples[0]).values == pytest.approx([52.0, 65.6])
