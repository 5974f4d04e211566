"""How many benchmark files of routing are proved, by whom, and in how much time of the processor.

Each run is a process of its own on one thread; CPU seconds are those of all its processes, without reading the file, so that loops should
be compiled before (``waybound warm``). No solver is told any value. Solvers that prove something by themselves, or say so, have all the
time for their search; those that do not have a part of it (``--search-share``), and the rest is for verified bounds, on the same core.

Each result is a line of JSON in ``--out``: a command that was stopped goes on there, and runs that are there are not run again. The keys
are ``set, file, solver, seconds`` (given), ``cpu, value, bound, status`` (``proved``, ``gap`` or ``none``), ``kind`` (of the bound:
``verified`` or ``claimed``), ``verified`` (the verified bound, if another one is told), ``leaves`` of a tree of cases, ``check`` (CPU
seconds of deriving the verified bounds once more, not part of ``cpu``), ``limit, message``, and ``fault`` of a run that failed.

Exits with 1 if a verified bound excludes the best value known, or if a run fails.
"""

from __future__ import annotations

import json
import math
import os
import random
import re
import statistics
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

from waybound import WayboundError, read, solve
from waybound.formulations.problem import Problem
from waybound.formulations.solution import Solution
from waybound.formulations.verified_bounds import proved_bound
from waybound.solvers.backend import BACKENDS, Engine, solver_named
from waybound.solvers.children import child, end_all

from ._harness import Folder, Option, command, known_values, markdown, timed

AUTO = "auto"
"""Stands for no name: the default solver of each problem."""

SEED = 12
"""Seed of the files that are drawn at random."""

