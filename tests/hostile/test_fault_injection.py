"""Whatever fails after a search, and however, the answer that passed its checks is handed over and the fault is said.

Each stage fails in turn: with a fault of the code, for want of memory, by an error of the system, by Ctrl-C.
"""

from __future__ import annotations

import dataclasses
import errno
import importlib
import json
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import waybound as wb
from waybound.cli.app import app
from waybound.formulations.certificate import Certificate
from waybound.formulations.evidence import BOUNDS, CHECKERS, Evidence
from waybound.formulations.problem import Problem
from waybound.formulations.solution import Solution
from waybound.instances.errors import CheckFailedError, InputError
from waybound.instances.selection import Coverage, PartitionMatroid
from waybound.solvers.backend import BACKENDS, Engine, RawResult

solving = importlib.import_module("waybound.solvers.solve")
cli = importlib.import_module("waybound.cli.solving")

TINY = wb.read("demo-tiny")
BEST, WORSE = wb.Routes.of([[7, 5, 3, 2], [4, 1, 6]]), wb.Routes.of([[7, 5, 3, 2], [1, 4, 6]])
VALUE = TINY.evaluate(BEST).values[0]
FAULTS: tuple[Callable[[], BaseException], ...] = (
    lambda: RuntimeError("made to fail"), MemoryError, lambda: OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt,
)  # fmt: skip
WORDS = ("RuntimeError: made to fail", "out of memory", "No space left on device", "interrupted")
ways = pytest.mark.parametrize(("fault", "words"), list(zip(FAULTS, WORDS, strict=True)), ids=["fault", "memory", "disk", "interrupt"])


def failing(fault: Callable[[], BaseException], times: float = float("inf")) -> Callable[..., Any]:
    """A function that fails ``times`` times, and tells nothing afterwards."""
    left = [times]

    def fail(*_: Any, **__: Any) -> Any:
        left[0] -= 1
        if left[0] >= 0:
            raise fault()

    return fail


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """``engine(work)`` registers a solver of routing problems, ``made``, for one test."""
    BACKENDS.names()

    def make(work: Callable[..., RawResult] = lambda p, o, c: RawResult("feasible", answer=BEST, objective=VALUE)) -> str:
        body = {
            "name": "made", "family": "routing", "features": frozenset(), "package": "numpy", "modules": ("json",), "summary": "made",
            "missing": lambda self, problem: frozenset(), "run": lambda self, *given: work(*given),
        }  # fmt: skip
        monkeypatch.setitem(BACKENDS._entries, "made", type("Made", (Engine,), body))
        return "made"

    return make


