"""Running commands inside this process."""

import json
from collections.abc import Callable
from typing import Any

import pytest
from typer.testing import CliRunner

from waybound.cli.app import app


@pytest.fixture
def run() -> Callable[..., Any]:
    """``run("solve", "demo-tiny", ...)``: what the command printed on either stream, and its exit code, which must be ``code`` if given."""

    def call(*arguments: object, code: int | None = None) -> Any:
        result = CliRunner(env={"COLUMNS": "200"}).invoke(app, [str(a) for a in arguments])
        assert code in (None, result.exit_code), (result.exit_code, result.stdout, result.stderr)
        return result

    return call


@pytest.fixture
def strict_json() -> Callable[[str], Any]:
    """Parses standard output that must be exactly one JSON object, without NaN and infinities."""

    def parse(text: str) -> Any:
        def refuse(name: str) -> None:
            raise AssertionError(f"{name} is no JSON")

        data = json.loads(text, parse_constant=refuse)
        assert isinstance(data, dict)
        return data

    return parse


@pytest.fixture
def json_of(run: Callable[..., Any], strict_json: Callable[[str], Any]) -> Callable[..., Any]:
    """``json_of("solve", "demo-tiny", ...)``: the object that a command prints with ``--json`` where it ends with exit code ``code``."""

    def call(*arguments: object, code: int = 0) -> Any:
        return strict_json(run(*arguments, "--json", code=code).stdout)

    return call


@pytest.fixture
def refused(run: Callable[..., Any]) -> Callable[..., str]:
    """Runs a command that must fail with one line on standard error and nothing on standard output; returns the line."""

    def call(*arguments: object, code: int = 2) -> str:
        result = run(*arguments, code=code)
        assert result.stdout == ""
        (line,) = result.stderr.strip().splitlines()
        assert line.startswith("error: ")
        assert "Traceback" not in line
        return str(line)

    return call
