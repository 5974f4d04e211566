"""All commands are there, each with a word of help, and every exit code is told."""

from typing import Any

import pytest
import typer

import waybound as wb
from waybound.cli.app import app

COMMANDS = {
    "bench", "bound", "check", "compare", "convert", "explain", "export", "generate", "heuristics", "info", "instances", "ratio", "report",
    "run", "solve", "solvers", "warm",
}  # fmt: skip


def commands() -> dict[str, Any]:
    return dict(typer.main.get_group(app).commands)


def test_every_command_is_registered_under_its_name() -> None:
    assert set(commands()) == COMMANDS
    assert set(commands()["instances"].commands) == {"list", "path", "show"}


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_and_every_option_has_a_word_of_help(run: Any, name: str) -> None:
    assert run(name, "--help").exit_code == run(name, "-h").exit_code == 0
    command = commands()[name]
    for one in [command, *getattr(command, "commands", {}).values()]:
        assert one.help, one.name
        silent = [p.name for p in one.params if not getattr(p, "help", None) and p.name != "help"]
        assert silent == [], one.name


def test_nothing_asked_is_help_and_nonsense_is_usage(run: Any) -> None:
    assert "Usage:" in run().output
    run("solv", code=2)
    run("solve", "--no-such-option", code=2)


def test_the_help_tells_every_exit_code(run: Any) -> None:
    words = " ".join(run("--help").stdout.split())
    for code in (
        "0 a verified answer",
        "1 internal error",
        "2 usage",
        "3 proven infeasible",
        "4 no answer",
        "5 a check failed",
        "130 interrupted",
    ):
        assert code in words


def test_the_version_is_printed_before_anything_else_is_looked_at(run: Any) -> None:
    result = run("--version", "no-such-command")
    assert (result.exit_code, result.stdout) == (0, f"waybound {wb.__version__}\n")
