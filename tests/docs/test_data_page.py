"""Every block of the page on data runs, and says what the page says."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from waybound.cli.app import app

PAGE = Path(__file__).resolve().parents[2] / "docs" / "data.md"
SESSIONS = re.findall(r"^\$ waybound (.*)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def test_every_block_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    held: dict[str, object] = {}
    for number, block in enumerate(BLOCKS, start=1):
        exec(compile(block, f"{PAGE.name}, block {number}", "exec"), held)
    said = capsys.readouterr().out
    assert len(BLOCKS) == 17
    assert "column 'demands' is unknown; did you mean 'demand'?" in said and "Yard > " in said
    assert {path.suffix for path in tmp_path.iterdir()} == {".json", ".csv", ".xlsx", ".sol", ".vroom", ".geojson", ".mps"}
    assert held["one_way"].forbidden.sum() == 2  # type: ignore[attr-defined]
    assert np.allclose(held["roads"].size("km"), 13.2)  # type: ignore[attr-defined]
    assert len(SESSIONS) == 4
    for line in SESSIONS:
        assert CliRunner().invoke(app, shlex.split(line)).exit_code == 0, line
