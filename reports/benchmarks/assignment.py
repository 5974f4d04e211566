"""The default solver of assignments against other libraries on the same costs, in turn in one process: CPU seconds, dense and sparse.

The default's seconds are for all of ``solve(from_matrix(costs))``: reading, auction, judging the answer, and multiplying out its prices;
those of the auction and its prices alone stand apart. Others return no prices: ``linear_sum_assignment`` and
``min_weight_full_bipartite_matching`` of scipy, and, where they are installed, ``lapjv`` of the packages lap and lapjv.
"""

import statistics
import sys
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

import numpy as np
from scipy.sparse import csr_matrix

import waybound as wb
from waybound.extending import NEVER, same, verified_bound

from ...solvers.engines.auctions.assignment_steps.auction import auction
from ...solvers.packages import is_installed
from ...solving.solve import solve
from ._harness import Option, command, generated, timed

ARCS = 21


def proved(problem: wb.BinAssignment) -> tuple[tuple[int, ...], wb.Evidence]:
    """Answer and prices of the auction."""
    outcome = auction(problem, NEVER)
    return outcome.answer, outcome.evidence(problem, "auction prices")


def scipy_dense(costs: Any) -> float:
    from scipy.optimize import linear_sum_assignment

    return float(costs[linear_sum_assignment(costs)].sum())


def scipy_sparse(costs: Any) -> float:
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    return float(costs[min_weight_full_bipartite_matching(costs)].sum())


def lap(costs: Any) -> float:
    from lap import lapjv

    return float(lapjv(costs)[0])


def lapjv(costs: Any) -> float:
    from lapjv import lapjv as solved

    return float(costs[np.arange(len(costs)), solved(costs)[0]].sum())


DENSE: dict[str, Callable[[Any], float]] = {"scipy": scipy_dense, "lap": lap, "lapjv": lapjv}
SPARSE: dict[str, Callable[[Any], float]] = {"scipy": scipy_sparse}


def compare(label: str, costs: Any, peers: dict[str, Callable[[Any], float]], repeats: int) -> bool:
    """A line of the table: medians of alternating runs; whether all optima are the same and ours is proved."""
    seconds: dict[str, list[float]] = {}
    optima: dict[str, float] = {}
    for _ in range(repeats):
        for name, peer in peers.items():
            spent, optima[name] = timed(partial(peer, costs))
            seconds.setdefault(name, []).append(spent)
        spent, solution = timed(lambda: solve(wb.BinAssignment.from_matrix(costs)))
        seconds.setdefault("solve", []).append(spent)
        problem = wb.BinAssignment.from_matrix(costs)
        spent, (answer, evidence) = timed(partial(proved, problem))
        seconds.setdefault("auction", []).append(spent)
    checked, bound = timed(lambda: verified_bound(problem, evidence))
    judged = problem.evaluate(answer)
    value = judged.values[0]
    others: list[Any] = [solution.objective, solution.bound, bound, *optima.values()]
    good = judged.feasible and solution.bound_kind == "verified" and all(same(value, other, judged.size) for other in others)
    medians = {name: statistics.median(spent) for name, spent in seconds.items()}
    figures = "   ".join(f"{name} {spent:7.3f}" for name, spent in medians.items())
    print(f"{label:28s} {figures}   check {checked:6.3f}   {value:.9g} {'proved' if good else f'NOT PROVED: {others}'}", flush=True)
    return good


@command
def main(
    sizes: str = "1000,3000",
    sparse: str = "10000,30000",
    alone: Annotated[str, Option(help="sparse sizes at which no other library runs")] = "",
    repeats: int = 3,
) -> bool:
    dense, many, unmatched = ([int(k) for k in text.split(",") if k] for text in (sizes, sparse, alone))
    for robots, bins, arcs in ((30, 30, 0), (30, 40, 0), (30, 30, 2), (30, 40, 2), (3000, 3000, ARCS)):  # compiles all loops
        solve(_generated(robots=robots, bins=bins, arcs=arcs))
    peers = {name: peer for name, peer in DENSE.items() if is_installed(name)}
    good = True
    for n in dense:
        for kind, drawn in (("whole", {"largest": 999}), ("uniform", {}), ("euclidean", {})):
            good &= compare(f"{n} x {n} {kind}", _generated(robots=n, bins=n, costs=kind, **drawn).matrix(), peers, repeats)
    for n in many + unmatched:
        for kind in ("whole", "uniform"):
            problem = _generated(robots=n, bins=n, costs=kind, arcs=ARCS)
            costs = csr_matrix((problem.cost + 1.0, problem.bins, problem.indptr), shape=(n, n))  # a stored 0 is no pair to scipy
            good &= compare(f"{n} sparse x {ARCS} {kind}", costs, {} if n in unmatched else SPARSE, 1)
    return good


def _generated(**settings: Any) -> wb.BinAssignment:
    return wb.BinAssignment(generated(wb.AssignmentInstance, "assignment", 1, **settings))


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    sys.exit(main())
