from __future__ import annotations

import pytest

import waybound as wb
from waybound.instances.errors import InputError
from waybound.solving import goal


@pytest.mark.share(2)
@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_an_answer_that_reaches_a_verified_bound_ends_the_search(solver: str) -> None:
    problem = wb.generate("random", seed=1, customers=4)
    solution = wb.solve(problem, solver, time_limit=40)
    assert solution.seconds["solve"] < 20
    assert (solution.status, solution.limit, solution.bound_kind) == ("optimal", "none", "verified")


@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_where_the_data_prove_that_there_is_no_answer_none_is_searched(solver: str) -> None:
    problem = wb.generate("random", seed=1, customers=6, vehicles=1, capacity=10)
    solution = wb.solve(problem, solver, time_limit=40)
    assert solution.seconds["solve"] < 20
    assert (solution.status, solution.answer) == ("infeasible", None)
    assert solution.certificate.infeasible


@pytest.mark.share(2)
@pytest.mark.parametrize("given", [{"iterations": 50}, {"time_limit": 1.0, "bound_time": 0.0}])
def test_nothing_is_proved_before_a_run_that_shall_repeat_or_that_asks_for_no_bound(monkeypatch, given) -> None:
    monkeypatch.setattr("waybound.solving.solve.first_evidence", lambda *_: pytest.fail("asked"))
    if "bound_time" in given:
        monkeypatch.setattr(
            "waybound.solving.solve.first_evidence",
            lambda problem, seconds, linear, gap, uncompiled: ([], None) if seconds == 0 else pytest.fail("asked"),
        )
    assert wb.solve(wb.read("demo-tiny"), "pyvrp", **given).answer is not None


@pytest.mark.parametrize("fault", [InputError("too large"), MemoryError(), KeyboardInterrupt()])
def test_a_bound_that_fails_costs_no_answer(monkeypatch, fault) -> None:
    def fails(*given, **named):
        raise fault

    monkeypatch.setattr(goal, "find_bounds", fails)
    assert goal.first_evidence(wb.read("demo-tiny"), 1.0) == ([], None)


def test_what_one_thread_saw_reached_stays_so_whatever_another_sees() -> None:
    problem = wb.generate("random", seed=1, customers=4)
    best = wb.solve(problem, "highs")
    made = goal.Goal(problem, [])
    made.bound = best.objective
    worse = wb.Routes(tuple(best.answer)[:-1])
    assert made(best.answer, best.objective)
    assert made(worse, best.objective)
    assert (made.reached, made.limit) == (True, "none")


def test_large_problems_set_no_goal_but_have_the_bound_that_is_there_at_once(monkeypatch) -> None:
    monkeypatch.setattr(goal, "LARGEST", 3)
    problem = wb.generate("random", seed=1, customers=6)
    monkeypatch.setattr("waybound.solving.bounding._late", lambda *_: pytest.fail("made ready"))
    evidence, aim = goal.first_evidence(problem, 5.0)
    assert aim is None and {e.kind for e in evidence} == {"load-shares", "nearest-moves"}
