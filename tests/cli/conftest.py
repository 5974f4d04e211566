"""Running commands inside this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from typer.testing import CliRunner

from waybound.cli.app import app


@pytest.fixture
def run() -> Callable[..., Any]:
    """``run("solve", "demo-tiny", ...)``: what the command printed on either stream, and its exit code."""

    def call(*arguments: object) -> Any:
        return CliRunner(env={"COLUMNS": "200"}).invoke(app, [str(a) for a in arguments])

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
def refused(run: Callable[..., Any]) -> Callable[..., str]:
    """Runs a command that must fail with one line on standard error and nothing on standard output; returns the line."""

    def call(*arguments: object, code: int = 2) -> str:
        result = run(*arguments)
        assert result.exit_code == code, (result.stdout, result.stderr)
        assert result.stdout == ""
        (line,) = result.stderr.strip().splitlines()
        assert line.startswith("error: ")
        assert "Traceback" not in line
        return str(line)

    return call
