"""Packing and covering data: two nonnegative matrices over the same variables."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class SparseMatrix:
    """A nonnegative matrix in CSR form: ascending columns within a row, none twice, values positive and finite."""

    indptr: Indices
    indices: Indices
    data: Floats
    columns: int

    @classmethod
    def of(cls, matrix: Any) -> SparseMatrix:
        """From a scipy sparse matrix or anything that numpy takes for a matrix; zeros are left out."""
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
            raise InputError("there must be one value an entry", expected=str(len(self.indices)), found=str(self.data.shape))
        if not (np.isfinite(self.data).all() and (self.data > 0).all()):
            k = int(np.argmax(~np.isfinite(self.data) | (self.data <= 0)))
            raise InputError("coefficients must be positive and finite; zeros are left out", found=str(self.data[k]))

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


@dataclass(frozen=True, eq=False)
class MaxMinInstance:
    """Packing rows A and covering rows C over variables x >= 0.

    ``sense`` ``max``: maximise the least entry of C x subject to A x <= 1. ``sense`` ``min``: minimise the largest entry of A x
    subject to C x >= 1.

    Parameters
    ----------
    packing, covering : SparseMatrix
        At least one row each; for ``max`` every variable of C stands in a row of A (else it is unbounded), for ``min`` every
        row of C holds a variable (else nothing covers it).
    variable_names : tuple of str, optional
        None stands for "1", "2", ...
    """

    kind: ClassVar[str] = "max-min"
    packing: SparseMatrix
    covering: SparseMatrix
    sense: str = "max"
    variable_names: tuple[str, ...] | None = None
    name: str = "max-min-lp"
    format: str = "arrays"
    problem: str = "max-min-lp"
    problems: tuple[str, ...] = ("max-min-lp",)
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        n = self.packing.columns
        if self.covering.columns != n:
            raise InputError("packing and covering rows must be over the same variables", expected=str(n), found=str(self.covering.columns))
        arrays.refuse_unused("variables", n, len(self.packing.indices) + len(self.covering.indices), "entries")
        if self.sense not in ("max", "min"):
            raise InputError("the sense must be max (max-min) or min (min-max)", found=str(self.sense))
        if not self.packing.rows or not self.covering.rows:
            raise InputError("there must be at least one packing row and one covering row")
        object.__setattr__(self, "name", label(self.name))
        object.__setattr__(self, "variable_names", arrays.names("variable", self.variable_names, n))
        if self.sense == "max":
            free = np.setdiff1d(self.covering.indices, self.packing.indices)
            if len(free):
                raise InputError(f"variable {free[0]} covers but is in no packing row: it is not bounded")
        elif (np.diff(self.covering.indptr) == 0).any():
            raise InputError(f"covering row {int(np.argmin(np.diff(self.covering.indptr))) + 1} holds no variable: nothing can cover it")

    def __repr__(self) -> str:
        rows = f"{self.packing.rows} packing and {self.covering.rows} covering rows"
        return f"<MaxMinInstance {self.name}: {self.sense}, {self.num_variables} variables, {rows}>"

    @property
    def num_variables(self) -> int:
        return self.packing.columns

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        a, c = self.packing, self.covering
        return digest("max-min", self.sense, a.columns, a.indptr, a.indices, a.data, c.indptr, c.indices, c.data)
