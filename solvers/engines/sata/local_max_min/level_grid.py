"""The levels that all robots try: powers of two and equal steps between them, so that the unit of the weights does not matter."""

from __future__ import annotations

import math


class LevelGrid:
    """Levels 2^(j / m) for whole j, with the least m that makes neighbours at most a factor 1 + eps apart.

    Weights times a power of two meet the same levels times that power; and nobody needs to know the weights of others for it.

    Parameters
    ----------
    eps : float
        From above 0 to 1.
    """

    def __init__(self, eps: float) -> None:
        self.parts = math.ceil(math.log(2.0) / math.log1p(eps))

    def number(self, level: float) -> float:
        """The j of a level, not rounded."""
        part, whole = math.frexp(level)
        return whole * self.parts + math.log2(part) * self.parts

    def level(self, j: int) -> float:
        """Level number j."""
        whole, part = divmod(j, self.parts)
        return math.ldexp(2.0 ** (part / self.parts), whole)
