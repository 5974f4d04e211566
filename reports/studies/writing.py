"""Reports as files: tables as CSV and Markdown, figures as PNG, each whole or not at all."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...instances.atomic import atomic_write
from ...instances.errors import UsageError
from ..plots.drawing import figure_without_display, png_of
from ..tables.table import Table
from .study import Figure, Report


def check_folder(folder: Path) -> None:
    """Raise UsageError, before anything is run, if ``folder`` cannot be made or written to."""
    import os

    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"--out {folder} is a file, not a folder")
    except OSError as fault:
        raise UsageError(f"--out {folder} cannot be made: {fault.strerror}") from None
    nearest = folder
    while not nearest.exists():
        nearest = nearest.parent
    if not nearest.is_dir():
        raise UsageError(f"--out {folder} cannot be made: {nearest} is a file, not a folder")
    if not os.access(nearest, os.W_OK):
        raise UsageError(f"--out {folder}: {nearest} cannot be written to")


def is_page(path: Path) -> bool:
    """Whether ``--out`` names a page, not a folder."""
    return path.suffix.lower() in (".html", ".htm")


def check_out(path: Path, several: bool) -> None:
    """Raise UsageError, before anything is run, if no page or folder can be written to ``path``; ``several`` studies need a folder."""
    if not is_page(path):
        check_folder(path)
        return
    if several:
        raise UsageError(f"--out {path} is one page: name a folder for several studies")
    if path.is_dir():
        raise UsageError(f"--out {path} is a folder")
    check_folder(path.parent)


def write_report(report: Report, folder: Path) -> tuple[Path, ...]:
    """Write ``STUDY.csv`` (the table), ``STUDY-observations.csv``, ``STUDY.md`` and the figures into ``folder``, which is made if needed.

    Raises InputError if a file cannot be written; those before it remain.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, rows in ((report.study, report.rows), (f"{report.study}-observations", report.observations)):
        if rows:
            written.append(folder / f"{name}.csv")
            atomic_write(written[-1], csv_text(rows))
    written.append(folder / f"{report.study}.md")
    atomic_write(written[-1], markdown(report))
    for figure in report.figures:
        written.append(folder / f"{figure.name}.png")
        atomic_write(written[-1], png(figure))
    return tuple(written)


def csv_text(rows: Sequence[dict[str, Any]]) -> str:
    """Rows with a heading, numbers in full, empty where there is no value."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if row.get(key) is None else row[key] for key in columns])
    return stream.getvalue()


def markdown(report: Report) -> str:
    """The table, notes and faults of a report, and its figures."""
    lines = [f"# {report.study}", "", report.title, ""]
    for table in report.tables:
        lines += [*([f"{table.title}:", ""] if len(report.tables) > 1 else []), *markdown_table(table), ""]
    lines += [f"- {note}" for note in report.notes]
    if report.interrupted:
        lines.append(f"- interrupted: {report.done} of {report.asked} parts of the work were done")
    lines += [f"- violation ({fault.kind}): {fault.message}" for fault in report.faults]
    if report.num_faults > len(report.faults):
        lines.append(f"- and {report.num_faults - len(report.faults)} more")
    lines += [f"\n![{figure.name}]({figure.name}.png)" for figure in report.figures]
    return "\n".join(lines).rstrip() + "\n"


def markdown_table(table: Table) -> list[str]:
    """A table as lines of Markdown."""
    heads = [column.name for column in table.columns]
    rules = ["---:" if column.right else "---" for column in table.columns]
    body = [[cell.replace("|", "\\|") for cell in row] for row in table.rows]
    return ["| " + " | ".join(cells) + " |" for cells in (heads, rules, *body)]


def png(figure: Figure) -> bytes:
    """A figure, drawn without a display; the same report gives the same bytes."""
    canvas = figure_without_display(*figure.size)
    figure.draw(canvas)
    return png_of(canvas, 150)
