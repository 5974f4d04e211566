"""Greedy on selections and on bottlenecks."""

import math
import time

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st
from sata_cases import graph_of_rows
from selection_problems import (
    KINDS,
    context,
    cover_30,
    cover_tight,
    greedy_by_hand,
    half_tight,
    only_evidence,
    optimum,
    random_problem,
    run,
    value,
    weight_of_cover_30,
)

from waybound import BottleneckSATA, Cardinality, InputError, Knapsack, PartitionMatroid, SubmodularSelection, UsageError
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import Code
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation, UserFunction


def test_cover_30_with_every_evaluation() -> None:
    problem = cover_30(6)
    picks, evaluations = greedy_by_hand(weight_of_cover_30, 30, 6, lazy=False)
    for evaluation in ("plain", "lazy", "incremental"):
        outcome = run("greedy", problem, evaluation=evaluation)
        assert outcome.answer.elements == (9, 8, 15, 2, 3, 26) == tuple(picks)
        assert problem.gains(outcome.answer.elements).tolist() == [31, 27, 26, 21, 16, 12]
        assert value(problem, outcome) == 133 == weight_of_cover_30(picks)
        assert outcome.statistics["evaluation"] == evaluation
        assert outcome.statistics["plain_evaluations"] == 165 == evaluations
    assert run("greedy", problem, evaluation="plain").statistics["evaluations"] == 165


@pytest.mark.slow
def test_greedy_is_optimal_on_cover_30_for_three_and_four_sets() -> None:
    assert value(cover_30(3), run("greedy", cover_30(3))) == 84 == optimum(cover_30(3))
    assert value(cover_30(4), run("greedy", cover_30(4))) == 105 == optimum(cover_30(4))


def test_cover_tight_comes_close_to_the_bound() -> None:
    outcome = run("greedy", cover_tight())
    assert value(cover_tight(), outcome) == 62
    assert optimum(cover_tight()) == 80
    assert outcome.guarantee is not None and outcome.guarantee.ratio == pytest.approx(1 / 0.75)
    assert "(1 - (1 - 1/2)^2)" in outcome.guarantee.statement


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(["cardinality", "partition"]), st.booleans())
def test_every_evaluation_picks_alike_and_keeps_its_guarantee(seed: int, kind: str, constraint: str, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, whole=whole)
    plain = run("greedy", problem, evaluation="plain")
    evaluations = ["auto", "lazy"] + (["incremental"] if kind in ("coverage", "facility-location") else [])
    for evaluation in evaluations:
        other = run("greedy", problem, evaluation=evaluation)
        assert other.answer == plain.answer
        assert other.evidence == plain.evidence
        if evaluation == "lazy":
            assert other.statistics["evaluations"] <= plain.statistics["evaluations"]
    assert plain.statistics["evaluations"] == plain.statistics["plain_evaluations"]
    best = optimum(problem)
    assert plain.guarantee is not None and value(problem, plain) * plain.guarantee.ratio >= best * (1 - 1e-9)
    assert verified_bound(problem, only_evidence(plain)) >= best * (1 - 1e-12)


@given(st.integers(0, 10**6))
def test_many_rounds_of_rounding_do_not_part_the_evaluations(seed: int) -> None:
    """Weights that are no binary fractions, and many that are alike: drifting sums meet exact ties."""
    rng = np.random.default_rng(seed)
    n, items = 60, 40
    mask = rng.random((n, items)) < 0.3
    values = rng.choice([0.1, 0.2, 0.3, 0.7], (n, items))
    starts = np.concatenate([[0], np.cumsum(mask.sum(axis=1))])
    functions = [
        FacilityLocation(starts, np.nonzero(mask)[1], values[mask], items),
        Coverage(starts, np.nonzero(mask)[1], rng.choice([0.1, 0.2, 0.3], items)),
    ]
    for function in functions:
        for constraint in (Cardinality(30), PartitionMatroid.of(np.arange(n) % 20)):
            problem = SubmodularSelection(function, constraint)
            plain = run("greedy", problem, evaluation="plain").answer
            assert run("greedy", problem, evaluation="incremental").answer == plain
            assert run("greedy", problem, evaluation="lazy").answer == plain


def test_the_half_of_a_partition_matroid_is_tight() -> None:
    problem = half_tight(copies=3, excess=1e-6)
    outcome = run("greedy", problem)
    assert value(problem, outcome) / optimum(problem) == pytest.approx(0.5, abs=1e-6)
    assert outcome.guarantee is not None and outcome.guarantee.ratio == 2.0
    assert only_evidence(outcome).value == pytest.approx(optimum(problem))


