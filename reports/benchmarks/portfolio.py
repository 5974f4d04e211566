"""How near to the best values known the portfolio comes, beside each of its engines and bare PyVRP, within the same time.

Each run is a process of its own with one thread, no bounds and compiled kernels, on files of the benchmark folder; ``bare-pyvrp`` is the
library alone, given the same whole numbers (``_bare_pyvrp``; not for reloads, groups and the longest route, which it models not). Gaps are
per cent of the best value known, those below it count as 0. A row is a file, with the mean over seeds; the last ones of a set are the
mean over files with half the width of its 95 % interval over seeds, and the mean difference to the first solver, paired by file and seed,
with its own. Runs side by side (``--jobs``) share the machine's memory, and none is timed against another one of other jobs. The column of
CPU is what a run took on the mean, reading left out.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound import read, solve
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.instances.routing.sites import Group

from ._harness import Folder, Option, command, in_a_fresh_process, markdown
from .overhead import integers
from .routing_families import Known, Sample, best_known, distance

BARE = "bare-pyvrp"


@dataclass(frozen=True)
class Kept:
    """Files of one kind, in one or more folders, and how they are read; ``row`` says which line of ``bks.csv`` is meant, and ``made`` what
    problem comes of each, told its name."""

    folders: Sequence[str]
    files: Sequence[str]
    settings: Mapping[str, Any] = field(default_factory=dict)
    row: Mapping[str, str] = field(default_factory=dict)
    made: Callable[[RoutingProblem, str], RoutingProblem] | None = None


def reloading(problem: RoutingProblem, name: str) -> RoutingProblem:
    """Two vehicles that come back for more, neither of which may drive more than 1.1 times half the length of the best routes without:
    after Taillard, Laporte and Gendreau (1996), Vehicle routeing with multiple use of vehicles, J. Operational Research Society 47(8)."""
    vehicle, length = problem.fleet[0], {"E-n51-k5": 521, "E-n76-k10": 830, "E-n101-k8": 815}[name]
    two = replace(vehicle, count=2, reloads=(vehicle.start,), max_distance=float(1.1 * length // 2))
    return replace(problem, fleet=(two,))


def grouped(problem: RoutingProblem, name: str) -> RoutingProblem:
    """One customer in three is visited: each with those nearest to a centre, centres being as far from each other as can be, after the
    clusters of Fischetti, Salazar and Toth (1997), Operations Research 45(3)."""
    distances, customers = problem.travel.distances, problem.customers
    centres = [int(customers[distances[problem.fleet[0].start, customers].argmax()])]
    while 3 * len(centres) < len(customers):
        centres.append(int(customers[distances[np.array(centres)][:, customers].min(axis=0).argmax()]))
    nearest = distances[np.array(centres)][:, customers].argmin(axis=0)
    groups = tuple(Group(tuple(customers[nearest == k].tolist()), True) for k in range(len(centres)))
    required = np.zeros(len(problem.sites), dtype=bool)
    return replace(problem, sites=replace(problem.sites, groups=groups, required=required))


SETS = {
    "vrptw": Kept(
        ("vrptw-solomon", "vrptw-homberger/200", "vrptw-homberger/400"),
        ("C101", "C104", "C201", "C204", "R101", "R112", "R203", "R210", "RC103", "RC107", "RC201", "RC207", "C1_2_5", "R1_2_1", "RC2_2_5",
         "C2_4_5", "R1_4_5", "RC1_4_1"),
        {"convention": "dimacs"},
        {"convention": "dimacs-trunc1"},
    ),
    "cvrp": Kept(
        ("cvrp/X",),
        ("X-n101-k25", "X-n143-k7", "X-n200-k36", "X-n256-k16", "X-n327-k20", "X-n420-k130", "X-n613-k62", "X-n1001-k43"),
    ),
    "orienteering": Kept(
        ("op/tsiligirides2", "op/chao66", "op/oplib-gen2", "op/oplib-gen3", "top/set2", "top/set4", "top/set5", "top/set7"),
        ("tsiligirides_problem_2_budget_30", "set_66_1_060", "kroA150-gen2-50", "gr202-gen3-50", "p2.3.k", "p4.2.j", "p4.3.k", "p4.4.o",
         "p5.3.q", "p7.4.t"),
    ),
    "longest-route": Kept(
        ("minmax-mtsp/mtsplib", "minmax-mtsp/set3", "minmax-mtsp/set4"),
        ("eil51-m5", "berlin52-m3", "rat99-m5", "mtsp100_3", "kroa200_10", "lin318_5"),
    ),
    "pickup-delivery": Kept(
        ("pdptw-lilim/100", "pdptw-lilim/200"), ("lc101", "lr104", "lrc103", "lr205", "lc1_2_5", "lr1_2_10", "lrc1_2_10", "lr2_2_10")
    ),
    "simultaneous-pickup": Kept(("vrpspd-salhi",), ("CMT1X", "CMT2X", "CMT4X", "CMT12Y"), {"vehicles": "unlimited"}),
    "several-depots": Kept(("mdvrp-cordeau",), ("p01", "p04", "p10", "p15")),
    "reloads": Kept(("cvrp/E",), ("E-n51-k5", "E-n76-k10", "E-n101-k8"), made=reloading),
    "groups": Kept(("cvrp/X",), ("X-n101-k25", "X-n200-k36", "X-n327-k20"), made=grouped),
}  # fmt: skip


FOUND = {
    "tsiligirides_problem_2_budget_30": 265.0, "set_66_1_060": 915.0, "mtsp100_3": 8509.16, "kroa200_10": 6223.22, "lin318_5": 11660.1,
    "reloads E-n51-k5": 526.0, "reloads E-n76-k10": 837.0, "reloads E-n101-k8": 815.0, "groups X-n101-k25": 7849.0,
    "groups X-n200-k36": 16879.0, "groups X-n327-k20": 12340.0,
}  # fmt: skip
"""The best values that were found in long runs, of files that ``bks.csv`` has no row for and of problems made of files."""


@dataclass(frozen=True)
class Task:
    """One run: which set's file, by whom, with which seed, for how long."""

    kind: str
    folder: Path
    path: Path
    solver: str
    seed: int
    seconds: float


