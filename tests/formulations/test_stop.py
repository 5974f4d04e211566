import os
import threading
import time
from collections.abc import Callable
from types import SimpleNamespace

import pytest
from patience import HANG

import waybound.formulations.stop as stopping
from waybound.formulations.kernels import kernel
from waybound.formulations.stop import NEVER, Stop, Stopped, current_stop, until
from waybound.formulations.stop_kernel import asked


@kernel()
def spin(flag, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Does nothing but look, up to ``most`` times: a compiler must not take the look out of the loop."""
    looked = 0
    while looked < most and not asked(flag):
        looked += 1
    return looked


MOST = 10**11  # minutes


def test_a_deadline_ends_a_compiled_loop() -> None:
    spin(NEVER.flag, 1)
    stop, began = Stop(0.2), time.perf_counter()
    assert spin(stop.flag, MOST) < MOST
    assert 0.2 <= time.perf_counter() - began < HANG
    assert stop.reached() == "time"


def test_a_flag_alone_keeps_its_clock() -> None:
    spin(NEVER.flag, 1)
    began = time.perf_counter()
    assert spin(Stop(0.1).flag, MOST) < MOST
    assert time.perf_counter() - began < HANG


@pytest.mark.parametrize("part", [lambda stop: stop, lambda stop: stop.within(60.0), lambda stop: stop.within(60.0).after(60.0)])
def test_a_wish_ends_a_compiled_loop_and_all_parts(part) -> None:  # type: ignore[no-untyped-def]
    spin(NEVER.flag, 1)
    stop = Stop()
    inner = part(stop)
    threading.Timer(0.1, stop.ask).start()
    began = time.perf_counter()
    assert spin(inner.flag, MOST) < MOST
    assert time.perf_counter() - began < HANG
    assert inner.reached() == stop.reached() == "interrupt"
    with pytest.raises(Stopped):
        inner.check()


def test_parts_made_afterwards_know() -> None:
    stop = Stop()
    stop.ask()
    assert stop.within(60.0).reached() == "interrupt"
    assert stop.within(60.0).flag[0] == 1
    assert stop.after(60.0).flag[0] == 1


def test_a_part_never_ends_later_and_what_comes_after_does() -> None:
    stop = Stop(0.0)
    assert stop.within(60.0).reached() == "time" and stop.within(60.0).flag[0] == 1
    assert stop.after(60.0).reached() == "" and stop.after(60.0).flag[0] == 0
    assert stop.seconds_left == 0.0
    Stop(60.0).check()


@pytest.mark.parametrize("seconds", [1e18, float("inf")])
def test_limits_beyond_all_clocks_are_no_limits(seconds: float) -> None:
    assert Stop(seconds).flag[0] == 0


def within(seconds: float, condition: Callable[[], bool]) -> bool:
    end = time.perf_counter() + seconds
    while not condition() and time.perf_counter() < end:
        time.sleep(0.01)
    return condition()


@pytest.mark.slow
def test_deadlines_are_kept_in_any_order() -> None:
    flags = [Stop(seconds).flag for seconds in (1e4, 0.3, 0.1, 0.2, 1e3, 0.1)]
    assert within(HANG, lambda: sum(int(flag[0]) for flag in flags) == 4)
    assert [int(flag[0]) for flag in flags] == [0, 1, 1, 1, 0, 1]


def test_deadlines_that_nobody_waits_for_are_forgotten() -> None:
    kept = Stop(0.3).flag
    for _ in range(5000):
        assert Stop(1000.0).flag[0] == 0
    assert len(stopping._CLOCK._due) <= 2000
    assert within(HANG, lambda: kept[0] == 1)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_a_forked_process_has_a_clock_of_its_own() -> None:
    Stop(60.0).flag  # noqa: B018
    child = os.fork()
    if not child:  # pragma: no cover - in the child
        flag = Stop(0.05).flag
        os._exit(int(within(HANG, lambda: flag[0] == 1)))
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 1


def test_all_deadlines_share_a_thread() -> None:
    before, held = threading.active_count(), [Stop(60.0).flag for _ in range(20)]
    assert threading.active_count() <= before + 1
    assert not any(flag[0] for flag in held)


def test_the_innermost_block_says_when_to_give_up() -> None:
    first, second = Stop(60.0), Stop(60.0)
    assert current_stop() is NEVER
    with until(first):
        with pytest.raises(ValueError), until(second):
            assert current_stop() is second
            raise ValueError
        assert current_stop() is first
        elsewhere = []
        thread = threading.Thread(target=lambda: elsewhere.append(current_stop()))
        thread.start()
        thread.join()
        assert elsewhere == [NEVER]  # a block is one thread's own
    assert current_stop() is NEVER


def test_no_deadline_comes_nearer_off_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = [100.0]
    monkeypatch.setattr(stopping, "time", SimpleNamespace(perf_counter=lambda: seconds[0]))
    made, heard = Stop(5.0), list[tuple[str, float]]()
    with stopping.hearing(lambda what, took: heard.append((what, took))):
        with stopping.off_the_clock("a loop"), stopping.off_the_clock():
            seconds[0] += 60.0
            assert made.seconds_left == 5.0 and not made.reached()
        seconds[0] += 4.0
        assert made.seconds_left == 1.0 and not made.reached()
        seconds[0] += 1.0
        assert made.reached() == "time"
    assert [what for what, _ in heard] == ["a loop", "", "", "a loop"]
    assert heard[-1] == ("a loop", 60.0)
