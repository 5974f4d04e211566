"""Instances on which something went wrong, as files that anyone can read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ...formulations.problem import Problem
from ...formulations.risk.uncertain_path import UncertainPath
from ...formulations.routing.problem import RoutingProblem
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.max_min_lp import MaxMinLP
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ...instances.instance import Instance
from ...instances.routing.instance import RoutingInstance
from ...instances.sata.selection import SelectionInstance, writable
from .study import Fault, Report


def instance_of(problem: Problem, note: str = "") -> Instance | None:
    """The instance of a problem with a note; None where no file can hold it."""
    notes = (note,) if note else ()
    if isinstance(problem, WinnerTakesAllSATA | BottleneckSATA):
        return replace(problem.graph, problem=problem.problem, notes=(*problem.graph.notes, *notes))
    if isinstance(problem, MaxMinLP):
        return replace(problem.instance, notes=(*problem.instance.notes, *notes))
    if isinstance(problem, UncertainPath):  # the risk is a setting, and no part of the graph
        return replace(problem.graph, notes=(*problem.graph.notes, f"risk={problem.risk!r}", *notes))
    if isinstance(problem, RoutingProblem) and problem.forbidden is None:
        names = tuple(term.name for level in problem.objective.levels() for _, term in level.terms)
        return RoutingInstance(
            problem.name, "generated", problem.sites, problem.travel, problem.fleet, problem.problem, (problem.problem,),
            problem.min_vehicles, names, (*problem.notes, *notes), problem.team_risk,
        )  # fmt: skip
    if isinstance(problem, SubmodularSelection) and writable(problem.function, problem.constraint):
        return SelectionInstance(
            problem.function, problem.constraint, problem.element_names, name=problem.name, notes=(*problem.notes, *notes)
        )
    return None


def instance_text(problem: Problem, note: str = "") -> str:
    """The file of an instance as text, for the message of a failing test."""
    from ...instances.formats import FORMATS

    instance, write = instance_of(problem, note), FORMATS["json"].write
    if instance is None or write is None:
        return f"{problem!r} cannot be written as a file"
    text = write(instance)
    return text if isinstance(text, str) else text.decode()


def write_faults(report: Report, folder: Path) -> tuple[str | None, ...]:
    """Write the instance of each fault into ``folder``; returns the paths, None where there is no instance. Raises InputError."""
    from ...instances.writing import write_instance

    written: list[str | None] = []
    count = 0
    for fault in report.faults:
        if fault.instance is None:
            written.append(None)
            continue
        count += 1
        path = folder / f"violation-{report.study}-{count}.json"
        write_instance(fault.instance, path)
        written.append(str(path))
    return tuple(written)


def summary_lines(faults: Sequence[Fault], files: Sequence[str | None], total: int, most: int = 20) -> list[str]:
    """The first ``most`` faults, one line each, and how many more there are."""
    lines = [f"{f.kind}: {f.message}" + (f"; instance in {file}" if file else "") for f, file in zip(faults, files, strict=True)][:most]
    if total > len(lines):
        lines.append(f"and {total - len(lines)} more")
    return lines
