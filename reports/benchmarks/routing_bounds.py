"""How far verified bounds stay from the best answers known, on the benchmark files of the literature.

Run as ``python -m waybound.reports.benchmarks.routing_bounds [--folder FOLDER] [--families cvrp top ...] [--every 1] [--seconds 1]``.

``FOLDER`` (by default what ``WAYBOUND_BENCHMARKS`` names) holds ``bks.csv``, with the columns ``family, instance, convention, objective,
vehicles, value``, and the files of each family. Every bound is what its checker derives. The budget is one for all methods together, in
seconds of the processor, so that a busy machine gives the same figures; kernels are compiled before. Exits with 1 if a bound excludes the
best known value.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import statistics
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from waybound.formulations.certificate import verified_bound
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.routing.objective import LongestRoute, Objective, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Flag, Stop
from waybound.instances.errors import WayboundError
from waybound.instances.reading import read_instance
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.linear_programs import LinearPrograms

CONVENTIONS = {"tsplib-nint": "file", "tsplib": "file", "dimacs-trunc1": "trunc1", "euclidean-double": "exact"}
FLEETS = ("top", "toptw", "minmax-mtsp")
"""Families whose rows say how many vehicles there are."""


class ProcessorTime(Stop):
    """Ends after so many seconds of this process."""

    def __init__(self, seconds: float) -> None:
        super().__init__(1e3 * seconds)
        self._processor_end = time.process_time() + seconds

    @property
    def seconds_left(self) -> float:
        return max(0.0, self._processor_end - time.process_time())

    def after(self, seconds: float) -> Stop:
        made = ProcessorTime(seconds)
        made._wish = self._wish
        return made

    @property
    def flag(self) -> Flag:
        if self._flag is None:  # without the clock on the wall
            self._flag = np.zeros(1, np.int64)
            self._wish.tell(self._flag)
            threading.Thread(target=self._watch, args=(self._flag,), daemon=True).start()
        return self._flag

    def _watch(self, flag: Flag) -> None:
        """Set the flag at the end: compiled loops, which release Python's lock, would run on otherwise."""
        while not self.reached():
            time.sleep(0.005)
        flag[0] = 1

    def reached(self) -> str:
        return super().reached() or ("time" if self.seconds_left <= 0 else "")


@dataclass(frozen=True)
class Row:
    """One file with its best known value."""

    family: str
    problem: RoutingProblem
    best: float


def rows(folder: Path, families: Sequence[str], every: int) -> Iterator[Row]:
    """The files of some families, or of all; values of 0 have no gap."""
    with (folder / "bks.csv").open(newline="") as stream:
        lines = [
            line for line in csv.DictReader(stream)
            if (not families or line["family"] in families or line["family"].partition("/")[0] in families)
            and float(line["value"]) and "routes)" not in line["objective"]
        ]  # fmt: skip
    for line in lines[::every]:
        group = line["family"].partition("/")[0]
        places = [p for p in sorted((folder / line["family"]).glob(f"{line['instance']}.*")) if p.suffix not in (".sol", ".tour")]
        settings: dict[str, Any] = {"vehicles": line["vehicles"]} if group in FLEETS and line["vehicles"] else {}
        if line["convention"] in CONVENTIONS:
            settings["convention"] = CONVENTIONS[line["convention"]]
        if "unlimited" in line["objective"]:
            settings["vehicles"] = "unlimited"
        try:
            problem = problem_from_instance(read_instance(places[0]), **settings)
        except (WayboundError, IndexError) as fault:
            print(f"{line['family']}/{line['instance']} is left out: {fault}", file=sys.stderr)
            continue
        assert isinstance(problem, RoutingProblem)
        if line["objective"] == "longest route":
            problem = replace(problem, objective=Objective.of(LongestRoute()))
        elif line["objective"].startswith("vehicles"):
            if not line["vehicles"]:
                continue
            yield Row(f"{line['family']} vehicles", replace(problem, objective=Objective.of(Vehicles())), float(line["vehicles"]))
            continue
        yield Row(line["family"], problem, float(line["value"]))


def best_bound(problem: RoutingProblem, seconds: float) -> tuple[float | None, str, float]:
    """The best verified bound that all methods find in ``seconds``, its source, and the seconds that they took."""
    sign = 1.0 if problem.sense == "min" else -1.0
    able = [m for m in sorted(BOUNDS.values(), key=lambda m: m.order) if not m.missing(problem)]
    for method in able:
        method.prepare()
    began, stop = time.process_time(), ProcessorTime(seconds)
    found = []
    for method in able:
        evidence = None if stop.reached() else method.evidence(problem, stop, LinearPrograms())
        if evidence is not None:
            found.append((evidence, time.process_time()))
    took = time.process_time() - began
    proved = [(sign * verified_bound(problem, evidence), evidence.kind) for evidence, _ in found]
    bound, kind = max(proved, default=(-math.inf, ""))
    return (sign * bound if math.isfinite(bound) else None), kind, took


def report(found: Iterator[Row], seconds: float) -> tuple[str, bool]:
    """The table, and whether no bound excludes a best known value."""
    gaps: dict[str, list[float]] = {}
    times: dict[str, list[float]] = {}
    kinds: dict[str, dict[str, int]] = {}
    good = True
    for row in found:
        bound, kind, took = best_bound(row.problem, seconds)
        sign = 1.0 if row.problem.sense == "min" else -1.0
        if bound is not None and sign * (bound - row.best) > 1e-6 * abs(row.best):
            print(f"{row.problem.name}: {kind} proves {bound}, best known {row.best}", file=sys.stderr)
            good = False
        gap = math.inf if bound is None else 100.0 * abs(bound - row.best) / abs(row.best)
        gaps.setdefault(row.family, []).append(gap)
        times.setdefault(row.family, []).append(took)
        own = kinds.setdefault(row.family, {})
        own[kind] = own.get(kind, 0) + 1
    lines = ["| family | files | median gap | worst | seconds | best by |", "|---|---|---|---|---|---|"]
    groups: dict[str, list[str]] = {}
    for family in gaps:
        groups.setdefault(family.partition("/")[0], []).append(family)
    for group, members in groups.items():
        named = [(member, [member]) for member in members]
        for name, own_families in [*named, *([(f"{group}, all", [m for m in members if " " not in m])] if len(members) > 1 else [])]:
            own_gaps = [gap for member in own_families for gap in gaps[member]]
            spent = [took for member in own_families for took in times[member]]
            if not own_gaps:
                continue
            count: dict[str, int] = {}
            for member in own_families:
                for kind, n in kinds[member].items():
                    count[kind] = count.get(kind, 0) + n
            by = ", ".join(f"{kind} {n}" for kind, n in sorted(count.items(), key=lambda item: -item[1]))
            figures = f"{statistics.median(own_gaps):.1f} % | {max(own_gaps):.1f} % | {statistics.median(spent):.2f}"
            lines.append(f"| {name} | {len(own_gaps)} | {figures} | {by} |")
    return "\n".join(lines), good


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=os.environ.get("WAYBOUND_BENCHMARKS"))
    parser.add_argument("--families", nargs="*", default=[])
    parser.add_argument("--every", type=int, default=1, help="take every so many rows")
    parser.add_argument("--seconds", type=float, default=1.0)
    chosen = parser.parse_args(arguments)
    if chosen.folder is None:
        parser.error("--folder or WAYBOUND_BENCHMARKS must name the folder of the files")
    text, good = report(rows(Path(chosen.folder), chosen.families, chosen.every), chosen.seconds)
    print(text)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
