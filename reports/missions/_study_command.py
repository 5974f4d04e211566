"""The command of a study: its folder, and whether a little of everything is enough."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from waybound.instances.errors import WayboundError


def study_command(
    name: str, about: str | None, study: Callable[[Path, bool], str], arguments: list[str] | None, of: str, made: str = "tables and figures"
) -> int:
    """Play a study and print its summary; returns the exit code.

    ``name`` is that of its module in ``waybound.reports.missions``, ``about`` its docstring, of which the first line is shown; ``study``
    gets the folder, and whether to be short; ``of`` is what a short one plays a few of, ``made`` what is written.
    """
    parser = argparse.ArgumentParser(prog=f"python -m waybound.reports.missions.{name}", description=(about or "").splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help=f"folder for {made}; made where it is missing")
    parser.add_argument("--short", action="store_true", help=f"a few {of} of everything, to see that it works")
    options = parser.parse_args(arguments)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        print(study(options.out, options.short), end="")
    except (WayboundError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return getattr(error, "exit_code", 2)
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        return 130
    return 0
