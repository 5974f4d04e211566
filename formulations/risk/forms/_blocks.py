"""Blocks of programs that all forms of risk allocation share: decisions, convex terms, deterministic rows, cones."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...evidence import Evidence
from ...programs.cones import Cones, Floats
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..risk_allocation import Ints, RiskAllocation

SHORTENED = 1e-9
"""Part by which prices of cones are reduced, so that the reduced cost of a variable that only a cone bounds keeps its sign."""


def dense_rows(name: str, matrix: Floats, lower: Any, upper: Any, extra: Any = (), keys: tuple[Ints, ...] = (), labels: Any = ()) -> Rows:
    """A block of rows from a matrix over the first columns, and further parts."""
    row, column = np.nonzero(matrix)
    return rows(name, len(matrix), [(row, column, matrix[row, column]), *extra], lower, upper, keys, labels)


def size_of(problem: RiskAllocation, pieces: int = 0) -> ProgramSize:
    """Size of the program of a form with this many pieces for each constraint, or with fixed margins."""
    terms, cones = problem.terms, problem.cones
    values = float(sum(len(constant) for _, _, _, constant in terms))
    entries = float(np.count_nonzero(problem.rows) + np.count_nonzero(problem.chance))
    entries += 2.0 * sum(np.count_nonzero(matrix) + len(constant) for _, _, matrix, constant in terms)
    entries += sum(np.count_nonzero(matrix) + np.count_nonzero(limit) for matrix, _, limit, _ in cones)
    rows, constraints, decisions = float(len(problem.limits)), float(len(problem.names)), float(len(problem.lower))
    squares = decisions**2 if any(kind == "square" for kind, *_ in terms) else 0.0
    choices = rows if problem.disjunctive else 0.0
    return ProgramSize(
        decisions + values + choices + (2.0 * constraints if pieces else 0.0),
        len(problem.rows) + rows + 2.0 * values + constraints * (pieces + bool(choices)) + len(problem.budgets),
        entries + rows + 3.0 * choices + constraints * (2.0 * pieces + 1.0), work=8.0 * squares,
    )  # fmt: skip


@dataclass
class Blocks:
    """A program under construction; ``columns`` counts its variables."""

    problem: RiskAllocation
    variables: list[Variables] = field(default_factory=list)
    rows: list[Rows] = field(default_factory=list)
    cones: list[Cones] = field(default_factory=list)
    columns: int = 0
    offset: float = 0.0
    squares: list[tuple[float, Floats]] = field(default_factory=list)

    def __post_init__(self) -> None:
        p = self.problem
        linear = p.linear.copy()
        self.offset = p.offset
        for kind, weight, matrix, constant in p.terms:
            if kind == "square":
                linear += p.sign * 2.0 * weight * (constant @ matrix)
                self.offset += p.sign * weight * float(constant @ constant)
                self.squares.append((p.sign * weight, matrix))
        self.add(Variables("x", (np.arange(len(linear)),), (p.instance.decision_names,), p.lower, p.upper, linear))
        if len(p.row_lower):
            names = (p.instance.constraint_names,)
            self.rows.append(dense_rows("constraint", p.rows, p.row_lower, p.row_upper, keys=(np.arange(len(p.rows)),), labels=names))
        for k, (kind, weight, matrix, constant) in enumerate(p.terms):
            if kind == "absolute":
                self._absolute(k, weight, matrix, constant)
            elif kind == "norm":
                self._cone(f"norm-{k + 1}", matrix, constant, [(self.add(self._above(f"norm-{k + 1}", 1, weight)), 1.0)], 0.0)
        for k, (matrix, constant, limit, most) in enumerate(p.cones):
            at = np.nonzero(limit)[0]
            self._cone(f"cone-{k + 1}", matrix, constant, list(zip(at.tolist(), limit[at].tolist(), strict=True)), most)

    def add(self, block: Variables) -> int:
        """Append a block of variables; the column of its first."""
        self.variables.append(block)
        self.columns += block.size
        return self.columns - block.size

    def _above(self, name: str, size: int, weight: float) -> Variables:
        """Variables that stand for the value of a term."""
        return Variables(name, (np.arange(size),), (), np.zeros(size), np.full(size, math.inf), np.full(size, self.problem.sign * weight))

    def _absolute(self, k: int, weight: float, matrix: Floats, constant: Floats) -> None:
        size = len(constant)
        start, each = self.add(self._above(f"absolute-{k + 1}", size, weight)), np.arange(size)
        for name, sign in (("over", 1.0), ("under", -1.0)):
            part = [(each, start + each, -1.0)]
            self.rows.append(dense_rows(f"{name}-{k + 1}", sign * matrix, -math.inf, -sign * constant, part, (each,)))

    def _cone(self, name: str, matrix: Floats, constant: Floats, limit: list[tuple[int, float]], most: float) -> None:
        """The norm of ``matrix x + constant`` is at most the sum of the limit's columns times coefficients, and ``most``."""
        row, column = np.nonzero(matrix)
        rows_at = np.concatenate([np.zeros(len(limit), dtype=np.int64), row + 1])
        columns = np.concatenate([np.array([c for c, _ in limit], dtype=np.int64), column])
        data = np.concatenate([np.array([v for _, v in limit]), matrix[row, column]])
        width = len(constant) + 1
        indptr = np.concatenate([[0], np.cumsum(np.bincount(rows_at, minlength=width))]).astype(np.int32)
        offset = np.concatenate([[most], constant])
        self.cones.append(Cones(name, "second-order", width, indptr, columns.astype(np.int32), data, offset))

    def program(self, name: str) -> Program:
        """All blocks as a program."""
        quadratic = None
        if self.squares:
            import scipy.sparse as sp

            n = len(self.problem.linear)
            dense = np.zeros((n, n))
            for weight, matrix in self.squares:
                dense += 2.0 * weight * (matrix.T @ matrix)
            part = sp.coo_matrix(dense)
            quadratic = sp.csr_matrix((part.data, (part.row, part.col)), shape=(self.columns, self.columns))
        return Program(name, self.problem.senses[0], tuple(self.variables), tuple(self.rows), self.offset, quadratic, tuple(self.cones))


