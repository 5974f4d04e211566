"""The command line. Each command imports what it needs when it runs, so that ``waybound --help`` is fast."""

from __future__ import annotations


def main() -> None:
    """Entry point of the command ``waybound``."""
    import sys

    try:
        from .app import app

        app(prog_name="waybound")
    except KeyboardInterrupt:  # before a command has begun
        sys.exit(130)
