"""Progress on standard error: sparse lines, none when quiet, and no harm where nobody can read them."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from waybound.cli.progress import SPARSE_SECONDS, Progress


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


def test_lines_are_sparse_and_hold_all_that_is_known(clock: Any, capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=False) as progress:
        told(progress, objective=12.0)
        clock(SPARSE_SECONDS - 0.1)
        told(progress, bound=8.0)
        assert capsys.readouterr().err == "solve 0.0 s, objective 12\n"
        clock(SPARSE_SECONDS + 0.1)
        told(progress, phase="bound", objective=None)
    assert capsys.readouterr().err == "bound 5.1 s, objective 12, bound 8, gap 33.3 %\n"


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
    with Progress(quiet=False) as progress:
        told(progress, objective=1.0)
