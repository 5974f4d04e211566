from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import check_coded
from sata_cases import CASES
from selection_problems import CONSTRAINTS, KINDS, context, cover_30, optimum, random_problem

from waybound import BottleneckSATA, Coverage, PartitionMatroid, SubmodularSelection, UsageError, WinnerTakesAllSATA, solve
from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.sata.rounding import largest_shares
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import RawResult
from waybound.solvers.linear_programs import LinearPrograms

GRAPH = graph_of_edges([0, 0, 1, 1, 1, 2], [0, 1, 2, 3, 4], [0, 0, 0, 0, 0], robots=4, targets=1)


@pytest.mark.parametrize(("name", "lp", "best"), [("S6", 1.2, 1.0), ("S7", 12 / 7, 1.0)])
def test_the_rounded_bottleneck_can_be_zero(name: str, lp: float, best: float) -> None:
    problem = BottleneckSATA(CASES[name].graph)
    rounded = solve(problem, heuristic="lp-rounding", bound_time=0)
    assert rounded.objective == 0
    assert rounded.statistics["lp_value"] == pytest.approx(lp)
    assert isinstance(rounded.bound, float) and rounded.bound_kind == "verified"
    assert best - 1e-9 <= rounded.bound <= lp + 1e-6  # the checker may know that values are whole
    assert rounded.certificate.guarantee is None
    assert "guarantees nothing" in rounded.message
    assert solve(problem, heuristic="brute-force", bound_time=0).objective == best


@pytest.mark.parametrize("seed", range(6))
def test_answers_are_feasible_and_the_lp_bounds_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for kind in KINDS[:4]:
        for constraint in CONSTRAINTS:
            problem = random_problem(rng, kind, constraint)
            rounded = solve(problem, heuristic="lp-rounding", bound_time=0)
            best = optimum(problem)
            assert isinstance(rounded.objective, float) and isinstance(rounded.bound, float)
            assert rounded.objective <= best * (1 + 1e-9) <= rounded.bound * (1 + 1e-6) + 1e-6
            assert rounded.certificate.guarantee is None


def test_equal_shares_are_taken_from_the_end_or_the_beginning() -> None:
    """One robot, two equal actions, and no way for the LP to prefer one."""
    twins = SubmodularSelection(Coverage.from_sets([[0], [0], [0]], [0.0]), PartitionMatroid.of([0, 0, 0]))
    for ties, expected in (("last", 2), ("first", 0)):
        answer = solve(twins, heuristic="lp-rounding", ties=ties, bound_time=0).answer
        shares = solve(twins, heuristic="lp-rounding", ties=ties, bound_time=0).statistics
        assert shares["lp_value"] == 0
        assert answer.elements == (expected,)


def test_winner_takes_all_and_coverage_are_solved_where_the_lp_is_whole() -> None:
    rounded = solve(WinnerTakesAllSATA(CASES["S7"].graph), heuristic="lp-rounding", bound_time=0)
    assert rounded.objective == 6 and rounded.status == "optimal"
    assert solve(cover_30(3), heuristic="lp-rounding", bound_time=0).statistics["form"] == "facility-location"


def test_without_a_solved_lp_there_is_no_answer() -> None:
    class Late(LinearPrograms):
        def solve(self, *_: Any, **__: Any) -> RawResult:
            return RawResult("unknown", limit="time", answer=np.zeros(91))

    late = replace(context(), linear=Late())
    outcome = HEURISTICS["lp-rounding"].run(cover_30(6), late)
    assert outcome.answer is None and outcome.evidence == ()
    assert "the LP was not solved in time" in outcome.message


# -- largest shares ------------------------------------------------------------------------------------------------------


def test_each_robot_takes_its_largest_share() -> None:
    shares = np.array([0.3, 0.7, 0.5, 0.2, 0.3, 0.0])
    for ties in ("last", "first", "random"):
        assert largest_shares(GRAPH, shares, ties, np.random.default_rng(1)).tolist() == [1, 2]


def test_ties_follow_the_rule_also_where_rounding_tells_shares_apart() -> None:
    shares = np.array([0.5, 0.5 - 1e-13, 0.4 - 1e-12, 0.4, 0.2, 0.0])
    assert largest_shares(GRAPH, shares).tolist() == [1, 3]
    assert largest_shares(GRAPH, shares, "first").tolist() == [0, 2]
    drawn = {tuple(largest_shares(GRAPH, shares, "random", np.random.default_rng(seed)).tolist()) for seed in range(40)}
    assert drawn == {(0, 2), (0, 3), (1, 2), (1, 3)}


def test_shares_that_differ_by_more_are_no_tie() -> None:
    assert largest_shares(GRAPH, np.array([0.5 + 1e-6, 0.5 - 1e-6, 0, 0, 1, 0])).tolist() == [0, 4]


def test_shares_of_other_robots_join_no_tie() -> None:
    count = 1000  # robots with two actions each; all shares together are a run without a gap
    shares = np.full(2 * count, 0.5)
    shares[0::2] += np.arange(1, count + 1) * 0.9e-9
    shares[1::2] -= np.arange(1, count + 1) * 0.9e-9
    robots = np.repeat(np.arange(count), 2)
    graph = graph_of_edges(robots, np.arange(2 * count), np.zeros(2 * count), robots=count, targets=1)
    assert largest_shares(graph, shares).tolist() == list(range(0, 2 * count, 2))


def test_robots_without_shares_take_no_action_and_the_order_of_actions_is_free() -> None:
    graph = graph_of_edges([2, 0, 2, 0], [0, 1, 2, 3], [0, 0, 0, 0], robots=3, targets=1)
    assert largest_shares(graph, np.array([0.5, 0.9, 0.5, 0.1])).tolist() == [1, 2]
    assert largest_shares(graph, np.zeros(4)).tolist() == []


def test_an_unknown_rule_and_random_without_a_generator_are_refused() -> None:
    check_coded(UsageError, "unknown-name", largest_shares, GRAPH, np.zeros(6), "lowest")
    check_coded(UsageError, "missing", largest_shares, GRAPH, np.zeros(6), "random")
