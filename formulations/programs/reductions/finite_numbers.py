"""Programs without numbers that a solver takes for infinite."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..program import Program
from .reduction import Irreducible, Reduction, Step


@dataclass(frozen=True)
class FiniteNumbers(Reduction):
    """Changes nothing, and refuses programs with finite numbers of ``infinite`` and more."""

    infinite: float
    may_refuse: bool = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``."""
        parts = [program.cost, program.data, program.lower, program.upper, program.row_lower, program.row_upper]
        if program.quadratic is not None:
            parts.append(program.quadratic.data)
        if any((np.isfinite(part) & (np.abs(part) >= self.infinite)).any() for part in parts):
            raise Irreducible(f"numbers of {self.infinite:g} and more")
        return ()
