"""CBC as a child process: driven by files, watched through its log, stopped by SIGINT."""

import math
import os
import re
import select
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...formulations.programs.export import write_program
from ...formulations.programs.program import Program
from ...instances.errors import MissingPackageError, UsageError
from ...instances.number_arrays import Floats
from ..backend import Control, Options, RawResult
from ..children import child
from ..own_options import own_options

GRACE = 0.8
"""Seconds CBC has to write its incumbent once the user wants the end; less than any process of ours has that waits for it."""

LATE = 3.0
"""Seconds it has for the same where it overstayed its time limit."""

AGAIN = 0.25
"""Seconds between two such requests."""

OVERTIME = 0.5
"""Seconds past its time limit after which CBC is asked to stop: it looks at its clock only between steps, and some take long."""

EXACT = ".bin"
"""Suffix of the file in which CBC saves its point."""

MOST_THREADS = 99
"""Most threads of CBC: a hundred and above choose a mode of working, in some of which it crashes."""

STATUS_MAP = {
    "optimal": "optimal", "infeasible": "infeasible", "integer": "infeasible", "unbounded": "unbounded", "stopped": "unknown",
}  # fmt: skip
"""Our status for the first word of CBC's solution file, before the log says more."""

LIMITS = (
    ("maximum nodes", "nodes"), ("node limit", "nodes"), ("maximum time", "time"), ("time limit", "time"), ("user event", "interrupt"),
    ("integer gap", "gap"), ("maximum solutions", "iterations"), ("maximum iterations", "iterations"),
)  # fmt: skip
"""Words of CBC's log when it ends early ("Exiting on maximum nodes"), and our limit."""

PRICED = 1e-6
"""Share of the largest cost up to which a reduced cost counts as 0."""

_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_BOUND = re.compile(rf"best possible {_NUMBER}")
_LOWER = re.compile(rf"Lower bound:\s+{_NUMBER}")
_NODES = re.compile(r"After (\d+) nodes")
_NONE = 1e49


def _weakened(bound: float, line: str) -> float:
    """A printed lower bound less the most that its printing may have added: three decimals at the end, seven digits before."""
    if line.startswith("Lower bound"):
        return bound - 5e-4
    return bound - (0.5 * 10.0 ** (math.floor(math.log10(abs(bound))) - 6) if bound else 5e-7)


def find_cbc() -> str:
    """Path of the CBC that PuLP brings, else of one on the PATH."""
    import pulp

    bundled = getattr(getattr(pulp.apis, "PULP_CBC_CMD", None), "pulp_cbc_path", None)
    for path in (bundled, shutil.which("cbc")):
        if path and os.access(path, os.X_OK):
            return str(Path(path).resolve())
    raise MissingPackageError("PuLP finds no CBC: pip install 'pulp>=3.3,<4' brings one")


@dataclass
class Log:
    """CBC's log so far: bounds as they come, and how it ended."""

    bound: float | None = None
    end: str = ""
    gap_closed: bool = True
    doubtful: bool = False
    start: str = ""
    nodes: int | None = None
    iterations: int | None = None
    tail: list[str] = field(default_factory=list)
    _rest: str = ""

    def feed(self, text: str) -> float | None:
        """Read new text of the log; a better bound, if it holds one."""
        *lines, self._rest = (self._rest + text).replace("\r", "").split("\n")
        before = self.bound
        for line in lines:
            self._take(line)
        return self.bound if self.bound != before else None

    def _take(self, line: str) -> None:
        if line.strip():
            self.tail = [*self.tail[-4:], line.strip()]
        bound_there = _BOUND.search(line) or _LOWER.match(line)
        if bound_there and abs(float(bound_there[1])) < _NONE:
            self.bound = max(_weakened(float(bound_there[1]), line), -math.inf if self.bound is None else self.bound)
        if counted := _NODES.search(line):
            self.nodes = int(counted[1])
        if "Exiting on" in line or "Exiting as" in line or (line.startswith("Result -") and not self.end):
            self.end = next((limit for words, limit in LIMITS if words in line), self.end)
        if "within gap tolerance" in line:
            self.gap_closed = False
        if "infeasible or unbounded" in line.lower():
            self.doubtful = True
        if "MIPStart provided solution" in line:
            self.start = "used"
        elif "mipstart values could not be used" in line.lower():
            self.start = "refused"
        for words, name in (("Enumerated nodes:", "nodes"), ("Total iterations:", "iterations")):
            if line.startswith(words):
                setattr(self, name, int(line.split()[-1]))


