"""Spanning-tree bounds never exceed the optimum, and reach it where a tree is all that matters."""

import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound import InputError, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.checking.spanning_tree import check_spanning_tree
from waybound.instances.routing.travel import EXPLICIT, Travel

SEEDS = st.integers(0, 10**6)


def data_from(vector: np.ndarray) -> dict:
    return {"multipliers": vector[:-1].tolist(), "depot": float(vector[-1])}


@settings(max_examples=draws(40), deadline=None)
@given(seed=SEEDS, scale=st.sampled_from([0.1, 1.0, 10.0, 1e3, 1e9]))
def test_no_prices_however_wrong_prove_more_than_the_optimum(random_problem, optimum, seed, scale):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best, rng = optimum(problem), np.random.default_rng(seed)
    for _ in range(8):
        bound = check_spanning_tree(problem, data_from(scale * rng.normal(size=len(problem.sites) + 1)))
        assert bound <= best + 1e-9 * max(1.0, abs(best))


@settings(max_examples=draws(25), deadline=None)
@given(seed=SEEDS)
def test_bounds_stay_below_the_optimum_on_the_way_to_the_best_prices(random_problem, optimum, ascent, seed):
    problem = random_problem(seed, customers=seed % 3 + 2)
    best = optimum(problem)
    seen = ascent(lambda v: check_spanning_tree(problem, data_from(v)), len(problem.sites) + 1, np.random.default_rng(seed), 120)
    assert max(seen) <= best + 1e-9 * max(1.0, abs(best))


def test_a_star_of_out_and_back_routes_is_proved_optimal():
    # One visit a vehicle: two vehicles, so two tree edges and two closing arcs at the depot.
    matrix = np.array([[0, 2, 3], [2, 0, 100], [3, 100, 0]], dtype=float)
    problem = RoutingProblem(Sites.of("abc", demand=[0, 1, 1]), Travel(EXPLICIT, matrix=matrix), (VehicleType(capacity=1.0),))
    assert check_spanning_tree(problem, {"multipliers": [0, 0, 0]}) == 10.0


def test_edges_of_length_zero_count_as_edges():
    matrix = np.array([[0, 0, 5], [0, 0, 0], [5, 0, 0]], dtype=float)
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=matrix), (VehicleType(count=1),))
    assert check_spanning_tree(problem, {"multipliers": [0, 0, 0]}) <= 5.0
    assert check_spanning_tree(problem, {"multipliers": [0, 0, 0]}) >= 0.0


def test_the_held_and_karp_bound_of_a_square_is_its_tour():
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    problem = RoutingProblem(Sites.of("abcd"), Travel("euclidean", coordinates=corners), (VehicleType(count=1),))
    assert check_spanning_tree(problem, {"multipliers": [0.0] * 4}) == pytest.approx(4.0, abs=1e-9)


def test_prices_beyond_all_measure_prove_nothing():
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    assert check_spanning_tree(problem, {"multipliers": [0.0, 1e308, -1e308], "depot": 1e308}) == -math.inf


@pytest.mark.parametrize(
    "spoil", [{"multipliers": [1.0]}, {"multipliers": [0, math.nan, 0]}, {"multipliers": {}}, {"depot": "x"}, {"depot": None}]
)
def test_malformed_evidence_is_refused(spoil):
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    with pytest.raises(InputError):
        check_spanning_tree(problem, {"multipliers": [0.0] * 3, "depot": 0.0, **spoil})


def test_evidence_without_prices_is_refused():
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    with pytest.raises(InputError, match="multipliers"):
        check_spanning_tree(problem, {})
