"""Where a log goes."""

from __future__ import annotations

import sys
import types
from pathlib import Path
from typing import Any

import pytest

import waybound as wb
from waybound.solving import showing
from waybound.solving.search_log import SearchLog
from waybound.solving.showing import shown


def test_a_path_is_written_as_the_search_goes(tmp_path: Path) -> None:
    wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0.0, log=tmp_path / "a.log")
    text = (tmp_path / "a.log").read_text()
    assert text.startswith("waybound ") and "not proved" in text


def test_true_is_standard_error_where_there_is_no_notebook(capsys: pytest.CaptureFixture[str]) -> None:
    with shown(True) as log:
        assert log is not None
        log({"phase": "solve", "objective": 1.0, "bound": None, "bound_kind": None, "found_by": "a"})
    told = capsys.readouterr()
    assert "answer by a" in told.err and told.out == ""


@pytest.mark.parametrize("log", [None, False])
def test_nothing_is_said_by_default(log: Any, capsys: pytest.CaptureFixture[str]) -> None:
    with shown(log) as made:
        assert made is None
    assert capsys.readouterr().err == ""


def test_a_file_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(wb.InputError, match=r"none/a\.log.*cannot be written"), shown(tmp_path / "none" / "a.log"):
        pass


def test_anything_else_is_refused() -> None:
    with pytest.raises(wb.UsageError, match="log is True, the name of a file"), shown(3):  # type: ignore[arg-type]
        pass


def test_an_error_is_told_in_the_log() -> None:
    lines: list[str] = []
    with pytest.raises(wb.UsageError), SearchLog(lines.append):
        raise wb.UsageError("no such thing")
    assert lines == ["ended by an error: no such thing"]


def test_in_a_notebook_the_cell_shows_the_log_and_keeps_it(monkeypatch: pytest.MonkeyPatch) -> None:
    pages: list[dict[str, str]] = []

    class Handle:
        def update(self, page: dict[str, str], raw: bool) -> None:
            pages.append(page)

    def display(page: dict[str, str], raw: bool, display_id: bool) -> Handle:
        pages.append(page)
        return Handle()

    python = types.ModuleType("IPython")
    python.get_ipython = lambda: object()  # type: ignore[attr-defined]
    python_display = types.ModuleType("IPython.display")
    python_display.display = display  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", python)
    monkeypatch.setitem(sys.modules, "IPython.display", python_display)
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    assert showing.in_notebook()
    with shown(True) as log:
        assert log is not None
        log({"phase": "solve", "objective": 1.0, "bound": None, "bound_kind": None, "found_by": "<b>"})
    assert "answer by <b>" in pages[-1]["text/plain"]
    assert "answer by &lt;b&gt;" in pages[-1]["text/html"]
