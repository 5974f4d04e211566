"""Packing and covering data: two nonnegative matrices over the same variables."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..declared import CountOf, Declared, Names
from ..document import array, fields, integer, json_numbers, kind_of, reals, string, strings, wholes
from ..errors import InputError
from ..instance import digest
from ..number_arrays import Floats
from ..parts import Axis

Indices = NDArray[np.int32]

MATRIX_KEYS = ("rows", "row", "variable", "value")
"""Columns of a matrix in JSON."""


@dataclass(frozen=True, eq=False)
class SparseMatrix:
    """A nonnegative matrix in CSR form: ascending columns within a row, none twice, values positive and finite."""

    indptr: Indices
    indices: Indices
    data: Floats
    columns: int

    @classmethod
    def of(cls, matrix: Any) -> "SparseMatrix":
        """A matrix from a sparse one of scipy or anything that numpy takes for a matrix; zeros are left out."""
        import scipy.sparse as sp

        try:
            a = sp.csr_matrix(matrix, dtype=np.float64, copy=True)  # what follows works in place
        except (TypeError, ValueError) as error:
            raise InputError("a matrix of numbers is needed", found=str(error)[:80]) from None
        a.sum_duplicates()
        a.eliminate_zeros()
        a.sort_indices()
        return cls(arrays.indices("indptr", a.indptr), arrays.indices("indices", a.indices), a.data, int(a.shape[1]))

    def __post_init__(self) -> None:
        for key in ("indptr", "indices"):
            object.__setattr__(self, key, arrays.indices(key, getattr(self, key)))
        object.__setattr__(self, "data", arrays.reals("coefficients", self.data))
        object.__setattr__(self, "columns", arrays.size("columns", self.columns))
        arrays.check_csr(self.indptr, self.indices, self.columns, "row", "column", "entries")
        if self.data.shape != self.indices.shape:
            raise InputError("there must be one value an entry", "wrong-shape", expected=str(len(self.indices)), found=str(self.data.shape))
        if not (np.isfinite(self.data).all() and (self.data > 0).all()):
            k = int(np.argmax(~np.isfinite(self.data) | (self.data <= 0)))
            raise InputError("coefficients must be positive and finite; zeros are left out", "out-of-range", found=str(self.data[k]))

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        return {"rows": self.rows, "entries": len(self.data), "longest_row": int(np.diff(self.indptr).max(initial=0))}

    def __repr__(self) -> str:
        return f"<SparseMatrix: {self.rows} rows, {self.columns} columns, {len(self.data)} entries>"

    @property
    def rows(self) -> int:
        return len(self.indptr) - 1

    @property
    def scipy(self) -> Any:
        """As a ``scipy.sparse.csr_matrix``."""
        import scipy.sparse as sp

        return sp.csr_matrix((self.data, self.indices, self.indptr), shape=(self.rows, self.columns))


@dataclass(frozen=True, eq=False, repr=False)
class MaxMinInstance(Declared):
    """Packing rows A and covering rows C over variables x >= 0.

    ``sense`` ``max``: maximise the least entry of C x subject to A x <= 1. ``sense`` ``min``: minimise the largest entry of A x
    subject to C x >= 1.

    ``packing`` and ``covering``: at least one row each; for ``max`` every variable of C stands in a row of A (else it is unbounded), for
    ``min`` every row of C holds a variable (else nothing covers it). ``variable_names``: none stands for "1", "2", ...
    """

    kind = "max-min"
    problem_names = ("max-min-lp",)
    lists_problems = True
    content = "packing and covering rows"
    default_name = "max-min-lp"
    axes = (Axis("variable", table=False, least=0),)
    own_keys = ("sense", "variables", "packing", "covering")
    packing: SparseMatrix
    covering: SparseMatrix
    sense: str = "max"
    variable_names: Names = None
    num_variables = CountOf("variable")

    def arrange(self) -> None:
        n = self.counts["variable"] = self.packing.columns
        if self.covering.columns != n:
            raise InputError(
                "packing and covering rows must be over the same variables",
                "wrong-shape",
                expected=str(n),
                found=str(self.covering.columns),
            )
        arrays.refuse_unused("variables", n, len(self.packing.indices) + len(self.covering.indices), "entries")
        if self.sense not in ("max", "min"):
            raise InputError("the sense must be max (max-min) or min (min-max)", "unknown-name", found=str(self.sense))
        if not self.packing.rows or not self.covering.rows:
            raise InputError("there must be at least one packing row and one covering row", "missing")

    def check_rest(self) -> None:
        if self.sense == "max":
            free = np.setdiff1d(self.covering.indices, self.packing.indices)
            if len(free):
                raise InputError(f"variable {free[0]} covers but is in no packing row: it is not bounded", "contradiction")
        elif (np.diff(self.covering.indptr) == 0).any():
            raise InputError(
                f"covering row {int(np.argmin(np.diff(self.covering.indptr))) + 1} holds no variable: nothing can cover it", "missing"
            )

    def summary(self) -> Iterable[str]:
        rows = f"{self.packing.rows} packing and {self.covering.rows} covering rows"
        return (self.sense, *super().summary(), rows)

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        a, c = self.packing, self.covering
        return digest(self.kind, self.sense, a.columns, a.indptr, a.indices, a.data, c.indptr, c.indices, c.data)

    def write_own(self) -> dict[str, Any]:
        variables = self.num_variables if self.variable_names is None else list(self.variable_names)
        data = {"sense": self.sense, "variables": variables}
        return {**data, "packing": _written_matrix(self.packing), "covering": _written_matrix(self.covering)}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        variables, names = data["variables"], None
        if isinstance(variables, list):
            names, count = strings(variables, "variables"), len(variables)
        elif isinstance(variables, int):
            count = integer(variables, "variables", 1)
        else:
            raise InputError("variables must be a list of names or a whole number", found=kind_of(variables))
        matrices = {key: _read_matrix(data[key], key, count) for key in ("packing", "covering")}
        return {**matrices, "sense": string(data["sense"], "sense"), "variable_names": names}


def _written_matrix(matrix: SparseMatrix) -> dict[str, Any]:
    row = np.repeat(np.arange(matrix.rows), np.diff(matrix.indptr))
    data: dict[str, Any] = {"rows": matrix.rows, "row": row.tolist(), "variable": matrix.indices.tolist()}
    return data if (matrix.data == 1.0).all() else {**data, "value": json_numbers(matrix.data)}


def _read_matrix(data: Any, path: str, columns: int) -> SparseMatrix:
    """A matrix from columns of entries, in any order."""
    fields(data, path, MATRIX_KEYS, ("rows", "row", "variable"))
    rows = integer(data["rows"], f"{path}.rows", 1)
    row = wholes(data["row"], f"{path}.row")
    column = wholes(data["variable"], f"{path}.variable", len(row))
    value = reals(data["value"], f"{path}.value", len(row)) if "value" in data else np.ones(len(array(data["row"], f"{path}.row")))
    arrays.refuse_unused(f"rows of {path}", rows, len(row), "entries")
    arrays.refuse_outside(f"{path}.row[{{}}]", row, rows, "row")
    arrays.refuse_outside(f"{path}.variable[{{}}]", column, columns, "variable")
    wrong = ~(value > 0)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{path}.value[{k}] must be positive", "out-of-range", found=str(value[k]))
    order = np.lexsort([column, row])
    row, column, value = row[order], column[order], value[order]
    twice = np.nonzero((np.diff(row) == 0) & (np.diff(column) == 0))[0]
    if len(twice):
        raise InputError(f"{path} has two entries in row {row[twice[0]] + 1} for variable {column[twice[0]]}", "duplicate")
    return SparseMatrix(arrays.row_starts(row, rows), column, value, columns)  # type: ignore[arg-type]
