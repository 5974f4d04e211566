import math
from typing import Any

import numpy as np
import pytest
from file_cases import check_refused
from programs import AnsweredBy
from random_sensing import optimum
from sata_cases import CASES, matrices_of
from truth.local_algorithm import random_graph

from waybound import BottleneckSATA, MaxMinLP, Selection, UnsupportedError, UsageError, solve
from waybound.formulations.stop import Stop
from waybound.heuristics.heuristic import HEURISTICS, Context, Outcome
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.engines.sata.local_max_min.shares import local_shares


def run(problem: Any, published: list[Any] | None = None, stopped: bool = False, **options: Any) -> Outcome:
    keep: list[Any] = [] if published is None else published
    stop = Stop()
    if stopped:
        stop.ask()
    context = Context(np.random.default_rng(1), 10.0, None, keep.append, stop, AnsweredBy(lambda program, seconds: None))
    return HEURISTICS["local"].run(problem, context, **{"ball": False, **options})


def shares_of(name: str) -> BottleneckSATA:
    return BottleneckSATA(CASES[name].graph, fractional=True)


# -- shares --------------------------------------------------------------------------------------------------------------


def test_the_answer_is_a_vector_of_shares_with_the_guarantee_that_was_checked() -> None:
    problem = shares_of("S1")
    outcome = run(problem, h=2)
    assert outcome.answer == pytest.approx(local_shares(problem.graph, 2).shares)
    guarantee = outcome.guarantee
    assert guarantee is not None and guarantee.ratio == pytest.approx(2 * 1.1 * 1.5 * (1 - 1 / 3), rel=1e-8)
    assert "OPT / value <= Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T)" in guarantee.statement
    assert any("every target" in a for a in guarantee.assumptions)
    assert "theorem 1" in guarantee.source
    assert outcome.message == ""


@pytest.mark.share(2)
@pytest.mark.parametrize("search", ["secant", "step"])
@pytest.mark.parametrize("messages", [False, True])
def test_the_stated_ratio_holds(search: str, messages: bool) -> None:
    for seed in range(40):
        graph = random_graph(np.random.default_rng(seed), most_robots=8)
        problem = BottleneckSATA(graph, fractional=True)
        outcome = run(problem, h=3, search=search, messages=messages)
        assert optimum(graph) <= problem.evaluate(outcome.answer).values[0] * outcome.guarantee.ratio * (1 + 1e-7)


def test_the_step_search_states_the_eps_that_its_step_amounts_to() -> None:
    fine, coarse = (run(shares_of("S1w"), search="step", step=step).guarantee for step in (0.01, 1.0))
    assert fine is not None
    assert coarse is not None and fine.ratio < coarse.ratio
    assert any("the additive step amounts to" in a for a in coarse.assumptions)


def test_several_heights_keep_the_best_answer_and_the_best_guarantee() -> None:
    problem, published = shares_of("S1"), []  # type: ignore[var-annotated]
    outcome = run(problem, published, heights="2,10,30", eps=1e-6)
    values = outcome.statistics["values_by_height"]
    assert list(values) == ["2", "10", "30"]
    assert outcome.statistics["h"] == 10
    assert problem.evaluate(outcome.answer).values[0] == pytest.approx(max(values.values())) == pytest.approx(1.2498, abs=1e-4)
    assert outcome.guarantee is not None and outcome.guarantee.ratio == pytest.approx(2 * (1 + 1 / 30) * (2 / 3), rel=1e-5)
    assert len(published) == 2  # of 2 and of 10; 30 was no better
    assert list(run(problem, heights=3).statistics["values_by_height"]) == ["1", "2", "3"]
    assert run(problem, heights=[2]).statistics["h"] == 2


def test_whoever_is_asked_to_stop_at_once_divides_evenly_and_guarantees_nothing() -> None:
    outcome = run(shares_of("S1"), stopped=True, heights=4)
    assert outcome.answer == pytest.approx([0.5] * 6)
    assert (outcome.guarantee, outcome.limit, outcome.statistics["h"]) == (None, "interrupt", 0)


def test_messages_are_counted_and_give_the_same_answer() -> None:
    problem = shares_of("S3")
    talk = run(problem, h=3, messages=True)
    assert talk.answer == pytest.approx(run(problem, h=3).answer, abs=1e-12)
    assert talk.statistics["rounds"] == 11
    assert talk.statistics["bytes"] > talk.statistics["messages"] > 0
    assert "rounds" not in run(problem, h=3).statistics


# -- where nothing is guaranteed -----------------------------------------------------------------------------------------


def test_whole_actions_are_the_largest_shares_without_a_guarantee_and_both_values_are_told_apart() -> None:
    problem = BottleneckSATA(CASES["S6"].graph)
    outcome = run(problem, h=2, eps=1e-6)
    assert isinstance(outcome.answer, Selection)
    assert outcome.guarantee is None
    assert "nothing is guaranteed" in outcome.message
    assert outcome.statistics["rounded_value"] == problem.evaluate(outcome.answer).values[0]
    assert outcome.statistics["fractional_value"] == pytest.approx(7 / 6, abs=1e-6)


def test_ties_of_shares_follow_the_rule() -> None:
    problem = BottleneckSATA(CASES["S1"].graph)  # all shares are 1/2 at height 1
    assert run(problem, h=1).answer.elements == (1, 3, 5)
    assert run(problem, h=1, ties="first").answer.elements == (0, 2, 4)
    assert len(run(problem, h=1, ties="random").answer) == 3


