"""The contract of studies: what they are asked, and what they bring back."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ...instances.instance import Instance
from ...instances.registry import Registry
from ..tables.table import Table
from .findings import FINDINGS, REPRODUCED, SIGN, Finding

if TYPE_CHECKING:
    from ..missions.animation import Film

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
    full : bool
        Whether all levels of an experiment are played, at their full length, or enough of each to see the study work in seconds.
    """

    instances: int
    seed: int = 1
    jobs: int = 1
    told: Told = lambda done, total, what: None
    full: bool = True

    @property
    def seeds(self) -> range:
        """One seed an instance."""
        return range(self.seed, self.seed + self.instances)


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


def figure(name: str, width: float, height: float) -> Callable[[Callable[..., None]], Callable[..., Figure]]:
    """Make of ``draw(figure, ...)`` a function that returns the figure of its other arguments, of a size in inches."""
    return lambda draw: lambda *data: Figure(name, lambda canvas: draw(canvas, *data), (width, height))


@dataclass(frozen=True)
class Clip:
    """A film to be played when it is wanted, and a sentence of what it shows."""

    play: Callable[[], "Film"]
    shows: str


def broken(findings: Sequence[Finding]) -> dict[str, Any]:
    """The fields of a report for findings that must be reproduced: a fault for each that is not."""
    faults = tuple(
        Fault("values", f"{f.what}: {f.ours}, published {f.published}", None, f.what)
        for f in findings
        if f.verdict not in (REPRODUCED, SIGN)
    )
    return {"faults": faults, "num_faults": len(faults)}


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
    findings : tuple of Finding
        Published numbers and claims beside ours.
    further : tuple of Table
        More tables for people.
    clips : tuple of Clip
        Films of missions, for pages.
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
    findings: tuple[Finding, ...] = ()
    further: tuple[Table, ...] = ()
    clips: tuple[Clip, ...] = ()

    @property
    def tables(self) -> tuple[Table, ...]:
        """All tables, findings first; those without rows are left out."""
        comparison = Table("Published and ours", FINDINGS, tuple((f.what, f.published, f.ours, f.verdict, f.why) for f in self.findings))
        return tuple(table for table in (comparison, self.table, *self.further) if table.rows)

    def to_json(self, files: tuple[str | None, ...] = ()) -> dict[str, Any]:
        """Plain JSON values; ``files`` names where the instance of each fault was written."""
        written = files or (None,) * len(self.faults)
        return {
            "study": self.study,
            "title": self.title,
            "rows": list(self.rows),
            "num_faults": self.num_faults,
            "faults": [{"kind": f.kind, "message": f.message, "file": file} for f, file in zip(self.faults, written, strict=True)],
            "findings": [asdict(finding) for finding in self.findings],
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
        Used with ``waybound report`` and ``waybound ratio``.
    summary : str
        One line.
    instances : int
        As many as are taken in full, when nothing else is said.
    run : callable
        ``run(setting) -> Report``.
    guarantees : bool
        Whether it tests stated guarantees: those studies make up ``all``.
    plan : object
        What ``run`` works through; processes look their part of the work up by the study's name.
    short : int
        Instances of the short form, which takes seconds.
    source : str
        Publication with section, figure or table, where the study repeats an experiment.
    claim : str
        One line: what the source says came of it.
    """

    name: str
    summary: str
    instances: int
    run: Callable[[StudySetting], Report]
    guarantees: bool = True
    plan: Any = None
    short: int = 12
    source: str = ""
    claim: str = ""

    def setting(self, **changes: Any) -> StudySetting:
        """The setting in full, or with ``full=False`` the short form, with ``changes``."""
        size = self.instances if changes.get("full", True) else min(self.short, self.instances)
        return StudySetting(**{"instances": size, **changes})

    def __call__(self, setting: StudySetting | None = None, **changes: Any) -> Report:
        """Run it, by default in full; ``full=False`` alone is the short form."""
        return self.run(replace(setting, **changes) if setting else self.setting(**changes))


def study(
    name: str, summary: str, instances: int, *, source: str = "", claim: str = "", **further: Any
) -> Callable[[Callable[[StudySetting], Report]], Study]:
    """Register the decorated function ``run(setting) -> Report`` as a study that repeats an experiment."""
    return lambda run: STUDIES.add(
        name, Study(name, summary, instances, run, **{"guarantees": False, "source": source, "claim": claim, **further})
    )


STUDIES: Registry[Study] = Registry("study", "waybound.reports.studies.*", group="waybound.studies")