def run(task: Task) -> tuple[tuple[float, ...], bool, float]:
    """The judged values of the answer, empty where there is none, whether the first is maximised, and CPU seconds."""
    kept = SETS[task.kind]
    problem: Any = read(task.folder / task.path, **kept.settings)
    if kept.made is not None:
        problem = kept.made(problem, task.path.stem)
    most = problem.senses[0] == "max"
    began = time.process_time()
    if task.solver == BARE:
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder) / "data.npz"
            np.savez(data, **integers(problem))
            script = Path(__file__).with_name("_bare_pyvrp.py")
            told = in_a_fresh_process(script, data, f"{task.seconds}s", task.seed)
        verdict = problem.evaluate(Routes.of(told["routes"]))
        return (tuple(verdict.values) if verdict.feasible else ()), most, told["engine"]
    solution = solve(problem, task.solver, time_limit=task.seconds, seed=task.seed, bound_time=0)
    values = () if solution.answer is None else tuple(problem.evaluate(solution.answer).values)
    return values, most, time.process_time() - began


def tasks(folder: Path, names: Iterable[str], solvers: Sequence[str], seeds: Iterable[int], seconds: float) -> dict[str, list[Task]]:
    """The runs of each set."""
    found: dict[str, list[Task]] = {}
    for name in names:
        kept = SETS[name]
        for file in kept.files:
            path = next((p for place in kept.folders for p in sorted((folder / place).glob(f"{file}.*")) if p.suffix != ".sol"), None)
            if path is None:
                raise SystemExit(f"error: no file {file} in {', '.join(kept.folders)}")
            many = [Task(name, folder, path.relative_to(folder), s, seed, seconds) for s in solvers for seed in seeds]
            found.setdefault(name, []).extend(many)
    return found


