"""Whole actions from shares, of which the largest come first, and the heuristic that takes the shares of the linear relaxation."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Evidence
from ...formulations.forms import FORMS
from ...formulations.programs.exactness import Exactness
from ...formulations.programs.program import INTEGERS
from ...formulations.programs.reductions.units import scaled
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UnsupportedError, UsageError
from ...instances.number_arrays import Floats
from ...instances.sata.sensing_graph import SensingGraph
from ..heuristic import Context, Outcome, heuristic
from .greedy_steps.limits import FORMULATED, FUNCTIONS, first_allowed, not_whole

TIES = ("last", "first", "random")

ALIKE = 1e-9
"""Shares that are no further apart are equal: neither an LP solver's zeros nor sums of shares are exact."""


def check_ties(ties: Any) -> None:
    """Raise UsageError unless ``ties`` is a rule."""
    if ties not in TIES:
        raise UsageError(f"ties must be {', '.join(TIES[:-1])} or {TIES[-1]}, not {ties!r}", "unknown-name")


def by_share(shares: Floats, ties: str = "last", rng: "np.random.Generator | None" = None) -> NDArray[np.int64]:
    """The elements by falling share; a run of neighbours among the shares that are alike is one tie.

    Of equal shares the ``last`` comes first (as in the recorded runs of the thesis' author), the ``first``, or any (``random``, by
    ``rng``).
    """
    turns, order = _turns(len(shares), ties, rng), np.argsort(shares, kind="stable")
    level = np.empty(len(shares), dtype=np.int64)
    level[order] = np.cumsum(np.diff(shares[order], prepend=shares[order][:1]) > ALIKE)
    return np.lexsort((turns, -level))


def largest_shares(graph: SensingGraph, shares: Floats, ties: str = "last", rng: "np.random.Generator | None" = None) -> NDArray[np.int32]:
    """The action with the largest share of each robot that has a share at all, in the order of robots; ``ties`` as in ``by_share``, among
    those alike to the robot's largest.

    Source: Sung (2019), section 3.4.1. The rounded value may be 0 where the shares cover everything:
    docs/formulations/bottleneck.md#whole-actions-from-shares.
    """
    most = np.zeros(graph.num_robots)
    np.maximum.at(most, graph.robot_of_action, shares)
    best = np.nonzero((shares > 0) & (shares >= most[graph.robot_of_action] - ALIKE))[0]
    order = best[np.argsort(_turns(len(best), ties, rng))]
    _, first = np.unique(graph.robot_of_action[order], return_index=True)
    return order[first].astype(np.int32)


def _turns(count: int, ties: str, rng: "np.random.Generator | None") -> NDArray[np.int64]:
    """Keys that break ties between equal shares, by the rule ``ties``."""
    check_ties(ties)
    if ties != "random":
        return np.arange(count) if ties == "first" else -np.arange(count)
    if rng is None:
        raise UsageError("ties=random needs a random generator", "missing")
    return -rng.permutation(count)


@heuristic(
    "lp-rounding", ("selection", "max-min"), FUNCTIONS | FORMULATED | {"sensing", "whole-actions"},
    "the largest shares of the linear relaxation, whose bound comes with the answer", "no guarantee (none is true for a bottleneck)",
    refuses=not_whole,
)  # fmt: skip
def lp_rounding(problem: SubmodularSelection | BottleneckSATA, context: Context, *, ties: str = "last") -> Outcome:
    """Solve the linear relaxation of the problem's first linear form, and take the elements of largest share, of equal ones by ``ties``.

    Robots: each takes its action of largest share. Cardinality limit and partition matroid: the largest shares that there is room for.
    Others: in order of share, what is still allowed. The LP's bound is the evidence. No guarantee: none is true for a bottleneck, whose
    rounded value can be 0 beside an LP value of 1.2.

    Source: Sung (2019), 3.4.1; where it fails: docs/formulations/bottleneck.md#whole-actions-from-shares.
    """
    check_ties(ties)
    stop = context.begin()
    linear = [f for f in problem.forms() if FORMS[f].exactness is Exactness.EXACT and FORMS[f].makes(problem) <= INTEGERS]
    if not linear:
        raise UnsupportedError("lp-rounding", {"a linear form of the problem"})
    compiled = problem.compile(linear[0], relax=True)
    program = compiled.program
    units = scaled(program)
    result = context.linear.solve(units.program, stop)
    statistics: dict[str, Any] = {"form": compiled.form, "lp_status": result.status}
    if result.answer is None or result.status != "optimal":
        message = f"the LP was not solved in time: {result.message or result.status}"
        return Outcome(None, statistics=statistics, message=message, limit=stop.reached() or "none")
    n = program.variables[0].size  # every form's first block has one variable an element, named x
    point = units.vector(np.asarray(result.answer, dtype=np.float64))
    shares = point[:n]
    statistics["lp_value"] = program.value(point)
    answer = Selection(tuple(first_allowed(problem, by_share(shares, ties, context.rng))))
    context.publish(answer)  # which outlives a fault in its evidence
    evidence: tuple[Evidence, ...] = ()
    if result.row_duals is not None and compiled.dual_evidence is not None:
        evidence = (compiled.dual_evidence(units.duals(result.row_duals)),)
    return Outcome(answer, evidence=evidence, statistics=statistics)
