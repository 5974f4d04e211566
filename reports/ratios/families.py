"""Families of instances: seeded random ones, and adversarial ones whose optimum is known by construction."""

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .judged_runs import Case

Make = Callable[[int, np.random.Generator], Case]


@dataclass(frozen=True)
class Family:
    """A family of instances: ``make(k, rng)`` returns case number k; ``size`` is None for random ones, which there are as many of as asked
    for.

    A guarantee in expectation is tested on ``effort`` times as many runs: few instances need many.
    """

    name: str
    summary: str
    make: Make
    size: int | None = None
    effort: int = 1

    def case(self, k: int, seed: int) -> Case:
        """Case number ``k``; the same for the same seed, regardless of other draws."""
        return self.make(k, np.random.default_rng([seed, zlib.crc32(self.name.encode()), k]))

    def named(self, name: str) -> "Family":
        """The same family under another name, with random cases of its own."""
        return replace(self, name=name)

    def count(self, wanted: int) -> int:
        """How many cases to take when ``wanted`` random ones are asked for."""
        return wanted if self.size is None else self.size


def listed(name: str, summary: str, cases: Sequence[Callable[[], Case]]) -> Family:
    """A family of a few cases, each made on demand."""
    return Family(name, summary, lambda k, rng: cases[k](), len(cases))
