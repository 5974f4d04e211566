"""Gaps between routing heuristics and the best answers known, on the benchmark files of the literature.

The folder of benchmark files holds ``bks.csv``, with the columns ``family, instance, convention, objective, vehicles, value``, and the
files of each family. Files with loads and windows are run with as many vehicles as are wanted, as their best distances are; min-max files
with as many as the row says. Exits with 1 if an answer fails its check, or is better than the best known by more than rounding.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import waybound as wb
from waybound.extending import HEURISTICS
from waybound.instances.reading import read_instance
from waybound.solving.request import Request
from waybound.solving.solve import solve

from ._harness import Folder, Option, command, known_values, timed

HEURISTICS_OF = {
    "cvrp": ("savings", "split", "tour-partitioning", "insertion"),
    "vrptw-solomon": ("savings", "split", "insertion"),
    "vrptw-homberger": ("savings", "split", "insertion"),
    "tsplib": ("christofides", "savings", "insertion"),
    "minmax-mtsp": ("tour-splitting", "greedy-assignment"),
}
CONVENTIONS = {"tsplib-nint": "round", "dimacs-trunc1": "trunc1", "tsplib": None, "euclidean-double": "exact"}
LEFT_OUT = {"vrptw-solomon": "euclidean-double", "vrptw-homberger": "euclidean-double"}
"""Scored by vehicles first, or the same files once more."""

WHOLE = 2_500
"""Sites up to which a file is run."""


@dataclass(frozen=True)
class Row:
    """One file with its best known value."""

    family: str
    problem: wb.RoutingProblem
    best: float


def rows(folder: Path, families: Sequence[str]) -> Iterator[Row]:
    """The files of some families, or of all."""
    for line in known_values(folder, families):
        family, name = line["family"], line["instance"]
        group = family.partition("/")[0]
        if group not in HEURISTICS_OF or line["convention"] == LEFT_OUT.get(group) or "routes)" in line["objective"]:
            continue
        vehicles = int(line["vehicles"]) if group in ("minmax-mtsp", "tsplib") else None
        stem = name.rpartition("-m")[0] if group == "minmax-mtsp" else name
        places = [folder / ("tsplib" if group == "minmax-mtsp" else family) / f"{stem}{end}" for end in (".vrp", ".txt", ".tsp")]
        path = next((place for place in places if place.exists()), None)
        if path is None:
            continue
        instance = read_instance(path)
        if not isinstance(instance, wb.RoutingInstance) or len(instance.sites) > WHOLE:
            continue
        settings: dict[str, object] = {"vehicles": vehicles or "unlimited"}
        if CONVENTIONS[line["convention"]]:
            settings["convention"] = CONVENTIONS[line["convention"]]
        problem = wb.RoutingProblem.from_instance(instance, settings=settings)
        if group == "minmax-mtsp":
            problem = replace(problem, objective=wb.Objective.of(wb.LongestRoute()))
        yield Row(family, problem, float(line["value"]))


def report(listed: Sequence[Row], seconds: float) -> tuple[str, bool]:
    """The table, and whether every answer holds up."""
    lines = [f"{'family':22} {'files':>5} {'heuristic':18} {'median gap':>10} {'worst':>8} {'seconds':>8} {'longest':>8} {'stated':>6}"]
    good = True
    for family in dict.fromkeys(row.family for row in listed):
        own = [row for row in listed if row.family == family]
        for name in HEURISTICS_OF[family.partition("/")[0]]:
            gaps, times, stated = [], [], 0
            for row in own:
                if HEURISTICS[name].missing(row.problem):
                    continue
                spent, solution = timed(partial(solve, row.problem, Request(heuristic=name, bound_time=0, time_limit=seconds)))
                times.append(spent)
                value = solution.objective
                if solution.status not in ("feasible", "optimal") or not isinstance(value, float) or value < row.best * (1 - 1e-6):
                    print(f"{row.problem.name}: {name} has {value}, best known {row.best}: {solution.status} {solution.message}")
                    good = False
                    continue
                gaps.append(100 * (value / row.best - 1))
                stated += solution.certificate.guarantee is not None
            if gaps:
                figures = f"{statistics.median(gaps):>9.1f}% {max(gaps):>7.1f}% {statistics.mean(times):>8.2f} {max(times):>8.2f}"
                lines.append(f"{family:22} {len(gaps):>5} {name:18} {figures} {stated:>6}")
    return "\n".join(lines), good


@command
def main(
    folder: Folder,
    families: tuple[str, ...] = (),
    every: Annotated[int, Option(help="take every so many files of a family")] = 1,
    seconds: float = 60.0,
) -> bool:
    listed = list(rows(folder, families))
    names = dict.fromkeys(row.family for row in listed)
    text, good = report([row for name in names for row in [row for row in listed if row.family == name][::every]], seconds)
    print(text)
    return good


if __name__ == "__main__":
    sys.exit(main())
