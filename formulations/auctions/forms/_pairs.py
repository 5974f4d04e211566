"""What the forms of bin assignments share: one binary a pair, and rows that let each robot and bin have one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...programs.program import Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..bin_assignment import Assignment, BinAssignment

Floats = NDArray[np.float64]


def pairs_size(problem: BinAssignment) -> ProgramSize:
    """Size of a program with one binary for each pair, and the rows that all forms have."""
    pairs = float(len(problem.bins))
    return ProgramSize(pairs, problem.num_robots + problem.num_bins + 1.0, 3.0 * pairs)


def pair_variables(problem: BinAssignment, cost: Floats) -> Variables:
    """x[i,j], binary, one a pair."""
    size = len(problem.bins)
    return Variables("x", (problem.robots, problem.bins), labels(problem), np.zeros(size), np.ones(size), cost, integer=True)


def labels(problem: BinAssignment) -> tuple[list[str], list[str]]:
    """Names of robots and bins."""
    data = problem.instance
    return [data.robot_name(i) for i in range(data.num_robots)], [data.bin_name(j) for j in range(data.num_bins)]


def pair_rows(problem: BinAssignment) -> tuple[Rows, ...]:
    """robot[i], bin[j], and pairs where neither all robots nor all bins are asked for."""
    n, m, asked = problem.num_robots, problem.num_bins, problem.pairs
    column, (robots, bins) = np.arange(len(problem.bins)), labels(problem)
    made = [
        rows("robot", n, [(problem.robots, column, 1.0)], float(asked == n), 1.0, (np.arange(n),), (robots,)),
        rows("bin", m, [(problem.bins.astype(np.int64), column, 1.0)], float(asked == m), 1.0, (np.arange(m),), (bins,)),
    ]
    if asked not in (n, m):
        made.append(rows("pairs", 1, [(np.zeros(len(column), int), column, 1.0)], float(asked), float(asked)))
    return tuple(made)


def decoded(problem: BinAssignment, vector: Floats) -> Assignment:
    """The pairs whose binaries are 1."""
    used = np.nonzero(vector[: len(problem.bins)] > 0.5)[0]
    bins = np.full(problem.num_robots, -1, dtype=np.int64)
    bins[problem.robots[used]] = problem.bins[used]
    return tuple(bins.tolist())


def encoded(problem: BinAssignment, answer: Any) -> Floats:
    """The binaries of an answer."""
    chosen: NDArray[np.bool_] = np.array(answer)[problem.robots] == problem.bins
    if int(chosen.sum()) != sum(j >= 0 for j in answer):
        raise InputError("the assignment has a pair that is not allowed")
    return np.asarray(chosen, dtype=np.float64)
