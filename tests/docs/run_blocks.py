"""Runs the Python blocks and console sessions of a page in the working directory; prints what fails or comes out otherwise than shown."""

import re
import sys
import traceback
from pathlib import Path

from run_page import console, session

BLOCK = re.compile(r"^```(python|console)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def silent(text: str) -> list[str]:
    """Faults of console commands whose output is not shown: those that end otherwise than with 0, or the exit code in their comment."""
    import shlex

    from typer.testing import CliRunner

    from waybound.cli.app import app

    faults = []
    for command in re.findall(r"^\$ waybound (.*)$", text, flags=re.MULTILINE):
        words = shlex.split(command, comments=True)
        expected = re.search(r"#.*exit code (\d+)", command)
        ended = CliRunner(env={"COLUMNS": "120"}).invoke(app, words)
        if ended.exit_code != (int(expected[1]) if expected else 0):
            faults.append(f"$ waybound {command}\n{ended.output}[exit code {ended.exit_code}]")
    return faults


def run_blocks(page: Path) -> list[str]:
    """Faults of a page, block after block, in one namespace."""
    names: dict[str, object] = {}
    faults: list[str] = []
    for language, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language == "console":
            shows = re.search(r"^(?!\$ |$)", text, flags=re.MULTILINE)
            faults += console(text, Path()) if shows else silent(text)
        elif text.startswith(">>> "):
            faults += session(text, names)
        else:
            try:
                exec(compile(text, page.name, "exec"), names)
            except Exception:
                faults.append(f"{text}\n{traceback.format_exc()}")
    return faults


if __name__ == "__main__":
    found = run_blocks(Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(bool(found))
