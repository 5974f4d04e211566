"""From shares to whole actions: each robot takes the action of its largest share. No guarantee."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....instances.errors import UsageError
from ....instances.sensing.graph import SensingGraph
from .cleaning import Floats, Indices

TIES = ("last", "first", "random")

SAME = 1e-9
"""Shares that differ by less are a tie: what differs further behind the point is rounding."""


def check_ties(ties: Any) -> None:
    """Raise UsageError unless ``ties`` is a rule."""
    if ties not in TIES:
        raise UsageError(f"ties must be {', '.join(TIES[:-1])} or {TIES[-1]}, not {ties!r}")


def largest_shares(graph: SensingGraph, shares: Floats, ties: str = "last", rng: np.random.Generator | None = None) -> Indices:
    """The action with the largest share of each robot that has a share at all.

    Parameters
    ----------
    graph : SensingGraph
    shares : array of shape (actions,)
    ties : str
        Among shares that agree to 1e-9: the ``last`` action (as in the recorded runs of the thesis' author), the ``first``, or a
        ``random`` one.
    rng : numpy.random.Generator, optional
        For ``random``.

    Returns
    -------
    array of actions, one a robot, in the order of robots

    Raises
    ------
    UsageError
        If ``ties`` is no rule, or random without a generator.

    Notes
    -----
    Source: Sung (2019), section 3.4.1. The rounded value may be 0 where the shares cover everything:
    docs/formulations/bottleneck.md#whole-actions-from-shares.
    """
    check_ties(ties)
    if ties == "random" and rng is None:
        raise UsageError("ties=random needs a random generator")
    most = np.zeros(graph.num_robots)
    np.maximum.at(most, graph.robot_of_action, shares)
    best = np.nonzero((shares > 0) & (shares >= most[graph.robot_of_action] - SAME))[0]
    rank = rng.permutation(len(best)) if ties == "random" and rng is not None else np.arange(len(best))
    if ties == "first":
        rank = rank[::-1]
    chosen = np.full(graph.num_robots, -1, dtype=np.int64)
    # Assignment in ascending rank: the last one written stays.
    order = np.argsort(rank)
    chosen[graph.robot_of_action[best[order]]] = best[order]
    return chosen[chosen >= 0].astype(np.int32)
