"""A bare program as a problem of its own: its answer is a vector, judged against rows, bounds and integrality."""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.errors import InputError, UnsupportedError, UsageError
from ...instances.instance import digest
from ...instances.printable import printable
from ..evaluation import Evaluation, judge
from ..evidence import Evidence
from ..problem import PROBLEMS, Decision, Problem, refuse_settings
from ..programs.cones import KINDS as CONE_KINDS
from ..programs.names import own_names
from ..programs.program import Floats, Program
from ..programs.reductions.units import scaled
from ..references import is_number, vector_of
from ..tolerance import EQUAL, VECTOR

if TYPE_CHECKING:
    import pandas as pd

SHOWN_ROWS = 6
"""Most rows that are named where they contradict each other."""

_WHOLE = 2**53
"""Below it doubles hold every whole number."""


class ArrayProblem(Problem):
    """Find a vector that a program allows, of the best value.

    ``program``: linear or quadratic, mixed-integer or not, with or without cones and circuits. What it was compiled from is forgotten.
    Raises InputError if its arrays do not fit each other, or hold a NaN or an infinite cost or coefficient. Raises UnsupportedError if it
    has several objectives in order of priority, which are those of the problem that it was compiled from.
    """

    family: ClassVar[str] = "arrays"
    notes: tuple[str, ...] = ()

    def __init__(self, program: Program, name: str | None = None) -> None:
        from ..programs.soundness import refuse_numbers

        _check_shapes(program)
        if program.further:
            raise UnsupportedError("a bare program", {"levels of priority"})
        refuse_numbers(program)
        self.program = program
        self.name = name or program.name
        self.problem = "arrays"

    @property
    def senses(self) -> tuple[str, ...]:
        return (self.program.sense,)

    def digest(self) -> str:
        p = self.program
        quadratic: tuple[Any, ...] = ()
        graphs = (part for graph in p.circuits for part in graph.parts())
        if p.quadratic is not None:
            q = p.quadratic.tocsr()
            quadratic = (q.indptr, q.indices, q.data)
        return digest(
            "arrays", p.sense, p.cost, p.lower, p.upper, p.integer, p.row_lower, p.row_upper, p.indptr, p.indices, p.data,
            float(p.offset), *(part for block in p.cones for part in block.parts()), *graphs, *quadratic,
        )  # fmt: skip

    def features(self) -> frozenset[str]:
        """``LP`` always; ``integer``, ``quadratic``, ``cones`` and ``circuits`` where the program has them."""
        p = self.program
        marks = {"integer": p.is_integer, "quadratic": p.quadratic is not None, "cones": bool(p.cones), "circuits": bool(p.circuits)}
        return frozenset({"LP", *(name for name, present in marks.items() if present)})

    def facts(self) -> dict[str, Any]:
        """Sizes of the program."""
        p = self.program
        return {"variables": p.num_variables, "rows": p.num_rows, "entries": len(p.data)}

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the objective and every row, bound, cone, integrality and circuit of the vector ``answer`` of shape (variables,).

        Rows, cones, circuits and the objective are those of the nearest vector within the bounds, its integers whole, if there is one
        within the tolerance. What a row may be broken by is relative to its size; ``concession`` says what that can be worth.
        """
        p, x = self.program, self._vector(answer)
        known = bool(np.isfinite(x).all())
        columns, rows = self._sizes
        with np.errstate(over="ignore", invalid="ignore"):
            fraction = np.where(p.integer, np.abs(x - np.round(x)), 0.0)
            outside = np.maximum(p.lower - x, x - p.upper)
            within = (outside <= VECTOR * columns).all() and (fraction <= VECTOR).all()
            near = np.clip(np.where(p.integer, np.round(x), x), p.lower, p.upper) if within else x
            row = np.repeat(np.arange(p.num_rows), np.diff(p.indptr))
            parts = p.data * near[p.indices]
            activity = np.bincount(row, parts, minlength=p.num_rows) if p.num_rows else np.zeros(0)
            np.maximum.at(rows := rows.copy(), row, np.abs(parts))
            terms = [*(p.cost * near).tolist(), float(p.offset)]
            if p.quadratic is not None:
                terms.append(float(near @ (p.quadratic @ near)) / 2.0)
            value = math.fsum(terms) if known else math.nan
            broken = np.maximum(p.row_lower - activity, activity - p.row_upper)
        judged = [
            judge("bounds", outside, lambda k: _outside(p.variable_name(k), x[k], p.lower[k], p.upper[k]), VECTOR * columns),
            judge("rows", broken, lambda k: _outside(p.row_name(k), activity[k], p.row_lower[k], p.row_upper[k]), VECTOR * rows),
            judge("integrality", fraction, lambda k: f"{p.variable_name(k)} is {x[k]:.9g}, not a whole number", VECTOR),
        ]
        for cones in p.cones:
            size = max(float(np.abs(cones.offset).max(initial=0.0)), float((np.abs(cones.data) * columns[cones.indices]).max(initial=0.0)))
            message = partial("{0} leaves cone number {1}".format, cones.name)
            judged.append(judge(cones.name, cones.excess(near), message, VECTOR * size))
        for graph in p.circuits:
            message = partial("{0} do not make up what they should".format, f"the used arcs of circuit {graph.name}")
            judged.append(judge(graph.name, np.array([graph.excess(near)]), message, VECTOR))
        checks = tuple(check for check, _ in judged)
        violations = tuple(v for _, violated in judged for v in violated)
        return Evaluation((value,), checks, violations, {}, (math.fsum(map(abs, terms)) if known else math.nan,), self._precision)

    def answer_at_hand(self) -> Floats:
        """The vector nearest to 0."""
        p = self.program
        return np.asarray(np.clip(0.0, np.where(p.integer, np.ceil(p.lower), p.lower), np.where(p.integer, np.floor(p.upper), p.upper)))

    @cached_property
    def _precision(self) -> float:
        """Precision of the objective: sums of whole numbers times costs are as exact as any sum."""
        p = self.program
        return EQUAL if p.quadratic is None and bool(p.integer[p.cost != 0].all()) else VECTOR

    @cached_property
    def _sizes(self) -> tuple[Floats, Floats]:
        """Size of each variable and row: the larger of its limits and, unless it is empty, of the unit in which solvers count it."""
        p, units = self.program, scaled(self.program)
        own = [np.where(np.isfinite(end), np.abs(end), 0.0) for end in (p.lower, p.upper, p.row_lower, p.row_upper)]
        columns, rows = np.ldexp(np.ones(p.num_variables), units.columns), np.zeros(p.num_rows)
        filled = np.repeat(np.arange(p.num_rows), np.diff(p.indptr))[p.data != 0]
        rows[filled] = np.ldexp(1.0, -units.rows[filled])
        return np.maximum.reduce([columns, *own[:2]]), np.maximum.reduce([rows, *own[2:]])

    def concession(self, evidence: Evidence, evaluation: Evaluation) -> float:
        """Difference that it makes to the bound of ``evidence`` if every row is as wide as the answer's largest residual."""
        from ..verified_bounds import verified_bound

        residual = next((c.residual for c in evaluation.checks if c.name == "rows"), 0.0)
        if residual == 0.0:
            return 0.0
        rows = tuple(replace(block, lower=block.lower - residual, upper=block.upper + residual) for block in self.program.rows)
        wider = ArrayProblem(replace(self.program, rows=rows), self.name)
        return abs(verified_bound(self, evidence) - verified_bound(wider, evidence))

    def check_statement(self, statement: Any) -> None:
        """``{"variable": column, "most": whole number}``: an integer variable is at most that; all others are then one more at least."""
        known = isinstance(statement, Mapping) and statement.keys() == {"variable", "most"}
        column, most = (statement["variable"], statement["most"]) if known else (None, None)
        if type(column) is not int or type(most) is not int or not 0 <= column < self.program.num_variables or abs(most) >= _WHOLE:
            expected = '{"variable": column, "most": whole number}'
            raise InputError("not a statement on a variable", expected=expected, found=printable(str(statement), 80))
        if not self.program.integer[column]:
            raise InputError(
                f"{self.program.variable_name(column)} is no integer, so it may lie between two whole numbers", "contradiction"
            )

    def restricted(self, decisions: Sequence[Decision]) -> "ArrayProblem":
        """The same arrays with tighter bounds; they may cross."""
        lower, upper = self.program.lower.copy(), self.program.upper.copy()
        for statement, holds in decisions:
            self.check_statement(statement)
            column, most = statement["variable"], statement["most"]
            if holds:
                upper[column] = min(upper[column], most)
            else:
                lower[column] = max(lower[column], most + 1)
        tighter = copy.copy(self)
        tighter.program = self.program.with_bounds(lower, upper)
        tighter.__dict__.pop("_sizes", None)
        return tighter

    def in_words(self, statement: Any, holds: bool) -> str:
        name, most = self.program.variable_name(statement["variable"]), statement["most"]
        return f"{name} <= {most}" if holds else f"{name} >= {most + 1}"

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        if kind != "lp-dual":
            return super().why_none(kind, data)
        ray = data["ray"]
        used = ray["at"] if isinstance(ray, Mapping) else [i for i, factor in enumerate(ray) if factor]
        names = [self.program.row_name(i) for i in used[:SHOWN_ROWS]] + ([f"{len(used) - SHOWN_ROWS} more"] * (len(used) > SHOWN_ROWS))
        rows = f"{'row' if len(used) == 1 else 'rows'} {', '.join(names)} and " if used else ""
        return f"{rows}the bounds cannot be kept together"

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        return {"kind": "vector", "values": self._vector(answer).tolist()}

    def answer_from_json(self, data: Any) -> Floats:
        if not isinstance(data, Mapping) or data.get("kind") != "vector" or not isinstance(data.get("values"), list):
            raise InputError("not an answer to a program", expected='an object {"kind": "vector", "values": [...]}')
        if not all(map(is_number, data["values"])):
            raise InputError("the answer's values must be numbers")
        return self._vector(data["values"])

    def to_instance(self) -> Any:
        raise UsageError(f"{self.name} is a bare program, which problem.program.write('model.mps') writes", "unsupported")

    def answer_of(self, given: Any) -> Floats:
        """A vector of shape (variables,)."""
        return self._vector(given)

    def answer_to_frame(self, answer: Any) -> "pd.DataFrame":
        """One row per variable: variable, value, lower, upper."""
        import pandas as pd

        p = self.program
        names = own_names(p.variables)
        return pd.DataFrame({"variable": names, "value": self._vector(answer), "lower": p.lower, "upper": p.upper})

    def _vector(self, answer: Any) -> Floats:
        x = vector_of(answer)
        if x.shape != (self.program.num_variables,):
            expected = f"({self.program.num_variables},)"
            raise InputError(
                "the answer to a program is a vector with one number a variable", "wrong-shape", expected=expected, found=f"{x.shape}"
            )
        return x