BEYOND = 1e-6
"""Part of the best value known by which a bound may exclude it, of values that were published rounded."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True)
class Kept:
    """Files of one kind: in which folders, by patterns, with names that ``name`` matches, how they are read, which rows of ``bks.csv`` tell
    their best values, empty where none does, and how many with a value above 0 are ``drawn``, 0 for all."""

    folders: Sequence[str]
    name: str = ""
    settings: Mapping[str, str] = field(default_factory=dict)
    row: Mapping[str, str] = field(default_factory=dict)
    drawn: int = 0


TRUNCATED = {"convention": "dimacs"}
DISTANCE = {"convention": "dimacs-trunc1", "objective": "distance"}

SETS = {
    "solomon-25": Kept(("vrptw-solomon",), settings={**TRUNCATED, "customers": "25"}),
    "solomon-50": Kept(("vrptw-solomon",), settings={**TRUNCATED, "customers": "50"}),
    "solomon-100-first": Kept(("vrptw-solomon",), r"[A-Z]+1\d\d", TRUNCATED, DISTANCE),
    "solomon-100-second": Kept(("vrptw-solomon",), r"[A-Z]+2\d\d", TRUNCATED, DISTANCE),
    "cvrp": Kept(("cvrp/[ABEP]",), row={"convention": "tsplib-nint"}),
    "cvrp-x": Kept(("cvrp/X",), row={"convention": "tsplib-nint"}),
    "homberger-200": Kept(("vrptw-homberger/200",), settings=TRUNCATED, row=DISTANCE),
    "team-orienteering": Kept(("top/set*",), row={"objective": "score(max)"}, drawn=40),
}  # fmt: skip


@dataclass(frozen=True)
class Task:
    """One run: a file of a set, read with settings, by a solver within so many seconds, of which ``bound`` are for bounds."""

    set: str
    file: str
    path: str
    settings: Mapping[str, str]
    solver: str
    seconds: float
    bound: float

    @property
    def key(self) -> tuple[str, str, str, float]:
        return self.set, self.file, self.solver, self.seconds


# -- what is run -------------------------------------------------------------------------------------------------------------


def best_values(folder: Path, row: Mapping[str, str]) -> dict[tuple[str, str], float]:
    """The best values known of files, by folder and name, for the fleets that the files have."""
    lines = known_values(folder) if row else iter(())
    return {
        (line["family"], line["instance"]): float(line["value"])
        for line in lines if line.items() >= row.items() and "unlimited" not in line["objective"]
    }  # fmt: skip


def files(folder: Path, name: str) -> dict[Path, float | None]:
    """The files of a set that are there, and the best values known of them."""
    kept = SETS[name]
    best = best_values(folder, kept.row)
    found: dict[Path, float | None] = {}
    for place in sorted(p for pattern in kept.folders for p in folder.glob(pattern)):
        for path in sorted(p for p in place.iterdir() if p.suffix in (".txt", ".vrp") and re.fullmatch(kept.name or ".*", p.stem)):
            found[path] = best.get((place.relative_to(folder).as_posix(), path.stem))
    if kept.drawn:
        worthy = [path for path, value in found.items() if value]
        found = {path: found[path] for path in sorted(random.Random(SEED).sample(worthy, min(kept.drawn, len(worthy))))}
    return found


def seconds_for_bounds(solver: str, seconds: float, share: float) -> float:
    """Seconds of a run that are not for its search: none where the solver proves by itself, or is there to say that it does."""
    kind = None if solver == AUTO else BACKENDS[solver.partition(":")[0]]
    proves = kind is not None and (not issubclass(kind, Engine) or kind.bounds_itself or not kind.by_default)
    return 0.0 if proves else (1.0 - share) * seconds


def prove(task: Task) -> dict[str, Any]:
    """The result of a run in this process."""
    problem: Any = read(task.path, **task.settings)
    if task.bound and hasattr(os, "sched_setaffinity"):  # on one core, so that bounds wait for the end of the search
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {cores[os.getpid() % len(cores)]})
    before = processor_seconds()
    solver = None if task.solver == AUTO else task.solver
    solution = solve(problem, solver, time_limit=task.seconds - task.bound, bound_time=task.bound, threads=1)
    spent = processor_seconds() - before
    return {"cpu": round(spent, 2), **told(problem, solution)}


def processor_seconds() -> float:
    """CPU seconds of this process and those that it has seen end."""
    import resource

    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def told(problem: Problem, solution: Solution) -> dict[str, Any]:
    """Value, bound and status of a solution, and the CPU seconds of checking its evidence once more."""
    value, bound, verified = (first_level(v) for v in (solution.objective, solution.bound, solution.certificate.bound))
    evidence = solution.certificate.evidence
    leaves = sum(sum("branch" not in node for node in one.data["nodes"]) for one in evidence if "nodes" in one.data)
    check = timed(lambda: [proved_bound(problem, one) for one in evidence])[0] if evidence else None
    both = value is not None and bound is not None
    return {
        "value": value, "bound": bound, "status": "proved" if solution.status == "optimal" and both else "gap" if both else "none",
        "kind": solution.bound_kind, "verified": verified, "leaves": leaves or None, "check": None if check is None else round(check, 2),
        "limit": solution.limit, "message": solution.message,
    }  # fmt: skip


def first_level(value: Any) -> float | None:
    """The first number of a value; None where it is none."""
    first = value[0] if isinstance(value, list) else value
    return float(first) if first is not None and math.isfinite(first) else None


def serve() -> None:
    """The process of a run: a task in, its result out."""
    task = Task(**json.loads(sys.stdin.read()))
    try:
        result = prove(task)
    except WayboundError as fault:
        result = {"fault": str(fault)}
    print(json.dumps(result))


def apart(task: Task) -> dict[str, Any]:
    """The result of a run in a process of its own."""
    code = f"import sys; sys.path[:] = {sys.path!r}; from {__spec__.name} import serve; serve()"
    environment = {**os.environ, **dict.fromkeys(ONE_THREAD, "1")}
    with child([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as run:
        said, complaint = run.communicate(json.dumps(asdict(task)).encode())
    lines = said.decode().splitlines()
    if run.returncode or not lines:
        last = complaint.decode(errors="replace").strip().splitlines()[-1:]
        return {"fault": f"ended with code {run.returncode}: {' '.join(last)}"}
    return dict(json.loads(lines[-1]))


# -- results -----------------------------------------------------------------------------------------------------------------


class Results:
    """Results by set, file, solver and seconds, kept in a file where there is one."""

    def __init__(self, out: Path | None) -> None:
        self.out, self.of, self._lock = out, dict[tuple[str, str, str, float], dict[str, Any]](), threading.Lock()
        for line in out.read_text().splitlines() if out is not None and out.exists() else ():
            try:
                held = json.loads(line)
                self.of[held["set"], held["file"], held["solver"], held["seconds"]] = held
            except (ValueError, KeyError, TypeError):  # of a run that was ended while it wrote
                print(f"{out}: a line is no result and is left out: {line[:60]}", file=sys.stderr)

    def add(self, task: Task, result: Mapping[str, Any]) -> None:
        held = {"set": task.set, "file": task.file, "solver": task.solver, "seconds": task.seconds, **result}
        with self._lock:
            self.of[task.key] = held
            if self.out is not None:
                with self.out.open("a+b") as stream:
                    stream.seek(0, os.SEEK_END)
                    if stream.tell() and (stream.seek(-1, os.SEEK_END), stream.read())[1] != b"\n":
                        stream.write(b"\n")
                    stream.write(json.dumps(held).encode() + b"\n")


def run_all(tasks: Iterable[Task], results: Results, jobs: int) -> None:
    """Run what has no result yet, ``jobs`` at a time."""
    left = [task for task in tasks if task.key not in results.of]
    with ThreadPoolExecutor(jobs) as pool:
        waiting = {pool.submit(apart, task): task for task in left}
        try:
            for number, done in enumerate(as_completed(waiting), 1):
                task, result = waiting[done], done.result()
                results.add(task, result)
                said = result.get("fault") or f"{result['status']}, value {cell(result['value'])}, bound {cell(result['bound'])}"
                cpu = f", {result['cpu']:.1f} CPU s" if "cpu" in result else ""
                print(f"{number} of {len(left)}: {task.set}, {task.file}, {task.solver}: {said}{cpu}", file=sys.stderr)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            end_all()
            kept = f"{results.out} has what is done: the same command goes on" if results.out else "nothing is kept without --out"
            raise SystemExit(f"stopped: {kept}") from None


def cell(value: float | None) -> str:
    return "" if value is None else f"{value:.10g}"


def gap(result: Mapping[str, Any]) -> float | None:
    """Per cent between value and bound; None where one is missing."""
    value, bound = result.get("value"), result.get("bound")
    return None if value is None or bound is None else 100.0 * abs(value - bound) / max(abs(value), 1e-9)


def proof(result: Mapping[str, Any]) -> str:
    """The kind of a proof; empty where there is none."""
    return str(result["kind"]) if result.get("status") == "proved" else ""


def table(solvers: Sequence[str], rows: Mapping[str, tuple[float | None, Mapping[str, Mapping[str, Any]]]]) -> list[str]:
    """Lines of a set's table: of each file the best value known, and the result of each solver."""
    heads = ["file", "best known", *(f"`{s}` {what}" for s in solvers for what in ("value", "bound", "gap", "CPU s", "proved"))]
    lines = []
    for file, (best, of) in rows.items():
        cells = [file, cell(best)]
        for result in (of[s] for s in solvers):
            away, cpu = gap(result), result.get("cpu")
            cells += [cell(result.get("value")), cell(result.get("bound")), "" if away is None else f"{away:.2f} %"]
            cells += ["" if cpu is None else f"{cpu:.1f}", proof(result) or result.get("fault", "")]
        lines.append(cells)
    return markdown(heads, lines)


