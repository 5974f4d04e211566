"""Rows of a tree's branchings: of a set of moves some route makes one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .arcs import Flags, Floats
from .restricted_master import Pool


@dataclass(frozen=True)
class MoveRow:
    """One of ``moves``, shape (nodes, nodes), is made; rows whose moves have the same ``names``, a tail and its heads each, are one row."""

    names: tuple[tuple[str, tuple[str, ...]], ...]
    moves: Flags = field(compare=False)
    sign: int = 1
    right: float = 1.0

    @classmethod
    def of(cls, named: Mapping[str, Sequence[str]], moves: Flags) -> "MoveRow":
        """The row of moves as a statement names them."""
        return cls(tuple((tail, tuple(heads)) for tail, heads in named.items()), moves)

    def missing(self, nodes: int) -> Floats:
        return np.ones(nodes - 1)

    @staticmethod
    def coefficients(rows: "Sequence[MoveRow]", pool: Pool, first: int) -> Floats:
        return np.array([pool.sums(row.moves, first) for row in rows]).T
