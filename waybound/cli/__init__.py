"""The command line. Each command imports what it needs when it runs, so that ``waybound --help`` is fast."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of the command ``waybound``."""
    from ..solvers import interrupts

    interrupts.take_over()
    try:
        from .app import app

        app(prog_name="waybound")
    except KeyboardInterrupt:  # before a command has begun
        _leave(interrupts.exit_code())
    except SystemExit as end:
        _leave(interrupts.exit_code() if end.code == 130 else end.code)  # Typer's, where it met the signal


def _leave(code: str | int | None) -> None:
    """Exit; at once after a signal, or if an engine that did not stop when asked still runs: ending its thread in order would abort."""
    import signal
    import threading

    from ..solvers import interrupts

    for number in interrupts.SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # all is said: one more Ctrl-C must not change the exit code
    search = sys.modules.get("waybound.solvers.search")
    running = search is not None and any(t.name == search.ENGINE_THREAD for t in threading.enumerate())
    if running or interrupts.received:
        interrupts.leave(code if isinstance(code, int) else int(code is not None))
    sys.exit(code)
