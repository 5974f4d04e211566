"""The command line. Each command imports what it needs when it runs, so that ``waybound --help`` is fast."""

import sys


def main() -> None:
    """Entry point of the command ``waybound``."""
    from ..solvers import interrupts

    _keep_streams_apart()
    interrupts.take_over()
    try:
        from .app import app

        app(prog_name="waybound")
    except KeyboardInterrupt:  # before a command has begun
        _leave(interrupts.exit_code())
    except SystemExit as end:
        _leave(interrupts.exit_code() if end.code == 130 else end.code)  # Typer's, where it met the signal
    except OSError as fault:  # help or version, where it cannot be printed
        from .handling import complain
        from .output import unprinted

        complain(str(unprinted(fault)))
        _leave(2)


def _keep_streams_apart() -> None:
    """Take the places of standard streams that came closed, else the next file takes them, and what is printed goes into it."""
    import os

    for place, name, mode, flag in ((0, "stdin", "r", os.O_WRONLY), (1, "stdout", "w", os.O_RDONLY), (2, "stderr", "w", os.O_WRONLY)):
        if getattr(sys, name) is None:  # read or written to, the first two fail as closed ones do; what is said to the third is lost
            nowhere = os.open(os.devnull, flag)
            if nowhere != place:
                os.dup2(nowhere, place)
                os.close(nowhere)
            setattr(sys, name, os.fdopen(place, mode, closefd=False))


def _leave(code: str | int | None) -> None:
    """Exit; at once after a signal, or if an engine that did not stop when asked still runs: ending its thread in order would abort."""
    import signal
    import threading

    from ..solvers import interrupts

    for number in interrupts.SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # all is said: one more Ctrl-C must not change the exit code
    search = sys.modules.get("waybound.solving.search")
    running = search is not None and any(t.name == search.ENGINE_THREAD for t in threading.enumerate())
    if running or interrupts.received:
        interrupts.leave(code if isinstance(code, int) else int(code is not None))
    sys.exit(code)
