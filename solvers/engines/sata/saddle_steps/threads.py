"""Threads that share the loops over a graph or a matrix; docs/saddle.md#threads."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

Parts = tuple[tuple[int, int], ...]
"""First row and end of what each thread has."""

LEAST_SHARED = 2e5
"""Entries that a step reads from which on threads share it: below, waiting for each other takes longer."""


class Threads:
    """Threads that each have a part of the rows of a compiled loop.

    A row is written by one thread alone, and what is summed over rows is summed afterwards by one, in their order: numbers are the same
    to the bit for any number of threads. Where a step reads less than ``LEAST_SHARED`` there is one.
    """

    def __init__(self, count: int, entries: float) -> None:
        self.count = count = count if entries >= LEAST_SHARED else 1
        self._pool = ThreadPoolExecutor(count - 1) if count > 1 else None

    def cut(self, starts: NDArray[np.integer[Any]]) -> Parts:
        """Parts of as many entries each, for rows of which row k has those from ``starts[k]`` to ``starts[k + 1]``."""
        ends = np.searchsorted(starts, np.linspace(int(starts[0]), int(starts[-1]), self.count + 1)).tolist()
        ends[0], ends[-1] = 0, len(starts) - 1
        return tuple(itertools.pairwise(ends))

    def share(self, loop: Callable[..., Any], parts: Parts, *given: Any) -> None:
        """``loop(*given, first, end)`` for each part, at the same time."""
        others = [] if self._pool is None else [self._pool.submit(loop, *given, *part) for part in parts[1:]]
        loop(*given, *parts[0])
        for other in others:
            other.result()
