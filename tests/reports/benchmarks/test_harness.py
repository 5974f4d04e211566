"""What benchmarks share: options of a command and its exit codes, fresh processes, clocks and tables."""

import importlib
from pathlib import Path
from typing import Annotated

import pytest

from waybound.reports.benchmarks import _harness as harness
from waybound.reports.benchmarks._harness import Option, best_of, command, in_a_fresh_process, markdown, timed


@command
def main(
    seeds: int = 10, robots: tuple[int, ...] = (3, 4), full: bool = False, kind: Annotated[str, Option(choices=["a", "b"])] = "a"
) -> bool:
    print(seeds, robots, full, kind)
    return seeds > 0


def test_defaults_say_what_options_take_and_false_is_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0 and main(["--seeds", "0", "--robots", "5", "6", "7", "--full", "--kind", "b"]) == 1
    assert capsys.readouterr().out.splitlines() == ["10 (3, 4) False a", "0 [5, 6, 7] True b"]
    with pytest.raises(SystemExit) as end:
        main(["--kind", "c"])
    assert end.value.code == 2 and "invalid choice: 'c'" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["pricing_alone", "stabilised_prices"])
def test_without_a_folder_it_says_so(name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("WAYBOUND_BENCHMARKS", raising=False)
    with pytest.raises(SystemExit):
        importlib.import_module(f"waybound.reports.benchmarks.{name}").main([])
    assert "--folder or WAYBOUND_BENCHMARKS" in capsys.readouterr().err


def test_without_the_tests_of_a_checkout_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(harness, "__file__", str(tmp_path / "reports" / "benchmarks" / "_harness.py"))
    with pytest.raises(SystemExit) as end:
        harness.find_tests()
    assert end.value.code == 2 and "run this from a checkout" in capsys.readouterr().err


def test_a_fresh_process_prints_json_or_fails_with_its_complaint(tmp_path: Path) -> None:
    """``json.tool`` hands on what a file holds."""
    path = tmp_path / "seconds.json"
    path.write_text('{"wall": 1.5}')
    assert in_a_fresh_process("-m", "json.tool", "--compact", path) == {"wall": 1.5}
    with pytest.raises(RuntimeError, match="no such word"):
        in_a_fresh_process("-c", "raise ValueError('no such word')")


def test_works_are_timed_in_turn() -> None:
    turns: list[str] = []
    assert timed(lambda: 7)[1] == 7
    assert len(best_of(2, lambda: turns.append("one"), lambda: turns.append("other"))) == 2
    assert turns == ["one", "other"] * 2


def test_tables_are_lines_of_markdown() -> None:
    assert markdown(("a", "b"), [(1, "x")]) == ["| a | b |", "| --- | --- |", "| 1 | x |"]
