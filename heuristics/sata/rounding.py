"""From shares to whole actions: the largest come first. No guarantee."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import UsageError
from ...instances.sata.sensing_graph import SensingGraph

Floats = NDArray[np.float64]

TIES = ("last", "first", "random")

ALIKE = 1e-9
"""Shares that are no further apart are equal: neither an LP solver's zeros nor sums of shares are exact."""


def check_ties(ties: Any) -> None:
    """Raise UsageError unless ``ties`` is a rule."""
    if ties not in TIES:
        raise UsageError(f"ties must be {', '.join(TIES[:-1])} or {TIES[-1]}, not {ties!r}")


def by_share(shares: Floats, ties: str = "last", rng: np.random.Generator | None = None) -> NDArray[np.int64]:
    """The elements by falling share; a run of neighbours among the shares that are alike is one tie.

    Of equal shares the ``last`` comes first (as in the recorded runs of the thesis' author), the ``first``, or any (``random``, by
    ``rng``).
    """
    turns, order = _turns(len(shares), ties, rng), np.argsort(shares, kind="stable")
    level = np.empty(len(shares), dtype=np.int64)
    level[order] = np.cumsum(np.diff(shares[order], prepend=shares[order][:1]) > ALIKE)
    return np.lexsort((turns, -level))


def largest_shares(graph: SensingGraph, shares: Floats, ties: str = "last", rng: np.random.Generator | None = None) -> NDArray[np.int32]:
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


def _turns(count: int, ties: str, rng: np.random.Generator | None) -> NDArray[np.int64]:
    """Numbers by which equal shares are ordered."""
    check_ties(ties)
    if ties != "random":
        return np.arange(count) if ties == "first" else -np.arange(count)
    if rng is None:
        raise UsageError("ties=random needs a random generator")
    return -rng.permutation(count)
