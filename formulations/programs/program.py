"""A mathematical program as plain arrays: blocks of variables and of rows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Floats as Floats
from .circuits import Circuit
from .cones import Cones

if TYPE_CHECKING:
    import scipy.sparse as sp

Indices = NDArray[np.int32]

LINEAR: frozenset[str] = frozenset()
INTEGERS = frozenset({"integers"})
QUADRATIC = frozenset({"quadratic-objective"})
CONES = frozenset({"second-order-cones", "exponential-cones"})
CIRCUITS = frozenset({"circuits"})


@dataclass(frozen=True, eq=False)
class Block:
    """Names of a block, made only when asked for.

    ``name``: "x", "time", ... ``keys``: one array an index position, each with one entry per variable or row: (i, j, k) of ``x[i,j,k]``.
    ``labels``, or None: what an index is called (site ids); None leaves the number.
    """

    name: str
    keys: tuple[NDArray[np.integer[Any]], ...] = ()
    labels: tuple[Sequence[str] | None, ...] = ()

    def label(self, k: int) -> str:
        """Name of entry ``k``, such as ``time[17,4,2]``."""
        parts = []
        for position, key in enumerate(self.keys):
            names = self.labels[position] if position < len(self.labels) else None
            parts.append(str(int(key[k])) if names is None else str(names[int(key[k])]))
        return f"{self.name}[{','.join(parts)}]" if parts else self.name


@dataclass(frozen=True, eq=False)
class Variables(Block):
    """A block of variables.

    Parameters
    ----------
    name, keys, labels
        What it is called, such as "x"; arrays of the indices of each variable, (i, j, k) of ``x[i,j,k]``; and what an index is called.
    lower, upper, cost : array of shape (size,)
        Bounds, infinite where there is none, and coefficients of the objective.
    integer : bool
        Whether they take whole values alone.
    """

    lower: Floats = field(default_factory=lambda: np.zeros(0))
    upper: Floats = field(default_factory=lambda: np.zeros(0))
    cost: Floats = field(default_factory=lambda: np.zeros(0))
    integer: bool = False

    @property
    def size(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, eq=False)
class Rows(Block):
    """A block of rows ``lower <= A x <= upper``.

    Parameters
    ----------
    name, keys, labels
        As of ``Variables``, a row each.
    indptr, indices, data : arrays
        A in CSR form; column indices count over the whole program.
    lower, upper : array of shape (size,)
        Infinite where a side is open.
    """

    indptr: Indices = field(default_factory=lambda: np.zeros(1, dtype=np.int32))
    indices: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    data: Floats = field(default_factory=lambda: np.zeros(0))
    lower: Floats = field(default_factory=lambda: np.zeros(0))
    upper: Floats = field(default_factory=lambda: np.zeros(0))

    @property
    def size(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, eq=False)
class FurtherLevel:
    """An objective that decides among the optima of those before it: ``cost x + offset``, ``cost`` of shape (variables,)."""

    sense: str
    cost: Floats
    offset: float = 0.0

    def value(self, x: Floats) -> float:
        """Value of the vector ``x`` of shape (variables,)."""
        return float(self.cost @ x) + self.offset


def _joined_blocks(blocks: str, name: str) -> cached_property[Floats]:
    """Array ``name`` of all blocks of a program, one after the other."""
    return cached_property(lambda program: _joined([getattr(block, name) for block in getattr(program, blocks)], np.float64))


@dataclass(frozen=True, eq=False)
class Program:
    """minimise or maximise ``cost x + x' quadratic x / 2 + offset`` over rows, bounds and integrality: arrays and nothing else.

    Parameters
    ----------
    name : str
        For models and error messages; that of the form, where a form made it.
    sense : str
        ``min`` or ``max``.
    variables, rows : tuples of blocks
        ``Variables`` and ``Rows``; columns and rows are numbered through all blocks.
    offset : float
        Constant of the objective.
    quadratic : scipy.sparse matrix of shape (variables, variables), optional
        Symmetric.
    cones : tuple of Cones
        Blocks of second-order and exponential cones, for backends that take them.
    circuits : tuple of Circuit
        Graphs whose used arcs make up circuits, for backends that take them.
    further : tuple of FurtherLevel
        Objectives after the first one, in order of priority. All that asks for one objective means the first.
    """

    name: str
    sense: str
    variables: tuple[Variables, ...]
    rows: tuple[Rows, ...]
    offset: float = 0.0
    quadratic: sp.csr_matrix | None = None
    cones: tuple[Cones, ...] = ()
    further: tuple[FurtherLevel, ...] = ()
    circuits: tuple[Circuit, ...] = ()

    # -- the whole, as arrays ----------------------------------------------------------------------------------------

    cost = _joined_blocks("variables", "cost")
    lower = _joined_blocks("variables", "lower")
    upper = _joined_blocks("variables", "upper")
    row_lower = _joined_blocks("rows", "lower")
    row_upper = _joined_blocks("rows", "upper")
    data = _joined_blocks("rows", "data")

    @property
    def num_variables(self) -> int:
        return sum(b.size for b in self.variables)

    @property
    def num_rows(self) -> int:
        return sum(b.size for b in self.rows)

    @cached_property
    def integer(self) -> NDArray[np.bool_]:
        return np.repeat([b.integer for b in self.variables], [b.size for b in self.variables]).astype(bool)

    @cached_property
    def indices(self) -> Indices:
        return _joined([b.indices for b in self.rows], np.int32)

    @cached_property
    def indptr(self) -> Indices:
        starts = np.cumsum([0] + [len(b.indices) for b in self.rows])
        parts = [b.indptr[:-1] + start for b, start in zip(self.rows, starts[:-1], strict=True)]
        return _joined([*parts, starts[-1:]], np.int32)

    @property
    def matrix(self) -> sp.csr_matrix:
        """The rows as one scipy CSR matrix."""
        import scipy.sparse as sp

        return sp.csr_matrix((self.data, self.indices, self.indptr), shape=(self.num_rows, self.num_variables))

    @property
    def is_integer(self) -> bool:
        return any(b.integer and b.size for b in self.variables)

    def features(self) -> frozenset[str]:
        """Features that a solver must take, beyond linear programs: ``INTEGERS``, ``QUADRATIC``, ``CIRCUITS`` and of ``CONES``."""
        held = ((INTEGERS, self.is_integer), (QUADRATIC, self.quadratic is not None), (CIRCUITS, self.circuits))
        return LINEAR.union(*(mark for mark, present in held if present), {f"{block.kind}-cones" for block in self.cones})

    @property
    def kind(self) -> str:
        """``described(features())``."""
        return described(self.features())

    def with_bounds(self, lower: Floats, upper: Floats) -> Program:
        """The same with other bounds of the variables, shape (variables,) each; all other arrays are shared."""
        ends = np.cumsum([b.size for b in self.variables])[:-1]
        blocks = zip(self.variables, np.split(lower, ends), np.split(upper, ends), strict=True)
        program = replace(self, variables=tuple(replace(b, lower=low, upper=high) for b, low, high in blocks))
        shared = {name: getattr(self, name) for name in ("cost", "integer", "row_lower", "row_upper", "indptr", "indices", "data")}
        program.__dict__.update(shared, lower=lower, upper=upper)
        return program

    def with_costs(self, cost: Floats) -> Program:
        """The same with another linear objective, shape (variables,)."""
        ends = np.cumsum([b.size for b in self.variables])[:-1]
        blocks = zip(self.variables, np.split(cost, ends), strict=True)
        return replace(self, variables=tuple(replace(block, cost=part) for block, part in blocks))

    def first_level(self) -> Program:
        """The same without the objectives after the first one."""
        return replace(self, further=()) if self.further else self

    def levels(self) -> list[Program]:
        """One program per objective, in order of priority, none with rows that keep the levels before."""
        first = self.first_level()
        return [first, *(replace(first.with_costs(level.cost), sense=level.sense, offset=level.offset) for level in self.further)]

    # -- names -------------------------------------------------------------------------------------------------------

    def variable_name(self, column: int) -> str:
        """Name of a column, such as ``x[3,7]``."""
        return _name(self.variables, column)

    def row_name(self, row: int) -> str:
        """Name of a row, such as ``time[17,4,2]``."""
        return _name(self.rows, row)

    # -- judging a vector --------------------------------------------------------------------------------------------

    def value(self, x: Floats) -> float:
        """Objective of the vector ``x`` of shape (variables,)."""
        total = float(self.cost @ x) + self.offset
        if self.quadratic is not None:
            total += float(x @ (self.quadratic @ x)) / 2.0
        return total

    def residual(self, x: Floats) -> float:
        """Largest violation of a row, a bound, a cone, integrality or circuit by ``x``."""
        if x.shape != (self.num_variables,) or not np.isfinite(x).all():
            return math.inf
        ax = self.matrix @ x
        gaps = [self.lower - x, x - self.upper, self.row_lower - ax, ax - self.row_upper, np.abs(x - np.round(x))[self.integer]]
        gaps.extend(block.excess(x) for block in self.cones)
        return max([*(float(g.max(initial=0.0)) for g in gaps), *(graph.excess(x) for graph in self.circuits)])

    # -- hand over ---------------------------------------------------------------------------------------------------

    def write(self, path: str | PathLike[str]) -> None:
        """Write as MPS or LP, by the suffix; atomic."""
        from .export import write_program

        write_program(self, path)

    def to_highs(self, *, names: bool = False) -> Any:
        """A ``highspy.Highs`` model, ready to run."""
        from .export.models import to_highs

        return to_highs(self, names=names)

    def to_pulp(self, *, names: bool = False) -> Any:
        """A ``pulp.LpProblem``; without names ``variables()`` lists them in column order, as ``x`` and the column, padded with zeros."""
        from .export.models import to_pulp

        return to_pulp(self, names=names)

    def to_cvxpy(self) -> Any:
        """A ``cvxpy.Problem`` with one vector variable per block."""
        from .export.cvxpy import to_cvxpy

        return to_cvxpy(self)

    def to_mathopt(self, *, names: bool = False) -> Any:
        """An OR-Tools ``mathopt.Model``."""
        from .export.models import to_mathopt

        return to_mathopt(self, names=names)

    def __repr__(self) -> str:
        return f"<Program {self.name}: {self.kind}, {self.num_variables} variables, {self.num_rows} rows, {len(self.data)} nonzeros>"


def described(features: frozenset[str]) -> str:
    """Features in the usual words: ``LP``, ``MILP``, ``QP``, ``MIQP``, and ``cone`` or ``circuit`` before them where there are any."""
    more = "cone " * bool(features & CONES) + "circuit " * (features >= CIRCUITS)
    return more + "MI" * (features >= INTEGERS) + ("QP" if features >= QUADRATIC else "LP")


def _joined(parts: Sequence[NDArray[Any]], dtype: Any) -> NDArray[Any]:
    return np.concatenate(parts).astype(dtype, copy=False) if parts else np.zeros(0, dtype=dtype)


def _name(blocks: Sequence[Variables] | Sequence[Rows], position: int) -> str:
    for block in blocks:
        if position < block.size:
            return block.label(position) if block.keys or block.size == 1 else f"{block.name}[{position}]"
        position -= block.size
    raise IndexError(position)