def test_which_evaluation_runs_by_itself() -> None:
    rng = np.random.default_rng(1)
    matrix = rng.random((40, 30))
    thin = np.where(rng.random((40, 30)) < 0.03, matrix, 0.0)
    starts = np.concatenate([[0], np.cumsum((thin > 0).sum(axis=1))])
    full = FacilityLocation(np.arange(41) * 30, np.tile(np.arange(30), 40), matrix.ravel(), 30)
    expected = [
        (cover_30(2).function, "incremental"),
        (FacilityLocation(starts, np.nonzero(thin)[1], thin[thin > 0], 30), "incremental"),
        (full, "lazy"),
        (DenseFacilityLocation(matrix), "lazy"),
        (UserFunction(lambda m: m.sum(axis=1), 5, monotone=True, submodular=True), "lazy"),
        (UserFunction(lambda m: m.sum(axis=1), 5, monotone=True), "plain"),
    ]
    for function, evaluation in expected:
        assert run("greedy", SubmodularSelection(function, Cardinality(2))).statistics["evaluation"] == evaluation


def test_eps_ends_it_and_takes_the_guarantee() -> None:
    outcome = run("greedy", cover_30(6), eps=20.0)
    assert outcome.answer.elements == (9, 8, 15, 2)
    assert outcome.guarantee is None
    assert "no element gains 20" in outcome.message
    assert run("greedy", cover_30(6), eps=12.0).guarantee is not None
    assert run("greedy", cover_30(6), eps=1000.0).answer.elements == ()


def test_elements_that_add_nothing_are_taken_while_there_is_room() -> None:
    problem = SubmodularSelection(Coverage.from_sets([[0], [0], []], [1.0]), Cardinality(3))
    assert run("greedy", problem).answer.elements == (0, 1, 2)
    assert run("greedy", problem, eps=1e-9).answer.elements == (0,)


def test_top_n_allocation_is_exact_and_proved_so() -> None:
    """Observing the cells of largest utility: a sum, so that the bound meets greedy's answer."""
    utility = np.array([0.2, 1.7, 0.4, 3.1, 0.9, 3.1])
    private = Coverage.from_sets([[cell] for cell in range(6)], utility)
    sums = UserFunction(lambda masks: masks @ utility, 6, monotone=True, submodular=True, label="sum of utilities")
    for function in (private, sums):
        outcome = run("greedy", SubmodularSelection(function, Cardinality(3)))
        assert outcome.answer.elements == (3, 5, 1)
        assert only_evidence(outcome).value == pytest.approx(7.9)
        assert only_evidence(outcome).data == {"prefix": []}


def test_a_users_function_is_asked_for_many_sets_at_once() -> None:
    asked: list[tuple[int, int]] = []

    def roots(masks):  # type: ignore[no-untyped-def]
        asked.append(masks.shape)
        return np.sqrt(masks @ np.arange(1.0, 51.0))

    problem = SubmodularSelection(UserFunction(roots, 50, monotone=True, submodular=True), Cardinality(4))
    outcome = run("greedy", problem, evaluation="plain")
    assert outcome.answer.elements == (49, 48, 47, 46)
    assert len(asked) < 60
    assert max(rows for rows, _ in asked) >= 50
    assert "as declared by the user" in only_evidence(outcome).source
    assert outcome.guarantee is not None and any("declared by the user" in a for a in outcome.guarantee.assumptions)


@pytest.mark.parametrize(("monotone", "submodular"), [(False, False), (True, False), (False, True)])
def test_a_function_of_unknown_kind_gets_neither_guarantee_nor_bound(monotone: bool, submodular: bool) -> None:
    f = UserFunction(lambda masks: masks.sum(axis=1), 4, monotone=monotone, submodular=submodular)
    outcome = run("greedy", SubmodularSelection(f, Cardinality(2)))
    assert outcome.guarantee is None and outcome.evidence == ()
    assert "not declared monotone and submodular" in outcome.message


def test_a_declaration_that_a_sample_contradicts_is_not_relied_upon() -> None:
    growing = UserFunction(lambda masks: masks.sum(axis=1) ** 2.0, 6, monotone=True, submodular=True, label="squares")
    outcome = run("greedy", SubmodularSelection(growing, Cardinality(3)))
    assert outcome.guarantee is None and outcome.evidence == ()
    assert "not submodular" in outcome.message


