"""One file of each routing family on every solver that its users would try.

Each run is ``waybound solve FILE --solver NAME --time-limit SECONDS`` in a process of its own, with the heuristics that take the problem
after the solvers: objective, best value known and how far it is, the bound that was verified and how far that is, and wall seconds of the
search and of the whole process. A solver that cannot take a problem stands there with what it lacks.

Exits with 1 if a run fails, or says no in other words than what it lacks, if an answer goes beyond a verified bound, or if a family has
fewer than two solvers that answer.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from waybound import read
from waybound.heuristics.heuristic import HEURISTICS

from ._harness import Folder, Option, command, known_values, markdown, markdown_row

SOLVERS = ("pyvrp", "ortools", "vroom", "highs")

REFUSED = "cannot take this problem: it does not handle "


@dataclass(frozen=True)
class Sample:
    """A file of a family, within the folder; ``rewritten`` where it is first converted to VROOM's JSON.

    ``row`` holds columns of its row of ``bks.csv`` besides family and instance, ``given`` arguments of the command besides the file.
    """

    path: str
    row: Mapping[str, str] = field(default_factory=dict)
    given: Sequence[str] = ()
    rewritten: bool = False

    def settings(self) -> dict[str, Any]:
        """``given`` as Python's callers say it."""
        settings: dict[str, Any] = {}
        for name, value in zip(self.given[::2], self.given[1::2], strict=True):
            settings |= dict([value.split("=")]) if name == "--set" else {name.removeprefix("--"): value}
        return settings


FAMILIES = {
    "CVRP": Sample("cvrp/E/E-n51-k5.vrp", {}, ("--set", "vehicles=unlimited")),
    "VRPTW": Sample("vrptw-solomon/R101.txt", {"convention": "dimacs-trunc1", "objective": "distance"}, ("--convention", "trunc1")),
    "TSP": Sample("tsplib/bays29.tsp"),
    "MDVRP (Cordeau)": Sample("mdvrp-cordeau/p01.txt"),
    "pickup and delivery (Li and Lim)": Sample("pdptw-lilim/100/lc101.txt"),
    "VRPSPD (Salhi and Nagy)": Sample("vrpspd-salhi/CMT1X.vrpspd", {}, ("--set", "vehicles=unlimited")),
    "orienteering (Tsiligirides)": Sample("op/tsiligirides1/tsiligirides_problem_1_budget_30.txt"),
    "orienteering (OPLib)": Sample("op/oplib-gen2/att48-gen2-50.oplib"),
    "team orienteering (Chao)": Sample("top/set4/p4.2.a.txt"),
    "TOPTW": Sample(
        "toptw/c101.txt", {"vehicles": "2"}, ("--problem", "team-orienteering", "--set", "vehicles=2", "--convention", "trunc1")
    ),
    "min-max mTSP": Sample("minmax-mtsp/mtsplib/eil51-m5.txt"),
    "VROOM JSON": Sample("cvrp/E/E-n51-k5.vrp", rewritten=True),
}  # fmt: skip


@dataclass(frozen=True)
class Known:
    """The best values known, in order of priority; ``text`` as the table shows them."""

    values: tuple[float, ...]
    text: str


def best_known(folder: Path, sample: Sample) -> Known | None:
    """The best known values of a sample in ``bks.csv``; None where it has none."""
    place = Path(sample.path)
    wanted = {"family": str(place.parent), "instance": place.stem, **sample.row}
    for line in known_values(folder, [wanted["family"]]):
        if line.items() >= wanted.items():
            first = [line["vehicles"]] if line["objective"].startswith("vehicles") else []
            shown = [*first, line["value"]]
            return Known(tuple(map(float, shown)), ", ".join(shown))
    return None


def numbers(value: Any) -> tuple[float, ...]:
    """The numbers of an objective or bound in the command's JSON, those before the first that is not there."""
    listed = value if isinstance(value, list) else [value]
    return tuple(listed[: listed.index(None)] if None in listed else listed)


def distance(values: Sequence[float], other: Sequence[float]) -> float:
    """Relative, at the first level that differs; not a number where there is nothing to compare."""
    pairs = list(zip(values, other, strict=False))
    apart = next(((a, b) for a, b in pairs if abs(a - b) > 5e-5 * abs(b)), pairs[-1] if pairs else None)
    return math.nan if apart is None else (apart[0] - apart[1]) / max(abs(apart[1]), 1e-12)


