"""Blocks of rows from numpy arrays, without a matrix library."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .program import Rows

Ints = NDArray[np.integer[Any]]
Part = tuple[Ints, Ints, ArrayLike]
"""Row, column and coefficient of some entries, broadcast against each other."""


def rows(
    name: str,
    size: int,
    parts: Sequence[Part],
    lower: ArrayLike = -math.inf,
    upper: ArrayLike = math.inf,
    keys: tuple[Ints, ...] = (),
    labels: tuple[Sequence[str] | None, ...] = (),
) -> Rows:
    """A block of ``size`` rows from its entries; no row may hold a column twice."""
    row = np.concatenate([np.asarray(r, dtype=np.int64) for r, _, _ in parts]) if parts else np.zeros(0, np.int64)
    column = np.concatenate([np.asarray(c, dtype=np.int32) for _, c, _ in parts]) if parts else np.zeros(0, np.int32)
    data = np.concatenate([np.broadcast_to(np.asarray(v, dtype=np.float64), len(r)) for r, _, v in parts]) if parts else np.zeros(0)
    order = np.argsort(row, kind="stable")
    indptr = np.zeros(size + 1, dtype=np.int32)
    np.cumsum(np.bincount(row, minlength=size), out=indptr[1:])
    return Rows(
        name, keys, labels, indptr=indptr, indices=column[order], data=data[order],
        lower=np.array(np.broadcast_to(np.asarray(lower, dtype=np.float64), size)),
        upper=np.array(np.broadcast_to(np.asarray(upper, dtype=np.float64), size)),
    )  # fmt: skip
