"""Instances on which something went wrong, as files that anyone can read back."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...formulations.problem import Problem
from ...instances.errors import InputError, UsageError
from ...instances.instance import Instance, settings_of, with_settings
from .study import Fault, Report


def instance_of(problem: Problem, note: str = "") -> Instance | None:
    """The instance of a problem with a note; None where no file can hold it."""
    try:
        instance: Any = problem.to_instance()
        notes = (*instance.notes, note) if note else instance.notes
        noted: Instance = with_settings(replace(instance, notes=notes), settings_of(instance))
        _written(noted)
    except (InputError, UsageError):
        return None
    return noted


def instance_text(problem: Problem, note: str = "") -> str:
    """The file of an instance as text, for the message of a failing test."""
    instance = instance_of(problem, note)
    return f"{problem!r} cannot be written as a file" if instance is None else _written(instance)


def _written(instance: Instance) -> str:
    from ...instances.formats import FORMATS

    write = FORMATS["json"].write
    assert write is not None
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
