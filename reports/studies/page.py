"""The page of a report: what the source says, what came of it, and what that was made of."""

from pathlib import Path

from ..pages.blocks import Animation, Code, DataTable, Facts, Figure, Folded, Text
from ..pages.page import Page
from ..pages.rendering import Block
from ..plots.drawing import figure_without_display
from .frames import framed
from .study import Report, Study, StudySetting

SHOWN_OBSERVATIONS = 1000
"""Observations on a page: a folder of tables holds all."""

SHOWN_PICTURES = 60
"""Pictures of an animation."""


def page_of(study: Study, setting: StudySetting, report: Report) -> Page:
    """A page of facts, findings, figures, tables and notes; observations and the command are folded away."""
    findings, tables = (report.tables[:1], report.tables[1:]) if report.findings else ((), report.tables)
    size = f"{'in full' if setting.full else 'short'}, instances or runs: {setting.instances}, seed: {setting.seed}"
    cut = f"; interrupted: {report.done} of {report.asked} parts of the work were done" if report.interrupted else ""
    facts = (("source", study.source), ("claimed there", study.claim), ("form", size + cut))
    blocks: list[Block] = [Facts([(name, text) for name, text in facts if text])]
    blocks += [DataTable(table) for table in findings]
    for figure in report.figures:
        drawn = figure_without_display(*figure.size)
        figure.draw(drawn)
        blocks.append(Figure(drawn, f"{figure.name}: {study.summary}"))
    blocks += [Animation(clip.play().pictures(SHOWN_PICTURES), clip.shows, clip.shows) for clip in report.clips]
    blocks += [DataTable(table) for table in tables]
    said = [*report.notes, *(f"violation ({fault.kind}): {fault.message}" for fault in report.faults)]
    if report.num_faults > len(report.faults):
        said.append(f"and {report.num_faults - len(report.faults)} violations more")
    blocks += [Text("\n".join(f"- {line}" for line in said))] if said else []
    if report.observations:
        shown = framed(report.observations[:SHOWN_OBSERVATIONS])
        more = len(report.observations) - len(shown)
        note = f"and {more:,} more; --out FOLDER writes all" if more else ""
        blocks.append(Folded(f"Observations ({len(report.observations):,})", [DataTable(shown, note=note)]))
    again = f"waybound report {study.name}{' --full' if setting.full else ''} --seed {setting.seed}"
    blocks.append(Folded("Run it again", [Code(again)]))
    return Page(study.name, f"{study.summary[:1].upper()}{study.summary[1:]}.", blocks)


def write_page(study: Study, setting: StudySetting, report: Report, path: Path) -> Path:
    """Write the page, whole or not at all; a missing folder is made. Raises InputError where it cannot be written."""
    path.parent.mkdir(parents=True, exist_ok=True)
    page_of(study, setting, report).write(path)
    return path