def test_several_heights_keep_the_best_rounded_answer_of_whole_actions() -> None:
    problem = BottleneckSATA(CASES["S10"].graph)
    outcome = run(problem, heights=6)
    assert outcome.statistics["rounded_value"] == max(outcome.statistics["rounded_by_height"].values())
    assert problem.evaluate(outcome.answer).values[0] == outcome.statistics["rounded_value"]


def test_a_target_that_nobody_sees_makes_the_value_0_which_is_said_and_proved() -> None:
    graph = graph_of_edges([0, 0, 1, 2], [0, 1, 2], [0, 1, 1], robots=3, targets=tuple("abcd"))
    problem = BottleneckSATA(graph, fractional=True)
    outcome = run(problem)
    assert problem.evaluate(outcome.answer).values[0] == 0
    assert problem.evaluate(outcome.answer).feasible
    assert outcome.guarantee is None
    assert "no action sees 2 of the targets (c, d), so the value is 0" in outcome.message
    assert outcome.statistics["unseen_targets"] == 2
    assert outcome.statistics["fractional_value"] > 0  # of the targets that somebody sees
    solution = solve(problem, heuristic="local", bound_time=0.0)
    assert (solution.objective, solution.bound, solution.status) == (0.0, 0.0, "optimal")


def test_nobody_sees_anything() -> None:
    graph = graph_of_edges([0, 1], [], [], robots=2, targets=1)
    assert run(BottleneckSATA(graph, fractional=True)).answer.tolist() == [0.0, 0.0]
    assert run(BottleneckSATA(graph)).answer.elements == ()


# -- general programs ----------------------------------------------------------------------------------------------------


def test_a_program_of_one_packing_row_a_variable_is_solved_as_one_of_robots() -> None:
    case = shares_of("S1w")
    scale = np.array([2.0, 0.5, 4.0, 1.0, 3.0, 0.25])
    a, c = matrices_of(case.graph)
    solution = solve(MaxMinLP(a * scale, c * scale), heuristic="local", h=5)
    assert solution.objective == pytest.approx(case.evaluate(run(case, h=5).answer).values[0], rel=1e-12)
    assert solution.certificate.guarantee is not None
    assert solution.certificate.bound == pytest.approx(30 / 7, rel=1e-6)
    assert solution.certificate.evidence[0].kind == "packing-covering-duals"


def test_programs_with_several_packing_rows_a_variable_or_of_the_other_sense_are_refused() -> None:
    check_refused(UnsupportedError, "several-packing-rows", solve, MaxMinLP([[1.0], [1.0]], [[1.0]]), heuristic="local")
    check_refused(UnsupportedError, "min-max", solve, MaxMinLP([[1.0]], [[1.0]], sense="min"), heuristic="local")


# -- through solve -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(CASES))
def test_every_case_is_answered_with_a_bound_that_the_checker_confirms(name: str) -> None:
    case = CASES[name]
    solution = solve(BottleneckSATA(case.graph, fractional=True), heuristic="local", h=5, bound_time=0.0)
    certificate = solution.certificate
    assert certificate.feasible
    assert certificate.bound == pytest.approx(case.lp, rel=1e-6)
    assert certificate.guarantee is not None
    assert certificate.observed_ratio is not None and certificate.observed_ratio <= certificate.guarantee.ratio
    whole = solve(BottleneckSATA(case.graph), heuristic="local", h=5, bound_time=0.0)
    assert whole.certificate.guarantee is None
    assert whole.objective <= case.bottleneck + 1e-9
    assert whole.certificate.bound is not None and case.bottleneck - 1e-9 <= whole.certificate.bound <= case.lp * (1 + 1e-6)
    assert "guarantees nothing" in whole.message


def test_the_ball_can_be_turned_off() -> None:
    assert solve(shares_of("S1"), heuristic="local", ball=False, bound_time=0.0).bound is None


# -- options -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"h": 0}, "h must be a whole number from 1"), ({"h": 1.5}, "h must be"), ({"eps": 0}, "eps must be"), ({"eps": 2}, "eps must be"),
        ({"step": -1}, "step must be"), ({"search": "exact"}, "search must be"), ({"smoothing": "no"}, "smoothing must be"),
        ({"heights": 0}, "heights must be"), ({"heights": -2}, "heights must be"), ({"heights": 5000}, "heights must be"),
        ({"heights": "1,x"}, "heights must be"), ({"heights": "1,,3"}, "heights must be"), ({"heights": ""}, "heights must be"),
        ({"heights": []}, "heights must be"), ({"heights": [1, 0]}, "heights must be"), ({"heights": [True]}, "heights must be"),
        ({"heights": True}, "heights must be"), ({"heights": 2.5}, "heights must be"), ({"heights": math.nan}, "heights must be"),
        ({"ties": "lowest"}, "ties must be"), ({"normalise": "yes"}, "normalise must be"), ({"ball": 1}, "ball must be"),
        ({"messages": None}, "messages must be"),
    ],
)  # fmt: skip
def test_an_option_out_of_range_gets_one_clear_error(options: dict[str, Any], named: str) -> None:
    with pytest.raises(UsageError, match=named):
        run(shares_of("S1"), **options)
