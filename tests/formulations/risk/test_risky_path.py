"""Risky paths: the judge, what cannot be asked, reasons why there is no answer, and answers as files."""

import math

import numpy as np
import pytest
import risky_cases as cases
from coded import coded

import waybound as wb
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.risk.risky_path import RiskyPath, unreachable
from waybound.instances.errors import InputError, UsageError
from waybound.instances.generating import generate
from waybound.instances.risk.elements import LocaleRisk


def broken(problem, path):
    return [violation.check for violation in problem.evaluate(path).violations]


def test_every_rule_is_judged():
    problem = cases.ring()
    name = {problem.graph.state_name(s): s for s in range(8)}
    path = lambda text: tuple(name[part] for part in text.split())  # noqa: E731
    assert broken(problem, path("00 10 20 21 22 12 02")) == []
    assert broken(problem, path("10 20 21 22 12 02")) == ["start"]
    assert broken(problem, path("00 10 20")) == ["end"]
    assert broken(problem, path("00 10 12 02")) == ["moves"] and problem.evaluate(path("00 10 12 02")).values == (1.0,)
    assert problem.evaluate(path("00 10")).values[0] == pytest.approx(1 - math.exp(-1 / 20))
    assert broken(problem, path("00 10 11 10 11 12 02")) == ["simple", "simple"]
    assert "comes to 10 again" in problem.evaluate(path("00 10 11 10 11 12 02")).violations[0].message


def test_a_certain_failure_is_no_way():
    graph = cases.graph([(0, 1), (1, 2)], [LocaleRisk([0, 1, 0])], goals=(2,))
    verdict = RiskyPath(graph).evaluate((0, 1, 2))
    assert (broken(RiskyPath(graph), (0, 1, 2)), verdict.values[0]) == (["passable"], 1.0)


@pytest.mark.parametrize("answer", [(), [0, 1], (0, 9), "01", (0.5,)])
def test_what_is_no_path_is_refused(answer):
    with pytest.raises(InputError):
        cases.two_ways().evaluate(answer)


def test_no_risk_makes_no_ratio():
    problem = cases.two_ways()
    assert broken(problem, (0,)) == ["ratio"]
    assert "0/0" in problem.evaluate((0,)).violations[0].message
    assert problem.evaluate((0, 1)).values == (pytest.approx(10.0),)


@pytest.mark.parametrize(
    ("make", "code", "message"),
    [
        (lambda: cases.two_ways((0, 0, 0, 0), objective="reward-per-risk"), "missing", "needs a state with a reward"),
        (lambda: cases.two_ways(objective="risk"), "missing", "the least risk needs a goal"),
        (lambda: cases.two_ways(objective="hazard"), "missing", "the least hazard needs a goal"),
        (
            lambda: RiskyPath(cases.graph([(0, 1), (1, 2)], [LocaleRisk([0, 0, 0.5])], rewards=[0, 1, 1])),
            "contradiction",
            "reward per risk has no maximum: a reward is reached without risk, by 1 2",
        ),
        (
            lambda: cases.two_ways((1, 1, 1, 1)),
            "contradiction",
            "reward per risk has no maximum: a reward is reached without risk, by 1",
        ),
        (lambda: RiskyPath(cases.two_ways().graph, "luck"), "unknown-name", "objective must be one of risk, hazard, reward-per-risk"),
    ],
)
def test_what_has_no_best_answer_is_refused(make, code, message):
    with pytest.raises((InputError, UsageError), match=message, check=coded(code)):
        make()


def test_a_free_reward_on_the_way_to_a_risky_goal_is_no_fault():
    graph = cases.graph([(0, 1), (1, 2)], [LocaleRisk([0, 0, 0.5])], rewards=[0, 1, 1], goals=(2,), objective="reward-per-risk")
    assert wb.solve(RiskyPath(graph)).objective == pytest.approx(4.0)


def test_hazard_orders_paths_as_risk_does():
    risk, hazard = cases.ring(), cases.ring(objective="hazard")
    for path in cases.all_paths(risk):
        if risk.evaluate(path).feasible:
            assert hazard.evaluate(path).values[0] == pytest.approx(-math.log1p(-risk.evaluate(path).values[0]))