def summary(solvers: Sequence[str], sets: Mapping[str, Sequence[Mapping[str, Mapping[str, Any]]]]) -> list[str]:
    """Lines of the table of all sets: how many are proved, median gaps (without a value or bound it is endless), and the geometric mean of
    CPU over the files that all solvers prove."""
    lines: list[list[object]] = []
    for name, rows in sets.items():
        shared = [of for of in rows if all(proof(of[s]) for s in solvers)]
        for solver in solvers:
            proofs = [proof(of[solver]) for of in rows]
            gaps = [gap(of[solver]) for of in rows]
            middle = statistics.median(math.inf if away is None else away for away in gaps)
            mean = statistics.geometric_mean(max(0.01, of[solver]["cpu"]) for of in shared) if shared else None
            lines.append(
                [
                    name, solver, len(rows), sum(map(bool, proofs)), proofs.count("verified"),
                    f"{middle:.2f} %" if math.isfinite(middle) else "none", "" if mean is None else f"{mean:.1f} ({len(shared)})",
                ]
            )  # fmt: skip
    together = "CPU s, geometric mean (files that all prove)"
    return markdown(("set", "solver", "files", "proved", "of these verified", "median gap", together), lines)


def excluded(known: float | None, result: Mapping[str, Any], most: bool) -> bool:
    """Whether a verified bound excludes the best value known."""
    bound = result.get("verified")
    return known is not None and bound is not None and (known - bound if most else bound - known) > BEYOND * abs(known)


