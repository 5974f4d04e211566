"""Gaps between verified bounds and the best answers known, on the benchmark files of the literature.

The folder of benchmark files holds ``bks.csv``, with the columns ``family, instance, convention, objective, vehicles, value``, and the
files of each family. Every bound is what its checker derives. The budget is one for all methods together, in seconds of the processor, so
that a busy machine gives the same figures; kernels are compiled before. Exits with 1 if a bound excludes the best known value.
"""

from __future__ import annotations

import math
import statistics
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

import waybound as wb
from waybound.extending import BOUNDS, LinearPrograms, verified_bound
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.stop import Flag, Stop
from waybound.instances.reading import read_instance

from ._harness import Folder, Option, command, known_values, markdown

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
        later = ProcessorTime(seconds)
        later._wish = self._wish
        return later

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
    problem: wb.RoutingProblem
    best: float


def rows(folder: Path, families: Sequence[str], every: int) -> Iterator[Row]:
    """The files of some families, or of all; values of 0 have no gap."""
    lines = [line for line in known_values(folder, families) if float(line["value"]) and "routes)" not in line["objective"]]
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
        except (wb.WayboundError, IndexError) as fault:
            print(f"{line['family']}/{line['instance']} is left out: {fault}", file=sys.stderr)
            continue
        assert isinstance(problem, wb.RoutingProblem)
        if line["objective"] == "longest route":
            problem = replace(problem, objective=wb.Objective.of(wb.LongestRoute()))
        elif line["objective"].startswith("vehicles"):
            if not line["vehicles"]:
                continue
            yield Row(f"{line['family']} vehicles", replace(problem, objective=wb.Objective.of(wb.Vehicles())), float(line["vehicles"]))
            continue
        yield Row(line["family"], problem, float(line["value"]))


def best_bound(problem: wb.RoutingProblem, seconds: float) -> tuple[float | None, str, float]:
    """The best verified bound that all methods find in ``seconds``, its source, and the seconds that they took."""
    sign = 1.0 if problem.sense == "min" else -1.0
    able = [m for m in sorted(BOUNDS.values(), key=lambda m: m.order) if not m.missing(problem)]
    for method in able:
        method.prepare()
    began, stop = time.process_time(), ProcessorTime(seconds)
    proofs = []
    for method in able:
        evidence = None if stop.reached() else method.evidence(problem, stop, LinearPrograms())
        if evidence is not None:
            proofs.append(evidence)
    took = time.process_time() - began
    proved = [(sign * verified_bound(problem, evidence), evidence.kind) for evidence in proofs]
    bound, kind = max(proved, default=(-math.inf, ""))
    return (sign * bound if math.isfinite(bound) else None), kind, took


def report(listed: Iterator[Row], seconds: float) -> tuple[str, bool]:
    """The table, and whether no bound excludes a best known value."""
    proved: dict[str, list[tuple[float, float, str]]] = {}  # gap, seconds and kind of evidence, by family
    good = True
    for row in listed:
        bound, kind, took = best_bound(row.problem, seconds)
        sign = 1.0 if row.problem.sense == "min" else -1.0
        if bound is not None and sign * (bound - row.best) > 1e-6 * abs(row.best):
            print(f"{row.problem.name}: {kind} proves {bound}, best known {row.best}", file=sys.stderr)
            good = False
        gap = math.inf if bound is None else 100.0 * abs(bound - row.best) / abs(row.best)
        proved.setdefault(row.family, []).append((gap, took, kind))
    groups: dict[str, list[str]] = {}
    for family in proved:
        groups.setdefault(family.partition("/")[0], []).append(family)
    rows = []
    for group, members in groups.items():
        named = [(member, [member]) for member in members]
        if len(members) > 1:
            named.append((f"{group}, all", [member for member in members if " " not in member]))
        for name, families in named:
            every = [proof for family in families for proof in proved[family]]
            if every:
                gaps, spent, kinds = zip(*every, strict=True)
                by = ", ".join(f"{kind} {count}" for kind, count in Counter(kinds).most_common())
                middle, time_taken = statistics.median(gaps), statistics.median(spent)
                rows.append((name, len(every), f"{middle:.1f} %", f"{max(gaps):.1f} %", f"{time_taken:.2f}", by))
    return "\n".join(markdown(("family", "files", "median gap", "worst", "seconds", "best by"), rows)), good


@command
def main(
    folder: Folder,
    families: tuple[str, ...] = (),
    every: Annotated[int, Option(help="take every so many rows")] = 1,
    seconds: float = 1.0,
) -> tuple[str, bool]:
    return report(rows(folder, families, every), seconds)


if __name__ == "__main__":
    sys.exit(main())