def prices(problem: RiskAllocation, program: Program, x: Floats, duals: Floats, cone_duals: Floats | None = None) -> dict[str, Floats]:
    """Prices of evidence ``risk-allocation-duals``, from the vector, row duals and, where there are cones, cone duals of a solver.

    ``program`` is made of ``Blocks``; row duals are d objective / d right side, cone duals members of the dual cones.
    """
    y, starts, row = problem.sign * duals, {}, 0
    for block in program.rows:
        starts[block.name] = slice(row, row + block.size)
        row += block.size
    terms, cones, at = [], [], 0
    for k, (kind, weight, matrix, constant) in enumerate(problem.terms):
        if kind == "absolute":
            terms.append(y[starts[f"under-{k + 1}"]] - y[starts[f"over-{k + 1}"]])
        elif kind == "square":
            terms.append(2.0 * weight * (matrix @ x[: len(problem.linear)] + constant))
        else:
            assert cone_duals is not None
            terms.append(-cone_duals[at + 1 : at + 1 + len(constant)])
            at += 1 + len(constant)
    for _, constant, _, _ in problem.cones:
        assert cone_duals is not None
        cones.append(cone_duals[at : at + 1 + len(constant)] * (1.0 - SHORTENED))
        at += 1 + len(constant)
    chance = y[starts["chance"]]
    return {
        "rows": y[starts["constraint"]] if "constraint" in starts else np.zeros(0),
        "chance": np.maximum(-chance, 0.0),
        "budgets": np.zeros(0),
        "terms": np.concatenate([np.zeros(0), *terms]),
        "cones": np.concatenate([np.zeros(0), *cones]),
    }


def evidence_of(prices: dict[str, Floats], value: float, source: str, *, infeasible: bool = False) -> Evidence:
    """Evidence ``risk-allocation-duals``."""
    data: dict[str, Any] = {key: _listed(values) for key, values in prices.items()}
    return Evidence("risk-allocation-duals", source, value, {**data, "infeasible": True} if infeasible else data)


def _listed(values: Floats) -> Any:
    """A list, or positions and values of the numbers that are not 0 where these are few."""
    at = np.nonzero(values)[0]
    return values.tolist() if 2 * len(at) > len(values) else {"at": at.tolist(), "values": values[at].tolist()}
