import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from waybound.solvers import interrupts


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.01)  # lets the handler run


@pytest.fixture(autouse=True)
def unharmed():
    """The handling of Ctrl-C is the one it was, and nothing is remembered."""
    before = signal.getsignal(signal.SIGINT)
    yield
    assert signal.getsignal(signal.SIGINT) is before
    assert (interrupts.received, interrupts.insisted, interrupts.searching, interrupts._held) == (0, False, 0, 0)


def test_a_held_interrupt_is_noted_and_forgotten_after_the_outermost_block() -> None:
    with interrupts.held():
        with interrupts.held():
            interrupt()
        assert interrupts.received == signal.SIGINT
        assert interrupts.exit_code() == 130
    assert not interrupts.received


def test_the_same_signal_sent_twice_at_once_is_one() -> None:
    with interrupts.held():
        interrupt()
        interrupt()
        assert interrupts.received == signal.SIGINT


def test_one_that_comes_later_interrupts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interrupts, "SAME", 0.0)
    with pytest.raises(KeyboardInterrupt), interrupts.held():
        interrupt()
        interrupt()


def test_one_that_comes_later_ends_a_search_at_once_and_the_next_one_interrupts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interrupts, "SAME", 0.0)
    with pytest.raises(KeyboardInterrupt), interrupts.waiting():
        interrupt()
        interrupt()
        assert interrupts.insisted
        interrupt()


def test_handlers_of_others_are_left_alone() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    try:
        with interrupts.held():
            interrupt()
            assert not interrupts.received
    finally:
        signal.signal(signal.SIGINT, before)
    assert heard == [signal.SIGINT]


def test_other_threads_hold_nothing() -> None:
    def hold() -> None:
        with interrupts.held():
            found.append(signal.getsignal(signal.SIGINT))

    found: list[object] = []
    thread = threading.Thread(target=hold)
    thread.start()
    thread.join()
    assert found == [signal.getsignal(signal.SIGINT)]


SPLIT = """
import os, signal, sys, threading, time
import numpy as np
import scipy.sparse as sp
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.solving.search import ENGINE_THREAD
from waybound.api import solve
rng = np.random.default_rng(0)
m, n = 6, 50
a = sp.csr_matrix(rng.integers(0, 100, (m, n)).astype(float))
half = np.floor(np.asarray(a.sum(axis=1)).ravel() / 2)
x = Variables("x", keys=(np.arange(n),), lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n), integer=True)
rows = Rows("r", keys=(np.arange(m),), indptr=a.indptr, indices=a.indices, data=a.data, lower=half, upper=half)
def interrupt():
    while not any(thread.name == ENGINE_THREAD for thread in threading.enumerate()):
        time.sleep(0.01)
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
solution = solve(Program("split", "min", (x,), (rows,)), sys.argv[1], time_limit=120, bound_time=0)
print(solution.status, solution.limit)
"""


@pytest.mark.share(2)
@pytest.mark.parametrize(
    "solver", ["cpsat", "scip", *(pytest.param(name, marks=pytest.mark.long) for name in ("mathopt:cp-sat", "mathopt:gscip"))]
)
def test_no_solver_takes_an_interrupt_for_itself(solver: str) -> None:
    # CP-SAT's own handler aborts the process, SCIP's keeps Ctrl-C from everybody else.
    done = subprocess.run([sys.executable, "-c", SPLIT, solver], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == ["unknown", "interrupt"]


LOST = """
import os, signal, time, weakref
from waybound.solvers import interrupts

class Thing: pass

interrupts.take_over()
interrupts._held = HELD
thing = Thing()
kept = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGTERM) or sum(range(100_000)))
try:
    del thing  # the signal comes in a callback, where Python drops what is raised
    time.sleep(20)
    print("never heard")
except KeyboardInterrupt:
    print("heard", interrupts.received)
"""


def test_an_interrupt_that_python_drops_comes_again() -> None:
    ended = subprocess.run([sys.executable, "-c", LOST.replace("HELD", "0")], capture_output=True, text=True, timeout=60)
    assert ended.stdout.split() == ["heard", str(int(signal.SIGTERM))] and ended.stderr == ""
