"""The contract of studies: what they are asked, and what they bring back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ...instances.instance import Instance
from ...instances.registry import Registry
from ..tables.table import Table

Told = Callable[[int, int, str], None]
"""``told(done, total, what)`` receives the progress of a study."""


@dataclass(frozen=True)
class StudySetting:
    """Settings of a run of a study.

    Parameters
    ----------
    instances : int
        Random instances for each heuristic, spread over the families; trials for each point of an experiment.
    seed : int
        The same seed gives the same instances and the same answers, whatever ``jobs`` is.
    jobs : int
        Processes.
    told : callable
        Progress.
    """

    instances: int
    seed: int = 1
    jobs: int = 1
    told: Told = lambda done, total, what: None


@dataclass(frozen=True)
class Fault:
    """Something that must not be, with the instance on which it is so.

    Parameters
    ----------
    kind : str
        ``ratio`` (worse than the stated guarantee), ``guarantee`` (withheld, or weaker than in the literature), ``bound`` (a verified bound
        below the optimum), ``answer`` (fails its check), ``error`` (no answer at all), ``optimum`` (the optimum itself does not hold
        up), ``certificate``, ``order`` (values that contradict each other), ``values`` (other than the published ones).
    message : str
        One line.
    instance : Instance, optional
        None where there is none to write, such as with a function of the user's own.
    where : str
        The configuration or method at fault.
    """

    kind: str
    message: str
    instance: Instance | None = None
    where: str = ""


def thinned(faults: Sequence[Fault], most: int = 3) -> tuple[Fault, ...]:
    """The first few faults of each kind and place, so that a common one does not hide the others."""
    kept: dict[tuple[str, str], int] = {}
    chosen = []
    for fault in faults:
        key = (fault.kind, fault.where)
        kept[key] = kept.get(key, 0) + 1
        if kept[key] <= most:
            chosen.append(fault)
    return tuple(chosen)


@dataclass(frozen=True)
class Figure:
    """A figure to be drawn when it is wanted: ``draw(figure)`` fills a matplotlib figure of ``size`` inches."""

    name: str
    draw: Callable[[Any], None]
    size: tuple[float, float] = (8.0, 5.0)


@dataclass(frozen=True)
class Report:
    """Results of a study.

    Parameters
    ----------
    study : str
    title : str
    table : Table
        For people.
    rows : tuple of dict
        The same for machines, one a row of the table, unrounded.
    observations : tuple of dict
        What the rows were made of, one an instance or trial.
    faults : tuple of Fault
        The first few of each kind and place; ``num_faults`` counts all.
    num_faults : int
    figures : tuple of Figure
    notes : tuple of str
    done, asked : int
        Units of work; fewer done than asked after an interrupt.
    interrupted : bool
    """

    study: str
    title: str
    table: Table
    rows: tuple[dict[str, Any], ...] = ()
    observations: tuple[dict[str, Any], ...] = ()
    faults: tuple[Fault, ...] = ()
    num_faults: int = 0
    figures: tuple[Figure, ...] = ()
    notes: tuple[str, ...] = field(default=())
    done: int = 0
    asked: int = 0
    interrupted: bool = False

    def to_json(self, files: tuple[str | None, ...] = ()) -> dict[str, Any]:
        """Plain JSON values; ``files`` names where the instance of each fault was written."""
        written = files or (None,) * len(self.faults)
        return {
            "study": self.study,
            "title": self.title,
            "rows": list(self.rows),
            "num_faults": self.num_faults,
            "faults": [{"kind": f.kind, "message": f.message, "file": file} for f, file in zip(self.faults, written, strict=True)],
            "notes": list(self.notes),
            "done": self.done,
            "asked": self.asked,
            "interrupted": self.interrupted,
        }


@dataclass(frozen=True)
class Study:
    """A study, registered in ``STUDIES``.

    Parameters
    ----------
    name : str
        Used with ``waybound ratio``.
    summary : str
        One line.
    instances : int
        As many as are taken when nothing else is said.
    run : callable
        ``run(setting) -> Report``.
    guarantees : bool
        Whether it tests stated guarantees: those studies make up ``all``.
    plan : object
        What ``run`` works through; processes look their part of the work up by the study's name.
    """

    name: str
    summary: str
    instances: int
    run: Callable[[StudySetting], Report]
    guarantees: bool = True
    plan: Any = None

    def __call__(self, setting: StudySetting | None = None, **changes: Any) -> Report:
        """Run it, by default as its summary says."""
        return self.run(replace(setting or StudySetting(self.instances), **changes))


STUDIES: Registry[Study] = Registry("study", "waybound.reports.ratios.studies.*", group="waybound.studies")
