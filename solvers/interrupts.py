"""Signals that ask for the end: Ctrl-C, SIGTERM, SIGHUP. While an answer may be lost they are noted; else they interrupt.

A search that is asked to end has ``GRACE`` seconds for its last word. With what follows it, a command ends within ``PATIENCE``.
"""

import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from types import FrameType
from typing import Any

PATIENCE = 2.0
"""Seconds within which everything ends once a signal has asked for it."""

GRACE = 1.2
"""Seconds an engine has to come back once it was asked to stop; after that its published incumbents count."""

LAST = 1.1
"""Seconds of ``PATIENCE`` that are left for showing and writing what was found."""

CHILD_GRACE = 0.8
"""Seconds a process of our own has for the same, so that its parent hears of it in time."""

SAME = 0.5
"""Seconds within which further signals are the first one once more: ``timeout`` sends its signal twice, as does a terminal that closes."""

DEAF = 1.5
"""Seconds after which a command that has nothing to lose is ended, though it never came to notice the signal."""

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))

received = 0
"""Number of the signal that asked for the end; 0 while none did."""

insisted = False
"""Whether another one came while a search was given its time to end."""

searching = 0
"""How many searches can be told to end at once."""

_since = 0.0
_held = 0
_ours = False


def exit_code() -> int:
    """The exit code of an end on a signal that left no answer: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
    return 128 + (received or signal.SIGINT)


def out_of_time() -> bool:
    """Whether a signal leaves no more time than the last steps take."""
    return insisted or (received != 0 and time.monotonic() - _since > PATIENCE - LAST)


def note(number: int = signal.SIGINT) -> None:
    """Remember that the end was asked for."""
    global received, _since
    if not received:
        received, _since = number, time.monotonic()


def reset() -> None:
    """Forget all signals."""
    global received, insisted
    received, insisted = 0, False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Within this block the first signal is only noted: the search looks at ``received``, and its answer so far is kept.

    The command line's signals are held. So is Ctrl-C elsewhere, in the main thread and where nobody else takes it; it is forgotten at
    the end of the outermost block, which is what asked for the search.
    """
    global _held
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    taken = not _ours and not _held and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    _held += 1
    if taken:
        reset()
        signal.signal(signal.SIGINT, _hear)
    try:
        yield
    finally:
        _held -= 1
        if taken:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            reset()
    if _ours and received and not _held:
        raise KeyboardInterrupt  # a command that goes on after its search, such as a study, hears of it now


@contextlib.contextmanager
def waiting() -> Iterator[None]:
    """``held``, in a search that looks at ``insisted`` too."""
    global searching
    searching += 1
    try:
        with held():
            yield
    finally:
        searching -= 1


def keep() -> None:
    """Hold signals to the end of the process: there will be an answer to check, to show and to write. Of use to the command line alone."""
    global _held
    if _ours:
        _held += 1


def take_over() -> None:
    """Handle the signals of this process, for the command line; signals that its caller made it ignore stay ignored."""
    global _ours, _held
    _ours, _held = True, 0
    reset()
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _hear)
    sys.unraisablehook = _lost
    ear, mouth = os.pipe()
    os.set_blocking(mouth, False)
    signal.set_wakeup_fd(mouth, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(ear,), name="waybound-signals", daemon=True).start()


def _hear(number: int, frame: FrameType | None) -> None:
    """The handler: runs in the main thread, between two steps of Python."""
    global insisted
    if not received:
        note(number)
        if not _held:
            raise KeyboardInterrupt
    elif time.monotonic() - _since < SAME:
        return
    elif searching and not insisted:
        insisted = True
    elif _ours:
        leave(exit_code())
    else:
        raise KeyboardInterrupt


def _lost(fault: Any) -> None:
    """Send a signal again whose exception Python dropped, as it does during garbage collection and in callbacks of the import system."""
    if fault.exc_type is not KeyboardInterrupt or not received:
        sys.__unraisablehook__(fault)
        return
    number = received
    reset()
    again = threading.Timer(0.01, os.kill, (os.getpid(), number))
    again.daemon = True
    again.start()


def _watch(ear: int) -> None:
    """End a command whose main thread is held up in native code and cannot hear, if nothing is lost by it."""
    number = os.read(ear, 1)[0]
    time.sleep(DEAF)
    if not received and not _held:
        leave(128 + number)


def leave(code: int) -> None:
    """End this process at once, with its children and their files."""
    children = sys.modules.get("waybound.solvers.children")
    if children is not None:
        children.end_all()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)
