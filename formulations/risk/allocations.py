"""Answers of risk allocation: a decision, and the risk that each constraint is given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Allocation:
    """A decision and its risks.

    Parameters
    ----------
    decision : array of shape (decisions,)
    risks : array of shape (constraints,), optional
        What each chance constraint is allowed; None leaves it to what each has.
    """

    decision: Floats
    risks: Floats | None = None

    @classmethod
    def of(cls, decision: ArrayLike, risks: ArrayLike | None = None) -> Allocation:
        """From anything that numpy takes for vectors."""
        given = None if risks is None else np.array(risks, dtype=np.float64)
        return cls(np.array(decision, dtype=np.float64), given)

    def __repr__(self) -> str:
        return f"<Allocation: {len(self.decision)} decisions{'' if self.risks is None else f', {len(self.risks)} risks'}>"
