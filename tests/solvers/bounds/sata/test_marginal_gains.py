"""The bound method for selections, and the choice of a prefix."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from patience import HANG
from selection_problems import CONSTRAINTS, KINDS, cover_30, cover_tight, optimum, random_problem, run, value

import waybound as wb
from waybound import BottleneckSATA, Cardinality, Coverage, Knapsack, PartitionMatroid, SensingGraph, SubmodularSelection, UserFunction
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.sata.marginal_gains import best_prefix, marginal_gains_bound


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(CONSTRAINTS), st.booleans())
def test_the_evidence_is_valid_and_says_what_it_proves(seed: int, kind: str, constraint: str, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, whole=whole)
    evidence = marginal_gains_bound(problem, Stop(10.0))
    assert evidence is not None
    proved = verified_bound(problem, evidence)
    assert proved >= optimum(problem) * (1 - 1e-12)
    assert evidence.value == pytest.approx(proved, rel=1e-5, abs=1e-5)


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(CONSTRAINTS))
def test_the_best_of_all_prefixes_is_taken_where_that_costs_little(seed: int, kind: str, constraint: str) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, kind, constraint)
    picks = rng.permutation(problem.num_elements).tolist()
    chosen, looked = best_prefix(problem, picks)
    assert chosen is not None
    bounds = []
    for size in range(len(picks) + 1):
        evidence = type(chosen)("marginal-gains", "test", 0.0, {"prefix": picks[:size]})
        bounds.append(verified_bound(problem, evidence))
    assert verified_bound(problem, chosen) == pytest.approx(min(bounds), rel=1e-5, abs=1e-5)
    assert looked == (len(picks) + 1) * problem.num_elements


def test_few_prefixes_are_looked_at_where_each_is_expensive(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = cover_30(6)
    monkeypatch.setattr("waybound.solvers.bounds.sata.marginal_gains.WORK", 3 * len(problem.function.indices))  # type: ignore[union-attr]
    evidence, looked = best_prefix(problem, [9, 8, 15, 2, 3, 26])
    assert looked == 3 * 30
    assert evidence is not None and len(evidence.data["prefix"]) in (0, 3, 6)


def test_it_is_found_by_the_general_search_for_bounds() -> None:
    assert wb.bound(cover_tight(), bound_time=60.0).bound == pytest.approx(80)
    free = marginal_gains_bound(cover_tight(), Stop(60.0))
    assert free is not None and free.value == pytest.approx(81)
    solved = wb.solve(cover_tight(), heuristic="random", bound_time=60.0)
    assert solved.bound_kind == "verified" and solved.bound == pytest.approx(80)


def test_a_modular_function_under_a_cardinality_limit_is_bounded_exactly() -> None:
    problem = SubmodularSelection(Coverage.from_sets([[k] for k in range(9)], np.arange(9.0)), Cardinality(4))
    evidence = marginal_gains_bound(problem, Stop(60.0))
    assert evidence is not None and evidence.value == 8 + 7 + 6 + 5
    assert evidence.source == "marginal gains over the empty set"


def test_what_costs_nothing_is_in_the_set_that_a_knapsack_is_bounded_by() -> None:
    f = Coverage.from_sets([[0], [0, 1], [2], [3]], [4.0, 2.0, 5.0, 1.0])
    problem = SubmodularSelection(f, Knapsack(np.array([0.0, 0.0, 1.0, 1.0]), 1.0))
    evidence = marginal_gains_bound(problem, Stop(60.0))
    assert evidence is not None and evidence.value == pytest.approx(4 + 2 + 5)


def test_it_says_what_it_lacks() -> None:
    missing = BOUNDS["marginal-gains"].missing
    assert missing(BottleneckSATA(SensingGraph.from_edges([0], [0], [0]))) == {"max-min problems"}
    undeclared = SubmodularSelection(UserFunction(lambda m: m.sum(axis=1), 3), Cardinality(1))
    assert missing(undeclared) == {"a function that is declared monotone and submodular"}
    assert not missing(cover_tight())
    assert best_prefix(undeclared, [0]) == (None, 0)


def test_a_users_function_is_asked_little_more_once_the_search_is_to_end() -> None:
    calls, stop = [0], Stop(HANG)

    def counted(masks):  # type: ignore[no-untyped-def]
        calls[0] += 1
        if calls[0] == 6:
            stop.ask()
        return np.sqrt(masks.sum(axis=1))

    problem = SubmodularSelection(UserFunction(counted, 200, monotone=True, submodular=True), Cardinality(100))
    marginal_gains_bound(problem, stop)
    assert 6 <= calls[0] < 20
    evidence = marginal_gains_bound(problem, Stop(HANG))  # half of it for the choice, the rest for what it proves
    assert evidence is not None and verified_bound(problem, evidence) >= 10.0


@pytest.mark.slow
def test_large_functions_are_bounded_close_to_what_greedy_reaches() -> None:
    rng = np.random.default_rng(1)
    n, items = 20_000, 500
    sets = np.sort(rng.integers(0, items, (n, 6)), axis=1)
    f = Coverage.from_sets(sets, rng.uniform(1, 2, items))
    for constraint, heuristic in (
        (Cardinality(40), "greedy"),
        (PartitionMatroid.of(np.arange(n) % 40), "greedy"),
        (Knapsack(rng.uniform(1, 2, n), 40.0), "knapsack-greedy"),
    ):
        problem = SubmodularSelection(f, constraint)
        evidence = marginal_gains_bound(problem, Stop(10.0))
        assert evidence is not None
        reached = value(problem, run(heuristic, problem))
        assert reached <= verified_bound(problem, evidence) <= 1.6 * reached


@pytest.mark.parametrize("weight", [5e-324, 1e-310, 1e300])
@pytest.mark.parametrize("constraint", [Cardinality(3), Knapsack(np.ones(4), 2.0)], ids=["cardinality", "knapsack"])
def test_thresholds_among_the_smallest_numbers_end(weight: float, constraint: Cardinality | Knapsack) -> None:
    problem = SubmodularSelection(Coverage.from_sets([[0], [1], [0, 1], [2]], np.array([weight, 1.0, weight])), constraint)
    evidence = marginal_gains_bound(problem, Stop(60.0))
    assert evidence is not None and evidence.value >= optimum(problem)
    alone = SubmodularSelection(Coverage.from_sets([[0], [1], [0, 1], [2]], np.full(3, weight)), constraint)
    evidence = marginal_gains_bound(alone, Stop(60.0))
    assert evidence is not None and evidence.value >= optimum(alone)


def test_no_evidence_comes_after_the_time() -> None:
    asked = Stop()
    asked.ask()
    assert marginal_gains_bound(cover_30(3), asked.within(5.0)) is None
    assert best_prefix(cover_30(3), [0, 1], Stop(0.0)) == (None, 0)
