"""One run judged: its ratio, what it states against what the literature states, and its bounds against the optimum."""

import math
from dataclasses import replace

import numpy as np
import pytest
from selection_problems import cover_tight

from waybound import Evidence, Guarantee, Selection
from waybound.heuristics.heuristic import Outcome
from waybound.reports.ratios.judged_runs import Case, Configuration, Expected, audit, judge, ratio_of, run_heuristic
from waybound.reports.ratios.optimum import Optimum, optimum

PROBLEM = cover_tight()  # optimum 80 of elements 0 and 1; greedy 62
BEST = Optimum(80.0, Selection((0, 1)), "by hand")


def stated(ratio: float) -> Guarantee:
    return Guarantee(ratio, "", (), "nowhere")


def faults(outcome: Outcome, expected: Expected = None, **more: object) -> set[str]:
    return {kind for kind, _ in judge(PROBLEM, BEST, outcome, expected, **more).faults}  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("sense", "value", "best", "ratio"),
    [
        ("max", 62.0, 80.0, 80 / 62), ("max", 80.0, 80.0, 1.0), ("max", 0.0, 0.0, 1.0), ("max", 0.0, 5.0, math.inf), ("min", 6.0, 4.0, 1.5),
        ("min", 4.0, 4.0 + 1e-13, 1.0), ("max", -1.0, 5.0, math.inf),
    ],
)  # fmt: skip
def test_ratios_are_at_least_1_and_infinite_where_nothing_is_left(sense: str, value: float, best: float, ratio: float) -> None:
    assert ratio_of(sense, value, best) == pytest.approx(ratio)


def test_a_sound_run_has_no_faults() -> None:
    run = judge(PROBLEM, BEST, run_heuristic(PROBLEM, "greedy", {}, 1), 4 / 3)
    assert (run.value, run.optimum, run.faults) == (62.0, 80.0, ())
    assert run.ratio == pytest.approx(80 / 62) and run.stated == pytest.approx(4 / 3) and run.bound is not None and run.bound >= 80.0


def test_an_answer_that_breaks_the_constraint_or_beats_the_optimum_is_a_fault() -> None:
    assert faults(Outcome(Selection((0, 1, 2)))) == {"answer"}
    low = replace(BEST, value=70.0)
    assert {kind for kind, _ in judge(PROBLEM, low, Outcome(Selection((0, 1)))).faults} == {"optimum"}


def test_a_broken_ratio_is_a_fault_unless_it_holds_in_expectation() -> None:
    poor = Outcome(Selection((2,)), stated(4 / 3))
    assert faults(poor, 4 / 3) == {"ratio"}
    assert faults(poor, 4 / 3, in_expectation=True) == set()


@pytest.mark.parametrize(
    ("ratio", "expected", "faulty"),
    [
        (None, 2.0, True), (None, None, False), (2.0, None, True), (2.0, 2.0, False), (2.1, 2.0, True), (1.9, 2.0, True),
        (1.9, (1.5, 2.0), False), (1.4, (1.5, 2.0), True), (2.1, (1.5, 2.0), True), (None, (1.5, 2.0), True), (0.9, 2.0, True),
        (math.nan, 2.0, True),
    ],
)  # fmt: skip
def test_what_is_stated_is_held_to_the_literature(ratio: float | None, expected: Expected, faulty: bool) -> None:
    outcome = Outcome(Selection((0, 1)), None if ratio is None else stated(ratio))
    assert ("guarantee" in faults(outcome, expected)) == faulty


def test_bounds_are_derived_and_held_to_the_optimum() -> None:
    good = Evidence("marginal-gains", "", 0.0, {"prefix": [0, 1]})
    run = judge(PROBLEM, replace(BEST, value=1e6), Outcome(Selection((0, 1)), evidence=(good,)))
    assert [kind for kind, _ in run.faults] == ["bound"] and run.bound is not None
    unreadable = Evidence("marginal-gains", "", 0.0, {"prefix": [99]})
    assert faults(Outcome(Selection((0, 1)), evidence=(unreadable,))) == {"bound"}
    both = judge(PROBLEM, BEST, Outcome(Selection((0, 1)), evidence=(Evidence("marginal-gains", "", 0.0, {"prefix": []}), good)))
    assert (run.bound, both.bound, both.faults) == (82.0, 81.0, ())  # 80 + 1 + 1, and the better 41 + 40 of nothing chosen


def test_a_case_without_an_optimum_finds_it_and_options_may_hang_on_the_problem() -> None:
    assert Case(PROBLEM).solved().value == 80.0 and Case(PROBLEM, BEST).solved() is BEST
    asked = Configuration("c", "greedy", lambda problem: None, lambda problem, rng: {"eps": float(problem.num_elements)})
    assert asked.chosen(PROBLEM, np.random.default_rng(1)) == {"eps": 4.0}
    assert Configuration("c", "greedy", lambda problem: None, {"eps": 1.0}).chosen(PROBLEM, np.random.default_rng(1)) == {"eps": 1.0}


def test_an_audit_of_an_honest_run_finds_nothing_and_of_another_one_what_differs() -> None:
    direct = run_heuristic(PROBLEM, "greedy", {}, 1)
    assert audit(PROBLEM, "greedy", {}, 1, optimum(PROBLEM), direct) == ()
    other = replace(direct, answer=Selection((0,)), guarantee=stated(9.0))
    assert [words.split(" ")[0] for _, words in audit(PROBLEM, "greedy", {}, 1, optimum(PROBLEM), other)] == ["solve", "the"]
    assert "bound" in {kind for kind, _ in audit(PROBLEM, "greedy", {}, 1, replace(BEST, value=1e6), direct)}