def known_of(task: Task) -> Known:
    """The best values known of its file, or of the problem made of it."""
    if SETS[task.kind].made is not None:
        return Known((FOUND[f"{task.kind} {task.path.stem}"],), "")
    return best_known(task.folder, Sample(str(task.path), SETS[task.kind].row)) or Known((FOUND[task.path.stem],), "")


def gap(values: Sequence[float], most: bool, known: Known) -> float:
    """Per cent beyond the best values known, at the first level that differs; not a number where there is no answer."""
    away = distance(values, known.values)
    return math.nan if math.isnan(away) else max(0.0, 100.0 * (-away if most else away))


def interval(values: Sequence[float]) -> str:
    """The mean and half the width of its 95 % interval by Student's distribution."""
    from scipy.stats import t

    if len(values) < 2:
        return f"{statistics.fmean(values):.3f}"
    half = t.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / math.sqrt(len(values))
    return f"{statistics.fmean(values):.3f} ± {half:.3f}"


def table(title: str, solvers: Sequence[str], gaps: Mapping[tuple[str, str, int], float], cpu: Mapping[str, list[float]]) -> list[str]:
    """Lines of a set's table."""
    files, seeds = sorted({f for f, _, _ in gaps}), sorted({s for _, _, s in gaps})
    rows: list[list[object]] = [
        [file, *(f"{statistics.fmean(gaps[file, solver, seed] for seed in seeds):.3f}" for solver in solvers)] for file in files
    ]
    over = {s: [statistics.fmean(gaps[f, s, seed] for f in files) for seed in seeds] for s in solvers}
    rows.append(["**mean**", *(f"**{interval(over[s])}**" for s in solvers)])
    first = solvers[0]
    apart = {s: [gaps[f, s, seed] - gaps[f, first, seed] for f in files for seed in seeds] for s in solvers[1:]}
    rows.append([f"minus {first}", "", *(interval(apart[s]) for s in solvers[1:])])
    rows.append(["CPU s", *(f"{statistics.fmean(cpu[s]):.1f}" for s in solvers)])
    return [f"\n### {title}\n", *markdown(["file", *solvers], rows)]


@command
def main(
    folder: Folder,
    kind: Annotated[list[str] | None, Option(choices=SETS, action="append", help="only this set; may be repeated")] = None,
    solver: Annotated[tuple[str, ...], Option(help="who runs, the first being compared with")] = ("portfolio", "pyvrp", BARE),
    seeds: Annotated[int, Option(help="how many, from 1 on")] = 3,
    seconds: Annotated[float, Option(help="time limit of each run")] = 30.0,
    jobs: Annotated[int, Option(help="runs at a time")] = 1,
    out: Annotated[str, Option(help="file that each run's gap is added to, a JSON object a line")] = "",
) -> bool:
    good = True
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=1) as pool:
        for name, many in tasks(folder, kind or SETS, solver, range(1, seeds + 1), seconds).items():
            gaps: dict[tuple[str, str, int], float] = {}
            cpu: dict[str, list[float]] = {}
            for task, (values, most, spent) in zip(many, pool.imap(run, many, chunksize=1), strict=True):
                away = gap(values, most, known_of(task))
                gaps[task.path.stem, task.solver, task.seed] = away
                cpu.setdefault(task.solver, []).append(spent)
                good = good and not math.isnan(away)
                if out:
                    with Path(out).open("a") as stream:
                        print(json.dumps([name, task.path.stem, task.solver, task.seed, values, away, round(spent, 2)]), file=stream)
            print("\n".join(table(f"{name}, {seconds:g} s", solver, gaps, cpu)), flush=True)
    return good


if __name__ == "__main__":
    sys.exit(main())
