"""Second-order and exponential cones, as blocks of affine images of a program's variables."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Floats as Floats

if TYPE_CHECKING:
    import scipy.sparse as sp

Indices = NDArray[np.int32]

KINDS = ("second-order", "exponential")


@dataclass(frozen=True, eq=False)
class Cones:
    """Cones of one kind and width: rows ``A x + b``, ``width`` of them a cone, must lie in it.

    ``second-order``: (t, v) with t >= Euclidean norm of v. ``exponential``: (a, b, c) with b > 0 and b exp(a / b) <= c, or its limit
    a <= 0, b = 0, c >= 0; width 3.

    Parameters
    ----------
    name : str
    kind : str
        ``second-order`` or ``exponential``.
    width : int
    indptr, indices, data : arrays
        A in CSR form; column indices count over the whole program.
    offset : array of shape (rows,)
        b; the number of rows is a multiple of ``width``.
    """

    name: str
    kind: str
    width: int
    indptr: Indices
    indices: Indices
    data: Floats
    offset: Floats

    @property
    def size(self) -> int:
        """Number of cones."""
        return len(self.offset) // self.width

    def matrix(self, columns: int) -> "sp.csr_matrix":
        """A as a scipy CSR matrix over ``columns`` variables."""
        import scipy.sparse as sp

        return sp.csr_matrix((self.data, self.indices, self.indptr), shape=(len(self.offset), columns))

    def excess(self, x: Floats) -> Floats:
        """Violation of each cone by the vector ``x``, at most 0 where it holds; shape (size,)."""
        row = np.repeat(np.arange(len(self.offset)), np.diff(self.indptr))
        image = self.offset + np.bincount(row, self.data * x[self.indices], minlength=len(self.offset))
        parts = image.reshape(self.size, self.width)
        if self.kind == "second-order":
            return np.asarray(np.linalg.norm(parts[:, 1:], axis=1) - parts[:, 0])
        a, b, c = parts.T
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            inside = np.where(b > 0, b * np.exp(a / b) - c, np.maximum.reduce([a, -b, -c]))
        return np.where(np.isnan(inside), np.inf, inside)

    def parts(self) -> tuple[Any, ...]:
        """Data that a digest covers."""
        return (self.kind, self.width, self.indptr, self.indices, self.data, self.offset)
