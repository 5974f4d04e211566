"""Most reward per risk: paths grown in the order of the most that any longer one could earn.

A path is dominated by another that ends with the same move at no more hazard and no less reward, with memories that are no worse and no
state behind it that the other has not. Where the last reward alone counts (discount 0) the least risky path to each state is all that
matters. Source: Xiao (2019), section 4.1; docs/formulations/risky-path.md#most-reward-per-risk.
"""

import heapq
import itertools
import math
from typing import Any

import numpy as np

from .....formulations.risk.marked_paths import CutShortError, risky_path
from .....formulations.risk.moves import Memories
from .....formulations.risk.risky_path import Path, RiskyPath
from .....formulations.stop import Stop
from .....instances.number_arrays import Floats
from ....backend import Control, Options, RawResult
from .least_hazard import LOOK, least_hazard


def most_reward(problem: RiskyPath, stop: Stop, options: Options, control: Control) -> RawResult:
    """A path of most reward per risk; see ``Engine.run``."""
    search = _Search(problem, stop, options, control)
    if options.start is not None:
        search.offer(problem.answer_of(options.start))
    search.offer((problem.graph.start,))
    return search.by_ends() if problem.graph.discount == 0.0 else search.by_paths()


class _Search:
    def __init__(self, problem: RiskyPath, stop: Stop, options: Options, control: Control) -> None:
        self.problem, self.stop, self.control, self.budget = problem, stop, control, options.iterations
        self.graph, self.moves, self.memories = problem.graph, problem.moves, Memories(problem.graph)
        self.reach = self.moves.to_states()
        self.ends = np.ones(self.graph.num_states, dtype=bool)
        if self.graph.goals:
            self.ends[:] = False
            self.ends[list(self.graph.goals)] = True
        self.best: Path | None = None
        self.value, self.grown = 0.0, 0

    def offer(self, path: Path) -> bool:
        """Keep ``path`` if it is the best so far; whether it is an answer."""
        verdict = self.problem.evaluate(path)
        if verdict.feasible and (self.best is None or verdict.values[0] > self.value):
            self.best, self.value = path, verdict.values[0]
            self.control.publish(path, self.value)
        return bool(verdict.feasible)

    def offer_walks(self) -> None:
        """The least risky way to each end, where it is a path."""
        for state in np.nonzero(np.isfinite(self.reach) & self.ends)[0].tolist():
            walk = self.moves.walk(state)
            if walk is not None and len(set(walk)) == len(walk):
                self.offer(walk)

    def by_ends(self) -> RawResult:
        """The last reward over the risk of the least risky path to it, the most promising ends first."""
        self.offer_walks()
        rewards = self.problem.rewards
        able = np.nonzero(self.ends & (rewards > 0.0) & np.isfinite(self.reach))[0]
        able = able[able != self.graph.start]
        with np.errstate(divide="ignore"):
            hopes = rewards[able] / -np.expm1(-self.reach[able])
        bound = self.value
        for k in np.argsort(-hopes, kind="stable").tolist():
            if hopes[k] <= self.value:
                break
            most = -math.log1p(-min(float(rewards[able[k]]) / self.value, 1.0)) if self.value > rewards[able[k]] else math.inf
            labels = None if self.budget is None else max(self.budget - self.grown, 0)
            search = least_hazard(self.problem, (int(able[k]),), self.stop, self.memories, most, labels)
            self.grown += search.labels
            if search.path is not None:
                self.offer(search.path)
            elif search.limit != "none":
                return self._result(search.limit, max(float(hopes[k]), self.value))
            bound = self.value
        return self._result("none", max(bound, self.value))

    def by_paths(self) -> RawResult:
        """All paths that may earn more than the best one so far."""
        self.offer_walks()
        limit, bound = self._grow()
        return self._result(limit, max(bound, self.value))

    def _grow(self) -> tuple[str, float]:
        graph, moves, memories = self.graph, self.moves, self.memories
        head, rewards, discount = graph.head.tolist(), self.problem.rewards.tolist(), graph.discount
        begin, serial, hopes = len(head), itertools.count(), _Hopes(self.problem, self.reach)
        heap: list[tuple[Any, ...]] = [
            (-math.inf, next(serial), moves.start_hazard, 0.0, begin, memories.begin, 1 << graph.start, (graph.start,))
        ]
        settled: dict[int, list[tuple[float, float, int, int]]] = {}
        while heap:
            hope, _, hazard, reward, move, memory, behind, path = heapq.heappop(heap)
            if -hope <= self.value:
                return "none", self.value
            others = settled.setdefault(move, [])
            if any(h <= hazard and r >= reward and not b & ~behind and memories.no_worse(m, memory) for h, r, m, b in others):
                continue
            others.append((hazard, reward, memory, behind))
            self.grown += 1
            if self.grown % LOOK == 0 and (limit := self.stop.reached()):
                return limit, -hope
            if self.budget is not None and self.grown > self.budget:
                return "iterations", -hope
            for after, own in zip(*moves.successors[move], strict=True):
                reached = head[after]
                if behind >> reached & 1:
                    continue
                carried, more = memories.step(memory, path[-1], reached) if memories.elements else (memory, 0.0)
                total, earned, longer = hazard + own + more, discount * reward + rewards[reached], (*path, reached)
                if total == math.inf:
                    continue
                if self.ends[reached] and total > 0.0 and earned / -math.expm1(-total) > self.value:
                    self.offer(longer)
                most = hopes.of(earned, total, longer)
                if most > self.value:
                    heapq.heappush(heap, (-min(most, -hope), next(serial), total, earned, after, carried, behind | 1 << reached, longer))
        return "none", self.value

    def _result(self, limit: str, bound: float) -> RawResult:
        if self.best is None and limit == "none":
            limit = self._without_reward()
        statistics = {"labels": self.grown}
        if self.best is None:
            if limit != "none":
                return RawResult("unknown", limit, statistics=statistics)
            return RawResult("infeasible", statistics=statistics, message="no path may end where it has a risk between 0 and 1")
        status = "optimal" if limit == "none" and math.isfinite(bound) else "feasible"
        return RawResult(status, limit, self.best, self.value, bound if math.isfinite(bound) else None, statistics=statistics)

    def _without_reward(self) -> str:
        """Offer any path with a risk, as none earns anything; the limit that ended the search."""
        try:
            path = risky_path(self.problem, self.stop, None if self.budget is None else max(self.budget - self.grown, 0))
        except CutShortError as cut:
            return str(cut)
        if path is not None:
            self.offer(path)
        return "none"


