import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from scipy.optimize import linprog

from waybound import InputError, Makespan, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.checking.arc_multipliers import PRICED, check_arc_multipliers
from waybound.instances.routing.travel import EXPLICIT, Travel

SEEDS = st.integers(0, 10**6)


def data_from(vector: np.ndarray, sites: int) -> dict:
    """Evidence from one vector: out, in, resources, fleet."""
    parts = vector[:-1].reshape(2 + len(PRICED), sites)
    resources = {name: (0.2 * row).tolist() for name, row in zip(PRICED, parts[2:], strict=True)}
    return {"out": parts[0].tolist(), "in": parts[1].tolist(), "fleet": float(vector[-1]), "resources": resources}


def nothing(sites: int) -> dict:
    return {"out": [0.0] * sites, "in": [0.0] * sites, "fleet": 0.0}


@settings(max_examples=draws(40), deadline=None)
@given(seed=SEEDS, scale=st.sampled_from([0.1, 1.0, 10.0, 1e3, 1e9]))
def test_no_multipliers_however_wrong_prove_more_than_the_optimum(random_problem, optimum, seed, scale):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best, rng, n = optimum(problem), np.random.default_rng(seed), len(problem.sites)
    for _ in range(8):
        bound = check_arc_multipliers(problem, data_from(scale * rng.normal(size=(2 + len(PRICED)) * n + 1), n))
        assert bound <= best + 1e-9 * max(1.0, abs(best))


@settings(max_examples=draws(25), deadline=None)
@given(seed=SEEDS)
def test_bounds_stay_below_the_optimum_on_the_way_to_the_best_multipliers(random_problem, optimum, ascent, seed):
    problem = random_problem(seed, customers=seed % 3 + 2)
    best, n = optimum(problem), len(problem.sites)
    seen = ascent(lambda v: check_arc_multipliers(problem, data_from(v, n)), (2 + len(PRICED)) * n + 1, np.random.default_rng(seed), 120)
    assert max(seen) <= best + 1e-9 * max(1.0, abs(best))


def test_good_multipliers_prove_the_optimum_of_an_assignment():
    # Two customers a unit from the depot on opposite sides, one visit a route: the relaxation is the problem.
    travel = Travel("euclidean", coordinates=np.array([[0.0, 0.0], [3.0, 0.0], [-3.0, 0.0]]))
    problem = RoutingProblem(Sites.of("abc", demand=[0, 1, 1]), travel, (VehicleType(capacity=1.0),))
    data = {"out": [0.0, 3.0, 3.0], "in": [0.0, 3.0, 3.0], "fleet": 0.0}
    assert check_arc_multipliers(problem, data) == 12.0


def two_far_pairs() -> RoutingProblem:
    """Pairs b-c and d-e: far from the depot and from each other, so that an assignment loops through one of them for 2."""
    matrix = np.full((5, 5), 10.0)
    matrix[1, 2] = matrix[2, 1] = matrix[3, 4] = matrix[4, 3] = 1.0
    np.fill_diagonal(matrix, 0.0)
    return RoutingProblem(Sites.of("abcde", due=[100, 12, 12, 25, 25]), Travel(EXPLICIT, matrix=matrix), (VehicleType(),))


def flow_relaxation(problem: RoutingProblem, *, with_time: bool) -> tuple[float, dict]:
    """Optimum of the two-index LP, written out by hand, and its duals as evidence."""
    n, cost = len(problem.sites), problem.travel.distances
    arcs = [(i, j) for i in range(n) for j in range(n) if i != j]
    low = [max(float(cost[0, i]), 0.0) for i in range(n)]
    high = [min(float(problem.sites.due[i]), 100.0 - float(cost[i, 0])) for i in range(n)]
    size = len(arcs)
    equal, at_most, right, limits = np.zeros((2 * n - 2, 2 * size)), [], [], []
    for k, (i, j) in enumerate(arcs):
        if i:
            equal[i - 1, k] = 1.0
        if j:
            equal[n - 1 + j - 1, k] = 1.0
        usable = not (i and j) or low[i] + cost[i, j] <= high[j]
        limits.append((0.0, None if usable else 0.0))
        if i and usable:
            row = np.zeros((2, 2 * size))
            row[0, [k, size + k]] = low[i], -1.0
            row[1, [k, size + k]] = -min(high[i], (high[j] if j else 100.0) - cost[i, j]), 1.0
            at_most.extend(row)
            right.extend([0.0, 0.0])
    prices = len(at_most)
    for i in range(1, n):
        row = np.zeros(2 * size)
        for k, (h, j) in enumerate(arcs):
            row[size + k] += (j == i and h != 0) - (h == i)
            row[k] += cost[h, j] * (j == i)
        at_most.append(row)
        right.append(0.0)
    limits += [(0.0, None if with_time and i else 0.0) for i, _ in arcs]
    if not with_time:
        at_most, right = [np.zeros(2 * size)] * len(at_most), [0.0] * len(right)
    objective = np.concatenate([[cost[i, j] for i, j in arcs], np.zeros(size)])
    found = linprog(objective, A_eq=equal, b_eq=np.ones(2 * n - 2), A_ub=np.array(at_most), b_ub=right, bounds=limits)
    assert found.status == 0
    duals, time = found.eqlin.marginals, -found.ineqlin.marginals[prices:]
    data = {"out": [0.0, *duals[: n - 1]], "in": [0.0, *duals[n - 1 :]], "fleet": 0.0, "resources": {"time": [0.0, *time]}}
    return float(found.fun), data


