import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from patience import HANG
from selection_problems import cover_30, optimum, random_problem

import waybound as wb
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.benchmarks.saddle import expander
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.linear_relaxation import SMALL
from waybound.solvers.bounds.sata.item_prices import GAP, PriceGame, item_prices_bound

SPARSE = st.sampled_from(("coverage", "facility-location"))
LIMITS = st.sampled_from(("cardinality", "partition"))


@given(st.integers(0, 10**6), SPARSE, LIMITS, st.booleans())
def test_prices_prove_the_value_of_the_linear_relaxation(seed: int, kind: str, constraint: str, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, whole=whole)
    game = PriceGame(problem)
    game.run(Stop(HANG), most=20_000)
    relaxed = BACKENDS["highs"]().run(problem.compile("strong-linearisation", relax=True).program, Options(), Control()).objective
    assert relaxed is not None and game.closed()
    assert game.value * game.unit <= relaxed + 1e-7 * (1 + relaxed)
    assert game.bound * game.unit == pytest.approx(relaxed, rel=2 * GAP, abs=1e-7)
    evidence = item_prices_bound(problem, Stop(HANG))
    assert evidence.value == verified_bound(problem, evidence) >= optimum(problem) * (1 - 1e-12)


@pytest.mark.parametrize("exponent", [-900, 0, 900])
def test_the_unit_of_the_weights_does_not_matter(exponent: int) -> None:
    graph = expander(200)
    scaled = wb.SensingGraph(
        graph.robot_of_action, graph.indptr, graph.indices, np.ldexp(graph.weights, exponent), graph.num_robots, graph.num_targets
    )
    games = [PriceGame(wb.WinnerTakesAllSATA(g)) for g in (graph, scaled)]
    for game in games:
        game.run(Stop(HANG))
    assert games[0].steps == games[1].steps and games[0].bound == games[1].bound
    assert games[1].unit == math.ldexp(games[0].unit, exponent)


def test_weights_of_all_sizes_and_robots_that_see_nothing_are_taken() -> None:
    weights = np.exp(np.random.default_rng(3).normal(0, 40, 7))
    robots, actions, targets = [0, 0, 1, 1, 2, 2, 3], [0, 1, 2, 2, 3, 4, 5], [0, 1, 0, 2, 3, 3, 1]
    graph = graph_of_edges(*map(np.array, (robots, actions, targets)), weights, robots=9, targets=6)
    problem = wb.WinnerTakesAllSATA(graph)
    game = PriceGame(problem)
    game.run(Stop(HANG), most=20_000)
    assert game.closed() and game.bound * game.unit >= wb.solve(problem, "highs").objective * (1 - 1e-9)
    nothing = PriceGame(wb.SubmodularSelection(wb.Coverage.from_sets([[], []], []), wb.Cardinality(1)))
    assert nothing.closed() and nothing.bound == 0.0


@pytest.mark.parametrize("weight", [1.1e308, 1.0, 5e-324])
def test_the_largest_and_the_smallest_weights_are_taken(weight: float) -> None:
    function = wb.FacilityLocation(np.array([0, 1]), np.array([0]), np.array([weight]), 1)
    evidence = item_prices_bound(wb.SubmodularSelection(function, wb.Cardinality(1)), Stop(HANG))
    assert evidence is not None and weight <= evidence.value <= weight * (1 + 2 * GAP) + 5e-324


def test_what_the_limits_rule_out_weighs_nothing() -> None:
    function = wb.FacilityLocation(np.array([0, 2, 4, 6, 8]), np.array([0, 1] * 4), np.array([1e30, 1e25, 3, 1, 2, 2, 1, 3.5]), 2)
    problem = wb.SubmodularSelection(function, wb.PartitionMatroid.of([0, 1, 1, 1], [0, 1]))
    game = PriceGame(problem)
    game.run(Stop(HANG), most=20_000)
    evidence = item_prices_bound(problem, Stop(HANG))
    assert game.closed() and evidence is not None and evidence.value == pytest.approx(4.5, rel=2 * GAP) and optimum(problem) == 4.5


def test_the_general_search_finds_them_in_place_of_a_linear_program() -> None:
    problem = wb.WinnerTakesAllSATA(expander(SMALL // 4 + 100))
    assert not BOUNDS["item-prices"].missing(problem)
    assert BOUNDS["item-prices"].replaces(problem) == {"linear-relaxation"}
    solution = wb.solve(problem, heuristic="lazy-greedy", bound_time=HANG)
    assert solution.bound_kind == "verified" and solution.certificate.bound_source is not None
    assert "prices of items" in str(solution.certificate.bound_source)
    assert isinstance(solution.objective, float) and solution.bound is not None and 0.97 < solution.objective / solution.bound < 1
    again = item_prices_bound(problem, Stop(HANG))
    assert again is not None and verified_bound(problem, again) == solution.bound


def test_what_it_lacks_is_named_and_left_to_linear_programs() -> None:
    method = BOUNDS["item-prices"]
    assert method.missing(cover_30(3)) == {f"fewer than {SMALL} weights, which a linear program settles"}
    rng = np.random.default_rng(1)
    assert method.missing(random_problem(rng, "dense", "cardinality")) == {"a function that is not given by weights of single items"}
    assert method.missing(random_problem(rng, "user", "cardinality")) == {"a function that is not given by weights of single items"}
    assert method.missing(random_problem(rng, "coverage", "knapsack")) == {"a constraint other than a limit for each group"}
    assert method.missing(wb.BottleneckSATA(expander(9))) == {"max-min problems"}
    assert method.replaces(cover_30(3)) == method.replaces(wb.BottleneckSATA(expander(9))) == frozenset()


def test_the_limit_leaves_the_best_prices_so_far_and_none_where_it_was_over_before() -> None:
    problem = wb.WinnerTakesAllSATA(expander(2000))
    game, whole = PriceGame(problem), PriceGame(problem)
    game.run(Stop(HANG), most=50)
    whole.run(Stop(HANG))
    assert game.steps == 50 and not game.closed() and game.bound > whole.bound
    over = Stop(HANG)
    over.ask()
    assert item_prices_bound(problem, over) is None
    game.run(over)
    assert game.steps == 50
