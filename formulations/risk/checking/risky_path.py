"""Checkers of evidence on risky paths: ``move-potentials``, ``guarded-walks`` and ``all-paths``.

Paths without repetition are walks that come to some states once at most, whatever states are guarded, and a walk costs no less than
potentials of its moves say.
"""

import heapq
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats, Integers as Indices
from ....instances.risk.element import TraverseElement
from ....instances.risk.risky_graph import RiskyGraph
from ...evidence import checker
from ...stop import current_stop
from ..risky_path import RiskyPath

_EPS = float(np.finfo(np.float64).eps)

MOST_PAIRS = 40_000_000
"""Pairs of moves that are looked at."""


@dataclass(frozen=True)
class FollowingMoves:
    """Pairs (a, b) of moves, a before b; a = -1 stands for nothing, where b leaves the start.

    ``hazard`` is at least that of b after a, infinite where nothing survives it; all arrays have the shape (pairs,).
    """

    earlier: Indices
    later: Indices
    hazard: Floats
    start_hazard: float

    def successors(self) -> dict[int, list[tuple[int, float]]]:
        """Moves that may follow each move, with their hazards; under -1 the moves that leave the start."""
        after: dict[int, list[tuple[int, float]]] = {}
        for earlier, later, hazard in zip(self.earlier.tolist(), self.later.tolist(), self.hazard.tolist(), strict=True):
            after.setdefault(earlier, []).append((later, hazard))
        return after


def following_moves(graph: RiskyGraph, among: tuple[Any, ...] | None = None) -> FollowingMoves | None:
    """All pairs, priced by the elements ``among`` (all by default); None where there are too many."""
    tail, head = graph.tail.astype(np.int64), graph.head.astype(np.int64)
    numbers = np.arange(len(tail))
    by_head = numbers[np.argsort(head, kind="stable")]
    into = np.bincount(head, minlength=graph.num_states)
    ends = np.cumsum(into)
    many = into[tail]
    if int(many.sum()) > MOST_PAIRS:
        return None
    later = np.repeat(numbers, many)
    place = np.arange(len(later)) - np.repeat(np.cumsum(many) - many, many)
    earlier = by_head[(ends - into)[tail[later]] + place]
    kept = (tail[later] != graph.start) & (head[earlier] != graph.start) & (head[later] != graph.start) & (tail[earlier] != head[later])
    leaving = numbers[tail == graph.start]
    earlier = np.concatenate([earlier[kept], np.full(len(leaving), -1)])
    later = np.concatenate([later[kept], leaving])
    before = np.where(earlier >= 0, tail[earlier] if len(tail) else -1, -1)
    elements = graph.elements if among is None else among
    hazard, begin = np.zeros(len(later)), 0.0
    for element in elements:
        with np.errstate(divide="ignore"):
            hazard -= np.log1p(-graph.least_risks(element, before, tail[later], head[later]))
        first = float(graph.least_risks(element, [-1], [-1], [graph.start])[0])
        begin += -math.log1p(-first) if first < 1.0 else math.inf
    return FollowingMoves(earlier, later, hazard, begin)


MOST_STEPS = 500
"""Hazards at which the largest ratio is looked for; more states with rewards are taken together."""


