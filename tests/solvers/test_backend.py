"""The line between ``solve`` and what searches: incumbents go out, the wish to stop comes in, and each solver is asked what it can take."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from programs import program

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.evidence import Evidence
from waybound.formulations.programs.program import INTEGERS, LINEAR, QUADRATIC
from waybound.formulations.programs.scaling import scaled
from waybound.instances.errors import MissingPackageError, UnsupportedError, UsageError
from waybound.solvers.backend import (
    BACKENDS,
    Control,
    Engine,
    Options,
    ProgramBackend,
    RawResult,
    kinds_of,
    solver_named,
    takers,
    takes_features,
)

PLAIN = program([3, 2], [[2, 3]], -np.inf, 10.5, 0, [4, 5])


class Made(ProgramBackend):
    """Says what it is told to."""

    name, package, modules, summary = "made", "no-such-distribution", ("json",), "for tests"
    programs = (LINEAR, INTEGERS)
    variants = ("fast",)
    said = RawResult("unknown")

    def search(self, program: Any, options: Options, control: Control) -> RawResult:
        self.seen, self.options = program, options
        control.publish(None if options.start is None else options.start, 1.0, 2.0)
        return self.said


# -- control -----------------------------------------------------------------------------------------------------------


def test_a_published_answer_replaces_the_last_and_a_bound_stands_by_itself() -> None:
    events: list[dict[str, Any]] = []
    control = Control(events.append)
    control.publish("first", 9.0)
    control.publish(bound=2.0)
    proof = (Evidence("k", "s", 3.0, {}),)
    control.publish(bound=3.0, evidence=proof)
    control.publish("second", 7.0)
    assert (control.answer, control.objective, control.bound, control.evidence) == ("second", 7.0, 3.0, proof)
    assert [(e["objective"], e["bound"]) for e in events] == [(9.0, None), (9.0, 2.0), (9.0, 3.0), (7.0, 3.0)]
    assert all(e["seconds"] >= 0 for e in events)


def test_a_wish_to_stop_reaches_all_that_end_a_search_also_those_who_come_late() -> None:
    control, ended = Control(), []
    control.on_stop(lambda: ended.append("early"))
    assert not control.stopped
    threading.Thread(target=control.stop).run()
    control.on_stop(lambda: ended.append("late"))
    assert control.stopped and ended == ["early", "late"]


def test_an_answer_that_reaches_the_goal_stops_the_search_and_a_bound_does_not() -> None:
    control, asked = Control(), []
    control.goal = lambda answer, objective: bool(asked.append((answer, objective)) or (objective or 9.0) <= 5.0)
    control.publish(bound=1.0)
    control.publish("a", 6.0)
    assert not control.stopped and asked == [("a", 6.0)]
    control.publish("b", 5.0)
    assert control.stopped
    control.publish("c", 4.0)
    assert len(asked) == 2 and control.answer == "c"


# -- programs ----------------------------------------------------------------------------------------------------------


def test_a_program_of_ordinary_size_is_searched_as_it_is() -> None:
    backend = Made()
    backend.run(PLAIN, Options(start=np.array([1.0, 1.0])), Control())
    assert backend.seen is PLAIN


def test_everything_comes_back_in_the_units_of_the_program() -> None:
    """The same program with x in millionths: start, incumbent, bound, answer and duals keep their meaning."""
    unit = 2.0**20
    tiny = program([3 / unit, 2 / unit], [[2 / unit, 3 / unit]], -np.inf, 10.5 / unit / unit, 0, [4 / unit, 5 / unit])
    made = scaled(tiny)
    assert made.program is not tiny
    backend, control = Made(), Control()
    point = np.array([1.0, 2.0]) / unit
    backend.said = RawResult("optimal", answer=made.scaled_vector(point), objective=3.0, bound=2.0, row_duals=np.array([1.0]))
    result = backend.run(tiny, Options(start=point), control)
    assert backend.options.start == pytest.approx(made.scaled_vector(point))
    assert control.answer == pytest.approx(point) and result.answer == pytest.approx(point)
    assert (result.objective, result.bound, control.bound) == (made.value(3.0), made.value(2.0), made.value(2.0))
    assert result.row_duals == pytest.approx(made.duals(np.array([1.0])))


def test_a_wish_to_stop_reaches_the_search_of_a_scaled_program() -> None:
    class Waits(Made):
        def search(self, program: Any, options: Options, control: Control) -> RawResult:
            outer.stop()
            return RawResult("unknown", "interrupt" if control.stopped else "none")

    outer = Control()
    huge = program([3e12, 2e12], [[2e12, 3e12]], -np.inf, 1e25, 0, [4e12, 5e12])
    assert scaled(huge).program is not huge
    assert Waits().run(huge, Options(), outer).limit == "interrupt"


def test_a_program_that_it_cannot_take_is_refused_with_those_that_can() -> None:
    squares = program([1, 1], [[1, 1]], 0, 1, quadratic=[[2, 0], [0, 2]])
    with pytest.raises(UnsupportedError, match=r"made:fast cannot take this problem: it lacks QP programs; can take it: .*highs"):
        Made("fast").run(squares, Options(), Control())
    assert Made().missing(squares) == {"QP programs"} and Made().missing(PLAIN) == frozenset()


@pytest.mark.parametrize(
    ("features", "programs", "only_integers", "takes"),
    [
        (LINEAR, (LINEAR,), False, True), (INTEGERS, (LINEAR,), False, False), (LINEAR, (INTEGERS,), False, True),
        (LINEAR, (INTEGERS,), True, False), (INTEGERS, (INTEGERS,), True, True),
        (INTEGERS | QUADRATIC, (INTEGERS, QUADRATIC), False, False),
        (INTEGERS | QUADRATIC, (INTEGERS | QUADRATIC,), True, True), (LINEAR, (), False, False),
    ],
)  # fmt: skip
def test_features_are_taken_together(features: frozenset[str], programs: Any, only_integers: bool, takes: bool) -> None:
    assert takes_features(features, programs, only_integers) == takes


def test_takers_leave_out_the_one_that_was_asked() -> None:
    assert {"highs", "scip"} <= set(takers(LINEAR)) and "highs" not in takers(LINEAR, but="highs")
    assert kinds_of(Made) == ["LP", "MILP"]


# -- names -------------------------------------------------------------------------------------------------------------


def test_a_solver_is_named_with_or_without_one_within_it(registered: Any) -> None:
    registered(BACKENDS, "made", Made)
    assert solver_named("made").variant == "" and solver_named("made:fast").variant == "fast"
    with pytest.raises(UsageError, match="names no solver within made; write made or made:NAME"):
        solver_named("made:")
    with pytest.raises(UsageError, match="solver highs has no variants, so highs:fast does not exist"):
        solver_named("highs:fast")
    with pytest.raises(UsageError, match="unknown solver"):
        solver_named("maid")


def test_a_package_that_is_missing_is_named_with_what_to_install(registered: Any) -> None:
    absent = type("Absent", (Made,), {"modules": ("no_such_module.inner",), "package": "no-such-package"})
    registered(BACKENDS, "absent", absent)
    assert not absent.installed() and absent.version() == "not installed" and Made.installed()
    with pytest.raises(MissingPackageError, match="solver absent needs the package no-such-package: pip install no-such-package"):
        solver_named("absent")


def test_an_engine_lacks_other_families_before_their_features() -> None:
    class Straight(Engine):
        name, package, modules, summary, family = "straight", "numpy", ("numpy",), "", "arrays"
        features = frozenset({"LP"})

        def run(self, problem: Any, options: Options, control: Control) -> RawResult:
            return RawResult("unknown")

    assert Straight().missing(ArrayProblem(PLAIN)) == frozenset()
    assert Straight().missing(ArrayProblem(program([1], [[1]], 0, 1, integer=[0]))) == {"integer"}
    other = type("Other", (Straight,), {"family": "routing"})
    assert other().missing(ArrayProblem(PLAIN)) == {"arrays problems"}


def test_only_what_is_asked_for_is_asked() -> None:
    assert Options().asked() == {} == Options(time_limit=1.0, seed=9, gap=0.0, threads=4).asked()
    assert Options(iterations=0, gap=0.1, no_improvement=5).asked() == {"iterations": 0, "gap": 0.1, "no_improvement": 5}