@pytest.fixture
def waybound(engine: Callable[..., str], tmp_path: Path) -> Callable[..., Any]:
    """Runs ``solve demo-tiny`` with a solver that finds the best answer; without bounds, that it may be fast."""
    engine()

    def call(*arguments: object) -> Any:
        given = ["solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "-q", *map(str, arguments)]
        return CliRunner(env={"COLUMNS": "200"}).invoke(app, given)

    return call


def answer_in(text: str) -> Any:
    """The answer in a JSON object, read back by the toolkit."""
    return TINY.answer_from_json(json.loads(text)["answer"])


# -- judging ----------------------------------------------------------------------------------------------------------


@ways
@pytest.mark.parametrize("stage", ["decode", "evaluate"])
def test_a_last_word_that_cannot_be_judged_costs_no_other_answer(
    stage: str, fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, engine: Any, tally: Any
) -> None:
    def work(problem: Any, options: Any, control: Any) -> RawResult:
        control.publish(BEST, VALUE)
        return RawResult("feasible", answer=WORSE)

    honest, fail = type(TINY).evaluate, failing(fault)
    if stage == "evaluate":
        monkeypatch.setattr(type(TINY), "evaluate", lambda self, a: fail() if a is WORSE else honest(self, a))
    else:
        monkeypatch.setattr(solving, "_solver_run", _decoding(solving._solver_run, fail))
    found = wb.solve(TINY, engine(work), bound_time=0)
    assert (found.objective, found.status) == (VALUE, "feasible")
    assert words in found.message
    tally["faults injected"] += 1


def _decoding(honest: Callable[..., Any], fail: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: dataclasses.replace(honest(*given), decode=lambda a: fail() if a is WORSE else a)


def test_one_interrupt_while_judging_costs_nothing(monkeypatch: pytest.MonkeyPatch, engine: Any) -> None:
    honest, fail = type(TINY).evaluate, failing(KeyboardInterrupt, 1)
    monkeypatch.setattr(type(TINY), "evaluate", lambda self, a: fail() or honest(self, a))
    assert wb.solve(TINY, engine(), bound_time=0).objective == VALUE


def test_without_another_answer_what_kept_the_only_one_from_being_judged_is_raised(monkeypatch: pytest.MonkeyPatch, engine: Any) -> None:
    monkeypatch.setattr(type(TINY), "evaluate", failing(MemoryError))
    with pytest.raises(MemoryError):
        wb.solve(TINY, engine(), bound_time=0)


def test_a_claimed_point_that_is_no_answer_is_the_solvers_fault_and_costs_no_start() -> None:
    def no_route(x: Any) -> Any:
        raise InputError("arcs form a cycle without the depot")

    program = dataclasses.replace(TINY.compile(), decode=no_route)
    with pytest.raises(CheckFailedError, match="the optimal answer claimed by highs is no answer: arcs form a cycle"):
        wb.solve(program, "highs", bound_time=0)
    found = wb.solve(program, "highs", start=BEST, bound_time=0)
    assert (found.objective, found.status) == (VALUE, "feasible")
    assert "arcs form a cycle" in found.faults[0]


@ways
def test_a_search_that_crashes_leaves_its_incumbent(fault: Any, words: str, engine: Any, tally: Any) -> None:
    def work(problem: Any, options: Any, control: Any) -> RawResult:
        control.publish(BEST, VALUE)
        raise fault()

    found = wb.solve(TINY, engine(work), bound_time=0)
    assert (found.objective, found.status, found.limit) == (VALUE, "feasible", "none")
    assert words in found.message
    tally["faults injected"] += 1


# -- bounding and certifying ------------------------------------------------------------------------------------------


def problems() -> Iterator[tuple[Problem, dict[str, Any]]]:
    """Small problems of every family that is bounded, and a method that solves each."""
    graph = wb.SensingGraph.from_edges([0, 0, 1], [0, 1, 2], [0, 1, 0], np.array([3.0, 2.0, 4.0]))
    yield TINY, {"solver": "made"}
    yield wb.BottleneckSATA(graph), {"heuristic": "greedy"}
    yield wb.WinnerTakesAllSATA(graph), {"heuristic": "random"}
    sets = Coverage.from_sets([[0, 1], [1, 2], [2]], [1.0, 2.0, 3.0])
    yield wb.SubmodularSelection(sets, PartitionMatroid.of([0, 0, 1])), {"heuristic": "random"}


PROBLEMS = list(problems())
METHODS = [(k, m.name) for k, (p, *_) in enumerate(PROBLEMS) for m in sorted(BOUNDS.values(), key=lambda m: m.order) if not m.missing(p)]
PARTS = [
    pytest.param(*method, part, marks=() if part == "compute" or k % 4 == 0 else pytest.mark.hostile)
    for k, method in enumerate(METHODS)
    for part in ("missing", "prepare", "compute")
]


@ways
@pytest.mark.parametrize(("case", "name", "part"), PARTS)
def test_a_bound_that_fails_is_no_bound(
    case: int, name: str, part: str, fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, engine: Any, tally: Any
) -> None:
    engine()
    problem, method = PROBLEMS[case]
    if part == "compute":  # the only one, else another may end the search for bounds before it
        for other in BOUNDS:
            monkeypatch.setitem(BOUNDS._entries, other, dataclasses.replace(BOUNDS[other], compute=lambda *_: None))
    monkeypatch.setitem(BOUNDS._entries, name, dataclasses.replace(BOUNDS[name], **{part: failing(fault)}))
    found = wb.solve(problem, **method, bound_time=0.5)
    assert found.certificate.feasible
    assert found.faults == ()
    assert words in found.message
    tally["faults injected"] += 1


def test_a_bound_that_fails_costs_no_other_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = wb.WinnerTakesAllSATA(wb.SensingGraph.from_edges([0, 1], [0, 1], [0, 1], np.array([3.0, 2.0])))
    names = [m.name for m in BOUNDS.values() if not m.missing(problem)]
    assert len(names) > 1
    for name in names:
        with monkeypatch.context() as patch:
            patch.setitem(BOUNDS._entries, name, dataclasses.replace(BOUNDS[name], compute=failing(MemoryError)))
            with pytest.warns(RuntimeWarning, match=f"no bound by {name}: out of memory"):
                assert wb.bound(problem, seconds=5).bound == 5.0


@ways
@pytest.mark.parametrize("case", range(len(PROBLEMS)))
def test_evidence_whose_checker_fails_proves_nothing(
    case: int, fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, engine: Any, tally: Any
) -> None:
    engine()
    for kind in CHECKERS:
        monkeypatch.setitem(CHECKERS._entries, kind, failing(fault))
    problem, method = PROBLEMS[case]
    found = wb.solve(problem, **method, bound_time=0.5)
    assert found.certificate.feasible
    assert (found.certificate.bound, found.faults) == (None, ())
    assert words in found.message
    tally["faults injected"] += 1


@ways
def test_evidence_of_a_solver_that_proves_nothing_costs_no_bound_of_ours(fault: Any, words: str, monkeypatch: Any, engine: Any) -> None:
    monkeypatch.setitem(CHECKERS._entries, "broken", failing(fault, 1 if fault is KeyboardInterrupt else float("inf")))
    useless = Evidence("broken", "the solver's proof", VALUE, {})
    name = engine(lambda p, o, c: RawResult("feasible", answer=BEST, evidence=(useless,)))
    found = wb.solve(TINY, name, bound_time=2)
    assert found.objective == VALUE
    assert words in found.message
    if fault is not KeyboardInterrupt:
        assert found.certificate.bound is not None


@ways
def test_a_certificate_that_fails_leaves_the_judges_verdict(fault: Any, words: str, monkeypatch: Any, engine: Any, tally: Any) -> None:
    monkeypatch.setattr(solving, "certify", failing(fault))
    monkeypatch.setattr(type(TINY), "digest", failing(MemoryError))
    found = wb.solve(TINY, engine(), bound_time=0)
    assert (found.objective, found.certificate.objective, found.certificate.feasible, found.faults) == (VALUE, VALUE, True, ())
    assert words in found.message
    assert found.to_json()["instance_hash"] is None
    tally["faults injected"] += 1


@pytest.mark.parametrize("bound", [2 * VALUE, np.inf])
def test_a_bound_that_contradicts_the_answer_is_withheld_and_said(bound: float, monkeypatch: Any, engine: Any, tmp_path: Path) -> None:
    monkeypatch.setitem(CHECKERS._entries, "false", lambda problem, data: bound)
    proof = Evidence("false", "a false proof", bound, {})
    name = engine(lambda p, o, c: RawResult("optimal", answer=BEST, objective=VALUE, bound=VALUE, evidence=(proof,)))
    found = wb.solve(TINY, name, bound_time=0)
    assert (found.objective, found.status, found.bound, found.certificate.bound) == (VALUE, "feasible", None, None)
    assert len(found.faults) == 1
    assert "a false proof" in found.faults[0]
    out = tmp_path / "a.json"
    result = CliRunner().invoke(app, ["solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "-q", "--json", "--out", str(out)])
    assert result.exit_code == 5
    assert "a false proof" in result.stderr
    assert answer_in(result.stdout) == answer_in(out.read_text()) == BEST


@ways
def test_a_guarantee_that_fails_leaves_the_heuristics_answer(fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, tally: Any) -> None:
    problem = PROBLEMS[1][0]
    whole = wb.solve(problem, heuristic="local", bound_time=0)
    monkeypatch.setattr("waybound.heuristics.methods.local._guarantee", failing(fault))
    found = wb.solve(problem, heuristic="local", bound_time=0)
    assert found.objective == whole.objective
    assert words in found.message
    tally["faults injected"] += 1


@pytest.mark.parametrize(("heuristic", "part"), [("greedy", "best_prefix"), ("lazy-greedy", "best_prefix")])
def test_evidence_that_a_heuristic_cannot_make_leaves_its_answer(heuristic: str, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = PROBLEMS[2][0]
    whole = wb.solve(problem, heuristic=heuristic, bound_time=0)
    monkeypatch.setattr(f"waybound.heuristics.selection.ending.{part}", failing(MemoryError))
    found = wb.solve(problem, heuristic=heuristic, bound_time=0)
    assert found.objective == whole.objective
    assert found.certificate.guarantee == whole.certificate.guarantee
    assert "out of memory" in found.message


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


# -- an interrupt at every line ---------------------------------------------------------------------------------------


class InterruptAt:
    """Ctrl-C before the ``number``-th line of waybound's functions ``names`` that is run; ``reached`` tells whether there was one."""

    def __init__(self, names: tuple[str, ...], number: int) -> None:
        self.names, self.left, self.reached = names, number, False

    def __enter__(self) -> InterruptAt:
        self.before = sys.gettrace()
        sys.settrace(self._trace)
        return self

    def __exit__(self, *_: object) -> None:
        sys.settrace(self.before)

    def _trace(self, frame: Any, event: str, argument: Any) -> Any:
        if frame.f_code.co_name not in self.names or "waybound" not in frame.f_globals["__name__"]:
            return None
        if event == "line" and not self.reached:
            self.left -= 1
            if not self.left:
                self.reached = True
                raise KeyboardInterrupt
        return self._trace


def test_an_interrupt_at_any_line_after_the_search_costs_no_answer(engine: Any, tally: Any) -> None:
    name, line, met = engine(), 0, True
    names = (
        "_verdict",
        "last_word",
        "_consider",
        "hear",
        "best",
        "_certified",
        "_gather",
        "certify",
        "_best_bound",
        "_status",
        "_versions",
    )
    while met:
        line += 1
        with InterruptAt(names, line) as interrupt:
            found = wb.solve(TINY, name, bound_time=0)
        met = interrupt.reached
        assert (found.objective, found.certificate.feasible, found.faults) == (VALUE, True, ())
        tally["lines interrupted"] += 1
    assert line > 50


def test_an_interrupt_at_any_line_of_handing_over_costs_no_answer(
    waybound: Any, tmp_path: Path, tally: Any, share: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.fsync", lambda _: None)
    out, line, met, step = tmp_path / "a.json", 0, True, share(7, 1)
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