def test_duals_of_the_flow_relaxation_prove_at_least_its_optimum():
    problem = two_far_pairs()
    value, duals = flow_relaxation(problem, with_time=True)
    assert check_arc_multipliers(problem, duals) >= value - 1e-4


def test_time_multipliers_prove_what_the_assignment_alone_cannot(optimum):
    problem = two_far_pairs()
    loose = check_arc_multipliers(problem, flow_relaxation(problem, with_time=False)[1])
    tight = check_arc_multipliers(problem, flow_relaxation(problem, with_time=True)[1])
    assert loose < tight <= optimum(problem)


def test_bounds_are_lifted_to_the_grain_of_the_distances():
    travel = Travel("euclidean", coordinates=np.array([[0.0, 0.0], [3.0, 4.0]]), convention="trunc1")
    problem = RoutingProblem(Sites.of("ab"), travel, (VehicleType(),))
    assert check_arc_multipliers(problem, nothing(2)) == 10.0


def test_an_open_fleet_counts_each_route_once_in_the_price_of_vehicles():
    matrix = np.array([[0, 1, 1], [1, 0, 9], [1, 9, 0]], dtype=float)
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=matrix), (VehicleType(fixed_cost=5.0),), min_vehicles=2)
    for phi in (-20.0, 0.0, 5.0, 6.0, 20.0):
        assert check_arc_multipliers(problem, {**nothing(3), "fleet": phi}) <= 14.0
    assert check_arc_multipliers(problem, {**nothing(3), "fleet": 6.0}) == 14.0


def test_a_problem_that_the_arcs_leave_no_answer_is_infeasible():
    problem = RoutingProblem(Sites.of("abc", due=[50, 5, 50]), Travel(EXPLICIT, matrix=np.full((3, 3), 10.0)), (VehicleType(),))
    assert check_arc_multipliers(problem, nothing(3)) == math.inf


@pytest.mark.parametrize("change", ["optional", "makespan"])
def test_nothing_is_proved_for_problems_outside_the_relaxation(change):
    required = [False, True, False] if change == "optional" else None
    sites = Sites.of("abc", required=required)
    objective = Makespan() if change == "makespan" else None
    travel = Travel(EXPLICIT, matrix=np.ones((3, 3)))
    problem = RoutingProblem(sites, travel, (VehicleType(),), **({"objective": objective} if objective else {}))
    assert check_arc_multipliers(problem, nothing(3)) == -math.inf


@pytest.mark.parametrize(
    "spoil",
    [
        {"out": [0.0, 0.0]}, {"out": [0.0, 0.0, 0.0, 0.0]}, {"out": None}, {"out": "abc"}, {"in": [0.0, "x", 0.0]},
        {"in": [0.0, math.nan, 0.0]}, {"in": [0.0, math.inf, 0.0]}, {"in": [0.0, True, 0.0]}, {"in": [0.0, [1.0], 0.0]}, {"fleet": "many"},
        {"fleet": math.nan}, {"fleet": 10**400}, {"resources": [1.0]}, {"resources": {"fuel": [0.0, 0.0, 0.0]}},
        {"resources": {"time": [0.0]}},
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused(spoil):
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    with pytest.raises(InputError):
        check_arc_multipliers(problem, {**nothing(3), **spoil})


def test_multipliers_beyond_all_measure_prove_nothing():
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    huge = {"out": [0.0, 1e308, 1e308], "in": [0.0, -1e308, 1e308], "fleet": -1e308, "resources": {"time": [0, 1e308, 0]}}
    assert check_arc_multipliers(problem, huge) == -math.inf