def run_cbc(cbc: str, program: Program, options: Options, control: Control, folder: Path, *, preprocess: bool = True) -> RawResult:
    """Solve ``program`` with CBC in a child process, by files in the empty ``folder``; see ``ProgramBackend.run``.

    ``preprocess`` says whether CBC may, where the user says nothing of it.
    """
    _check_extra(cbc, options.extra)
    model, solution = folder / "model.mps", folder / "model.sol"
    for old in (solution, solution.with_suffix(EXACT)):
        old.unlink(missing_ok=True)
    write_program(program, model, names=False)
    start = None
    if options.start is not None and program.is_integer:
        start = folder / "start.sol"
        _write_start(start, options.start)
    log = Log()
    ours, theirs = _terminal()
    command = _command(cbc, program, options, model, solution, start, preprocess)
    with (
        os.fdopen(ours, "rb", 0),
        os.fdopen(theirs, "wb", 0) as end,
        child(command, folder, stdin=subprocess.DEVNULL, stdout=end, stderr=end, cwd=folder) as process,
    ):
        end.close()
        asked = _follow(process, ours, log, options, control)
    return _said(solution, log, program, options, process.returncode, asked)


def _command(cbc: str, program: Program, options: Options, model: Path, solution: Path, start: Path | None, preprocess: bool) -> list[str]:
    words: dict[str, Any] = {
        "sec": max(0.01, min(options.time_limit, 1e9)),
        "timeMode": "elapsed",
        "ratioGap": options.gap,
        "randomSeed": options.seed % (2**31 - 1),
        "randomCbcSeed": options.seed % (2**31 - 1),
    }
    if options.threads > 1:
        words["threads"] = min(options.threads, MOST_THREADS)
    if options.iterations is not None:
        words["maxNodes" if program.is_integer else "maxIterations"] = options.iterations
    if not preprocess:
        words["preprocess"] = "off"
    words.update(options.extra)
    line = [cbc, str(model)]
    for name, value in words.items():
        line += [f"-{name}", str(value)]
    if start is not None:
        line += ["-mipstart", str(start)]
    return [*line, "-solve", "-solution", str(solution), "-saveSolution", str(solution.with_suffix(EXACT))]


def _terminal() -> tuple[int, int]:
    """Ends of a pseudo-terminal, on which CBC's output comes line by line; where there is none, of a pipe, where it comes late."""
    try:
        return os.openpty()
    except OSError:  # a container without devpts
        return os.pipe()


def _follow(process: subprocess.Popen[bytes], output: int, log: Log, options: Options, control: Control) -> str:
    """Pass bounds on until CBC ends; the reason why it was asked to, if it was: ``interrupt`` or ``time``."""
    deadline, again, end, why = time.perf_counter() + options.time_limit + OVERTIME, math.inf, math.inf, ""
    while True:
        if select.select([output], [], [], 0.05)[0]:
            try:
                text = os.read(output, 65536).decode(errors="replace")
            except OSError:  # Linux's word for the end of a terminal
                text = ""
            if not text:
                process.wait()
                return why
            bound = log.feed(text)
            if log.nodes is not None:
                control.count(log.nodes)
            if bound is not None:
                control.publish(bound=bound)
        now = time.perf_counter()
        if why != "interrupt" and (control.stopped or (now > deadline and not why)):
            why = "interrupt" if control.stopped else "time"
            again, end = now, now + (GRACE if control.stopped else LATE)
        if now > end:
            process.kill()
        elif now >= again:
            process.send_signal(signal.SIGINT)
            again = now + AGAIN  # it hears nothing before its tree search


def _said(solution: Path, log: Log, program: Program, options: Options, code: int, asked: str) -> RawResult:
    statistics: dict[str, Any] = {name: getattr(log, name) for name in ("nodes", "iterations") if getattr(log, name) is not None}
    if options.start is not None and program.is_integer:
        statistics["start"] = log.start or "ignored"
    limit = asked or log.end or "none"
    if limit == "nodes":
        limit = "iterations"  # CBC's words for either
    bound = log.bound if program.is_integer else None
    if not solution.exists() or code < 0:  # what it wrote when it was killed may be half of it
        if asked:
            return RawResult("unknown", asked, bound=bound, statistics=statistics, message="CBC was ended before it wrote an answer")
        said = " / ".join(log.tail)
        return RawResult("error", statistics=statistics, message=f"CBC ended with code {code} and no answer: {said}")
    with solution.open() as file:
        said = file.readline().strip()
    word = said.split()[0].lower() if said.split() else ""
    status = STATUS_MAP.get(word, "error")
    if status == "infeasible" and (log.doubtful or _may_be_endless(program)):
        status = "infeasible_or_unbounded"
    statistics["said"] = said
    if status == "error":
        return RawResult("error", statistics=statistics, message=f"CBC says: {said}")
    point, duals = _read_point(solution.with_suffix(EXACT), program) or (None, None)
    if "no integer solution" in said:
        point = None
    if status == "unknown" and limit == "none":
        limit = "time" if "time" in said else "iterations"
    if status == "optimal" and log.gap_closed and point is not None:
        bound = program.value(point)
    solved = not program.is_integer and status == "optimal"
    if solved and duals is not None and _unpriced(program, duals):
        return RawResult("infeasible_or_unbounded", limit, statistics=statistics)
    return RawResult(status, limit, point, None, bound, duals if solved else None, statistics)


