"""Improvement of an answer and a bound by work on the targets that fall short alone; docs/saddle.md#what-the-engine-does.

Shares are moved downhill on the sum of squared deficits max(0, level - cover)^2, at a level just below the bound, robot by robot
(``descent_kernels``). Where this comes to rest, the deficits are weights that prove a bound below the level: with d = max(0, level -
cover), rest means that no shares do better on sum_j d_j cover_j, so that the optimum is at most sum_j d_j cover_j / sum_j d_j = level -
|d|^2 / sum_j d_j. They mark the cluster that keeps the value down, whose price a linear program over the ball around it tells exactly; the
last few targets are lifted by linear programs over the robots around them.
"""

from __future__ import annotations

import numpy as np

from .....formulations.sata.balls import Floats, Indices, ball_graph, grown
from ....bounds.sata.ball import ball_weights
from .game import Game
from .programs import lift, lift_edges, parts

FEW, LEAST_FEW = 1 / 64, 16
"""Targets that may fall short of a level to begin with, as a share and a number. While the bound is far off, levels rise step by step."""

RISE = 0.5
"""Least rise of the level in a step, as a share of what is left to rise."""

NEAR = 0.95
"""From this share of the bound on, the level is the one that is aimed at."""

MANY, LEAST_MANY = 0.2, 1_000
"""If more targets than this share and this number fall short at a rest, the value is no matter of some clusters."""

STILL = 0.05
"""Improvement of a bound that counts, as a share of the gap asked for."""

AIM = 0.5
"""The level aimed at lies above the value wanted by this share of its distance to the bound."""

NEGLIGIBLE = 0.2
"""Deficit that does not count, as a share of the distance between the level aimed at and the value wanted."""

CLUSTERS = 8
"""Clusters of the lowest bounds that one linear program prices together."""

SEEDS = 3
"""Worst-covered targets that the first ball is grown around."""


def refine(game: Game, shares: Floats, most_work: float, share: float = AIM) -> None:
    """Improve answer and bound from ``shares``, which change in place, until the gap is closed or this brings nothing more.

    ``most_work``: edges that the descent may read; ``share``: other than ``AIM``.
    """
    record, limits = game.record, game.limits
    end = limits.work + most_work
    cover = record.offer(shares)
    if not np.isfinite(record.bound):
        _first_bound(game, cover)
    level = record.value
    while not (record.closed() or limits.reached() or limits.work >= end):
        aim = record.wanted + share * (record.bound - record.wanted)
        negligible = NEGLIGIBLE * (aim - record.wanted)
        few = min(int(FEW * len(cover)) + LEAST_FEW, len(cover) - 1)
        level = max(float(np.partition(cover, few)[few]), level + RISE * (aim - level))
        final = record.value >= NEAR * record.bound or level >= aim - negligible
        level = aim if final else level
        game.descend(shares, cover, level, negligible, end)
        cover = record.offer(shares)
        short = np.nonzero(level - cover > negligible)[0]
        if record.closed() or limits.reached():
            return
        if not len(short):
            continue
        if len(short) > max(MANY * len(cover), LEAST_MANY):
            record.prove(short, level - cover[short])
            if game.graph.num_edges <= game.programs.most_edges(limits.work):
                _price_ball(game, np.arange(len(cover)))
                _lift(game, shares, cover, 0.5 * (record.wanted + record.bound), record.wanted)
            return
        before = record.bound
        _price(game, short, level - cover[short], final)
        if not final or before - record.bound > STILL * (before - before / (1.0 + record.gap)):
            continue
        if not _lift(game, shares, cover, level, record.wanted):
            return
        cover = record.offer(shares)


def _first_bound(game: Game, cover: Floats) -> None:
    """Bounds to begin with: by even prices, and by the worst-covered targets."""
    n = len(cover)
    game.record.prove(np.arange(n), np.ones(n))
    count = min(SEEDS, n)
    _price_ball(game, np.sort(np.argpartition(cover, count - 1)[:count]))


def _price(game: Game, targets: Indices, deficits: Floats, always: bool) -> None:
    """Bounds from the deficits at a rest: those of each cluster as they are, then linear programs around the worst clusters.

    The programs are solved only if a cluster's deficits lowered the bound, or ``always``.
    """
    part = ball_graph(game.graph, targets)
    seeing = part.robot_of_action[part.action_of_edge]
    cluster, cluster_of_robot, count = parts(part.indices, seeing, part.num_targets, part.num_robots)
    with np.errstate(over="ignore"):  # a bound that overflows proves nothing
        worth = np.bincount(part.action_of_edge, part.weights * deficits[part.indices], minlength=part.num_actions)
    best = np.zeros(part.num_robots)
    np.maximum.at(best, part.robot_of_action, worth)
    bounds = np.bincount(cluster_of_robot, best, minlength=count) / np.bincount(cluster, deficits, minlength=count)
    order = np.argsort(bounds, kind="stable")
    lowest = np.nonzero(cluster == order[0])[0]
    before = game.record.bound
    game.record.prove(targets[lowest], deficits[lowest], float(bounds[order[0]]))
    if not (always or game.record.bound < before):
        return
    edges = np.bincount(cluster, np.diff(part.by_target.indptr), minlength=count)[order[:CLUSTERS]]
    fitting = int(np.searchsorted(np.cumsum(edges), game.programs.most_edges(game.limits.work), side="right"))
    if fitting:
        chosen = np.zeros(count, dtype=bool)
        chosen[order[:fitting]] = True
        _price_ball(game, targets[chosen[cluster]])


def _price_ball(game: Game, targets: Indices) -> None:
    """Linear programs over a ball that grows until its bound stands still."""
    record, limits, last = game.record, game.limits, np.inf
    ball: Indices | None = targets
    while ball is not None and not limits.reached():
        ball_price = ball_weights(game.graph, ball, limits.stop, game.programs)
        if ball_price is None:
            return
        bound, priced, weights = ball_price
        record.prove(priced, weights, bound)
        if bound > last * (1.0 - STILL * record.gap):
            return
        last = bound
        ball = grown(game.graph, ball, game.programs.most_edges(limits.work))


def _lift(game: Game, shares: Floats, cover: Floats, level: float, wanted: float) -> bool:
    """Lift the targets below ``wanted`` by linear programs over growing balls; true if all were lifted."""
    record, limits, doublings = game.record, game.limits, 0
    while not limits.reached():
        ball: Indices | None = np.nonzero(cover < wanted)[0]
        if ball is None or not len(ball):
            return True
        room = game.programs.most_edges(limits.work)
        for _ in range(doublings):
            ball = None if ball is None else grown(game.graph, ball, room)
        if ball is None or lift_edges(game.graph, ball) > room:
            return False
        lifted = lift(game.graph, shares, cover, ball, level, game.programs.solve)
        if lifted is None:
            return False
        done = lifted.reached >= wanted
        shares[lifted.actions[done]] = lifted.shares[done]
        cover[:] = record.offer(shares)
        doublings += 1
    return False
