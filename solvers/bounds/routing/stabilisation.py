"""Prices at which column generation looks for routes next, so that these do not jump about: near the best so far, or within a box.

``smoothing``: at the mean of the prices that the linear program has and those of the best Lagrangian bound (Wentges 1997), and at the
former where that finds nothing. ``trust-region``: at prices that the linear program may not have further than a radius from a centre, which
moves where the bound rises (Kallehauge, Larsen, Madsen 2006). ``none``: at the prices that the linear program has. All end at the same
value, at which nothing holds the linear program back. docs/branch-price-cut.md
"""

import math
from collections.abc import Iterator, Sequence

from .restricted_master import Cut, Prices

SMOOTHING = 0.6
"""Weight of the best prices so far."""

RADIUS, LEAST_RADIUS = 0.5, 1e-3
"""The first radius, and the least, as parts of the mean price of a visit."""

GOOD, PATIENCE = 0.5, 5
"""Part of the ascent that the linear program promised from which the radius is doubled, and after how many searches without an ascent it is
halved: the routes that these found mend the linear program, too."""


class Stabilisation:
    """None: routes are looked for at the prices of the linear program.

    ``begin`` is told of a linear program and prices to begin near, ``told`` of all prices ``at`` which routes were looked for, their
    Lagrangian ``bound``, by the search ``how`` (0 for the exact one, others may tell too much), and the value of the linear program,
    ``promised``.
    """

    radius = math.inf

    def __init__(self) -> None:
        self.centre: Prices | None = None
        self.bounds: dict[int, float] = {}

    def begin(self, centre: Prices | None) -> None:
        self.centre, self.bounds = centre, {}

    def places(self, prices: Prices, cuts: Sequence[Cut]) -> Iterator[Prices]:
        """Prices at which routes are looked for, one after the other until some are found."""
        yield prices

    def told(self, at: Prices, bound: float, promised: float, how: int) -> None:
        """Hear of a search."""

    def held(self, at: Prices) -> None:
        """Hear that only the box keeps the linear program from better prices than these."""


class Smoothing(Stabilisation):
    """A mean with the prices of the best bound."""

    def places(self, prices: Prices, cuts: Sequence[Cut]) -> Iterator[Prices]:
        if self.centre is not None:
            yield prices.mixed(self.centre, SMOOTHING, cuts)
        yield prices

    def told(self, at: Prices, bound: float, promised: float, how: int) -> None:
        quick = min(how, 1)
        if quick not in self.bounds or bound > self.bounds[quick]:
            self.centre, self.bounds[quick] = at, bound


class TrustRegion(Stabilisation):
    """A box around a centre; ``size`` is the mean price of a visit."""

    def __init__(self, size: float) -> None:
        super().__init__()
        self.size = size

    def begin(self, centre: Prices | None) -> None:
        super().begin(centre)
        self.radius, self.nulls = RADIUS * self.size, 0

    def told(self, at: Prices, bound: float, promised: float, how: int) -> None:
        best = self.bounds.get(how, -math.inf)
        if bound > best:
            if bound - best > GOOD * (promised - best):
                self.radius *= 2.0
            self.centre, self.bounds, self.nulls = at, {how: bound}, 0
        else:
            self.nulls += 1
            if self.nulls % PATIENCE == 0:
                self.radius = max(self.radius / 2.0, LEAST_RADIUS * self.size)

    def held(self, at: Prices) -> None:
        self.centre, self.radius = at, 2.0 * self.radius


BOXED = "trust-region"

KINDS = (BOXED, "smoothing", "none")
"""The first is the usual one."""


def stabilised(kind: str, size: float) -> Stabilisation:
    """A new stabilisation of the given ``kind``, one of ``KINDS``; ``size`` is the order of magnitude of the prices."""
    return {"smoothing": Smoothing, "none": Stabilisation}[kind]() if kind != BOXED else TrustRegion(size)
