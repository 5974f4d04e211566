"""Summary of a run in plain sentences: what is proved, by which evidence, and what is not."""

from collections.abc import Sequence

from ..instances.printable import one_line
from .rendering import Line, as_text, number, percent
from .solution import Solution, solution_title, status_line
from .tolerance import EQUAL, gap, same

_BEST = {"min": ("least", "below"), "max": ("largest", "above")}


def verdict_in_words(solution: Solution) -> list[str]:
    """How a run ended, what is proved and what is not, remarks, and the seconds spent: what stands at the end of its log."""
    lines = as_text(solution_title(solution), [status_line(solution), *verdict_lines(solution)]).split("\n")
    remarks = [f"remarks: {one_line(solution.message)}"] if solution.message else []
    return [*lines, *remarks, "seconds: " + ", ".join(f"{name} {seconds:.2f}" for name, seconds in solution.seconds.items())]


def verdict_lines(solution: Solution) -> list[Line]:
    """One line a fact, each labelled ``proved`` or ``not proved``; claims of a solver are never among what is proved."""
    s, c = solution, solution.certificate
    lines = [Line("fault", fault, "bad") for fault in s.faults]
    if s.answer is not None:
        checks = "1 check" if len(c.checks) == 1 else f"{len(c.checks)} checks"
        lines.append(
            Line("proved", f"the answer keeps every constraint and is worth {number(s.objective)}: {checks}, redone from the data", "good")
        )
    elif c.infeasible:
        return [*lines, Line("proved", f"there is no answer (evidence: {c.bound_source}; checked without any solver)", "good")]
    elif c.unbounded:
        return [*lines, Line("proved", f"there is no best answer (evidence: {c.bound_source}; checked without any solver)", "good")]
    else:
        said = f"{s.solver} says {s.status.replace('_', ' ')}" if s.status not in ("unknown", "error") else f"{s.solver} found none"
        lines.append(Line("not proved", f"whether there is an answer: {said}, which is no proof", "bad"))
    verified = _verified_bounds(s)
    values = None if s.objective is None else s.objective if isinstance(s.objective, list) else [s.objective]
    lines += _levels(s, verified, values)
    if s.status == "optimal" and not _closed(s, verified, values):
        lines.append(Line("claimed", f"that the answer is optimal: {s.solver}'s own word, without evidence that could be checked"))
    elif s.bound_kind == "claimed":
        lines.append(Line("claimed", f"the bound {number(s.bound)}: {s.bound_source}'s own figure, without evidence that could be checked"))
    return lines


def _verified_bounds(s: Solution) -> list[tuple[float, str]]:
    c = s.certificate
    return [] if c.bound is None else [(c.bound, str(c.bound_source)), *((level.bound, level.source) for level in c.levels)]


def _levels(s: Solution, verified: Sequence[tuple[float, str]], values: Sequence[float | None] | None) -> list[Line]:
    """Lines on each level: what its verified bound says of the answer, and whether it is open."""
    lines = []
    senses = s.problem.senses
    for level, sense in enumerate(senses):
        best, beyond = _BEST[sense]
        at = f" at level {level + 1}" if len(senses) > 1 else ""
        given = "" if level == 0 else " as good before"
        value = None if values is None else values[level]
        if level >= len(verified):
            what = "any limit on what answers are worth" if value is None else f"that {number(value)} is the {best}"
            lines.append(Line("not proved", f"{what}{at}: no bound was verified", "quiet"))
            return lines
        bound, source = verified[level]
        lines.append(
            Line("proved", f"no answer{given} is {beyond} {number(bound)}{at} (evidence: {source}; checked without any solver)", "good")
        )
        if value is None:
            return lines
        if not _met(s, level, bound, value):
            far = f"better ones may exist, by up to {percent(gap(value, bound))}"
            lines.append(Line("not proved", f"that {number(value)} is the {best}{at}: {far}", "quiet"))
            return lines
        lines.append(Line("proved", f"{number(value)} is the {best}{at}: bound and answer meet", "good"))
    return lines


def _met(s: Solution, level: int, bound: float, value: float) -> bool:
    if s.evaluation is None:
        return same(value, bound, precision=EQUAL)
    return s.evaluation.same_at(level, bound, s.evaluation.precision)


def _closed(s: Solution, verified: Sequence[tuple[float, str]], values: Sequence[float | None] | None) -> bool:
    if values is None or len(verified) < len(values):
        return False
    return all(v is not None and _met(s, k, b, v) for k, (v, (b, _)) in enumerate(zip(values, verified, strict=False)))
