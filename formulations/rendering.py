"""Certificates and solutions for people: the same lines as plain text, as HTML for notebooks, and as a rich table."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..instances.printable import printable
from .tolerance import EQUAL

if TYPE_CHECKING:
    from .certificate import Certificate
    from .solution import Solution

SHOWN_VIOLATIONS = 10
"""Violations that are listed one by one; the rest is counted."""

SHOWN_LABEL = 80
"""Characters of a label that are shown."""

_STYLES = {"good": "green", "bad": "bold red", "quiet": "dim", "plain": ""}
_COLOURS = {"good": "#1a7f37", "bad": "#b42318", "quiet": "#6e7781", "plain": "inherit"}


@dataclass(frozen=True)
class Line:
    """One fact: what it is, what holds, and its tone (``good, bad, quiet, plain``). Its texts are printable, wherever they come from."""

    label: str
    text: str
    tone: str = "plain"

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", printable(self.label, SHOWN_LABEL))
        object.__setattr__(self, "text", printable(self.text))


def number(value: Any) -> str:
    """A value as people read it: ten significant digits, levels of priority joined by "then", "-" where there is none."""
    if value is None:
        return "-"
    if isinstance(value, list | tuple):
        return " then ".join(number(v) for v in value)
    return f"{float(value):.10g}"


def percent(gap: float | None) -> str:
    """A relative gap as a percentage."""
    if gap is None:
        return "-"
    return "0 %" if gap <= EQUAL else f"{100.0 * gap:.3g} %"


def certificate_lines(certificate: Certificate) -> list[Line]:
    """What a certificate says, one fact a line."""
    return [*_answer_lines(certificate), *_bound_lines(certificate)]


def _answer_lines(c: Certificate) -> list[Line]:
    if c.feasible is None:
        return [Line("answer", "none", "quiet")]
    if c.feasible:
        lines = [Line("answer", f"feasible: all {len(c.checks)} checks hold", "good")]
    else:
        lines = [Line("answer", f"infeasible: {_count(len(c.violations), 'violation')}", "bad")]
    for check in c.checks:
        if check.tested:
            text = f"{check.tested} tested, largest residual {check.residual:.3g}"
            lines.append(Line(f"  {check.name}", text if check.passed else f"broken: {text}", "quiet" if check.passed else "bad"))
        else:
            lines.append(Line(f"  {check.name}", "nothing to test", "quiet"))
    lines += [
        Line("  !", v.message if v.amount == float("inf") else f"{v.message} (by {v.amount:.6g})", "bad")
        for v in c.violations[:SHOWN_VIOLATIONS]
    ]
    if len(c.violations) > SHOWN_VIOLATIONS:
        lines.append(Line("  !", f"and {len(c.violations) - SHOWN_VIOLATIONS} more", "bad"))
    lines.append(Line("objective", f"{number(c.objective)}, recomputed from the data"))
    return lines


def _bound_lines(c: Certificate) -> list[Line]:
    lines = [
        Line("bound", "none verified", "quiet") if c.bound is None else Line("bound", f"{number(c.bound)}, verified: {_source(c)}", "good")
    ]
    if c.gap is not None:
        lines.append(Line("gap", percent(c.gap)))
    return [*lines, *_ratio_lines(c)]


def _source(c: Certificate) -> str:
    """What proves the bound: a file's own name for it stands in quotes, behind the kind of evidence that was multiplied out."""
    return f"{c.evidence[0].kind}, in the file {printable(c.bound_source, 200)!r}" if c.from_file and c.evidence else str(c.bound_source)


def _ratio_lines(c: Certificate) -> list[Line]:
    lines = []
    if c.guarantee is not None:
        text = f"ratio {number(c.guarantee.ratio)}: {c.guarantee.statement} ({c.guarantee.source})"
        if c.guarantee.assumptions:
            text += f"; checked on this instance: {', '.join(c.guarantee.assumptions)}"
        lines.append(Line("guarantee", text))
    if c.stated_guarantee is not None:
        g = c.stated_guarantee
        text = f"ratio {number(g.ratio)}: {printable(g.statement, 300)!r} ({printable(g.source, 300)!r})"
        lines.append(Line("guarantee", f"stated in the file, not verified: {text}", "quiet"))
    if c.observed_ratio is not None:
        lines.append(Line("ratio", f"at most {c.observed_ratio:.6g}, observed against the verified bound"))
    return lines


