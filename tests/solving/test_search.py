import _thread
import threading
import time

import pytest

from waybound.solvers import interrupts
from waybound.solvers.backend import Control, RawResult
from waybound.solving.search import in_time, search


def test_the_engines_last_word_is_returned() -> None:
    searched = search(lambda control: RawResult("optimal", answer=1, objective=2.0), Control(), 1.0)
    assert searched.result.answer == 1
    assert not searched.interrupted


def test_a_crash_without_an_answer_is_raised() -> None:
    def crash(control: Control) -> RawResult:
        raise ZeroDivisionError("engine broke")

    with pytest.raises(ZeroDivisionError, match="engine broke"):
        search(crash, Control(), 1.0)


def test_an_answer_outlives_a_crash() -> None:
    def crash(control: Control) -> RawResult:
        control.publish("best so far", 3.0)
        raise ZeroDivisionError("engine broke")

    searched = search(crash, Control(), 1.0)
    assert searched.result.answer == "best so far"
    assert "engine broke" in searched.result.message


def test_an_engine_that_overstays_is_asked_to_stop() -> None:
    def stubborn(control: Control) -> RawResult:
        control.publish("incumbent", 1.0)
        while not control.stopped:
            time.sleep(0.01)
        return RawResult("feasible", limit="interrupt", answer="last word")

    searched = search(stubborn, Control(), 0.1, overtime=0.1)
    assert searched.result.answer == "last word"
    assert searched.result.limit == "time"  # nobody but the clock interrupted it


def test_an_engine_that_never_comes_back_leaves_its_incumbent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.solving.search.GRACE", 0.2)
    release = threading.Event()

    def deaf(control: Control) -> RawResult:
        control.publish("incumbent", 1.0)
        release.wait(20)
        return RawResult("feasible", answer="too late")

    searched = search(deaf, Control(), 0.1, overtime=0.1)
    release.set()
    assert searched.result.answer == "incumbent"
    assert searched.result.limit == "time"


def test_ctrl_c_stops_the_engine_and_keeps_its_answer() -> None:
    def engine(control: Control) -> RawResult:
        control.publish("incumbent", 1.0)
        threading.Timer(0.2, _thread.interrupt_main).start()
        while not control.stopped:
            time.sleep(0.01)
        return RawResult("feasible", answer="incumbent", objective=1.0)

    searched = search(engine, Control(), 30.0)
    assert searched.interrupted
    assert searched.result.limit == "interrupt"
    assert searched.result.answer == "incumbent"


def test_after_a_signal_nothing_is_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interrupts, "received", 15)
    monkeypatch.setattr(interrupts, "_ours", True)
    with pytest.raises(KeyboardInterrupt):
        search(lambda control: pytest.fail("begun"), Control(), 1.0)


def test_what_takes_longer_than_a_signal_leaves_is_done_without() -> None:
    release = threading.Event()
    threading.Timer(0.2, _thread.interrupt_main).start()
    assert in_time(lambda: "all" if release.wait(60) else "", lambda: "less") == "less"
    release.set()


def test_what_is_done_in_time_is_taken_and_its_faults_are_raised() -> None:
    assert in_time(lambda: 1, lambda: 2) == 1
    with pytest.raises(ZeroDivisionError):
        in_time(lambda: 1 // 0, lambda: 2)


def test_who_is_given_up_is_heard_no_more():
    events: list[dict] = []
    control = Control(events.append)
    late = threading.Event()

    def deaf(control: Control) -> RawResult:
        late.wait(20.0)
        control.publish("late", 1.0)
        done.set()
        return RawResult("feasible", answer="late")

    done = threading.Event()
    found = search(deaf, control, 0.05, overtime=0.0)
    late.set()
    assert done.wait(20.0)
    assert (found.result.answer, control.answer, events) == (None, None, [])
