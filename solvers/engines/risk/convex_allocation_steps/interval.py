"""The interval that holds the optimum of a risk allocation, with what proves it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .....formulations.evidence import Evidence
from .....formulations.risk.allocations import Allocation
from .....formulations.risk.forms._blocks import evidence_of

Floats = NDArray[np.float64]


@dataclass
class Interval:
    """What is known of the optimum.

    Attributes
    ----------
    status : str
        ``optimal`` (closed to what was asked), ``feasible``, ``infeasible``, ``unbounded`` or ``unknown``.
    bound, value : float
        In the sense of minimisation: at most and at least the optimum; infinite where nothing is known.
    answer : Allocation or None
    evidence : Evidence or None
        Of the bound, or that there is no answer.
    rounds : int
    """

    status: str = "unknown"
    bound: float = -math.inf
    value: float = math.inf
    answer: Allocation | None = None
    rounds: int = 0
    prices: dict[str, Floats] | None = None

    @property
    def gap(self) -> float:
        """Between bound and value, in parts of the value."""
        if not (math.isfinite(self.bound) and math.isfinite(self.value)):
            return math.inf
        return max(0.0, self.value - self.bound) / max(abs(self.value), 1e-300)

    def evidence(self, sign: float) -> tuple[Evidence, ...]:
        """What its prices prove; ``sign`` is the problem's."""
        if self.prices is None:
            return ()
        if self.status == "infeasible":
            return (evidence_of(self.prices, sign * math.inf, "prices that no decision can pay", infeasible=True),)
        return (evidence_of(self.prices, sign * self.bound, "duals of successive tangents"),)
