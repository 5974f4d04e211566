import itertools

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, KINDS, optimum, random_problem, run, value

from waybound import BottleneckSATA, MaxMinLP, SensingGraph, SubmodularSelection, UsageError, WinnerTakesAllSATA, solve
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.sata.set_functions import Coverage, UserFunction


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(CONSTRAINTS), st.booleans())
def test_the_value_is_that_of_plain_enumeration(seed: int, kind: str, constraint: str, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, whole=whole)
    outcome = run("brute-force", problem)
    assert value(problem, outcome) == pytest.approx(optimum(problem), rel=1e-12, abs=1e-12)
    assert outcome.guarantee is not None and outcome.guarantee.ratio == 1.0


@given(st.integers(0, 10**6), st.sampled_from(CONSTRAINTS))
def test_functions_of_any_kind_are_maximised_if_they_are_a_users(seed: int, constraint: str) -> None:
    """Neither monotone nor submodular: then sets that are not full count as well."""
    rng = np.random.default_rng(seed)
    drawn = random_problem(rng, "coverage", constraint, 7)
    table = np.concatenate([[0.0], rng.normal(size=2**drawn.num_elements - 1)])
    f = UserFunction(lambda masks: table[masks @ (1 << np.arange(masks.shape[1]))], drawn.num_elements)
    problem = SubmodularSelection(f, drawn.constraint)
    assert value(problem, run("brute-force", problem)) == optimum(problem)


def random_graph(rng: np.random.Generator) -> SensingGraph:
    counts = rng.integers(0, 4, int(rng.integers(1, 5)))
    targets = int(rng.integers(1, 5))
    weights = rng.integers(0, 4, (int(counts.sum()), targets)) * rng.choice([1.0, 0.3])
    a, t = np.nonzero(weights)
    return SensingGraph.from_edges(np.repeat(np.arange(len(counts)), counts), a, t, weights[a, t], robots=len(counts), targets=targets)


@pytest.mark.filterwarnings("ignore::UserWarning")
@given(st.integers(0, 10**6))
def test_bottlenecks_by_plain_enumeration(seed: int) -> None:
    problem = BottleneckSATA(random_graph(np.random.default_rng(seed)))
    g = problem.graph
    options = [np.nonzero(g.robot_of_action == i)[0].tolist() or [None] for i in range(g.num_robots)]
    best = 0.0
    for chosen in itertools.product(*options):
        shares = np.zeros(g.num_actions)
        shares[[a for a in chosen if a is not None]] = 1.0
        best = max(best, float(problem.coverage(shares).min()))
    outcome = run("brute-force", problem)
    assert value(problem, outcome) == pytest.approx(best)
    assert outcome.statistics["enumerated"] <= outcome.statistics["answers"]
    assert len(outcome.answer) == sum(o != [None] for o in options)


@pytest.mark.share(3)
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("seed", range(8))
def test_highs_agrees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    problems = [BottleneckSATA(graph), WinnerTakesAllSATA(graph)]
    problems += [random_problem(rng, kind, constraint) for kind in KINDS[:4] for constraint in CONSTRAINTS]
    for problem in problems:
        exact = solve(problem, "highs", bound_time=0)
        assert exact.status == "optimal"
        assert value(problem, run("brute-force", problem)) == pytest.approx(exact.objective, rel=1e-6, abs=1e-6)


def test_branches_that_cannot_win_are_cut() -> None:
    rng = np.random.default_rng(1)
    f = Coverage.from_sets([rng.integers(0, 30, 6) for _ in range(18)], rng.random(30))
    outcome = run("brute-force", SubmodularSelection(f, Cardinality(6)))
    assert outcome.statistics["answers"] == 18564
    assert outcome.statistics["enumerated"] < 18564


def test_what_is_too_large_is_refused_in_one_line() -> None:
    f = Coverage.from_sets([[0]] * 100, [1.0])
    for constraint, count in ((Cardinality(10), "17,310,309,456,440"), (Knapsack(np.ones(100), 3.0), "about 10\\^30"),
                              (PartitionMatroid.of(np.arange(100) // 2), "about 10\\^15")):  # fmt: skip
        with pytest.raises(UsageError, match=f"at most 10,000,000 answers, this problem has {count}") as caught:
            run("brute-force", SubmodularSelection(f, constraint))
        assert "\n" not in str(caught.value)
    with pytest.raises(UsageError, match="at most 1,000,000"):
        run("brute-force", SubmodularSelection(UserFunction(lambda m: m.sum(axis=1), 30), Cardinality(30)))
    many = SensingGraph.from_edges(np.arange(60) // 2, np.arange(60), np.zeros(60, int))
    with pytest.raises(UsageError, match="at most 10,000,000 answers, this problem has 1,073,741,824"):
        run("brute-force", BottleneckSATA(many))


def test_memory_is_bounded_too() -> None:
    f = Coverage.from_sets([[k] for k in range(8000)], np.ones(8000))
    with pytest.raises(UsageError, match="brute-force keeps 8,000 x 8,000 numbers", check=coded("too-large")):
        run("brute-force", SubmodularSelection(f, PartitionMatroid.of(np.arange(8000))))


def test_other_max_min_problems_are_not_taken() -> None:
    graph = SensingGraph.from_edges([0], [0], [0])
    for name in ("brute-force", "random", "lp-rounding", "greedy"):
        assert HEURISTICS[name].missing(BottleneckSATA(graph, fractional=True)) == {"bottleneck-lp problems"}
        assert HEURISTICS[name].missing(MaxMinLP(np.eye(2), np.eye(2)))
        assert not HEURISTICS[name].missing(BottleneckSATA(graph))
