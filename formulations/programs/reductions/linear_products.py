r"""Products of a binary and a bounded variable, written with linear rows.

With z = b y, b binary and l <= y <= u, an objective that would have z large needs only the rows ::

    z <= u b,    z <= y - l (1 - b)

and one that would have it small only ``z >= l b`` and ``z >= y - u (1 - b)``: at b = 0 and b = 1 they leave z = b y as its best value.

Source: McCormick (1976), Mathematical Programming 10, 147-175; Glover (1975), Management Science 22, 455-460.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..program import INTEGERS, QUADRATIC, Floats, Program, Rows, Variables
from .reduction import Irreducible, Reduction, Step

if TYPE_CHECKING:
    import scipy.sparse as sp


@dataclass(frozen=True, eq=False, kw_only=True)
class Linearised(Step):
    """A program whose products are variables after its own; ``pairs`` of shape (products, 2) holds the columns of their factors."""

    name = "linear-products"
    columns: int
    rows: int
    pairs: np.ndarray

    def vector(self, x: Floats) -> Floats:
        return x[: self.columns]

    def encoded(self, x: Floats) -> Floats:
        return np.concatenate([x, x[self.pairs].prod(axis=1)])

    def duals(self, duals: Floats) -> Floats:
        return duals[: self.rows]


class LinearProducts(Reduction):
    """Linearises the quadratic objective of programs with integers, exactly; a continuous one is left alone."""

    may_refuse = True

    def features(self, features: frozenset[str]) -> frozenset[str]:
        return features - QUADRATIC if features >= INTEGERS | QUADRATIC else features

    def apply(self, program: Program) -> tuple[Step, ...]:
        if program.quadratic is None or not program.is_integer:
            return ()
        import scipy.sparse as sp

        upper = sp.coo_matrix(sp.triu(program.quadratic))
        i, j, q = upper.row.astype(np.int64), upper.col.astype(np.int64), upper.data
        binary = program.integer & (program.lower >= 0) & (program.upper <= 1)
        keep = q != 0
        i, j, q = i[keep], j[keep], q[keep]
        square = i == j
        if not binary[i[square]].all():
            raise Irreducible("squares of variables that are not binary")
        cost = program.cost + np.bincount(i[square], q[square] / 2.0, minlength=program.num_variables)
        i, j, q = i[~square], j[~square], q[~square]
        b, y = np.where(binary[i], i, j), np.where(binary[i], j, i)
        if not binary[b].all():
            raise Irreducible("products of which neither variable is binary")
        low, high = program.lower[y], program.upper[y]
        if not (np.isfinite(low) & np.isfinite(high)).all():
            raise Irreducible("products with a variable that has no bounds")
        n, count = program.num_variables, len(q)
        z = Variables(
            "product", (b, y), lower=np.minimum(low, 0.0), upper=np.maximum(high, 0.0), cost=q,
        )  # fmt: skip
        large = (q > 0) == (program.sense == "max")
        near, far = np.where(large, high, low), np.where(large, low, high)
        own, every, shape = n + np.arange(count), np.arange(count), (count, n + count)
        ones = np.ones(count)
        at_0 = sp.csr_matrix((np.concatenate([ones, -near]), (np.tile(every, 2), np.concatenate([own, b]))), shape)
        at_1 = sp.csr_matrix((np.concatenate([ones, -ones, -far]), (np.tile(every, 3), np.concatenate([own, y, b]))), shape)
        wanted = (_rows("product_of_0", at_0, large, np.zeros(count)), _rows("product_of_1", at_1, large, 0.0 - far))
        ends = np.cumsum([0, *(v.size for v in program.variables)])
        blocks = tuple(replace(v, cost=cost[s:e]) for v, s, e in zip(program.variables, ends[:-1], ends[1:], strict=True))
        linear = replace(program, variables=(*blocks, z), rows=(*program.rows, *wanted), quadratic=None)
        note = f"{count} products, {int(square.sum())} squares"
        return (Linearised(program=linear, told=note, columns=n, rows=program.num_rows, pairs=np.stack([b, y], axis=1)),)


def _rows(name: str, matrix: "sp.csr_matrix", most: np.ndarray, side: Floats) -> Rows:
    """Rows ``matrix x <= side`` where ``most``, else ``>=``."""
    matrix.eliminate_zeros()
    matrix.sort_indices()
    return Rows(
        name, (np.arange(len(side)),), indptr=matrix.indptr.astype(np.int32), indices=matrix.indices.astype(np.int32), data=matrix.data,
        lower=np.where(most, -np.inf, side), upper=np.where(most, side, np.inf),
    )  # fmt: skip


LINEAR_PRODUCTS = LinearProducts()
