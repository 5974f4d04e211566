"""Balls in sensing graphs: parts around some targets, cut out at a cost that depends on the part alone.

Two targets are one hop apart if a robot sees both. The ball of a set of targets is the graph of these targets, the actions that see some of
them, and the robots of those.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import entries_of
from ...instances.sata.sensing_graph import SensingGraph

Floats = NDArray[np.float64]
Indices = NDArray[np.integer[Any]]
Positions = NDArray[np.int64]

NEAR_ONE = 8.0
"""Values from the inverse of this to this are near 1."""


def num_entries(indptr: Indices, rows: Indices) -> int:
    """Number of entries in some rows of a CSR matrix."""
    return int((indptr[rows + 1].astype(np.int64) - indptr[rows]).sum())


def robots_seeing(graph: SensingGraph, targets: Indices) -> Positions:
    """Robots with an action that sees one of ``targets``, ascending."""
    sight = graph.by_target
    edges, _ = entries_of(sight.indptr, targets)
    return np.unique(graph.robot_of_action[sight.indices[edges]]).astype(np.int64)


def actions_of(graph: SensingGraph, robots: Indices) -> Positions:
    """The actions of some robots, robot after robot."""
    starts, members = graph.by_robot
    return members[entries_of(starts, robots)[0]].astype(np.int64)


def targets_seen(graph: SensingGraph, actions: Indices) -> Positions:
    """Targets that one of ``actions`` sees, ascending."""
    return np.unique(graph.indices[entries_of(graph.indptr, actions)[0]]).astype(np.int64)


def num_edges(graph: SensingGraph, targets: Indices) -> int:
    """Edges of the ball of ``targets``."""
    return num_entries(graph.by_target.indptr, targets)


def ball_graph(graph: SensingGraph, targets: Indices) -> SensingGraph:
    """The ball of ``targets`` (ascending, none twice) as a graph of its own, the targets numbered as they stand."""
    sight = graph.by_target
    edges, counts = entries_of(sight.indptr, targets)
    actions, of_edge = np.unique(sight.indices[edges], return_inverse=True)
    robots, owners = np.unique(graph.robot_of_action[actions], return_inverse=True)
    order = np.argsort(of_edge, kind="stable")  # targets ascend already, so they do within an action
    indptr = np.zeros(len(actions) + 1, dtype=np.int32)
    np.cumsum(np.bincount(of_edge, minlength=len(actions)), out=indptr[1:])
    return SensingGraph(
        owners.astype(np.int32), indptr, np.repeat(np.arange(len(targets), dtype=np.int32), counts)[order],
        sight.weights[edges][order], len(robots), len(targets), name=f"ball of {graph.name}",
    )  # fmt: skip


def grown(graph: SensingGraph, targets: Indices, most_edges: int) -> Positions | None:
    """``targets`` and as many hops more as it takes to double the edges of their ball, ascending; None where nothing can be added, or
    where the ball would have more than ``most_edges``."""
    wanted, ball = 2 * num_edges(graph, targets), targets.astype(np.int64)
    while num_edges(graph, ball) < wanted:
        actions = actions_of(graph, robots_seeing(graph, ball))
        if num_entries(graph.indptr, actions) > most_edges:
            return None
        larger = np.union1d(ball, targets_seen(graph, actions)).astype(np.int64)
        if len(larger) == len(ball):
            break
        ball = larger
    return None if len(ball) == len(targets) or num_edges(graph, ball) > most_edges else ball


def weights_bound(graph: SensingGraph, targets: Indices, weights: Floats) -> float:
    """Bound that weights of some targets prove: the largest weighted sum of coverage that the robots reach, over the sum of the weights.
    The targets ascend, none twice; one weight each, not negative, not all 0."""
    part = graph if len(targets) == graph.num_targets else ball_graph(graph, targets)
    with np.errstate(over="ignore"):
        worth = np.bincount(part.action_of_edge, part.weights * weights[part.indices], minlength=part.num_actions)
    best = np.zeros(part.num_robots)
    np.maximum.at(best, part.robot_of_action, worth)
    return float(best.sum() / weights.sum())


def near_one(graph: SensingGraph) -> tuple[SensingGraph, float]:
    """The graph with its weights in a unit in which values are near 1, and that unit; solvers have absolute tolerances.

    The unit is a power of two, which changes no digit; it is 1 where values are near 1 as they are.
    """
    value = float(coverage(graph, even_shares(graph)).min(initial=math.inf))
    if not 0.0 < value < math.inf or 1.0 / NEAR_ONE <= value <= NEAR_ONE:
        return graph, 1.0
    unit = math.ldexp(1.0, min(max(-math.frexp(value)[1], -1000), 1000))
    with np.errstate(over="ignore"):
        weights = graph.weights * unit
    # Weights of all sizes at once have no such unit: what would vanish or overflow stays as it is.
    return (replace(graph, weights=weights), unit) if (weights > 0.0).all() and np.isfinite(weights).all() else (graph, 1.0)


def even_shares(graph: SensingGraph) -> Floats:
    """Shares of shape (actions,) of robots that divide themselves evenly among their actions."""
    actions = np.bincount(graph.robot_of_action, minlength=graph.num_robots)
    return np.asarray(1.0 / actions[graph.robot_of_action])


def coverage(graph: SensingGraph, shares: Floats) -> Floats:
    """Summed weight that each target gets, of shape (targets,), from shares of shape (actions,)."""
    covered = np.bincount(graph.indices, graph.weights * shares[graph.action_of_edge], minlength=graph.num_targets)
    return np.asarray(covered, dtype=np.float64)
