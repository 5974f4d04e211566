"""Small linear programs over parts of a graph: the price of a ball, and shares of some robots while the others stand still."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .....formulations.programs.program import Program, Rows, Variables
from .....formulations.sata.balls import Floats, Indices, actions_of, num_entries, robots_seeing, targets_seen
from .....formulations.stop import NEVER, Stop
from .....instances.errors import InputError
from .....instances.number_arrays import entries_of
from .....instances.sata.sensing_graph import SensingGraph
from ....backend import RawResult
from ....linear_programs import LinearPrograms, Suits

SIMPLEX = {"highs": {"solver": "simplex"}}

EDGES_PER_SECOND = 2e8
"""Edges that the compiled loops read in a second: measured 1e8 to 3e8. Linear programs are charged in such edges, for their simplex
iterations, so that budgets do not depend on the clock and a run can be repeated to the bit."""

WORK_OF_PROGRAM, WORK_OF_ITERATION, WORK_OF_ENTRY = 2e5, 2e3, 1.5
"""Charge of a linear program, of an iteration, and of an entry in an iteration: measured 1 ms, 10 us and 7.5 ns."""

SHARE = 0.5
LEAST_WORK = 4e7
"""Linear programs may cost this share of the work of the compiled loops, and 0.2 s in any case."""

SPARE_ITERATIONS = 500
"""A program may take one simplex iteration an entry, and these; the median is half an iteration an entry."""


class Programs(LinearPrograms):
    """Linear programs, solved within the time and work that are left; ``work`` is their charge so far, in edges."""

    def __init__(self, stop: Stop, linear: LinearPrograms | None = None) -> None:
        linear = linear or LinearPrograms()
        super().__init__(linear.solver, linear.seed, linear.threads)
        self._stop = stop
        self.solved, self.work = 0, 0.0

    def most_edges(self, other_work: float) -> int:
        """Edges that the next program may have, from the work of the compiled loops.

        A program of E edges takes about E iterations of 10 us + 15 ns E.
        """
        seconds = (SHARE * other_work + LEAST_WORK - self.work) / EDGES_PER_SECOND
        return int((math.sqrt(1e-10 + 6e-8 * max(seconds, 0.0)) - 1e-5) / 3e-8)

    def solve(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None, *, iterations: int | None = None) -> RawResult:
        """Solve ``program``; not ``optimal``, and without duals, where it exceeds its share, or is refused."""
        try:
            result = super().solve(program, self._stop, SIMPLEX, iterations=len(program.data) + SPARE_ITERATIONS)
        except InputError as fault:  # weights of sizes that the solver does not take
            result = RawResult("error", message=str(fault))
        if result.status != "optimal":
            result = replace(result, row_duals=None)
        iterations = sum(result.statistics.get(name, 0) for name in ("simplex_iterations", "ipm_iterations", "iterations"))
        self.solved += 1
        self.work += WORK_OF_PROGRAM + iterations * (WORK_OF_ITERATION + WORK_OF_ENTRY * len(program.data))
        return result


@dataclass(frozen=True)
class Lifted:
    """New shares of some robots: one an action, and the least coverage over the targets of its part that could fall below the level
    asked for."""

    actions: Indices
    shares: Floats
    reached: Floats


def lift_edges(graph: SensingGraph, ball: Indices) -> int:
    """Edges of the program that ``lift`` would solve for ``ball``."""
    return num_entries(graph.indptr, actions_of(graph, robots_seeing(graph, ball)))


def lift(
    graph: SensingGraph, shares: Floats, cover: Floats, ball: Indices, level: float, run: Callable[[Program], RawResult]
) -> Lifted | None:
    """Divide the robots that see ``ball`` (ascending) anew, all others as they stand, so that the least coverage is largest, up to
    ``level``.

    All that these robots see counts, so that nothing falls below what is reached. Parts that have nothing in common reach levels of their
    own::

        max sum_p t_p,   sum_{m of i} x_m <= 1 for each robot i,   sum_m c_mj x_m + others_j >= t_p(j) for each target j,   t <= level

    None if ``run`` did not solve the program, or no target could be below ``level``.
    """
    actions = actions_of(graph, robots_seeing(graph, ball))
    edges, counts = entries_of(graph.indptr, actions)
    column, weights = np.repeat(np.arange(len(actions)), counts), graph.weights[edges]
    targets = targets_seen(graph, actions)
    row = np.searchsorted(targets, graph.indices[edges])
    mine = np.bincount(row, weights * shares[actions[column]], minlength=len(targets))
    others = np.maximum(cover[targets] - mine, 0.0)
    robots, owner = np.unique(graph.robot_of_action[actions], return_inverse=True)
    kept = np.nonzero(others < level)[0]
    number = np.full(len(targets), -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    inside = number[row] >= 0
    row, column, weights, others = number[row[inside]], column[inside], weights[inside], others[kept]
    part_of_row, part_of_robot, count = parts(row, owner[column], len(kept), len(robots))
    if count == 0:
        return None
    result = run(_lift_program(owner, len(robots), row, column, weights, others, part_of_row, count, level))
    if result.status != "optimal" or result.answer is None:
        return None
    fresh = np.clip(result.answer[: len(actions)], 0.0, 1.0)
    load = np.bincount(owner, fresh, minlength=len(robots))[owner]
    # What a robot has to spare does no harm anywhere; one that is not needed stands as it stood.
    fresh = np.where(load > 0.0, fresh / np.where(load > 0.0, load, 1.0), shares[actions])
    least = np.full(count, np.inf)
    np.minimum.at(least, part_of_row, others + np.bincount(row, weights * fresh[column], minlength=len(kept)))
    part = part_of_robot[owner]
    return Lifted(actions, fresh, np.where(part >= 0, least[part], -np.inf))


def parts(rows: Indices, robots: Indices, num_rows: int, num_robots: int) -> tuple[NDArray[np.int64], NDArray[np.int64], int]:
    """Connected parts of a graph of rows and robots: the part of each row, of each robot (-1 for what has no edge), and their number."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    size = num_rows + num_robots
    _, label = connected_components(coo_matrix((np.ones(len(rows)), (rows, num_rows + robots)), shape=(size, size)), directed=False)
    used = np.zeros(size, dtype=bool)
    used[rows] = used[num_rows + robots] = True
    number = np.full(size, -1, dtype=np.int64)
    names, number[used] = np.unique(label[used], return_inverse=True)
    return number[:num_rows], number[num_rows:], len(names)


def _lift_program(
    owner: Indices, num_robots: int, row: Indices, column: Indices, weights: Floats, others: Floats, part: Indices, count: int, level: float
) -> Program:
    import scipy.sparse as sp

    n, m = len(owner), len(others)
    values = np.concatenate([weights, np.full(m, -1.0)])
    places = np.concatenate([row, np.arange(m)]), np.concatenate([column, n + part])
    covering = sp.csr_matrix((values, places), shape=(m, n + count))
    packing = sp.csr_matrix((np.ones(n), (owner, np.arange(n))), shape=(num_robots, n + count))
    return Program(
        "lift", "max",
        (
            Variables("x", lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n)),
            Variables("t", lower=np.zeros(count), upper=np.full(count, level), cost=np.ones(count)),
        ),
        (
            _rows("robot", packing, np.full(num_robots, -math.inf), np.ones(num_robots)),
            _rows("target", covering, -others, np.full(m, math.inf)),
        ),
    )  # fmt: skip


def _rows(name: str, matrix: Any, lower: Floats, upper: Floats) -> Rows:
    starts, columns = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
    return Rows(name, indptr=starts, indices=columns, data=matrix.data, lower=lower, upper=upper)
