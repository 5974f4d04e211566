"""Evidence ``move-potentials``: numbers of the moves that no hazard of a walk ending with them falls below."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS
from .following_moves import FollowingMoves, following_moves

if TYPE_CHECKING:
    from ....instances.risk.risky_graph import RiskyGraph
    from ..risky_path import RiskyPath

Floats = NDArray[np.float64]

MOST_STEPS = 500
"""Hazards at which the largest ratio is looked for; more states with rewards are taken together."""

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("move-potentials")
def check_move_potentials(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """The bound that any potentials prove: what a pair of moves exceeds its hazard by is paid at every move of a path.

    ``potentials`` holds one number a move, null for infinity; ``prices``, optional, one number of at least 0 a state, which a path pays
    once at most, so that hazards may be the larger by them and the bound is the smaller by their sum. Least risk or hazard: the least
    potential of a move into a goal, or that there is no answer where all are infinite. Reward per risk: for each hazard t the rewards of
    all states that can be reached within it, as many as their least hazards leave room for, over the risk of the larger of t and what they
    take.

    Notes
    -----
    Source: docs/formulations/risky-path.md#bounds.
    """
    if problem.family != "risky-path":
        raise InputError("potentials of moves are evidence for risky paths", found=problem.family)
    graph = problem.graph
    nothing = -math.inf if problem.sense == "min" else math.inf
    potentials = np.array([math.inf if p is None else p for p in data["potentials"]], dtype=np.float64)
    if potentials.shape != graph.tail.shape or np.isnan(potentials).any():
        raise InputError("evidence needs one potential a move", expected=str(len(graph.tail)), found=str(potentials.shape))
    pairs = following_moves(graph)
    if pairs is None:
        return nothing
    prices = np.array(data.get("prices", [0.0] * graph.num_states), dtype=np.float64)
    if prices.shape != (graph.num_states,) or not (np.isfinite(prices) & (prices >= 0.0)).all():
        raise InputError("prices must be finite and not negative, one a state", expected=str(graph.num_states), found=str(prices.shape))
    reached = _reached(graph, potentials, pairs, prices)
    if reached is None:
        return nothing
    reached[graph.start] = pairs.start_hazard
    goals = list(graph.goals)
    if goals and np.isinf(reached[goals]).all():
        return -nothing
    if problem.sense == "min":
        least = max(0.0, float(reached[goals].min()))
        return least if problem.objective == "hazard" else -math.expm1(-least) * (1.0 - 4.0 * _EPS)
    return _ratio(problem, reached, pairs, float(reached[goals].min()) if goals else 0.0)


def _reached(graph: RiskyGraph, potentials: Floats, pairs: FollowingMoves, prices: Floats) -> Floats | None:
    """A lower bound on the hazard of paths to each state; None where the potentials prove none."""
    head = graph.head
    before = np.where(pairs.earlier >= 0, potentials[pairs.earlier] if len(head) else 0.0, pairs.start_hazard)
    with np.errstate(invalid="ignore"):
        excess = float(
            np.nan_to_num(potentials[pairs.later] - (before + pairs.hazard + prices[head[pairs.later]]), nan=0.0, posinf=math.inf).max(
                initial=0.0
            )
        )
    if excess == math.inf:
        return None
    finite = potentials[np.isfinite(potentials)]
    size = float(np.abs(finite).max(initial=pairs.start_hazard if pairs.start_hazard < math.inf else 0.0))
    low = np.full(graph.num_states, math.inf)
    np.minimum.at(low, head, potentials)
    paid = math.fsum(prices.tolist())
    return np.maximum(low - paid - graph.num_states * (excess + 4.0 * _EPS * (size + paid)), 0.0)


def _ratio(problem: RiskyPath, reached: Floats, pairs: FollowingMoves, least: float) -> float:
    graph, discount = problem.graph, problem.graph.discount
    rewards = np.asarray(graph.rewards, dtype=np.float64)
    entry = np.full(graph.num_states, math.inf)
    np.minimum.at(entry, graph.head[pairs.later], np.maximum(pairs.hazard * (1.0 - 4.0 * _EPS), 0.0))
    begin = pairs.start_hazard
    alone = [float(rewards[graph.start])] if not graph.goals or graph.start in graph.goals else []
    best = max((r / -math.expm1(-begin) if begin > 0.0 else math.inf for r in alone if r > 0.0), default=0.0)
    able = np.nonzero((rewards > 0.0) & np.isfinite(reached) & np.isfinite(entry))[0]
    able = able[able != graph.start]
    with np.errstate(divide="ignore"):
        able = able[np.argsort(-rewards[able] / entry[able], kind="stable")]
    worth, cost, near = rewards[able], entry[able], reached[able]
    steps = np.unique(near)
    groups = np.array_split(steps, MOST_STEPS) if len(steps) > MOST_STEPS else [steps[k : k + 1] for k in range(len(steps))]
    for group in groups:
        within = near <= group[-1]
        floor = max(float(group[0]), least)
        value = np.concatenate([[0.0], np.cumsum(discount * worth[within])]) + (1.0 - discount) * worth[within].max()
        spent = begin + np.concatenate([[0.0], np.cumsum(cost[within])])
        at_floor = float(np.interp(floor, spent, value)) if floor > begin else float(value[spent <= begin].max())
        beyond = spent > floor
        risk = np.concatenate([[-math.expm1(-floor)], -np.expm1(-spent[beyond])])
        gained = np.concatenate([[at_floor], value[beyond]])
        if (risk[gained > 0.0] == 0.0).any():
            return math.inf
        best = max(best, float((gained[gained > 0.0] / risk[gained > 0.0]).max(initial=0.0)))
    return best * (1.0 + 64.0 * _EPS * (len(able) + 4))