@PROBLEMS.register("arrays")
def _build(program: Any, name: str, settings: dict[str, Any]) -> ArrayProblem:
    if not isinstance(program, Program):
        raise UsageError(f"{program.name} is no bare program, so it cannot be read as {name}", "unsupported")
    refuse_settings(name, settings)
    return ArrayProblem(program)


def _outside(name: str, value: float, low: float, high: float) -> str:
    return f"{name} is {value:.9g}, outside [{low:g}, {high:g}]"


def _check_shapes(program: Program) -> None:
    if program.sense not in ("min", "max"):
        raise InputError("the sense of a program is min or max", "unknown-name", found=str(program.sense))
    for block in program.variables:
        if {len(block.lower), len(block.upper), len(block.cost)} != {block.size}:
            raise InputError(f"the arrays of variables {block.name} have different lengths", "wrong-shape")
    for rows in program.rows:
        if len(rows.upper) != rows.size or len(rows.indptr) != rows.size + 1 or len(rows.indices) != len(rows.data):
            raise InputError(f"the arrays of rows {rows.name} have different lengths", "wrong-shape")
        if rows.indptr[0] != 0 or rows.indptr[-1] != len(rows.data) or (np.diff(rows.indptr) < 0).any():
            raise InputError(f"the row starts of rows {rows.name} do not ascend from 0 to the number of entries")
        if len(rows.indices) and not (rows.indices.min() >= 0 and rows.indices.max() < program.num_variables):
            raise InputError(
                f"rows {rows.name} name a column that does not exist", "unknown-name", expected=f"0 to {program.num_variables - 1}"
            )
    for cones in program.cones:
        if cones.kind not in CONE_KINDS or cones.width < 2 or (cones.kind == "exponential" and cones.width != 3):
            shape = f"{cones.kind} of width {cones.width}"
            raise InputError(f"cones {cones.name} must be second-order of width 2 or more, or exponential of width 3", found=shape)
        if len(cones.offset) % cones.width or len(cones.indptr) != len(cones.offset) + 1 or len(cones.indices) != len(cones.data):
            raise InputError(f"the arrays of cones {cones.name} have different lengths", "wrong-shape")
        if len(cones.indices) and not (cones.indices.min() >= 0 and cones.indices.max() < program.num_variables):
            raise InputError(
                f"cones {cones.name} name a column that does not exist", "unknown-name", expected=f"0 to {program.num_variables - 1}"
            )
    n = program.num_variables
    if program.quadratic is not None and program.quadratic.shape != (n, n):
        raise InputError(
            "the quadratic part has the wrong shape", "wrong-shape", expected=f"({n}, {n})", found=str(program.quadratic.shape)
        )
