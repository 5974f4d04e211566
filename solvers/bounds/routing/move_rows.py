"""Rows of a tree's branchings: of a set of moves some route makes one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .arcs import Flags, Floats
from .restricted_master import Pool


@dataclass(frozen=True, eq=False)
class MoveRow:
    """One of ``moves``, shape (nodes, nodes), is made; ``named`` says which these are, as statements do."""

    moves: Flags
    named: Mapping[str, Sequence[str]]
    sign: int = 1
    right: float = 1.0

    def missing(self, nodes: int) -> Floats:
        return np.ones(nodes - 1)

    @staticmethod
    def coefficients(rows: Sequence[MoveRow], pool: Pool, first: int) -> Floats:
        return np.array([pool.sums(row.moves, first) for row in rows]).T
