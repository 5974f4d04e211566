"""Rows with one side, or two equal ones, for modelling layers that know no ranges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .reduction import Reduction, Step

if TYPE_CHECKING:
    from ..program import Floats, Indices, Program, Rows


@dataclass(frozen=True, eq=False, kw_only=True)
class OneSided(Step):
    """A program with ranges split; ``rows`` of shape (rows of the result,) holds the row that each was made of."""

    name = "one-sided-rows"
    rows: Indices
    num_rows: int

    def duals(self, duals: Floats) -> Floats:
        return np.asarray(np.bincount(self.rows, duals, minlength=self.num_rows), dtype=np.float64)


class OneSidedRows(Reduction):
    """Splits rows with two different finite sides; the lower ones come last, as blocks named ``low``."""

    def apply(self, program: Program) -> tuple[OneSided, ...]:
        ranges = [(b.lower != b.upper) & np.isfinite(b.lower) & np.isfinite(b.upper) for b in program.rows]
        if not any(r.any() for r in ranges):
            return ()
        upper, lower, origins, first = [], [], [], 0
        for block, split in zip(program.rows, ranges, strict=True):
            upper.append(replace(block, lower=np.where(split, -np.inf, block.lower)))
            if split.any():
                lower.append(_below(block, split))
                origins.append(first + np.nonzero(split)[0])
            first += block.size
        rows = np.concatenate([np.arange(first), *origins])
        note = f"{len(rows) - first} ranges split"
        return (OneSided(program=replace(program, rows=(*upper, *lower)), told=note, rows=rows, num_rows=first),)


def _below(block: Rows, split: np.ndarray) -> Rows:
    """Rows of the lower sides of ``split``."""
    widths = np.diff(block.indptr)
    entries = np.repeat(split, widths)
    return replace(
        block, name=f"{block.name}.low", keys=tuple(key[split] for key in block.keys),
        indptr=np.concatenate([[0], np.cumsum(widths[split])]).astype(np.int32), indices=block.indices[entries],
        data=block.data[entries], lower=block.lower[split], upper=np.full(int(split.sum()), np.inf),
    )  # fmt: skip


ONE_SIDED_ROWS = OneSidedRows()