def status_line(solution: Solution) -> Line:
    """How a run ended, and on whose word."""
    s = solution
    stopped = "" if s.limit == "none" else f"; stopped by {_LIMIT_WORDS.get(s.limit, s.limit)}"
    if s.status == "optimal":
        precision = EQUAL if s.evaluation is None else s.evaluation.precision
        if s.bound_kind == "verified" and s.gap is not None and s.gap <= precision:
            return Line("status", "optimal: the verified bound meets the objective", "good")
        return Line("status", f"optimal according to {s.solver}{stopped}", "good")
    if s.status == "feasible":
        return Line("status", f"feasible{stopped}")
    if s.status == "infeasible" and s.certificate.infeasible:
        return Line("status", f"infeasible, verified: {s.certificate.bound_source}", "bad")
    if s.status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        return Line("status", f"{s.status.replace('_', ' ')} according to {s.solver}", "bad")
    return Line("status", f"no answer{stopped}" if s.status == "unknown" else f"{s.status}{stopped}", "bad")


_LIMIT_WORDS = {
    "time": "the time limit",
    "iterations": "the limit on iterations",
    "gap": "the gap asked for",
    "nodes": "the limit on nodes",
    "memory": "the memory limit",
    "interrupt": "an interrupt",
}


def solution_lines(solution: Solution) -> list[Line]:
    """How a run ended and what its certificate says; a claimed bound is told apart from a verified one."""
    s, c = solution, solution.certificate
    lines = [status_line(s), *(Line("fault", fault, "bad") for fault in s.faults), *_answer_lines(c)]
    if s.bound_kind == "claimed":
        lines.append(Line("bound", f"{number(s.bound)}, claimed by {s.bound_source} (its own figure, no evidence)"))
        if c.bound is not None:
            lines.append(Line("", f"{number(c.bound)}, verified: {c.bound_source}", "good"))
    elif c.bound is not None:
        lines.append(Line("bound", f"{number(c.bound)}, verified: {c.bound_source}", "good"))
    else:
        lines.append(Line("bound", "none", "quiet"))
    if s.gap is not None:
        against = f", against the {s.bound_kind} bound" if s.bound_kind else ""
        lines.append(Line("gap", percent(s.gap) + against))
    lines += _ratio_lines(c)
    lines.append(Line("seconds", ", ".join(f"{name} {spent:.2f}" for name, spent in s.seconds.items()), "quiet"))
    if s.message:
        lines.append(Line("message", s.message))
    return lines


def certificate_title(certificate: Certificate) -> str:
    """Heading of a certificate."""
    return f"Certificate: {certificate.problem}, {certificate.sense}, convention {certificate.convention}"


def solution_title(solution: Solution) -> str:
    """Heading of a solution."""
    by = f"{solution.solver} ({solution.form})" if solution.form else solution.solver
    p = solution.problem
    return f"{p.name}: {p.problem}, {p.sense}, convention {p.convention}, by {by}"


def as_text(title: str, lines: Sequence[Line]) -> str:
    """Plain text, labels in a column of their own."""
    width = max((len(line.label) for line in lines), default=0)
    return "\n".join([printable(title), *(f"{line.label:<{width}}  {line.text}".rstrip() for line in lines)])


def as_html(title: str, lines: Sequence[Line]) -> str:
    """An HTML table."""
    cell = "text-align:left;padding:1px 10px 1px 0;vertical-align:top"
    rows = "".join(
        f'<tr><th style="{cell};font-weight:normal;white-space:pre">{html.escape(line.label)}</th>'
        f'<td style="{cell};color:{_COLOURS[line.tone]}">{html.escape(line.text)}</td></tr>'
        for line in lines
    )
    return (
        f'<table style="border-collapse:collapse"><caption style="text-align:left">{html.escape(printable(title))}</caption>{rows}</table>'
    )


def as_rich(title: str, lines: Sequence[Line]) -> Any:
    """A ``rich`` renderable."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    for line in lines:
        grid.add_row(Text(line.label, style="red" if line.label.strip() == "!" else "bold cyan"), Text(line.text, style=_STYLES[line.tone]))
    return Group(Text(printable(title), style="bold"), grid)


def _count(n: int, what: str) -> str:
    return f"{n} {what}" if n == 1 else f"{n} {what}s"
