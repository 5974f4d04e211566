"""``waybound solvers --examine``: solvers on small programs whose optima are known."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..instances.errors import UsageError
from ..instances.limits import check_whole
from ..solvers import interrupts
from .options import bounded, complain, parse_pairs, remark
from .progress import PartsCounter

if TYPE_CHECKING:
    from ..reports.battery.cases import Draw
    from ..reports.battery.examining import Examination

COUNT = 1000
"""Cases for each solver where the user says nothing."""


def refuse_settings(word: str, **given: Any) -> None:
    """Raise UsageError for options that go only ``with`` or ``without`` an examination."""
    for name, value in given.items():
        if value not in (None, []):
            raise UsageError(f"--{name} is for solvers {word} --examine")


def examine_solvers(
    solver: str | None, count: int | None, seed: int | None, kind: str | None, form: str | None, option: Sequence[str] | None,
    by: str | None, out: Path | None, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Examine one solver or all that are installed; ends with 5 if anything that one says is false."""
    from ..reports.battery.cases import Draw
    from ..reports.battery.examining import examinable
    from ..reports.ratios.writing import check_folder
    from ..solvers.backend import solver_named

    bounded(seed=seed)
    if count is not None:
        check_whole("instances", count, least=1, option="--count")
    if by not in (None, "kind", "form"):
        raise UsageError(f"--by takes kind or form, not {by!r}")
    own = parse_pairs(option, "--option")
    if own and solver is None:
        raise UsageError("--option is for one solver: --examine NAME --option KEY=VALUE")
    if out is not None:
        check_folder(out)
    draw = Draw(COUNT if count is None else count, 1 if seed is None else seed, kind, form)
    names = examinable() if solver is None else [solver_named(solver).label]
    found = _examined(names, draw, own, quiet)
    if found:
        _tell(draw, found, by or "", out, json)
    if any(e.wrong for e in found):
        raise typer.Exit(5)
    raise typer.Exit(0 if found else interrupts.exit_code())


def _examined(names: Sequence[str], draw: Draw, own: dict[str, Any], quiet: bool) -> list[Examination]:
    """Ctrl-C ends the examination under way, which then brings what it has; a second one is not begun after it."""
    from ..reports.battery.examining import examine

    found: list[Examination] = []
    for name in names:
        with PartsCounter(name, quiet, "cases") as told:
            one = examine(name, draw, own, told=told)
        if one.outcomes:
            found.append(one)
        if one.interrupted:
            remark(f"interrupted: {name} was given {len(one.outcomes)} of {draw.count} cases")
            break
    return found


def _tell(draw: Draw, found: Sequence[Examination], by: str, out: Path | None, json: bool) -> None:
    from ..reports.battery.report import examination_table, summary_lines, to_json, write_wrong
    from .output import print_json, print_table

    files = {} if out is None else {e.solver: write_wrong(out, draw, e) for e in found}
    if json:
        print_json(to_json(draw, found, files))
    else:
        print_table(examination_table(found, by))
    for one in found:
        for line in summary_lines(one, files.get(one.solver)):
            complain(line)
