"""Programs whose quadratic objective is a sum of squares, for solvers that take no other."""

from __future__ import annotations

from ..program import Program
from .reduction import Irreducible, Reduction, Step


class SeparableObjective(Reduction):
    """Changes nothing, and refuses products of two variables."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``."""
        if program.quadratic is not None:
            entries = program.quadratic.tocoo()
            if (entries.data[entries.row != entries.col] != 0).any():
                raise Irreducible("products of two variables")
        return ()


SEPARABLE_OBJECTIVE = SeparableObjective()