def report(
    listed: Mapping[str, Mapping[Path, float | None]], solvers: Sequence[str], seconds: float, results: Results
) -> Iterator[tuple[str, bool]]:
    """Lines of the tables, and whether nothing is wrong with what each tells."""
    sets: dict[str, list[Mapping[str, Mapping[str, Any]]]] = {}
    for name, held in listed.items():
        rows, good = {}, True
        for path, best in held.items():
            rows[path.stem] = best, {s: results.of[name, path.stem, s, seconds] for s in solvers}
            for solver, result in rows[path.stem][1].items():
                wrong = excluded(best, result, "orienteering" in name)
                if wrong:
                    print(f"{name}, {path.stem}: {solver} has the verified bound {result['verified']}, best known {best}", file=sys.stderr)
                good = good and not wrong and "fault" not in result
        sets[name] = [of for _, of in rows.values()]
        yield "\n".join([f"\n### {name}, {seconds:g} s\n", *table(solvers, rows)]), good
    yield "\n".join(["\n### All\n", *summary(solvers, sets)]), True


@command
def main(
    folder: Folder,
    set: Annotated[list[str] | None, Option(choices=SETS, action="append", help="only this set; may be repeated")] = None,  # noqa: A002
    solver: Annotated[tuple[str, ...], Option(help=f"who proves; {AUTO} names nobody")] = (AUTO,),
    file: Annotated[tuple[str, ...], Option(help="only files of these names")] = (),
    seconds: Annotated[float, Option(help="time limit of each run")] = 300.0,
    search_share: Annotated[float, Option(help="part of it for the search of solvers that prove nothing by themselves")] = 0.1,
    jobs: Annotated[int, Option(help="runs at a time")] = 1,
    out: Annotated[str, Option(help="file that each result is added to, a JSON object a line; what is there is not run again")] = "",
) -> bool:
    try:
        for name in solver:
            if name != AUTO:
                solver_named(name)
    except WayboundError as fault:
        raise SystemExit(f"error: {fault}") from None
    listed = {name: {p: v for p, v in files(folder, name).items() if not file or p.stem in file} for name in set or SETS}
    listed = {name: held for name, held in listed.items() if held}
    if not listed:
        raise SystemExit(f"error: there are no such files in {folder}")
    results = Results(Path(out) if out else None)
    tasks = [
        Task(name, path.stem, str(path), SETS[name].settings, s, seconds, seconds_for_bounds(s, seconds, search_share))
        for name, held in listed.items() for path in held for s in solver
    ]  # fmt: skip
    run_all(tasks, results, jobs)
    good = True
    for text, right in report(listed, solver, seconds, results):
        print(text, flush=True)
        good = good and right
    return good


if __name__ == "__main__":
    sys.exit(main())