@dataclass(frozen=True)
class Ran:
    """The result of one run: exit code, the command's JSON, its complaint, and wall seconds."""

    code: int
    said: dict[str, Any]
    complaint: str
    seconds: float

    @property
    def refused(self) -> bool:
        return self.code == 2 and REFUSED in self.complaint


def solve(path: Path, method: str, seconds: float, settings: Sequence[str]) -> Ran:
    """One ``waybound solve``."""
    kind = "--solver" if method in SOLVERS else "--heuristic"
    words = ["-m", "waybound", "solve", str(path), kind, method, "--time-limit", str(seconds), "--json", "--quiet", *settings]
    began = time.perf_counter()
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    complaint = next((line for line in done.stderr.splitlines() if line.startswith("error: ")), done.stderr.strip()[-300:])
    said = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    return Ran(done.returncode, said, complaint.removeprefix("error: "), time.perf_counter() - began)


def row(family: str, method: str, ran: Ran, known: Known | None) -> tuple[list[str], bool]:
    """Cells of the table, and whether nothing is wrong."""
    if ran.refused:
        lacks = ran.complaint.partition(REFUSED)[2].partition(";")[0]
        return [family, method, f"lacks {lacks}", *[""] * 4, f"{ran.seconds:.1f}"], True
    if ran.code not in (0, 4):
        return [family, method, f"exit code {ran.code}: {ran.complaint}", *[""] * 4, f"{ran.seconds:.1f}"], False
    values, bound = numbers(ran.said["objective"]), numbers(ran.said["certificate"]["bound"])
    most = ran.said["sense"] == "max"
    # What a value known does not mention, such as the number of jobs done of VROOM's JSON, comes first; it is for all that can be had.
    before = max(0, len(values) - len(known.values)) if known else 0
    gap = distance(values[before:], known.values) if known and values[:before] == bound[:before] else math.nan
    rising = most and known is not None and len(known.values) == len(values)
    open_ = -distance(bound, values)
    beyond = bool(values) and bool(bound) and (-open_ if most else open_) < -1e-6
    return [
        family, method, ", ".join(f"{v:.7g}" for v in values) or "no answer", known.text if known else "",
        ("better by " if (gap > 5e-5 if rising else gap < -5e-5) else "") + percent(gap),
        f"{bound[0]:.7g} ({percent(open_)})" if bound and values else f"{bound[0]:.7g}" if bound else "none",
        f"{ran.said['seconds']['solve']:.1f}", f"{ran.seconds:.1f}",
    ], not beyond and (ran.code == 4 or bool(ran.said["certificate"]["feasible"]))  # fmt: skip


def percent(part: float) -> str:
    return "" if math.isnan(part) else f"{100 * abs(part):.1f} %"


HEADS = ("family", "method", "objective", "best known", "gap", "verified bound (gap)", "search s", "whole s")


def table(folder: Path, families: Sequence[str], methods: Sequence[str], seconds: float) -> bool:
    """Print the table as it grows; whether nothing is wrong."""
    good = True
    print("\n".join(markdown(HEADS)), flush=True)
    with tempfile.TemporaryDirectory() as converted:
        for family in families:
            sample = FAMILIES[family]
            path, known = folder / sample.path, best_known(folder, sample)
            if sample.rewritten:
                source, path = path, Path(converted) / f"{path.stem}.json"
                convert = [sys.executable, "-m", "waybound", "convert", str(source), "--to", str(path), "--to-format", "vroom"]
                subprocess.run(convert, capture_output=True, check=True)
            problem = read(path, **sample.settings())
            applicable = [h.name for h in HEURISTICS.values() if "routing" in h.families and not h.missing(problem)]
            answered = 0
            for method in (*SOLVERS, *applicable):
                if methods and method not in methods:
                    continue
                ran = solve(path, method, seconds, sample.given)
                cells, right = row(family, method, ran, known)
                answered += method in SOLVERS and ran.code == 0
                good = good and right
                print(markdown_row(cells), flush=True)
            if not methods and answered < 2:
                print(f"{family}: {answered} solvers answer")
                good = False
    return good


@command
def main(
    folder: Folder,
    family: Annotated[list[str] | None, Option(choices=FAMILIES, action="append", help="only this one; may be repeated")] = None,
    method: Annotated[list[str] | None, Option(action="append", help="only this solver or heuristic; may be repeated")] = None,
    seconds: Annotated[float, Option(help="time limit of each run")] = 5.0,
) -> bool:
    return table(folder, family or tuple(FAMILIES), method or (), seconds)


if __name__ == "__main__":
    sys.exit(main())
