import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st
from sata_cases import CASES, graph_of_rows
from selection_problems import KINDS, half_tight, only_evidence, optimum, random_problem, run, value

from waybound import Coverage, PartitionMatroid, SensingGraph, SubmodularSelection, WinnerTakesAllSATA
from waybound.formulations.verified_bounds import verified_bound


def winner_takes_all(*robots: list[tuple[float, ...]], names: tuple[str, ...] | None = None) -> WinnerTakesAllSATA:
    return WinnerTakesAllSATA(graph_of_rows(*robots, names=names))


S2, S10 = CASES["S2"].robots, CASES["S10"].robots

GREEDY = {
    "S1": 3, "S1w": 11, "S2": 11, "S2b": 1, "S3": 31, "S4": 2, "S4a": 2, "S4b": 2, "S5": 2, "S6": 4, "S7": 6, "S8": 2, "S9": 1, "S10": 9,
    "S11": 3, "S11d": 2.707107,
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_reference_cases_in_the_order_of_the_robots(name: str) -> None:
    """The reference cases (S2b: ties to the first action), against the optimum."""
    problem = winner_takes_all(*CASES[name].robots)
    outcome = run("sequential-greedy", problem)
    assert value(problem, outcome) == pytest.approx(GREEDY[name], abs=1e-6)
    assert optimum(problem) == pytest.approx(CASES[name].winner, abs=1e-6) == value(problem, run("brute-force", problem))
    if name in ("S3", "S7"):
        assert outcome.answer.elements == {"S3": (2, 4, 6), "S7": (1, 3)}[name]


def test_the_order_decides() -> None:
    problem = winner_takes_all(*S10)
    assert value(problem, run("sequential-greedy", problem)) == 9
    assert run("sequential-greedy", problem).answer.elements == (0, 3, 5)
    assert value(problem, run("sequential-greedy", problem, order=[2, 1, 0])) == 14 == optimum(problem)
    assert value(problem, run("greedy", problem)) == 9
    tight = winner_takes_all(*S2)
    assert value(tight, run("sequential-greedy", tight)) == 11
    assert value(tight, run("sequential-greedy", tight, order=[1, 0])) == 21 == optimum(tight)


@pytest.mark.parametrize("excess", [0.5, 1e-3, 1e-9])
def test_the_half_is_tight(excess: float) -> None:
    problem = half_tight(copies=2, excess=excess)
    share = value(problem, run("sequential-greedy", problem)) / optimum(problem)
    assert share == pytest.approx((1 + excess) / (2 + excess))
    assert share >= 0.5


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.booleans())
def test_no_order_falls_below_half_of_the_optimum(seed: int, kind: str, whole: bool) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, kind, "partition", 7, whole=whole)
    best = optimum(problem)
    groups = len(problem.constraint.limits)  # type: ignore[union-attr]
    orders = itertools.permutations(range(groups)) if groups <= 3 else [rng.permutation(groups).tolist() for _ in range(6)]
    for order in orders:
        outcome = run("sequential-greedy", problem, order=list(order))
        assert outcome.guarantee is not None and outcome.guarantee.ratio == 2.0
        assert 2 * value(problem, outcome) >= best * (1 - 1e-12)
        assert verified_bound(problem, only_evidence(outcome)) >= best * (1 - 1e-12)
        assert outcome.statistics["communication_rounds"] == groups


def test_each_action_of_a_robot_is_evaluated_once() -> None:
    outcome = run("sequential-greedy", winner_takes_all(*S10))
    assert outcome.statistics["evaluations"] == 6
    assert outcome.statistics["communication_rounds"] == 3


def test_ties_go_to_the_first_action_also_where_nothing_is_gained() -> None:
    problem = winner_takes_all([(1, 0), (0, 1)], [(1, 0), (1, 0)])
    assert run("sequential-greedy", problem).answer.elements == (0, 2)


def test_a_group_with_room_for_two_picks_two() -> None:
    problem = SubmodularSelection(
        Coverage.from_sets([[0], [0, 1], [2], [3]], [5.0, 1.0, 3.0, 4.0]), PartitionMatroid.of([0, 0, 0, 1], [2, 1])
    )
    assert run("sequential-greedy", problem).answer.elements == (1, 2, 3)


def test_an_order_by_name_and_as_on_a_command_line() -> None:
    problem = winner_takes_all(*S10, names=("ada", "bob", "cyd"))
    expected = run("sequential-greedy", problem, order=[2, 1, 0]).answer
    for order in (["cyd", "bob", "ada"], "cyd,bob,ada", "cyd, bob, ada", np.array([2, 1, 0]), (2, 1, 0)):
        assert run("sequential-greedy", problem, order=order).answer == expected
    assert run("sequential-greedy", winner_takes_all(*S10), order="3,2,1").answer == expected
    assert run("sequential-greedy", winner_takes_all([(1, 2)]), order=1).answer.elements == (0,)


def test_robots_without_actions_and_without_sight_are_passed_over() -> None:
    with pytest.warns(UserWarning, match="sees anything"):
        graph = SensingGraph.from_edges([0, 2], [0], [0], robots=3, targets=1)
    problem = WinnerTakesAllSATA(graph)
    assert run("sequential-greedy", problem).answer.elements == (0, 1)
    assert value(problem, run("sequential-greedy", problem, order=[1, 2, 0])) == 1