@pytest.mark.parametrize(
    ("bad", "code"),
    [
        (lambda masks: np.ones((len(masks), 2)), "wrong-shape"),
        (lambda masks: np.where(masks.any(axis=1), math.nan, 0.0), "out-of-range"),
        (lambda masks: np.where(masks.any(axis=1), math.inf, 0.0), "out-of-range"),
        (lambda masks: 0.0 if len(masks) > 1 else np.zeros(1), "wrong-shape"),
        (lambda masks: np.zeros(1) if len(masks) == 1 else ["many"] * len(masks), "malformed"),
        (lambda masks: np.zeros(1) if len(masks) == 1 else None, "wrong-shape"),
    ],
)
@pytest.mark.parametrize("heuristic", ["greedy", "lazy-greedy", "stochastic-greedy", "brute-force"])
def test_what_a_users_function_returns_is_checked(heuristic: str, bad: object, code: Code) -> None:
    function = UserFunction(bad, 5, monotone=True, submodular=True)  # type: ignore[arg-type]
    with pytest.raises(InputError, check=coded(code)):
        run(heuristic, SubmodularSelection(function, Cardinality(2)))


# -- bottleneck --------------------------------------------------------------------------------------------------------


def test_bottleneck_greedy_can_be_arbitrarily_bad_and_promises_nothing() -> None:
    for d in (0.1, 0.01, 1e-6):
        problem = BottleneckSATA(graph_of_rows([(d, d), (1, 0)], [(0, 1)]))
        outcome = run("greedy", problem)
        assert value(problem, outcome) == pytest.approx(d)
        assert value(problem, run("brute-force", problem)) == 1.0
        assert outcome.guarantee is None
    tied = BottleneckSATA(graph_of_rows([(0, 1), (1, 0)], [(0, 1), (1, 0)], [(0, 0), (1, 0)], [(1, 0), (0, 0)]))
    assert value(tied, run("greedy", tied)) == 1.0
    assert value(tied, run("brute-force", tied)) == 2.0


@given(st.integers(0, 10**6))
def test_bottleneck_greedy_takes_the_best_worst_target_robot_by_robot(seed: int) -> None:
    rng = np.random.default_rng(seed)
    targets = int(rng.integers(1, 6))
    shape = [int(rng.integers(0, 4)) for _ in range(int(rng.integers(1, 6)))]
    robots = [[tuple(rng.integers(0, 4, targets).astype(float)) for _ in range(k)] for k in shape]
    weights = np.array([row for robot in robots for row in robot]).reshape(-1, targets)
    a, t = np.nonzero(weights)
    owner = [i for i, k in enumerate(shape) for _ in range(k)]
    problem = BottleneckSATA(graph_of_edges(owner, a, t, weights[a, t], robots=len(shape), targets=targets))
    covered, expected, first = np.zeros(targets), [], 0
    for k in shape:
        if k:
            trials = covered + weights[first : first + k]
            best = int(np.argmax(trials.min(axis=1)))
            covered, first = trials[best], first + k
            expected.append(first - k + best)
    assert run("greedy", problem).answer.elements == tuple(expected)


def test_options_of_selections_are_refused_for_a_bottleneck() -> None:
    with pytest.raises(UsageError, check=coded("contradiction")):
        run("greedy", BottleneckSATA(graph_of_rows([(1, 1)])), eps=0.5)


# -- users' functions that are slow, or lose --------------------------------------------------------------------------


def slow_roots(masks):  # type: ignore[no-untyped-def]
    time.sleep(0.02)
    return np.sqrt(masks.sum(axis=1))


@pytest.mark.parametrize(
    ("heuristic", "constraint"),
    [
        ("greedy", Cardinality(150)), ("lazy-greedy", Cardinality(150)), ("stochastic-greedy", Cardinality(150)),
        ("sequential-greedy", PartitionMatroid.of(np.arange(200))), ("brute-force", Cardinality(3)),
    ],
)  # fmt: skip
def test_a_slow_function_ends_at_the_time_limit_without_a_guarantee(heuristic: str, constraint: Cardinality | PartitionMatroid) -> None:
    n = 150 if heuristic == "brute-force" else 200
    problem = SubmodularSelection(UserFunction(slow_roots, n, monotone=True, submodular=True), constraint)
    outcome = HEURISTICS[heuristic].run(problem, context(seconds=0.05))
    assert problem.evaluate(outcome.answer).feasible
    assert outcome.guarantee is None
    assert "the time was up" in outcome.message


@pytest.mark.parametrize("heuristic", ["greedy", "lazy-greedy", "sequential-greedy", "stochastic-greedy", "knapsack-greedy"])
def test_elements_that_lose_are_not_taken(heuristic: str) -> None:
    worth = np.array([3.0, -1.0, 2.0, -5.0])
    constraint = {
        "sequential-greedy": PartitionMatroid.of([0, 1, 2, 3]),
        "knapsack-greedy": Knapsack(np.ones(4), 4.0),
    }.get(heuristic, Cardinality(4))
    problem = SubmodularSelection(UserFunction(lambda masks: masks @ worth, 4, submodular=True), constraint)
    outcome = run(heuristic, problem)
    assert sorted(outcome.answer.elements) == [0, 2]
    assert outcome.guarantee is None