def test_sums_of_risks_are_told_beside_products():
    quantities = cases.of_table(cases.RED).evaluate(tuple(range(11))).quantities
    assert quantities["sum of risks"] == pytest.approx(1.23) and quantities["risk"] == pytest.approx(0.7143, abs=5e-5)


@pytest.mark.parametrize(
    ("risks", "arcs", "why"),
    [([0, 0, 0], [(0, 1), (2, 1)], "no moves lead there"), ([0, 1, 0], [(0, 1), (1, 2)], "a risk of 1 is on every way")],
)
def test_a_goal_out_of_reach_is_told_with_proof(risks, arcs, why):
    problem = RiskyPath(cases.graph(arcs, [LocaleRisk(risks)], goals=(2,)))
    (reason,) = problem.infeasibility_reasons()
    assert reason.message == f"3 cannot be reached from 1: {why}"
    assert CHECKERS["move-potentials"](problem, unreachable(problem).data) == math.inf
    solution = wb.solve(problem)
    assert solution.status == "infeasible" and solution.certificate.infeasible
    assert solution.message == f"{reason.message}; proved before the search"
    assert unreachable(cases.ring()) is None


def test_answers_as_json_by_name_and_as_a_table():
    problem = cases.mud()
    assert problem.answer_to_json((0, 2, 3)) == {"kind": "path", "vertices": ["s", "a", "b"]}
    assert problem.answer_from_json({"kind": "path", "vertices": ["s", "a", "b"]}) == (0, 2, 3) == problem.answer_of(["s", "a", "b"])
    for wrong in ({"kind": "path", "vertices": []}, {"kind": "path", "vertices": ["zz"]}, {"kind": "routes"}, [0]):
        with pytest.raises(InputError):
            problem.answer_from_json(wrong)
    for unclear in ("sab", [None], [True], ["zz"]):
        with pytest.raises(UsageError):
            problem.answer_of(unclear)
    frame = cases.two_ways().answer_to_frame((0, 2, 3))
    assert list(frame.columns) == ["state", "reward", "locale", "risk"] and frame["risk"].tolist() == pytest.approx([0, 0.11, 0.11])


def test_settings_change_start_goals_discount_and_objective():
    graph = cases.ring().graph
    problem = problem_from_instance(graph, start="10", goals="22,12", objective="hazard")
    assert (problem.graph.state_name(problem.graph.start), problem.objective, len(problem.graph.goals)) == ("10", "hazard", 2)
    rewarded = problem_from_instance(cases.two_ways().graph, discount="0")
    assert wb.solve(rewarded).objective == pytest.approx(2 / 0.11)
    for wrong in ({"start": "10,20"}, {"goals": "zz"}, {"discount": "x"}, {"speed": 1}):
        with pytest.raises(UsageError):
            problem_from_instance(graph, **wrong)
    with pytest.raises(UsageError, check=coded("foreign")):
        problem_from_instance(_routing(), "risky-path")


def _routing():
    return generate("random", 1, customers=3)


def test_features_and_facts():
    assert cases.mud().features() == {"objective:risk", "goals", "action-risk", "traverse-risk"}
    facts = cases.two_ways().facts()
    assert (facts["rewarding_states"], facts["total_reward"], facts["locale_risks"]) == (3, 4.0, ["locale"])


@pytest.mark.parametrize("seed", range(3))
def test_risk_never_falls_along_a_path(seed):
    problem = cases.random_map(np.random.default_rng(seed), muddy=True)
    for path in cases.all_paths(problem)[::7]:
        risk = problem.answer_to_frame(path)["risk"]
        assert (np.diff(risk) >= -1e-15).all() and risk.iloc[-1] == pytest.approx(problem.evaluate(path).quantities["risk"])


@pytest.mark.parametrize(
    "problem", [cases.mud(), cases.loop(), cases.two_ways(), cases.ring(objective="hazard")], ids=lambda p: p.objective
)
def test_an_answer_at_hand_passes_or_there_is_none(problem):
    answer = problem.answer_at_hand()
    assert answer is None or problem.evaluate(answer).feasible
    assert (answer is None) == (problem.graph.state_name(1) == "v")  # the best walk of the loop comes to it twice


def test_there_is_nothing_to_explain_of_a_goal_that_can_be_reached():
    explanation = wb.explain(cases.mud(), time_limit=60.0)
    assert (explanation.verdict, explanation.according_to) == ("feasible", "the data")
