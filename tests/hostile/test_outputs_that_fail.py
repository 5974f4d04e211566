"""Files, plots and standard output that fail: each other output is written, and the answer is shown whatever becomes of them."""

import importlib
import json
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from injected import BEST, TINY, InterruptAt, answer_in, failing, solver_of, ways
from typer.testing import CliRunner

from waybound import Certificate, Solution
from waybound.cli.app import app
from waybound.solvers.backend import RawResult

cli = importlib.import_module("waybound.cli.solving")


@pytest.fixture
def engine(registered: Any) -> Callable[..., str]:
    return solver_of(registered)


@pytest.fixture
def waybound(engine: Callable[..., str], tmp_path: Path) -> Callable[..., Any]:
    """Runs ``solve demo-tiny`` with a solver that finds the best answer; without bounds, that it may be fast."""
    engine()

    def call(*arguments: object) -> Any:
        given = ["solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "-q", *map(str, arguments)]
        return CliRunner(env={"COLUMNS": "200"}).invoke(app, given)

    return call


# -- writing, drawing, printing ---------------------------------------------------------------------------------------

OUTPUTS = {"--out": "a.json", "--certificate": "c.json", "--plot": "p.png"}
MAKERS = {
    "--out": (Solution, "to_json"), "--certificate": (Certificate, "to_json"), "--plot": ("waybound.reports.plots", "save_plot"),
}  # fmt: skip


@ways
@pytest.mark.parametrize("option", OUTPUTS)
def test_an_output_that_cannot_be_made_costs_no_other_and_not_the_answer(
    option: str, fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, waybound: Any, tmp_path: Path, tally: Any
) -> None:
    where, what = MAKERS[option]
    owner = importlib.import_module(where) if isinstance(where, str) else where
    if option == "--certificate":
        honest = Certificate.to_json
        fail = failing(fault)
        monkeypatch.setattr(owner, what, lambda self, with_evidence=False: fail() if with_evidence else honest(self))
    else:
        monkeypatch.setattr(owner, what, failing(fault))
    paths = {o: tmp_path / name for o, name in OUTPUTS.items()}
    result = waybound("--json", *(part for pair in paths.items() for part in pair))
    assert result.exit_code == (130 if fault is KeyboardInterrupt else 1)
    assert f"error: {option} {paths[option]}: cannot be written: {words}" in result.stderr
    assert answer_in(result.stdout) == BEST
    assert {o for o, path in paths.items() if path.exists()} == OUTPUTS.keys() - {option}
    tally["faults injected"] += 1


@ways
def test_an_answer_that_cannot_be_shown_is_printed_as_it_is(
    fault: Any, words: str, monkeypatch: Any, waybound: Any, tmp_path: Path
) -> None:
    monkeypatch.setattr(cli, "_shown", failing(fault))
    result = waybound("--out", tmp_path / "a.json")
    assert result.exit_code == (130 if fault is KeyboardInterrupt else 1)
    assert words in result.stderr
    assert answer_in(result.stdout) == answer_in((tmp_path / "a.json").read_text()) == BEST


@pytest.mark.parametrize("stage", [(cli, "_shown"), (cli, "_write_outputs")])
def test_one_interrupt_while_handing_over_costs_nothing(stage: Any, monkeypatch: Any, waybound: Any, tmp_path: Path) -> None:
    fail = failing(KeyboardInterrupt, 1)
    if stage[1] == "_shown":
        honest = cli._shown
        monkeypatch.setattr(cli, "_shown", lambda *given: fail() or honest(*given))
    else:
        honest = Solution.to_json
        monkeypatch.setattr(Solution, "to_json", lambda self: fail() or honest(self))
    result = waybound("--out", tmp_path / "a.json")
    assert result.exit_code == 0
    assert "feasible: all" in result.stdout
    assert answer_in((tmp_path / "a.json").read_text()) == BEST


def test_what_the_system_refuses_is_exit_2_after_the_answer(waybound: Any, engine: Any, tmp_path: Path) -> None:
    full, certificate, taken = tmp_path / "full.json", tmp_path / "c.json", tmp_path / "p.png"
    full.symlink_to("/dev/full")

    def work(problem: Any, options: Any, control: Any) -> RawResult:
        taken.mkdir()
        return RawResult("feasible", answer=BEST)

    engine(work)
    result = waybound("--out", full, "--certificate", certificate, "--plot", taken, "--json")
    assert result.exit_code == 2
    assert f"error: --out {full}: cannot be written: No space left on device" in result.stderr
    assert f"error: --plot {taken}: is a directory" in result.stderr
    assert answer_in(result.stdout) == BEST
    assert json.loads(certificate.read_text())["kind"] == "certificate"
    assert full.is_symlink()
    assert Path("/dev/full").is_char_device()


@pytest.mark.parametrize("name", ["missing/a.json", "folder.json", "dangling.json", "loop.json", "a" * 300 + ".json"])
@pytest.mark.parametrize("option", ["--out", "--certificate"])
def test_what_could_never_be_written_is_refused_before_the_search(
    option: str, name: str, waybound: Any, engine: Any, tmp_path: Path
) -> None:
    (tmp_path / "folder.json").mkdir()
    (tmp_path / "dangling.json").symlink_to(tmp_path / "nowhere" / "a.json")
    (tmp_path / "loop.json").symlink_to(tmp_path / "loop.json")
    engine(failing(lambda: AssertionError("the search began")))
    result = waybound(option, tmp_path / name)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: {option} {tmp_path}") and name[-60:] in result.stderr  # a long line is cut in its middle
    assert "the search began" not in result.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dangling.json", "folder.json", "loop.json"]


def test_a_fault_beside_an_output_that_fails_is_exit_5(waybound: Any, engine: Any, tmp_path: Path) -> None:
    (tmp_path / "full.json").symlink_to("/dev/full")
    engine(lambda p, o, c: RawResult("feasible", answer=BEST, objective=1.0))
    result = waybound("--out", tmp_path / "full.json")
    assert result.exit_code == 5
    assert "No space left" in result.stderr
    assert "made claims the objective 1.0" in result.stderr
    assert "made claims the objective 1.0" in result.stdout


def test_an_interrupt_at_any_line_of_handing_over_costs_no_answer(
    waybound: Any, tmp_path: Path, tally: Any, share: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.fsync", lambda _: None)
    out, line, met, step = tmp_path / "a.json", 0, True, share(15, 1)
    names = ("hand_over", "_write_outputs", "file", "show", "_attempt", "write_answer", "atomic_write", "to_json", "json_text")
    while met:
        line += step
        out.unlink(missing_ok=True)
        with InterruptAt(names, line) as interrupt:
            result = waybound("--out", out, "--json")
        met = interrupt.reached
        assert result.exit_code in (0, 130), (line, result.stderr)
        assert answer_in(result.stdout) == answer_in(out.read_text()) == BEST, line
        tally["lines interrupted"] += 1
    assert line > 20


# -- files and streams that the system refuses ------------------------------------------------------------------------

COMMAND = [sys.executable, "-m", "waybound", "solve", "demo-tiny", "--heuristic", "savings", "--bound-time", "0", "-q"]


@pytest.mark.slow
def test_a_file_that_outgrows_its_limit_leaves_the_answer_and_no_half_file(tmp_path: Path) -> None:
    plot, out = tmp_path / "p.png", tmp_path / "a.json"
    limited = subprocess.run(
        [*COMMAND, "--json", "--plot", str(plot), "--out", str(out)], capture_output=True, text=True, timeout=120,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192)),
    )  # fmt: skip
    assert limited.returncode == 2
    assert f"error: --plot {plot}: cannot be written: File too large" in limited.stderr
    assert answer_in(limited.stdout) == answer_in(out.read_text())
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("to", "words"),
    [
        pytest.param(">/dev/full", "No space left on device", marks=pytest.mark.hostile),
        ("| head -c 0", "Broken pipe"),
        (">&-", "Bad file descriptor"),
    ],
)
def test_standard_output_that_is_full_left_or_closed_costs_no_file(to: str, words: str, tmp_path: Path) -> None:
    out = tmp_path / "a.json"
    line = f"set -o pipefail; {' '.join(COMMAND)} --out {out} {to}"
    ended = subprocess.run(["bash", "-c", line], capture_output=True, text=True, timeout=120)
    assert ended.returncode == 2
    assert ended.stderr == f"error: standard output cannot be written to: {words}\n"
    assert TINY.evaluate(answer_in(out.read_text())).feasible


@pytest.mark.slow
@pytest.mark.parametrize("to", ["2>/dev/full", pytest.param("2>&-", marks=pytest.mark.hostile)])
def test_standard_error_that_nobody_reads_costs_nothing(to: str, tmp_path: Path) -> None:
    command = " ".join(part for part in COMMAND if part != "-q")
    ended = subprocess.run(["bash", "-c", f"{command} --json {to}"], capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0
    assert TINY.evaluate(answer_in(ended.stdout)).feasible


@pytest.mark.parametrize("what", [pytest.param("info demo-tiny", marks=pytest.mark.hostile), "--version", "instances path demo-tiny"])
@pytest.mark.parametrize("to", [pytest.param(">/dev/full", marks=pytest.mark.hostile), ">&-"])
def test_other_commands_say_in_one_line_that_they_cannot_print(what: str, to: str) -> None:
    ended = subprocess.run(["bash", "-c", f"{sys.executable} -m waybound {what} {to}"], capture_output=True, text=True, timeout=120)
    assert ended.returncode == 2
    assert ended.stderr.startswith("error: standard output cannot be written to: ")
    assert ended.stderr.count("\n") == 1
