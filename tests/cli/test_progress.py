"""Progress on standard error: only where somebody looks, and no harm where nobody can read it."""

import sys
from pathlib import Path
from typing import Any

import pytest

from waybound.cli.progress import Progress


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Any:
    """``clock(seconds)`` sets how long the search has taken."""
    now = [100.0]
    monkeypatch.setattr("waybound.cli.progress.time.perf_counter", lambda: now[0])

    def set_to(seconds: float) -> None:
        now[0] = 100.0 + seconds

    return set_to


def told(progress: Progress, **event: Any) -> None:
    progress({"phase": "solve", **event})


def test_nothing_is_said_where_nobody_looks(clock: Any, capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=False, logged=True) as progress:
        assert progress.log is None
        told(progress, objective=12.0)
        clock(100.0)
        told(progress, bound=8.0)
    assert capsys.readouterr().err == ""


def test_a_log_is_written_to_a_file_wherever_standard_error_goes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=True, log=str(tmp_path / "a.log"), logged=True) as progress:
        progress.log({"phase": "solve", "objective": 12.0, "bound": None, "bound_kind": None, "found_by": "pyvrp"})
    assert "answer by pyvrp" in (tmp_path / "a.log").read_text()
    assert capsys.readouterr().err == ""


def test_a_dash_is_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=False, log="-", logged=True) as progress:
        progress.log({"phase": "solve", "objective": 12.0, "bound": None, "bound_kind": None, "found_by": "pyvrp"})
    assert "answer by pyvrp" in capsys.readouterr().err


def test_the_live_line_shows_the_limit_of_the_phase(clock: Any) -> None:
    progress = Progress(quiet=True)
    with progress:
        clock(2.0)
        progress.begin_phase("solve", 60.0)
        clock(5.5)
        told(progress, objective=12.0)
        assert progress.line() == "solve 3.5 of 60 s, objective 12"


def test_the_live_line_tells_nodes(clock: Any) -> None:
    progress = Progress(quiet=True)
    with progress:
        clock(2.0)
        told(progress, objective=12.0, nodes=345)
        assert progress.line() == "solve 2.0 s, objective 12, 345 nodes"


def test_what_is_told_later_replaces_what_was_and_none_does_not(clock: Any) -> None:
    progress = Progress(quiet=True)
    with progress:
        for event in ({"objective": 12.0, "bound": 6.0}, {"objective": 10.0}, {"bound": None}):
            told(progress, **event)
        clock(2.0)
        assert progress.line() == "solve 2.0 s, objective 10, bound 6, gap 40 %"


def test_an_infinite_bound_says_that_there_is_no_answer(clock: Any) -> None:
    progress = Progress(quiet=True)
    with progress:
        told(progress, bound=float("inf"))
        assert progress.line() == "solve 0.0 s, no answer exists"


def test_objectives_of_several_levels_have_no_gap(clock: Any) -> None:
    progress = Progress(quiet=True)
    with progress:
        told(progress, objective=[3.0, 24.5], bound=[3.0, None])
        assert "gap" not in progress.line() and "3" in progress.line() and "24.5" in progress.line()


def test_quiet_is_silent(clock: Any, capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=True) as progress:
        told(progress, objective=1.0)
        clock(100.0)
        told(progress, objective=1.0)
    assert capsys.readouterr().err == ""


def test_a_stream_that_nobody_reads_does_not_end_a_search(clock: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    class Closed:
        def isatty(self) -> bool:
            return False

        def write(self, text: str) -> int:
            raise BrokenPipeError

        def flush(self) -> None:
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stderr", Closed())
    with Progress(quiet=False, log="-", logged=True) as progress:
        progress.log({"phase": "solve", "objective": 1.0, "bound": None, "bound_kind": None, "found_by": "a"})
