import dataclasses
import os
import pickle
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import psutil
import pytest
from coded import coded
from patience import HANG
from small_routing import FEATURES, small

from waybound import RoutingProblem, UnsupportedError, UsageError, solve
from waybound.formulations.stop import now
from waybound.solvers import isolation
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.isolation import run_isolated

HERE = Path(__file__).parent


@pytest.fixture
def misbehaving(monkeypatch: pytest.MonkeyPatch):
    """``misbehaving(deed)``: a problem that does something bad in the child."""
    monkeypatch.syspath_prepend(str(HERE))
    import misbehaving as module

    def make(deed: str) -> RoutingProblem:
        good = small("capacity", 0, "round")
        fields = {f.name: getattr(good, f.name) for f in dataclasses.fields(good)}
        return module.Misbehaving(**fields, deed=deed, home=os.getpid())

    return make


def children() -> list[str]:
    """Python processes that this one has started and not buried."""
    return [process.name() for process in psutil.Process().children() if "python" in process.name()]


@pytest.mark.parametrize("feature", FEATURES)
def test_every_routing_problem_survives_the_journey(feature: str) -> None:
    problem = small(feature, 0, "trunc1")
    assert pickle.loads(pickle.dumps(problem)).digest() == problem.digest()


@pytest.mark.share(2)
@pytest.mark.parametrize("engine", ["pyvrp", "ortools"])
def test_the_answer_is_the_one_found_without_isolation(engine: str) -> None:
    from waybound.solvers.backend import BACKENDS

    problem, options = small("time-windows", 1, "exact"), Options(time_limit=20, iterations=40)
    apart = run_isolated(engine, problem, options, Control())
    here = BACKENDS[engine]().run(problem, options, Control())  # type: ignore[arg-type]
    assert (apart.status, apart.limit, apart.answer, apart.objective) == (here.status, here.limit, here.answer, here.objective)


def test_programs_travel_and_come_back_as_vectors() -> None:
    result = run_isolated("highs", _program(), Options(time_limit=10), Control())
    assert result.status == "optimal"
    assert result.objective == pytest.approx(9.0)
    assert isinstance(result.answer, np.ndarray)


def test_what_decodes_a_program_stays_here() -> None:
    made, decoded = small("time-windows", 1, "exact").compile(), []
    kept = dataclasses.replace(made, decode=lambda x: decoded.append(x) or made.decode(x))  # no function travels, and this one could not
    assert solve(kept, "highs", isolate=True, time_limit=20, bound_time=0).answer is not None and decoded


def _program():
    from waybound.formulations.programs.program import Program, Rows, Variables

    integer = Variables("z", lower=np.zeros(1), upper=np.full(1, np.inf), cost=np.array([3.0]), integer=True)
    free = Variables("x", lower=np.zeros(1), upper=np.full(1, np.inf), cost=np.array([2.0]))
    rows = Rows(
        "row", indptr=np.array([0, 2], dtype=np.int32), indices=np.array([0, 1], dtype=np.int32), data=np.ones(2),
        lower=np.array([4.5]), upper=np.array([np.inf]),
    )  # fmt: skip
    return Program("tiny", "min", (free, integer), (rows,))


def test_incumbents_stream_to_the_parent() -> None:
    events: list[dict] = []
    control = Control(events.append)
    result = run_isolated("pyvrp", small("capacity", 0, "exact"), Options(time_limit=HANG, iterations=200), control)
    assert events
    assert control.objective == pytest.approx(result.objective)
    assert control.answer is not None


@pytest.mark.parametrize(("how", "words"), [("crash", "SIGSEGV"), ("exit", "code 3")])
def test_an_end_of_the_child_costs_only_that_solve_and_is_reported(how: str, words: str, misbehaving) -> None:
    result = run_isolated("pyvrp", misbehaving(how), Options(time_limit=10), Control())
    assert result.status == "error"
    assert words in result.message


def test_an_answer_published_before_a_crash_survives(misbehaving) -> None:
    control = Control()
    control.publish("the best so far", 1.0)
    result = run_isolated("pyvrp", misbehaving("crash"), Options(time_limit=10), control)
    assert (result.status, result.answer, result.objective) == ("feasible", "the best so far", 1.0)
    assert "SIGSEGV" in result.message


def test_a_fault_in_the_engine_is_told_in_one_line(misbehaving) -> None:
    result = run_isolated("pyvrp", misbehaving("raise"), Options(time_limit=10), Control())
    assert result == RawResult("error", message="the solver failed: ZeroDivisionError: a fault in the engine")


def test_a_hanging_child_is_ended_at_its_time_limit(misbehaving, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolation, "OVERTIME", 0.3)
    monkeypatch.setattr(isolation, "GRACE", 0.3)
    result = run_isolated("pyvrp", misbehaving("hang"), Options(time_limit=0.5), Control())
    assert (result.status, result.limit, result.answer) == ("unknown", "time", None)
    assert not children()


def test_a_child_that_tells_much_is_ended_at_its_time_limit_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(HERE))
    from misbehaving import Chatters

    monkeypatch.setattr(isolation, "OVERTIME", 0.1)
    monkeypatch.setattr(isolation, "GRACE", 0.1)
    result = isolation.run_in_process(Chatters(), Options(time_limit=0.1), Control())
    assert (result.status, result.limit, result.answer) == ("feasible", "time", "word")


