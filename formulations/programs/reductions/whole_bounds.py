"""Bounds of integer variables made whole, for solvers that count on it: HiGHS called 0.3 the optimum of a whole number from 0.3 to 1.5."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..program import Program
from .reduction import Reduction, Step

SLACK = 1e-9
"""How far beyond a whole number a bound still means that number."""


class Rounded(Step):
    """The same variables, with bounds that are whole where they are."""

    name = "whole-bounds"


class WholeBounds(Reduction):
    """Rounds bounds of integer variables inwards; those between which there is no whole number cross."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``."""
        variables, count = [], 0
        for block in program.variables:
            low, high = block.lower, block.upper
            if block.integer:
                low, high = np.ceil(low - SLACK), np.floor(high + SLACK)
                count += int(((low != block.lower) | (high != block.upper)).sum())
            variables.append(replace(block, lower=low, upper=high))
        if not count:
            return ()
        return (Rounded(program=replace(program, variables=tuple(variables)), told=f"bounds of {count} integer variables rounded"),)


WHOLE_BOUNDS = WholeBounds()