class _Hopes:
    """Upper bounds on the reward per risk of paths that continue one: rewards ahead in the order of their least cost."""

    def __init__(self, problem: RiskyPath, reach: Floats) -> None:
        graph, moves = problem.graph, problem.moves
        entry = np.full(graph.num_states, math.inf)
        np.minimum.at(entry, graph.head[moves.second], moves.hazard)
        np.minimum.at(entry, graph.head[moves.begin], moves.begin_hazard)
        able = np.nonzero((problem.rewards > 0.0) & np.isfinite(reach) & np.isfinite(entry))[0]
        with np.errstate(divide="ignore"):
            able = able[np.argsort(-problem.rewards[able] / entry[able], kind="stable")]
        self.worth, self.cost, self.discount = problem.rewards[able], entry[able], graph.discount
        self._place = {state: k for k, state in enumerate(able.tolist())}

    def of(self, reward: float, hazard: float, path: Path) -> float:
        """An upper bound for all paths that begin with ``path`` and are longer."""
        ahead = np.ones(len(self.worth), dtype=bool)
        ahead[[self._place[s] for s in path if s in self._place]] = False
        worth = self.worth[ahead]
        if not len(worth):
            return self.discount * reward / -math.expm1(-hazard) if hazard > 0.0 else math.inf
        last = (1.0 - self.discount) * float(worth.max())
        value = last + self.discount * (reward + np.concatenate([[0.0], np.cumsum(worth)]))
        risk = -np.expm1(-hazard - np.concatenate([[0.0], np.cumsum(self.cost[ahead])]))
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.nan_to_num(value / risk, nan=0.0, posinf=math.inf).max()) * (1.0 + 1e-12)
