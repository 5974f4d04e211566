"""A claim without evidence is put to other engines: who agrees is told, and an answer of theirs that passes every check refutes it."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from programs import program

import waybound as wb
from waybound.cli.solving import exit_code
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.solution import Opinion, status_line
from waybound.instances.errors import CheckFailedError
from waybound.solvers.backend import BACKENDS, RawResult
from waybound.solving import concluding, method, opinions
from waybound.solving.opinions import independent

pytestmark = pytest.mark.usefixtures("without_trees")

KNAPSACK = ArrayProblem(program([3.0, 2.0], [[2.0, 3.0]], -np.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max", offset=1.0))
"""13 at (4, 0); its relaxation is worth 14 2/3, of which the checker makes 14."""
EMPTY = ArrayProblem(program([1.0, 1.0], [[2.0, 2.0]], 3.0, 3.0, 0, 5, integer=[0, 1]))
"""2 x + 2 y = 3 in whole numbers: no bound on the relaxation says so."""
LESS = np.array([3.0, 1.0])


def test_an_optimum_without_evidence_is_confirmed_by_two_other_engines():
    solution = wb.solve(KNAPSACK, "highs")
    assert (solution.status, solution.objective, solution.bound_kind) == ("optimal", 13.0, "claimed")
    assert [o.verdict for o in solution.opinions] == ["agrees", "agrees"]
    assert f"optimal according to highs and {solution.opinions[0].solver}, {solution.opinions[1].solver}" in str(solution)
    assert solution.to_json()["opinions"][0]["verdict"] == "agrees"


def test_infeasibility_without_evidence_is_confirmed_likewise():
    solution = wb.solve(EMPTY, "highs")
    assert solution.status == "infeasible"
    assert [(o.status, o.verdict) for o in solution.opinions] == [("infeasible", "agrees")] * 2
    assert "infeasible according to highs and " in str(solution)


def test_an_answer_of_another_engine_refutes_infeasibility_and_is_handed_over(says):
    solution = wb.solve(KNAPSACK, says(RawResult("infeasible")))
    assert (solution.objective, solution.status) == (13.0, "feasible")
    assert any("claims that there is no answer, but one of value 13.0 passed every check" in fault for fault in solution.faults)
    assert solution.opinions[0].verdict == "refutes"


def test_a_better_answer_of_another_engine_refutes_an_optimum(says):
    solution = wb.solve(KNAPSACK, says(RawResult("optimal", answer=LESS, objective=12.0)))
    assert (solution.objective, solution.status) == (13.0, "feasible")
    assert any("claims the optimum 12.0, but an answer of value 13.0" in fault for fault in solution.faults)


def test_claims_that_contradict_each_other_unrefuted_are_a_fault_with_both_numbers(says, monkeypatch):
    says(RawResult("optimal", objective=14.0), "dreamer", order=-1)
    solution = wb.solve(KNAPSACK, "highs")
    assert (solution.objective, solution.status, exit_code(solution)) == (13.0, "feasible", 5)
    assert "highs claims the optimum 13.0, dreamer claims the optimum 14.0: nothing that was checked refutes either" in solution.faults[0]
    assert [o.verdict for o in solution.opinions] == ["contradicts", "agrees"]


def test_without_an_answer_such_a_contradiction_is_an_error_with_both_claims(says):
    says(RawResult("optimal", objective=3.0), "dreamer", order=-1)
    with pytest.raises(CheckFailedError, match=r"highs claims that there is no answer, dreamer claims the optimum 3\.0: nothing"):
        wb.solve(EMPTY, "highs")


def test_an_opinion_that_a_verified_bound_refutes_costs_nothing(says):
    says(RawResult("unbounded"), "dreamer", order=-1)
    solution = wb.solve(EMPTY, "highs")
    assert (solution.status, solution.opinions[0].verdict, solution.faults) == ("infeasible", "is refuted", ())
    assert "dreamer says unbounded, which the verified bound refutes" in solution.message


def test_an_optimum_beyond_a_verified_bound_is_refuted_by_it(says):
    says(RawResult("optimal", objective=15.0), "dreamer", order=-1)
    solution = wb.solve(KNAPSACK, "highs")
    assert solution.certificate.bound == pytest.approx(14.0)
    assert (solution.status, solution.faults) == ("optimal", ())
    assert "dreamer says optimal 15.0, which the verified bound refutes" in solution.message


def test_how_many_of_those_asked_agreed_is_told(says):
    says(RawResult("unknown"), "silent", order=-1)
    assert "(1 of 2 asked agreed)" in status_line(wb.solve(KNAPSACK, "highs")).text


def test_an_endless_objective_that_is_refuted_costs_no_answer_that_others_have(says):
    bounded = ArrayProblem(program([1.0, 1.0], [[1.0, 1.0]], 0.0, np.inf, 0, 5, integer=[0, 1]))
    solution = wb.solve(bounded, says(RawResult("unbounded")))
    assert (solution.objective, solution.opinions[0].verdict) == (0.0, "refutes")
    assert "liar claims that there is no best answer, but the verified bound is 0.0" in solution.faults


def test_an_endless_objective_without_evidence_is_put_to_others(says, monkeypatch):
    monkeypatch.setattr(concluding.Conclusion, "gather_evidence", lambda *_: None)
    bounded = ArrayProblem(program([1.0, 1.0], [[1.0, 1.0]], 0.0, np.inf, 0, 5, integer=[0, 1]))
    solution = wb.solve(bounded, says(RawResult("unbounded")))
    assert any("liar claims that there is no best answer" in fault and "claims the optimum 0.0" in fault for fault in solution.faults)


COSTS = wb.BinAssignment.from_matrix([[1.0, 2.0], [2.0, 1.0]])


@pytest.fixture
def engine_says(says: Any) -> Any:
    return partial(says, name="engine", family="bin-assignment", features=COSTS.features())


@pytest.mark.parametrize("said", [RawResult("infeasible"), RawResult("infeasible_or_unbounded"), RawResult("unbounded")])
@pytest.mark.parametrize("bounds", [True, False])
def test_what_an_engine_claims_is_put_to_others_too(engine_says, monkeypatch, said, bounds):
    if not bounds:
        monkeypatch.setattr(concluding.Conclusion, "gather_evidence", lambda *_: None)
    solution = wb.solve(COSTS, engine_says(said), bound_time=60)
    assert (solution.objective, solution.answer) == (2.0, (0, 1))
    assert solution.faults and {o.verdict for o in solution.opinions} <= {"refutes", "contradicts"} and solution.opinions


def test_an_optimum_of_an_engine_is_put_to_others_and_a_better_answer_refutes_it(engine_says, monkeypatch):
    monkeypatch.setattr(concluding.Conclusion, "gather_evidence", lambda *_: None)
    monkeypatch.setattr("waybound.solving.bounding.first_evidence", lambda *_: ([], None))
    agreed = wb.solve(COSTS, engine_says(RawResult("optimal", answer=(0, 1))), bound_time=60)
    assert (agreed.status, agreed.bound, agreed.bound_kind) == ("optimal", 2.0, "claimed")
    assert {o.verdict for o in agreed.opinions} == {"agrees"}
    refuted = wb.solve(COSTS, engine_says(RawResult("optimal", answer=(1, 0))), bound_time=60)
    assert (refuted.status, refuted.objective) == ("feasible", 2.0)
    assert "engine claims the optimum 4.0, but an answer of value 2.0 passed every check" in refuted.faults


def test_no_program_is_written_only_to_ask_about_it_where_it_would_be_large(monkeypatch):
    monkeypatch.setattr(type(COSTS), "linear_entries", lambda self: opinions.MOST_ENTRIES + 1)
    assert opinions.program_of(COSTS) is None


def test_a_program_that_cannot_be_written_is_not_asked_about(monkeypatch):
    monkeypatch.setattr(opinions, "first_compiled", lambda *_: 1 / 0)
    assert opinions.program_of(COSTS) is None


def test_an_opinion_that_the_answer_refutes_is_told_and_costs_nothing(says):
    says(RawResult("infeasible"), "doubter", order=-1)
    solution = wb.solve(KNAPSACK, "highs")
    assert (solution.status, solution.faults) == ("optimal", ())
    assert solution.opinions[0].verdict == "is refuted"
    assert "doubter says infeasible, which the answer refutes" in solution.message


@pytest.mark.parametrize("given", [{"bound_time": 0}, {"relax": True}])
def test_nobody_is_asked_without_time_or_about_linear_programs(given):
    assert wb.solve(KNAPSACK, "highs", **given).opinions == ()


def test_nobody_is_asked_where_evidence_settles_it():
    solution = wb.solve(wb.generate("random", seed=1, customers=4), "highs")
    assert (solution.bound_kind, solution.opinions) == ("verified", ())


def test_an_engine_is_asked_once_by_whatever_road_and_never_about_its_own_word():
    made = KNAPSACK.compile()
    engines = {name: (BACKENDS[name.partition(":")[0]](name.partition(":")[2])).engine for name in independent(made.program, "pulp:HiGHS")}
    assert "HiGHS" not in engines.values()
    assert len(set(engines.values())) == len(engines) >= 3
    assert "SCIP" not in [BACKENDS[n.partition(":")[0]](n.partition(":")[2]).engine for n in independent(made.program, "mathopt")]


def test_an_opinion_whose_solver_crashes_costs_nothing(registered, says):
    def search(self: Any, *given: Any) -> RawResult:
        raise RuntimeError("a fault of the library")

    says(RawResult("unknown"), "crasher", order=-1)
    registered(BACKENDS, "crasher", type("Crashes", (BACKENDS["crasher"],), {"search": search}))
    solution = wb.solve(KNAPSACK, "highs")
    assert (solution.status, solution.objective) == ("optimal", 13.0)
    assert solution.opinions and "crasher" not in {o.solver for o in solution.opinions}


@pytest.mark.share(3)
@pytest.mark.parametrize(("given", "alone"), [({}, False), ({"isolate": True}, True), ({"memory_limit": 4000.0}, True)])
def test_whoever_is_asked_keeps_to_the_isolation_of_the_first(monkeypatch, given, alone):
    asked: list[float | None] = []
    inside = method.run_in_process
    monkeypatch.setattr(
        method, "run_in_process", lambda work, told, control: asked.append(told.memory_limit) or inside(work, told, control)
    )
    monkeypatch.setattr(opinions, "independent", lambda program, solver: ["scip"])
    assert wb.solve(KNAPSACK, "highs", **given).opinions[0].verdict == "agrees"
    assert asked == ([given.get("memory_limit")] * 2 if alone else [])


def test_who_is_refuted_is_not_called_undecided():
    opinions = tuple(Opinion(name, "unknown", None, None, verdict) for name, verdict in (("scip", "is refuted"), ("pulp", "undecided")))
    solution = wb.solve(KNAPSACK, "highs")
    assert "optimal according to highs alone: pulp undecided; scip is refuted" in status_line(replace(solution, opinions=opinions)).text


def test_an_opinion_that_cannot_be_had_is_none(monkeypatch):
    monkeypatch.setattr(opinions, "independent", lambda program, solver: ["scip:nothing", "highs:nothing"])
    solution = wb.solve(KNAPSACK, "highs")
    assert (solution.status, solution.opinions) == ("optimal", ())