def _may_be_endless(program: Program) -> bool:
    """True if a program may be unbounded: CBC calls such programs infeasible where variables are whole."""
    falls = ((program.cost < 0) & np.isinf(program.upper)) | ((program.cost > 0) & np.isinf(program.lower))
    return bool(falls.any())


def _unpriced(program: Program, duals: Floats) -> bool:
    """True if a variable without a bound still lowers the objective: CBC calls unbounded linear programs optimal that have free columns."""
    reduced = program.cost - program.matrix.T @ duals
    least = PRICED * float(np.abs(program.cost).max(initial=0.0))
    return bool((((reduced < -least) & np.isinf(program.upper)) | ((reduced > least) & np.isinf(program.lower))).any())


def _write_start(path: Path, start: Floats) -> None:
    known = np.nonzero(np.isfinite(start))[0]
    lines = [f"{j} x{j} {float(start[j])!r} 0" for j in known.tolist()]
    path.write_text("\n".join(["Stopped on time - objective value 0", *lines]) + "\n")


def _read_point(path: Path, program: Program) -> tuple[Floats, Floats] | None:
    """Values of the columns and duals of the rows, to the last bit: the file of text has eight digits of each."""
    limited = np.isfinite(program.row_lower) | np.isfinite(program.row_upper)  # CBC keeps no others
    rows, columns = int(limited.sum()), program.num_variables
    counts = np.dtype([("rows", "i4"), ("columns", "i4"), ("objective", "f8")])
    if not path.exists() or path.stat().st_size != counts.itemsize + 16 * (rows + columns):
        return None
    head = np.fromfile(path, counts, count=1)[0]
    if (head["rows"], head["columns"]) != (rows, columns):
        return None
    _, prices, values, _ = np.split(np.fromfile(path, np.float64, offset=counts.itemsize), np.cumsum([rows, rows, columns]))
    duals = np.zeros(program.num_rows)
    duals[limited] = prices
    return values, duals


COMMON_PARAMETERS = {
    "seconds": "the time limit", "ratioGap": "the gap", "threads": "the threads", "randomSeed": "the seed",
    "randomCbcSeed": "the seed", "maxNodes": "the iterations", "maxIterations": "the iterations",
}  # fmt: skip
"""Parameters that have a name common to all solvers."""


def _check_extra(cbc: str, extra: dict[str, Any]) -> None:
    """Raise UsageError for parameters or values that CBC does not know."""
    if not extra:
        return
    listed = _say(cbc, "-?").split("Actions or string parameters:")
    known = [word for part in listed[:1] for word in re.findall(r"(?<![\w(])[A-Za-z]\w*(?:\(\w+\))?", part.split("Commands are:")[-1])]
    full = {k.replace("(", "").replace(")", ""): k.split("(")[0] for k in known}
    for name, value in extra.items():
        meant = [f for f, least in full.items() if f.lower().startswith(name.lower()) and len(name) >= len(least)]
        own_options("pulp", {(meant or [name])[0]: value}, dict.fromkeys(full), COMMON_PARAMETERS, "parameter")
        said = _say(cbc, f"-{name}", str(value))
        fault = re.search(r"Possible options for \S+ are:([^;>]*)|is illegal for|out of range|valid range", said)
        if fault:
            choices = f"; choose from {fault[1].strip()}" if fault[1] else ""
            raise UsageError(
                f"pulp: {value!r} is no value for CBC's parameter {name}{choices}", "unknown-name" if fault[1] else "out-of-range"
            )


def _say(cbc: str, *words: str) -> str:
    return subprocess.run([cbc, *words, "-quit"], capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL).stdout
