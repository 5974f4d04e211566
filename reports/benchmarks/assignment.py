"""Bertsekas' auction against scipy on the same assignments, in turn in one process: CPU seconds, dense and sparse.

``python -m waybound.reports.benchmarks.assignment [--sizes 1000,3000] [--sparse 10000,30000,100000] [--repeats 3]``

The auction's seconds are for the answer and its prices; those of the checker that multiplies them out stand apart. scipy returns no prices.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.certificate import verified_bound
from ...formulations.evidence import Evidence
from ...formulations.problem import problem_from_instance
from ...formulations.stop import NEVER
from ...formulations.tolerance import same
from ...instances.generating import generate
from ...solvers.engines.assignment_steps.auction import auction

ARCS = 21


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds and what came of it."""
    began = time.process_time()
    made = work()
    return time.process_time() - began, made


def proved(problem: BinAssignment) -> tuple[tuple[int, ...], Evidence]:
    """Answer and prices of the auction."""
    found = auction(problem, NEVER)
    return found.answer, found.evidence(problem, "auction prices")


def dense(problem: BinAssignment) -> float:
    """The optimum by ``scipy.optimize.linear_sum_assignment``."""
    from scipy.optimize import linear_sum_assignment

    matrix = problem.matrix()
    return float(matrix[linear_sum_assignment(matrix)].sum())


def sparse(problem: BinAssignment) -> float:
    """The optimum by ``scipy.sparse.csgraph.min_weight_full_bipartite_matching``."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    matrix = csr_matrix((problem.cost, problem.bins, problem.indptr), shape=(problem.num_robots, problem.num_bins))
    return float(matrix[min_weight_full_bipartite_matching(matrix)].sum())


def compare(label: str, problem: BinAssignment, peer: Callable[[BinAssignment], float] | None, repeats: int) -> bool:
    """A line of the table: medians of alternating runs; whether both optima are the same and the auction's is proved."""
    own, other, best = [], [], None
    for _ in range(repeats):
        if peer is not None:
            seconds, best = timed(lambda: peer(problem))
            other.append(seconds)
        seconds, (answer, evidence) = timed(lambda: proved(problem))
        own.append(seconds)
    checked, bound = timed(lambda: verified_bound(problem, evidence))
    judged = problem.evaluate(answer)
    value = judged.values[0]
    good = judged.feasible and same(value, bound, judged.size) and (best is None or same(value, best, judged.size))
    a, b = statistics.median(own), statistics.median(other) if other else float("nan")
    told = "proved" if good else f"NOT PROVED: {value!r} {bound!r} {best!r}"
    print(f"{label:28s} scipy {b:9.3f}   auction {a:9.3f}   {b / a:7.1f} x   check {checked:6.3f}   {value:.9g} {told}", flush=True)
    return good


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--sizes", default="1000,3000")
    parser.add_argument("--sparse", default="10000,30000")
    parser.add_argument("--alone", default="", help="sparse sizes at which the auction runs without its peer")
    parser.add_argument("--repeats", type=int, default=3)
    asked = parser.parse_args(arguments)
    sizes, many, alone = ([int(k) for k in text.split(",") if k] for text in (asked.sizes, asked.sparse, asked.alone))
    for arcs in (0, 2):  # compiles dense and sparse loops
        proved(_made(robots=30, bins=30, arcs=arcs))
        proved(_made(robots=30, bins=40, arcs=arcs))
    proved(_made(robots=3000, bins=3000, arcs=ARCS))  # loops that only many pairs are worth
    good = True
    for n in sizes:
        for kind, costs in (("whole", {"largest": 999}), ("uniform", {}), ("euclidean", {})):
            problem = _made(robots=n, bins=n, costs=kind, **costs)
            good &= compare(f"{n} x {n} {kind}", problem, dense, asked.repeats)
    for n in many + alone:
        for kind in ("whole", "uniform"):
            problem = _made(robots=n, bins=n, costs=kind, arcs=ARCS)
            if kind == "whole":  # a stored 0 is no pair to scipy
                problem = BinAssignment.from_matrix(_shifted(problem))
            good &= compare(f"{n} sparse x {ARCS} {kind}", problem, None if n in alone else sparse, 1)
    return 0 if good else 1


def _made(**settings: Any) -> BinAssignment:
    problem = problem_from_instance(generate("assignment", 1, **settings))
    assert isinstance(problem, BinAssignment)
    return problem


def _shifted(problem: BinAssignment) -> Any:
    from scipy.sparse import csr_matrix

    return csr_matrix((problem.cost + 1.0, problem.bins, problem.indptr), shape=(problem.num_robots, problem.num_bins))


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    sys.exit(main())
