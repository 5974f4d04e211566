"""Objectives in order of priority for backends that take one objective: level by level, with a row that keeps what was reached.

The program of level k + 1 is that of level k with another objective and the row ``cost_k x <= value_k`` (``>=`` where more is better),
and its search begins with the answer of level k. Where the value is a multiple of what all costs are multiples of, it is held exactly;
any other up to ``EQUAL`` of the absolute values that add up to it. Where a solver finds nothing within that, for it knows continuous
variables to ``VECTOR`` only, the value is held up to this.

A bound of level k + 1 holds for all answers no worse than ``value_j`` at each level j <= k, so for the best one, whether or not a level
before was closed.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..formulations.checking.granularity import grain
from ..formulations.evidence import Evidence
from ..formulations.programs.exactness import Link
from ..formulations.programs.program import Floats, FurtherLevel, Program, Rows
from ..formulations.tolerance import EQUAL, VECTOR, same
from ..instances.errors import UnsupportedError
from .backend import Control, LevelClaim, Options, RawResult

Run = Callable[[Program, Options, Control], RawResult]


def by_priority(who: str, run: Run, program: Program, options: Options, control: Control) -> RawResult:
    """Search the levels of ``program`` one after the other, all within the one time limit; other limits hold for each level.

    ``who``: name of the solver. ``run``: searches a program of one objective. In the result, ``objective`` and ``bound`` are those of the
    first level, ``further`` those of the others as far as they were searched. ``optimal`` only where every level was closed. ``earlier``
    holds the answers of levels before the last one. Raises UnsupportedError if the first objective is quadratic, which no row can hold.
    """
    if program.quadratic is not None:
        raise UnsupportedError(who, {"levels of priority after a quadratic objective"})
    ends = time.perf_counter() + options.time_limit
    current, held = program.first_level(), Held()
    result = first = run(current, options, control)
    answer, further, earlier, notes, searched = first.answer, list[LevelClaim](), list[Any](), list[str](), [first]
    for number, level in enumerate(program.further, start=2):
        seconds_left = ends - time.perf_counter()
        if answer is None or result.status not in ("optimal", "feasible") or result.limit in ("time", "interrupt", "memory"):
            break
        if control.stopped or seconds_left <= 0:
            result = replace(result, status="feasible", limit="interrupt" if control.stopped else "time")
            break
        before = current
        for precision in _precisions(before, answer):
            current = held.add(before, answer, level, precision)
            within = replace(options, time_limit=max(ends - time.perf_counter(), 0.0), start=answer)
            try:
                result = run(current, within, _LevelControl(control, first, held))
            except UnsupportedError as fault:
                result = RawResult("unknown", message=f"level {number}: {fault}")
            if result.status != "infeasible":
                break
        searched.append(result)
        if result.answer is not None and held.keeps(result.answer):
            earlier.append(answer)
            answer = result.answer
        elif result.status not in ("unknown", "error"):
            notes.append(f"level {number}: {who} says {result.status} of what the answer before it is one of")
            result = replace(result, status="feasible")
        further.append(LevelClaim(level.value(answer), result.bound))
    if not further:
        return replace(first, status="feasible" if first.status == "optimal" else first.status, limit=result.limit)
    closed = all(one.status == "optimal" for one in searched) and len(searched) == len(program.further) + 1
    limits = [one.limit for one in (*searched, result) if one.limit != "none"] or ["time" if time.perf_counter() >= ends else "none"]
    holds = first.holds
    for one in searched[1:]:
        holds = holds.then(one.holds)
    return replace(
        first,
        status="optimal" if closed and not notes else "feasible",
        limit="none" if closed else limits[0],
        answer=answer,
        objective=program.first_level().value(answer),
        further=tuple(further),
        earlier=tuple(earlier),
        statistics={**first.statistics, "further_levels": [one.statistics for one in searched[1:]]},
        message="; ".join(dict.fromkeys(m for m in (*(one.message for one in searched), *notes) if m)),
        holds=holds,
        links=(*searched[-1].links, Link("levels-of-priority", told=held.told)),
    )


class Held:
    """The rows that hold the levels before the one that is searched."""

    def __init__(self) -> None:
        self._levels: dict[str, tuple[Floats, float, float]] = {}

    def add(self, program: Program, x: Floats, level: FurtherLevel, precision: float = VECTOR) -> Program:
        """``program`` with its objective held at the value of ``x``, and ``level`` in its place."""
        name = f"level{1 + sum(rows.name in self._levels for rows in program.rows)}"
        sign = 1.0 if program.sense == "min" else -1.0
        cost, at = sign * program.cost, np.nonzero(program.cost)[0].astype(np.int32)
        most = _side(program, x, precision)
        self._levels[name] = (cost, _side(program, x, VECTOR) + VECTOR * float(np.abs(cost) @ np.abs(x)), program.value(x))
        row = Rows(
            name, indptr=np.array([0, len(at)], dtype=np.int32), indices=at, data=program.cost[at],
            lower=np.array([-np.inf if sign > 0 else -most]), upper=np.array([most if sign > 0 else np.inf]),
        )  # fmt: skip
        made = program.with_costs(level.cost)
        return replace(made, sense=level.sense, offset=level.offset, rows=(*program.rows, row))

    def keeps(self, x: Floats) -> bool:
        """Whether ``x`` is no worse at any level than what was reached, as closely as solvers see."""
        return all(float(cost @ x) <= most for cost, most, _ in self._levels.values())

    @property
    def told(self) -> str:
        """The levels that were held while later ones were improved, in words."""
        return "held " + ", ".join(f"level {k} at {value:.10g}" for k, (_, _, value) in enumerate(self._levels.values(), start=1))


def _precisions(program: Program, x: Floats) -> list[float]:
    """Tolerances within which later levels keep the value of ``x``: first the least that counts as a difference, then that of solvers."""
    return [EQUAL] if _side(program, x, EQUAL) == _side(program, x, VECTOR) else [EQUAL, VECTOR]


def _side(program: Program, x: Floats, precision: float) -> float:
    """The right side of the row that keeps the objective no worse than at ``x``: without its offset, and negative where more is better."""
    at = np.nonzero(program.cost)[0]
    cost, whole = (1.0 if program.sense == "min" else -1.0) * program.cost[at], bool(program.integer[at].all())
    amount = np.where(program.integer[at], np.round(x[at]), x[at])
    value, size, step = float(cost @ amount), float(np.abs(cost) @ np.abs(amount)), grain(cost)
    if step is not None:
        multiple = step.multiple(round(value * step.parts / step.units))
        if whole or same(value, multiple, size):  # a continuous variable that is whole stays so
            return multiple
    return value + (EQUAL if whole else precision) * size


class _LevelControl(Control):
    """Hands on the incumbents of a later level, with the value of the first level and its bound, as long as all before it are kept."""

    def __init__(self, outer: Control, first: RawResult, held: Held) -> None:
        super().__init__()
        self._outer, self._first, self._held, self._counts_for = outer, first, held, outer
        outer.on_stop(self.stop)

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        if answer is not None and self._held.keeps(answer):
            self._outer.publish(answer, self._first.objective, evidence=evidence)
