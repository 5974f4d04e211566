"""What auctions of bins share: the condition of their ratios, and assignments of the most pairs for whatever they leave out."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.stop import Stop
from ...formulations.tolerance import LIMIT
from ...instances.auctions.assignment import AssignmentInstance
from ..heuristic import Outcome

if TYPE_CHECKING:
    from ...formulations.auctions.bin_assignment import Assignment

MOST_TRIPLES = 2_000_000_000
"""Robots x robots x bins up to which the quadrangle inequality is tested: some seconds."""

QUADRANGLE = "c_ij <= c_il + c_kl + c_kj for all robots i, k and bins j, l, to 11 digits"


def quadrangle(problem: BinAssignment, stop: Stop) -> bool:
    """Whether all pairs are allowed and their costs keep the quadrangle inequality, as travel times in a metric do, waiting included.

    It implies costs of at least 0. The side of fewer is compared pair by pair.
    """
    from .conflict_kernels import quadrangle_broken

    if not problem.complete:
        return False
    matrix = problem.matrix()
    if problem.num_robots > problem.num_bins:
        matrix = np.ascontiguousarray(matrix.T)
    if matrix.shape[0] * matrix.size > MOST_TRIPLES:
        return False
    return bool(quadrangle_broken(stop.flag, matrix, LIMIT) == 0)


def completed(problem: BinAssignment, taken: NDArray[np.int64], stop: Stop) -> tuple[Assignment, int]:
    """An assignment of the most pairs that keeps as many of ``taken`` as possible, and how many it changes."""
    from ...solvers.engines.auctions.assignment_steps.auction import auction

    most = int((problem.largest >= 0).sum())
    if int((taken >= 0).sum()) >= most:
        return tuple(taken.tolist()), 0
    kept = taken[problem.robots] == problem.bins
    changes = AssignmentInstance(problem.num_robots, problem.num_bins, problem.indptr, problem.bins, np.where(kept, 0.0, 1.0))
    repaired = auction(BinAssignment(changes), stop)
    answer = repaired.answer if repaired.complete else problem.answer_at_hand()
    return answer, int((np.array(answer) != taken).sum())


def cut_short(problem: BinAssignment, stop: Stop, statistics: Mapping[str, float] = MappingProxyType({})) -> Outcome:
    """The outcome of an auction that was stopped: any assignment of the most pairs."""
    message = "cut short: the answer is any of the most pairs"
    return Outcome(problem.answer_at_hand(), statistics=dict(statistics), message=message, limit=stop.reached() or "time")


def changes_message(changed: int) -> str:
    """A message that a completed assignment differs from the auction's."""
    return f"as many pairs as possible need other bins for {changed} robots than it found" if changed else ""
