"""The page of one answer: what was asked, what was found, and what proves it."""

from collections.abc import Sequence
from os import PathLike

from ...formulations.certificate import Certificate
from ...formulations.problem import Problem
from ...formulations.rendering import Line, number
from ...formulations.solution import Solution, solution_lines
from ...instances.atomic import atomic_write
from ..plots.drawing import axes_without_display
from ..plots.history import plot_history
from ..tables.facts import facts, facts_table
from ..tables.table import Column, Table
from . import PAGES
from .blocks import DataTable, Facts, Figure, Folded
from .default_blocks import default_blocks
from .page import Page
from .rendering import Block


def answer_page(solution: Solution) -> Page:
    """The page of a solution, with or without an answer; ``solution.to_html`` writes it."""
    problem, answer = solution.problem, solution.answer
    by = f"{solution.solver} ({solution.form})" if solution.form else solution.solver
    lead = f"{problem.problem}, {problem.sense}, convention {problem.convention}, by {by}"
    lines = [line for line in solution_lines(solution) if not line.label.startswith("  ")]
    blocks: list[Block] = [Facts(lines)]
    if answer is not None:
        known = problem.family in PAGES
        blocks += PAGES[problem.family](problem, answer, solution) if known else default_blocks(solution)
    blocks.append(Folded("Certificate: what was checked, and what proves the bound", certificate_blocks(solution.certificate)))
    if len({event.seconds for event in solution.events}) > 1:
        drawn = plot_history(solution, ax=axes_without_display())
        blocks.append(Folded("Course of the search", [Figure(drawn, "Objective and bound over time")]))
    blocks += [Folded("What was asked", [_asked(problem)]), Folded("How it was found", [Facts(_way(solution))])]
    return Page(problem.name, lead, blocks)


def answer_html(solution: Solution, path: str | PathLike[str] | None) -> str:
    """The page as text, which is also written to ``path`` where one is given."""
    text = answer_page(solution).html()
    if path is not None:
        atomic_write(path, text)
    return text


def certificate_blocks(certificate: Certificate) -> list[Block]:
    """Checks, violations and evidence of a certificate."""
    c = certificate
    columns = (
        Column("check"), Column("verdict"), Column("tested", right=True), Column("largest residual", right=True),
        Column("confidence", right=True),
    )  # fmt: skip
    rows = [
        (
            check.name, "holds" if check.passed else "broken", str(check.tested), f"{check.residual:.3g}" if check.tested else "-",
            f"{check.confidence:.6g}",
        )
        for check in c.checks
    ]  # fmt: skip
    blocks: list[Block] = [DataTable(Table("Checks of the answer against the data", columns, tuple(rows)))] if rows else []
    if c.violations:
        broken = tuple((v.check, v.message, number(v.amount)) for v in c.violations)
        blocks.append(DataTable(Table("Violations", (Column("check"), Column("what", wide=True), Column("by", right=True)), broken)))
    lines = [Line("evidence", f"{e.kind}, of {e.source}: {number(e.value)}") for e in c.evidence]
    lines += [Line(f"level {k}", f"{number(level.bound)}, of {level.source}") for k, level in enumerate(c.levels, start=2)]
    lines.append(Line("data", f"hash {c.instance_hash}", "quiet"))
    return [*blocks, Facts(lines)]


def _asked(problem: Problem) -> Facts:
    table = facts_table(facts(problem))
    return Facts([(label, text) for label, text in table.rows])


def _way(solution: Solution) -> Sequence[Line]:
    s = solution
    lines = [Line("solver", s.solver), Line("seed", str(s.seed))]
    lines += [Line("" if k else "chain", str(link)) for k, link in enumerate(s.chain)]
    lines += [Line("" if k else "second opinions", f"{o.solver}: {o.verdict}, {o.status}") for k, o in enumerate(s.opinions)]
    lines += [Line(name.replace("_", " "), str(value)) for name, value in s.statistics.items()]
    return [*lines, Line("versions", ", ".join(f"{name} {version}" for name, version in s.versions.items()), "quiet")]