@checker("move-potentials", "risky-path", "potentials of moves are", of="risky paths")
def check_move_potentials(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """Bound that any potentials prove: the most by which a pair of moves exceeds its hazard is paid at every move of a path.

    ``potentials`` holds one number per move, null for infinity; ``prices``, optional, one number of at least 0 a state, which a path pays
    once at most, so that hazards may be the larger by them and the bound is the smaller by their sum. Least risk or hazard: the least
    potential of a move into a goal, or that there is no answer where all are infinite. Reward per risk: for each hazard t the rewards of
    all states that can be reached within it, as many as their least hazards leave room for, over the risk of the larger of t and what they
    take. Source: docs/formulations/risky-path.md#bounds.
    """
    graph = problem.graph
    nothing = -math.inf if problem.sense == "min" else math.inf
    potentials = np.array([math.inf if p is None else p for p in data["potentials"]], dtype=np.float64)
    if potentials.shape != graph.tail.shape or np.isnan(potentials).any():
        raise InputError("evidence needs one potential a move", "wrong-shape", expected=str(len(graph.tail)), found=str(potentials.shape))
    pairs = following_moves(graph)
    if pairs is None:
        return nothing
    prices = np.array(data.get("prices", [0.0] * graph.num_states), dtype=np.float64)
    if prices.shape != (graph.num_states,) or not (np.isfinite(prices) & (prices >= 0.0)).all():
        raise InputError(
            "prices must be finite and not negative, one a state", "wrong-shape", expected=str(graph.num_states), found=str(prices.shape)
        )
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


MOST_WALKS = 300_000
"""Walks that are kept."""


@checker("guarded-walks", "risky-path", "walks are", of="risky paths")
def check_guarded_walks(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """Least risk or hazard of walks to a goal that come to no state of ``guarded`` twice, or ``most``, a hazard, if that is less.

    ``guarded`` lists states, ``most`` is a number or null. What traverse elements remember of a walk is kept beside its last move, so that
    their risks count in full. Nothing is proved for rewards, nor where there are too many walks.
    """
    graph = problem.graph
    guarded = [int(state) for state in data["guarded"]]
    if not all(0 <= state < graph.num_states for state in guarded):
        raise InputError("evidence guards a state that does not exist", "unknown-name", expected=f"0 to {graph.num_states - 1}")
    most = math.inf if data["most"] is None else float(data["most"])
    if math.isnan(most):
        raise InputError("most must be a number or null", "out-of-range")
    if problem.sense != "min":
        return math.inf
    memoryless = tuple(e for e in graph.elements if not isinstance(e, TraverseElement))
    own, whole = following_moves(graph, memoryless), following_moves(graph)
    least = None if own is None or whole is None else _least(problem, own, least_left(problem, whole), frozenset(guarded), most)
    if least is None:
        return -math.inf
    low = max(0.0, least * (1.0 - 16.0 * _EPS * (graph.num_states + 4)))
    return low if problem.objective == "hazard" or low == math.inf else -math.expm1(-low) * (1.0 - 4.0 * _EPS)


def least_left(problem: RiskyPath, pairs: FollowingMoves) -> Floats:
    """Least hazard from each move to a goal, whatever came before; 0 without goals."""
    goals = list(problem.graph.goals)
    if not goals:
        return np.zeros(len(problem.graph.tail))
    to_goal = np.where(np.isin(problem.graph.head, goals), 0.0, math.inf)
    inner = pairs.earlier >= 0
    earlier, later, hazard = pairs.earlier[inner], pairs.later[inner], pairs.hazard[inner]
    for _ in range(len(to_goal)):
        before = to_goal.copy()
        np.minimum.at(to_goal, earlier, hazard + before[later])
        if (to_goal == before).all():
            break
    return to_goal * (1.0 - 1e-12)


class Remembered:
    """Memories of all traverse elements along walks; equal steps are looked up."""

    def __init__(self, problem: RiskyPath) -> None:
        self._graph, self._elements = problem.graph, problem.graph.traverse
        self._made: dict[tuple[Any, int, int], tuple[tuple[Any, ...], float]] = {}
        begun = [e.begin(self._graph, self._graph.start) for e in self._elements]
        self.begin, self.start_hazard = tuple(memory for memory, _ in begun), _hazard([risk for _, risk in begun])

    def step(self, memories: tuple[Any, ...], state: int, after: int) -> tuple[tuple[Any, ...], float]:
        """Memories and hazard after a move."""
        if not self._elements:
            return memories, 0.0
        key = memories, state, after
        if key not in self._made:
            stepped = [e.step(self._graph, memory, state, after) for e, memory in zip(self._elements, memories, strict=True)]
            self._made[key] = tuple(memory for memory, _ in stepped), _hazard([risk for _, risk in stepped])
        return self._made[key]


def _hazard(risks: list[float]) -> float:
    return math.inf if any(r >= 1.0 for r in risks) else math.fsum(-math.log1p(-r) for r in risks)


def _least(problem: RiskyPath, own: FollowingMoves, left: Floats, guarded: frozenset[int], most: float) -> float | None:
    graph, remembered, stop = problem.graph, Remembered(problem), current_stop()
    head, goals, to_goal = graph.head.tolist(), set(graph.goals), left.tolist()
    after = own.successors()
    start = own.start_hazard + remembered.start_hazard
    if graph.start in goals:
        return min(start, most)
    # hazard with what is left, number, hazard, last move, memories, guarded states behind
    ahead: list[tuple[float, int, float, int, tuple[Any, ...], frozenset[int]]] = [(start, 0, start, -1, remembered.begin, frozenset())]
    kept: dict[tuple[int, tuple[Any, ...]], list[tuple[float, frozenset[int]]]] = {}
    number = walks = 0
    while ahead:
        least, _, hazard, move, memories, behind = heapq.heappop(ahead)
        if least >= most:
            return most
        if move >= 0 and head[move] in goals:
            return min(hazard, most)
        others = kept.setdefault((move, memories), [])
        if any(h <= hazard and b <= behind for h, b in others):
            continue
        others.append((hazard, behind))
        walks += 1
        if walks > MOST_WALKS or (walks % 512 == 0 and stop.reached()):
            return None
        here = graph.start if move < 0 else head[move]
        for later, more in after.get(move, ()):
            state = head[later]
            if state in behind:
                continue
            then, extra = remembered.step(memories, here, state)
            total = hazard + more + extra
            if total + to_goal[later] < math.inf:
                number += 1
                marked = behind | {state} if state in guarded else behind
                heapq.heappush(ahead, (max(least, total + to_goal[later]), number, total, later, then, marked))
    return most


MOST_PATHS = 30_000
"""Beginnings of paths that are walked."""

CANCELLED = 1e-3
"""Part of all rewards below which those not yet collected are added up anew, instead of subtracted from all."""


@checker("all-paths", "risky-path", "all paths are", of="risky paths")
def check_all_paths(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """The larger of ``target`` and of the rewards per risk of all paths that could earn more; null asks for all paths.

    A beginning is left alone once all rewards that are not yet collected would not bring it above the target. Nothing is proved for least
    risks, nor where there are more than ``MOST_PATHS`` others.
    """
    target = data["target"]
    if target is not None and (isinstance(target, bool) or not isinstance(target, int | float) or math.isnan(target)):
        raise InputError("the target must be a number", found=str(target)[:40])
    if problem.sense != "max":
        return -math.inf
    own = following_moves(problem.graph, tuple(e for e in problem.graph.elements if not isinstance(e, TraverseElement)))
    best = None if own is None else _walked(problem, own, -math.inf if target is None else float(target))
    return math.inf if best is None else best


def _walked(problem: RiskyPath, own: FollowingMoves, best: float) -> float | None:
    graph, remembered, stop, walked = problem.graph, Remembered(problem), current_stop(), 0
    head, rewards, ends = graph.head.tolist(), problem.rewards.tolist(), set(graph.goals)
    after = own.successors()
    total, slack = math.fsum(rewards), 1.0 + 16.0 * _EPS * (graph.num_states + 4)
    # path, hazard, reward, memories of traverse elements, last move
    ahead: list[tuple[tuple[int, ...], float, float, tuple[Any, ...], int]] = [
        ((graph.start,), own.start_hazard + remembered.start_hazard, rewards[graph.start], remembered.begin, -1)
    ]
    while ahead:
        path, hazard, reward, memories, move = ahead.pop()
        walked += 1
        if walked > MOST_PATHS or (walked % 512 == 0 and stop.reached()):
            return None
        if hazard == math.inf:
            continue
        risk = -math.expm1(-hazard) / slack
        if risk > 0.0 and (not ends or path[-1] in ends):
            best = max(best, reward / risk)
        if risk > 0.0 and len(path) > 1 and (reward + _rest(rewards, total, path)) * slack / risk <= best:
            continue
        for later, more in after.get(move, ()):
            state = head[later]
            if state not in path:
                then, extra = remembered.step(memories, path[-1], state)
                kept = graph.discount * reward if len(path) > 1 else 0.0
                ahead.append(((*path, state), hazard + more + extra, kept + rewards[state], then, later))
    return best


def _rest(rewards: list[float], total: float, path: tuple[int, ...]) -> float:
    """Upper bound, up to relative rounding, on the total reward of the states that are not on ``path``."""
    rest = total - math.fsum(rewards[state] for state in path)
    if rest > CANCELLED * total:
        return rest + 2.0 * _EPS * total
    behind = set(path)
    return math.fsum(reward for state, reward in enumerate(rewards) if state not in behind)