def test_what_is_prepared_takes_no_time_of_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(HERE))
    from misbehaving import SlowToBegin

    assert isolation.run_in_process(SlowToBegin(0.1), Options(time_limit=HANG), Control()).answer
    now, sent = [0.0], []
    child = SimpleNamespace(
        asked=None, began=0.0, searching=None, late=False, standing=0, options=Options(time_limit=0.5), control=Control(),
        mine=SimpleNamespace(send_bytes=sent.append),
    )  # fmt: skip
    monkeypatch.setattr(isolation, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    now[0] = 0.6 + isolation.OVERTIME
    assert not isolation._Child._overdue(child) and not sent
    child.searching = 0.0
    assert not isolation._Child._overdue(child) and sent == [b"stop"] and child.late
    now[0] += isolation.GRACE + 1.0
    assert isolation._Child._overdue(child)


def test_the_clock_of_all_deadlines_stands_still_while_a_process_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(HERE))
    from misbehaving import SlowToBegin

    before, began = now(), time.perf_counter()
    assert isolation.run_in_process(SlowToBegin(0.3), Options(time_limit=60), Control()).answer
    assert (time.perf_counter() - began) - (now() - before) >= 0.3


def test_how_long_an_engine_set_up_is_told_from_another_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(HERE))
    from misbehaving import SetsUp

    control, told = Control(), []
    control.on_set_up = told.append
    isolation.run_in_process(SetsUp(), Options(time_limit=60), control)
    assert (control.set_up, control.setting_up, told) == (2.5, False, [2.5])


def test_a_hanging_child_is_ended_on_an_interrupt(misbehaving) -> None:
    control = Control()
    threading.Timer(1.0, control.stop).start()
    result = run_isolated("pyvrp", misbehaving("hang"), Options(time_limit=600), control)
    assert (result.status, result.limit) == ("unknown", "interrupt")
    assert not children()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux keeps limits on the address space")
def test_the_memory_limit_is_kept(misbehaving) -> None:
    result = run_isolated("pyvrp", misbehaving("exhaust"), Options(time_limit=30, memory_limit=200), Control())
    assert (result.status, result.limit) == ("unknown", "memory")
    assert "200 MB" in result.message


@pytest.mark.share(2)
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux keeps limits on the address space")
@pytest.mark.parametrize("engine", ["pyvrp", "ortools"])
def test_a_sufficient_memory_limit_does_no_harm(engine: str) -> None:
    result = run_isolated(engine, small("capacity", 0, "round"), Options(time_limit=10, iterations=20, memory_limit=1000), Control())
    assert result.status == "feasible"


def test_errors_of_the_user_come_back_as_they_are() -> None:
    with pytest.raises(UsageError, match=r"no option 'ils\.history'; did you mean 'ils\.history_length'", check=coded("unknown-name")):
        run_isolated("pyvrp", small("capacity", 0, "round"), Options(extra={"ils.history": 3}), Control())
    with pytest.raises(UnsupportedError, match="energy:windows"):
        run_isolated("pyvrp", small("windows", 0, "round"), Options(), Control())


def test_a_problem_that_cannot_travel_is_refused() -> None:
    problem = small("capacity", 0, "round")
    object.__setattr__(problem, "name", lambda: "unpicklable")
    with pytest.raises(UsageError, check=coded("unsupported")):
        run_isolated("pyvrp", problem, Options(), Control())


def test_a_script_without_a_main_guard_is_not_run_again(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(f"""
        import sys
        sys.path.insert(0, {str(HERE.parent)!r})
        print("started")
        from small_routing import small
        from waybound.solvers.backend import Control, Options
        from waybound.solvers.isolation import run_isolated
        print(run_isolated("pyvrp", small("capacity", 0, "round"), Options(iterations=10), Control()).status)
        """)
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout.split() == ["started", "feasible"], done.stderr


def test_the_child_does_not_outlive_its_parent(tmp_path: Path) -> None:
    script = tmp_path / "parent.py"
    script.write_text(
        textwrap.dedent(f"""
        import os, sys, threading, time
        sys.path.insert(0, {str(HERE.parent)!r})
        from small_routing import small
        from waybound.solvers.backend import Control, Options
        from waybound.solvers.isolation import run_isolated
        def leave(event):
            import psutil
            print(psutil.Process().children()[0].pid, flush=True)
            os._exit(0)
        run_isolated("pyvrp", small("capacity", 0, "round"), Options(time_limit=120), Control(leave))
        """)
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60, check=True)
    child = int(done.stdout.split()[0])
    for _ in range(50):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        if Path(f"/proc/{child}/stat").exists() and Path(f"/proc/{child}/stat").read_text().split()[2] == "Z":
            return
        time.sleep(0.1)
    raise AssertionError("the child is still alive")


def test_a_process_aside_makes_no_clock_stand_still_while_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(HERE))
    from misbehaving import SlowToBegin

    monkeypatch.setattr(isolation, "off_the_clock", lambda: 1 / 0)
    assert isolation.run_in_process(SlowToBegin(0.0), Options(time_limit=HANG), Control(), aside=True).answer
