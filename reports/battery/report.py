"""Results of examinations as a table, as JSON and as files."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..tables.table import Column, Table
from .cases import Draw, cases
from .examining import GAVE_UP, WRONG, Examination, Outcome


def examination_table(examinations: Sequence[Examination], by: str = "") -> Table:
    """One row per solver; with ``by`` (``kind`` or ``form``) one for each of its kinds or forms."""
    columns = [Column("solver"), Column("version"), *([Column(by)] if by else []), Column("cases", right=True)]
    columns += [Column(name, right=True) for name in (*WRONG, GAVE_UP, "seconds")]
    rows = []
    for examination in examinations:
        names = sorted({getattr(o, by) for o in examination.taken}) if by else [""]
        for name in names or [""]:
            part = [o for o in examination.taken if not by or getattr(o, by) == name]
            rows.append((examination.solver, examination.version, *([name] if by else []), *_figures(part)))
    return Table("Solvers on programs whose optima are known", tuple(columns), tuple(rows))


def _figures(outcomes: Sequence[Outcome]) -> list[str]:
    counts = Counter(o.verdict for o in outcomes)
    return [str(len(outcomes)), *(str(counts[v]) for v in (*WRONG, GAVE_UP)), f"{sum(o.seconds for o in outcomes):.1f}"]


def summary_lines(examination: Examination, files: Mapping[int, str] | None = None, most: int = 5) -> list[str]:
    """One line for each of the first few false words, and how many more there are."""
    lines = [
        f"{examination.solver}, case {o.number} ({o.kind}, {o.form}): {o.verdict}: the program is {o.truth}, the solver says {o.said}"
        + (f"; {files[o.number]}" if files and o.number in files else "")
        for o in examination.wrong[:most]
    ]
    more = len(examination.wrong) - len(lines)
    return lines + ([f"{examination.solver}: and {more} more"] if more > 0 else [])


def to_json(draw: Draw, examinations: Sequence[Examination], files: Mapping[str, Mapping[int, str]] | None = None) -> dict[str, Any]:
    """Plain JSON values: counts by solver, and every case that is wrong or was given up."""
    solvers = []
    for examination in examinations:
        counts = Counter(o.verdict for o in examination.taken)
        written = (files or {}).get(examination.solver, {})
        cases_told = [{**asdict(o), "file": written.get(o.number)} for o in examination.taken if o.verdict in (*WRONG, GAVE_UP)]
        solvers.append(
            {
                "solver": examination.solver, "version": examination.version, "cases": len(examination.taken),
                **{name.replace(" ", "_"): counts[name] for name in (*WRONG, GAVE_UP)},
                "seconds": sum(o.seconds for o in examination.taken), "told": cases_told,
            }
        )  # fmt: skip
    return {"schema": 1, **asdict(draw), "solvers": solvers}


def write_wrong(folder: Path, draw: Draw, examination: Examination) -> dict[int, str]:
    """Write the program of every false word into ``folder``, which is made if needed; returns the paths by case.

    Raises InputError if a file cannot be written; those before it stand.
    """
    written = {}
    for outcome in examination.wrong:
        (case,) = cases(draw, range(outcome.number, outcome.number + 1))
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{examination.solver.replace(':', '-')}-{outcome.verdict.replace(' ', '-')}-{outcome.number}.mps"
        case.program.write(path)
        written[outcome.number] = str(path)
    return written
