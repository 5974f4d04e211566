"""Forms of bin assignments, ``bipartite`` and ``largest-cost``: one binary per pair, and rows that let each robot and bin have one."""

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Flags, Floats
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..bin_assignment import Assignment, BinAssignment


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
    blocks = [
        rows("robot", n, [(problem.robots, column, 1.0)], float(asked == n), 1.0, (np.arange(n),), (robots,)),
        rows("bin", m, [(problem.bins.astype(np.int64), column, 1.0)], float(asked == m), 1.0, (np.arange(m),), (bins,)),
    ]
    if asked not in (n, m):
        blocks.append(rows("pairs", 1, [(np.zeros(len(column), int), column, 1.0)], float(asked), float(asked)))
    return tuple(blocks)


def decoded(problem: BinAssignment, vector: Floats) -> Assignment:
    """The pairs whose binaries are 1."""
    used = np.nonzero(vector[: len(problem.bins)] > 0.5)[0]
    bins = np.full(problem.num_robots, -1, dtype=np.int64)
    bins[problem.robots[used]] = problem.bins[used]
    return tuple(bins.tolist())


def encoded(problem: BinAssignment, answer: Any) -> Floats:
    """The binaries of an answer."""
    chosen: Flags = np.array(answer)[problem.robots] == problem.bins
    if int(chosen.sum()) != sum(j >= 0 for j in answer):
        raise InputError("the assignment has a pair that is not allowed", "unsupported")
    return np.asarray(chosen, dtype=np.float64)


def bipartite(problem: BinAssignment) -> Compiled:
    """Robot i is sent to bin j (x_ij), K pairs in all::

        min  sum c_ij x_ij,   x binary
        robot[i]   sum_j x_ij <= 1     (= 1 where K is the number of robots)
        bin[j]     sum_i x_ij <= 1     (= 1 where K is the number of bins)
        pairs      sum_ij x_ij = K     (where it is neither)

    The matrix is totally unimodular (Hoffman and Kruskal 1956); duals of ``bin`` are prices.
    """
    n, m = problem.num_robots, problem.num_bins

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        level = float(duals[n + m]) if len(duals) > n + m else 0.0
        value = level * problem.pairs * (len(duals) > n + m) + float(duals[: n + m].sum())
        return Evidence("assignment-prices", "LP duals of bipartite", value, {"prices": (-duals[n : n + m]).tolist(), "level": level})

    program = Program("bipartite", "min", (pair_variables(problem, problem.cost),), pair_rows(problem))
    return Compiled(program, problem, lambda v: decoded(problem, v), lambda a: encoded(problem, a), dual_evidence)


FORMS.enter(Form("bipartite", "bin-assignment", frozenset({"objective:sum"}), bipartite, size=pairs_size))


def largest_cost(problem: BinAssignment) -> Compiled:
    """Robot i is sent to bin j (x_ij), K pairs in all; l is the least of all costs, t by how much the largest is more::

    min  l + t,   x binary,   t >= 0
    cost[i]    sum_j (c_ij - l) x_ij <= t
    robot[i], bin[j], pairs as in ``bipartite``
    """
    n, size = problem.num_robots, len(problem.bins)
    low = float(problem.cost.min(initial=np.inf)) if size else 0.0
    above, column = problem.cost - low, np.arange(size)
    most = float(above.max(initial=0.0))
    t = Variables("t", (), (), np.zeros(1), np.full(1, most), np.ones(1))
    parts = [(problem.robots, column, above), (np.arange(n), np.full(n, size), -1.0)]
    capped = rows("cost", n, parts, upper=0.0, keys=(np.arange(n),), labels=(labels(problem)[0],))  # type: ignore[arg-type]

    def encode(answer: Any) -> Floats:
        x = encoded(problem, answer)
        return np.append(x, (above * x).max(initial=0.0))

    offset = low if problem.pairs else 0.0
    program = Program("largest-cost", "min", (pair_variables(problem, np.zeros(size)), t), (capped, *pair_rows(problem)), offset)
    return Compiled(program, problem, lambda v: decoded(problem, v), encode)


def _capped_size(problem: BinAssignment) -> ProgramSize:
    return pairs_size(problem) + ProgramSize(1.0, problem.num_robots, problem.num_robots + float(len(problem.bins)))


FORMS.enter(Form("largest-cost", "bin-assignment", frozenset({"objective:bottleneck"}), largest_cost, size=_capped_size))
