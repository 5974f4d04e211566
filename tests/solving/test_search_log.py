"""The log of a search, and where it goes."""

import re
import sys
import types
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from coded import coded

import waybound as wb
from waybound.solving import search_log
from waybound.solving.recording import Recorder
from waybound.solving.search_log import EVERY, SearchLog, shown


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Any:
    now = [100.0]
    monkeypatch.setattr(search_log.time, "perf_counter", lambda: now[0])
    return lambda seconds: now.__setitem__(0, 100.0 + seconds)


def told(objective: float | None, bound: float | None, kind: str | None, who: str) -> dict[str, Any]:
    return {"phase": "solve", "seconds": 0.0, "objective": objective, "bound": bound, "bound_kind": kind, "found_by": who}


def test_a_line_an_improvement_and_a_sign_of_life_every_few_seconds(clock: Any) -> None:
    lines: list[str] = []
    log = SearchLog(lines.append)
    log.begin(repr(wb.read("demo-tiny")), (), "pyvrp", "time limit 10 s")
    assert lines[0].startswith("waybound ") and "demo-tiny" in lines[0] and lines[1] == "search by pyvrp; time limit 10 s"
    del lines[:]
    clock(1.0)
    log(told(12.0, None, None, "pyvrp"))
    clock(1.5)
    log(told(12.0, 9.0, "evidence", "round trips"))
    clock(1.5 + EVERY)
    log.tick()
    assert [re.sub(" +", " ", line).strip() for line in lines] == [
        "1.00 12 - - answer by pyvrp, not checked yet",
        "1.50 12 9 25 % bound by round trips, its evidence is checked at the end",
        "6.50 12 9 25 % searching",
    ]


def test_a_sign_of_life_tells_nodes_where_the_solver_does(clock: Any) -> None:
    lines: list[str] = []
    log = SearchLog(lines.append)
    log({**told(12.0, None, None, "highs"), "nodes": 0})
    log({**told(12.0, None, None, "highs"), "nodes": 1})
    clock(EVERY)
    log.tick()
    log({**told(12.0, 9.0, "claimed", "highs"), "nodes": 1234})
    clock(2 * EVERY)
    log.tick()
    assert [line.split("  ")[-1] for line in lines] == [
        "answer by highs, not checked yet", "searching, 1 node", "bound by highs, its own figure; 1234 nodes", "searching, 1234 nodes",
    ]  # fmt: skip


def test_of_a_flood_of_answers_the_last_is_told(clock: Any) -> None:
    lines: list[str] = []
    log = SearchLog(lines.append)
    clock(1.0)
    for k in range(50):
        clock(1.0 + k / 1000)
        log(told(100.0 - k, None, None, "pyvrp"))
    assert len(lines) == 1
    clock(1.5)
    log.tick()
    assert len(lines) == 2 and " 51 " in lines[-1]


def test_of_a_bound_that_rises_all_the_time_a_line_is_told_every_few_seconds(clock: Any) -> None:
    lines: list[str] = []
    log = SearchLog(lines.append)
    for k in range(1, 200):
        clock(k / 10)
        log(told(None if k < 33 else 900.0, float(k), "claimed", "scip"))
        log.tick()
    log(told(900.0, 500.0, "evidence", "round trips"))  # of another source: at once
    log(told(900.0, 501.0, "evidence", "round trips"))
    log.begin_phase("check", None)  # what was held back is told before the search ends
    assert [re.sub(" +", " ", line).strip() for line in lines] == [
        "0.10 - 1 - bound by scip, its own figure",
        "3.30 900 33 96.3 % answer by scip, not checked yet, and bound by scip, its own figure",
        "8.30 900 83 90.8 % bound by scip, its own figure",
        "13.30 900 133 85.2 % bound by scip, its own figure",
        "18.30 900 183 79.7 % bound by scip, its own figure",
        "19.90 900 500 44.4 % bound by round trips, its evidence is checked at the end",
        "19.90 900 501 44.3 % bound by round trips, its evidence is checked at the end",
    ]


def test_a_better_answer_is_told_soon_whatever_bound_is_held_back(clock: Any) -> None:
    lines: list[str] = []
    log = SearchLog(lines.append)
    for at, objective, bound in [(0.0, 9.0, 1.0), (0.1, 8.0, 1.0), (0.12, 8.0, 2.0), (0.15, 7.0, 2.0), (0.2, 7.0, 3.0)]:
        clock(at)
        log(told(objective, bound, "claimed", "scip"))
    clock(0.3)
    log.tick()
    assert len(lines) == 2 and "answer by scip" in lines[1] and re.search(r" 7 +3 ", lines[1])


def test_that_no_answer_exists_is_told_in_words(clock: Any) -> None:
    lines: list[str] = []
    SearchLog(lines.append)(told(None, float("inf"), "evidence", "bin packing"))
    assert "no answer exists: bin packing; its evidence is checked at the end" in lines[0] and "inf" not in lines[0]


