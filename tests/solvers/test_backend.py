import threading
from typing import Any

import numpy as np
import pytest
from coded import check_coded
from file_cases import check_refused
from programs import program

from waybound import Evidence, MissingPackageError, UsageError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.solvers.backend import BACKENDS, Control, Engine, Needs, Options, RawResult, solver_named
from waybound.solvers.program_backend import ProgramBackend

PLAIN = program([3, 2], [[2, 3]], -np.inf, 10.5, 0, [4, 5])


class Made(ProgramBackend):
    """Says what it is told to."""

    name, package, modules, summary = "made", "no-such-distribution", ("json",), "for tests"
    variants = ("fast",)

    def search(self, program: Any, options: Options, control: Control) -> RawResult:
        return RawResult("unknown")


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


def test_an_engine_tells_how_long_it_set_up_and_what_is_left_of_it() -> None:
    told: list[float] = []
    control = Control()
    control.on_set_up = told.append
    control.end_set_up(1.0)
    assert (control.set_up, told, control.left) == (None, [], ", and had published no answer")
    control.begin_set_up()
    assert control.left == " while it was still setting up, and had published no answer"
    control.end_set_up(2.0)
    control.end_set_up(3.0)
    assert (control.set_up, told, control.setting_up) == (2.0, [2.0], False)
    control.publish("found", 1.0)
    assert control.left == "; its last published answer is used"


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


# -- names -------------------------------------------------------------------------------------------------------------


def test_a_solver_is_named_with_or_without_one_within_it(registered: Any) -> None:
    registered(BACKENDS, "made", Made)
    assert solver_named("made").variant == "" and solver_named("made:fast").variant == "fast"
    check_refused(UsageError, "names no solver within made; write made or made:NAME", solver_named, "made:")
    check_refused(UsageError, "solver highs has no variants, so highs:fast does not exist", solver_named, "highs:fast")
    check_coded(UsageError, "unknown-name", solver_named, "maid")


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


def test_an_engine_that_lacks_something_is_asked_for_nothing_else() -> None:
    class Heavy(Engine):
        name, family, package, modules, summary, features = "heavy", "arrays", "waybound", ("json",), "for tests", frozenset[str]()
        needs_process = True

        def memory(self, problem: Any) -> float:
            return 8.0 * problem.size

        def run(self, problem: Any, options: Options, control: Control) -> RawResult:
            return RawResult("unknown")

    made = ArrayProblem(program([1.0], [[1.0]], 0.0, 1.0, 0, 1))
    heavy = type("Able", (Heavy,), {"features": made.features()})()
    assert heavy.needs(made) == Needs(frozenset(), 8.0 * made.size, 0.0, apart=True)
    assert type("Foreign", (Heavy,), {"family": "routing", "memory": None})().needs(made) == Needs(frozenset({"arrays problems"}))


def test_only_what_is_asked_for_is_asked() -> None:
    assert Options().asked() == {} == Options(time_limit=1.0, seed=9, gap=0.0, threads=4).asked()
    assert Options(iterations=0, gap=0.1, no_improvement=5).asked() == {"iterations": 0, "gap": 0.1, "no_improvement": 5}
