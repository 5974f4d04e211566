"""Recording: only what is better counts, seconds never go back, and the last row is what was checked."""

import math
from typing import Any

import pytest

import waybound as wb
from waybound.solvers.backend import RawResult
from waybound.solving.recording import Recorder


@pytest.fixture
def problem() -> wb.Problem:
    return wb.read("demo-tiny")


def test_only_better_answers_and_bounds_are_events(problem: wb.Problem) -> None:
    heard: list[dict[str, Any]] = []
    record = Recorder(problem.senses, [heard.append])
    search = record.of_search("engine")
    search({"objective": 12.0, "bound": None})
    search({"objective": 13.0, "bound": 5.0})
    record.of_bounds({"bound": 4.0, "source": "weaker"})
    record.of_bounds({"bound": 8.0, "source": "stronger"})
    assert [(e.objective, e.bound, e.bound_kind, e.found_by) for e in record.events] == [
        ((12.0,), None, None, "engine"),
        ((12.0,), (5.0,), "claimed", "engine"),
        ((12.0,), (8.0,), "evidence", "stronger"),
    ]
    assert heard[-1]["objective"] == 12.0 and heard[-1]["bound"] == 8.0
    assert [e.seconds for e in record.events] == sorted(e.seconds for e in record.events)


def test_where_more_is_better_larger_answers_and_smaller_bounds_are_news() -> None:
    record = Recorder(wb.WinnerTakesAllSATA(wb.SensingGraph.from_edges([0], [0], [0], 1.0)).senses)
    search = record.of_search("engine")
    for value, bound in ((1.0, 9.0), (0.5, 10.0), (2.0, 8.0)):
        search({"objective": value, "bound": bound})
    assert [(e.objective, e.bound) for e in record.events] == [((1.0,), (9.0,)), ((2.0,), (8.0,))]


def test_levels_of_priority_are_compared_one_after_the_other() -> None:
    heard: list[dict[str, Any]] = []
    record = Recorder(wb.read("demo-tiny", objective="vehicles then total-cost").senses, [heard.append])
    for values in ([3.0, 400.0], [2.0, 500.0], [3.0, 100.0], [2.0, 450.0]):
        record.of_search("engine")({"objective": values, "bound": 1.0})
    assert [e.objective for e in record.events] == [(3.0, 400.0), (2.0, 500.0), (2.0, 450.0)]
    assert heard[-1]["objective"] == [2.0, 450.0]


def test_incumbents_of_several_levels_are_priced_for_who_watches(says: Any) -> None:
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    answer = wb.solve(problem, heuristic="insertion", bound_time=0.0).answer

    def publishes(asked: wb.Problem, options: Any, control: Any) -> RawResult:
        control.publish(answer, None)
        return RawResult("feasible", answer=answer)

    events = wb.solve(problem, says(publishes, family="routing", features=problem.features()), bound_time=0.0).events
    assert ("solve", problem.evaluate(answer).values) in [(e.phase, e.objective) for e in events]


def test_what_does_not_hold_for_the_problem_is_no_event(problem: wb.Problem) -> None:
    record = Recorder(problem.senses)
    record.of_search("relaxed", answers=False)({"objective": 1.0, "bound": 1.0})
    record.of_search("restricted", bounds=False)({"objective": 3.0, "bound": 2.0})
    assert [(e.objective, e.bound) for e in record.events] == [(None, (1.0,)), ((3.0,), (1.0,))]


def test_objectives_that_are_none_or_no_numbers_are_no_events(problem: wb.Problem) -> None:
    record = Recorder(problem.senses)
    for value in (None, math.nan, math.inf, [1.0, None], [], "1"):
        record.of_search("engine")({"objective": value, "bound": None})
    assert record.events == []


def test_phases_are_told_to_those_who_want_to_know(problem: wb.Problem) -> None:
    class Hears:
        def __init__(self) -> None:
            self.phases: list[Any] = []

        def __call__(self, event: dict[str, Any]) -> None: ...

        def begin_phase(self, phase: str, limit: float | None) -> None:
            self.phases.append((phase, limit))

    hears = Hears()
    Recorder(problem.senses, [hears, lambda event: None]).begin_phase("solve", 3.0)
    assert hears.phases == [("solve", 3.0)]


def test_the_history_of_a_solution_ends_with_what_was_checked(problem: wb.Problem) -> None:
    solution = wb.solve(problem, "highs", bound_time=0.0)
    frame = solution.history
    last = frame.iloc[-1]
    assert (last["phase"], last["objective"], last["bound"]) == ("check", solution.objective, solution.bound)
    assert last["bound_kind"] == solution.bound_kind
    assert frame["seconds"].is_monotonic_increasing
    assert (frame["objective"].dropna().diff().dropna() <= 1e-6).all()


@pytest.mark.parametrize(("solver", "isolate"), [("highs", False), ("scip", False), ("highs", True)])
def test_nodes_come_through_levels_reductions_and_processes(solver: str, isolate: bool) -> None:
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    heard: list[dict[str, Any]] = []
    wb.solve(problem, solver, bound_time=0.0, progress=heard.append, isolate=isolate)
    nodes = [event["nodes"] for event in heard if event["phase"] == "solve" and event["nodes"] is not None]
    assert nodes and all(isinstance(count, int) and count >= 0 for count in nodes)