def test_a_reader_who_is_gone_ends_nothing() -> None:
    def gone(line: str) -> None:
        raise BrokenPipeError

    SearchLog(gone)(told(1.0, None, None, "pyvrp"))


def test_names_out_of_files_forge_no_lines(clock: Any) -> None:
    lines: list[str] = []
    SearchLog(lines.append)(told(1.0, None, None, "x\nproved  all is well\x1b[31m"))
    assert len(lines) == 1 and "\n" not in lines[0] and "\x1b" not in lines[0]


SNAPSHOT = """\
waybound VERSION, RoutingProblem demo-tiny: vrptw, 7 customers, at most 3 vehicles, min total-cost, convention exact
search by savings; time limit 60 s, bound time 0 s, seed 1, 1 thread

  seconds       objective           bound       gap
     TIME               -               -         -  searching begins, for up to 60 s
     TIME     436.2208418               -         -  answer by savings, checked
     TIME     436.2208418               -         -  all checks done

demo-tiny: vrptw, min, convention exact, by savings
status      feasible
proved      the answer keeps every constraint and is worth 436.2208418: 7 checks, redone from the data
not proved  that 436.2208418 is the least: no bound was verified
remarks: savings guarantees nothing for this instance
seconds: TIMES
"""


def test_the_whole_log_of_a_run_says_what_was_proved_and_what_was_not() -> None:
    lines: list[str] = []
    wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0.0, log=SearchLog(lines.append))
    text = "\n".join(lines) + "\n"
    text = text.replace(wb.__version__, "VERSION")
    text = re.sub(r"^seconds: .*$", "seconds: TIMES", text, flags=re.MULTILINE)
    text = re.sub(r"^ *\d+\.\d\d  ", "     TIME  ", text, flags=re.MULTILINE)
    assert text == SNAPSHOT


@pytest.mark.parametrize(
    ("value", "bound", "expected"),
    [
        (10.0, 8.0, 0.2), ([4.0, 9.0], 3.0, 0.25), ([3.0, 9.0], 3.0, None), (None, 3.0, None), (3.0, None, None),
        ([3.0, 9.0], [3.0, None], None),
    ],
)  # fmt: skip
def test_the_gap_on_the_way_is_that_of_an_open_first_level(value: Any, bound: Any, expected: float | None) -> None:
    assert search_log.open_gap(value, bound) == (None if expected is None else pytest.approx(expected))


def test_remarks_on_the_problem_stand_above_the_search(tmp_path: Path) -> None:
    sites = pd.DataFrame({"x": [0, 1], "y": 0, "colour": "red"})
    wb.solve(wb.RoutingProblem.from_frame(sites, vehicles=1), "highs", bound_time=0, log=tmp_path / "log.txt")
    assert "\nnote: columns kept and not used: colour\nsearch by highs" in (tmp_path / "log.txt").read_text()


def test_the_set_up_of_an_engine_is_told_where_it_took_a_while(clock: Any) -> None:
    lines: list[str] = []
    record = Recorder(wb.read("demo-tiny").senses, [SearchLog(lines.append)])
    clock(3.0)
    record.engine_set_up("pyvrp", 0.2)
    record.engine_set_up("pyvrp", 2.96)
    assert len(lines) == 1 and lines[0].endswith("pyvrp is set up, which took 3.0 s")


def test_a_path_is_written_as_the_search_goes(tmp_path: Path) -> None:
    wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0.0, log=tmp_path / "a.log")
    text = (tmp_path / "a.log").read_text()
    assert text.startswith("waybound ") and "not proved" in text


def test_true_is_standard_error_where_there_is_no_notebook(capsys: pytest.CaptureFixture[str]) -> None:
    with shown(True) as log:
        log({"phase": "solve", "objective": 1.0, "bound": None, "bound_kind": None, "found_by": "a"})
    told = capsys.readouterr()
    assert "answer by a" in told.err and told.out == ""


@pytest.mark.parametrize("log", [None, False])
def test_nothing_is_said_by_default(log: Any, capsys: pytest.CaptureFixture[str]) -> None:
    with shown(log) as made:
        assert made is None
    assert capsys.readouterr().err == ""


def test_a_file_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(wb.InputError, match=r"none/a\.log", check=coded("file")), shown(tmp_path / "none" / "a.log"):
        pass


def test_anything_else_is_refused() -> None:
    with pytest.raises(wb.UsageError, check=coded("malformed")), shown(3):  # type: ignore[arg-type]
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
    assert search_log.in_notebook()
    with shown(True) as log:
        log({"phase": "solve", "objective": 1.0, "bound": None, "bound_kind": None, "found_by": "<b>"})
    assert "answer by <b>" in pages[-1]["text/plain"]
    assert "answer by &lt;b&gt;" in pages[-1]["text/html"]
