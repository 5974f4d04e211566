"""D* Lite: the shortest path by means and observed costs, replanned at each vertex with what earlier searches found."""

from __future__ import annotations

import copy
import heapq
import math
from typing import Self

import numpy as np

from ....instances.risk.uncertain_graph import Floats, UncertainGraph
from .policy import Policy

LEAST = 1e-10
"""Cost, in parts of the largest mean, that edges count with at least: circles of cost 0 would keep each other's distances low."""


class DStarLite(Policy):
    """D* Lite of Koenig and Likhachev (2002), from the goal backwards, without a heuristic: costs may come true below every estimate.

    A vertex is consistent where its distance is what its neighbours' distances make it; a cost that is observed makes vertices
    inconsistent, and the search goes on from these alone.
    """

    def __init__(self, graph: UncertainGraph) -> None:
        self.graph = graph
        n = graph.num_vertices
        self._entering = np.argsort(graph.heads, kind="stable")
        self._starts = np.searchsorted(graph.heads[self._entering], np.arange(n + 1)).tolist()
        self._leaving = graph.indptr.tolist()
        self._least = LEAST * (float(graph.mean.max()) or 1.0)
        self._costs = np.maximum(graph.mean, self._least)
        self._distance, self._ahead = np.full(n, np.inf), np.full(n, np.inf)  # g and rhs
        self._ahead[graph.goal] = 0.0
        self._queue: list[tuple[float, int]] = [(0.0, graph.goal)]
        self._search(graph.start)

    def fresh(self) -> Self:
        made = copy.copy(self)
        for name in ("_costs", "_distance", "_ahead", "_queue"):
            setattr(made, name, getattr(self, name).copy())
        return made

    def next_vertex(self, at: int, known: Floats) -> int:
        costs = np.maximum(known, self._least)
        changed = np.nonzero(~np.isnan(known) & (costs != self._costs))[0]
        if len(changed):
            self._costs[changed] = costs[changed]
            for vertex in np.unique(self.graph.tails[changed]).tolist():
                self._update(vertex)
            self._search(at)
        here = slice(self._leaving[at], self._leaving[at + 1])
        heads = self.graph.heads[here]
        return int(heads[np.argmin(self._costs[here] + self._distance[heads])])

    def _update(self, vertex: int) -> None:
        """Look ahead from a vertex anew, and queue it where it is inconsistent; what the queue holds of it besides is stale."""
        if vertex != self.graph.goal:
            here = slice(self._leaving[vertex], self._leaving[vertex + 1])
            self._ahead[vertex] = (self._costs[here] + self._distance[self.graph.heads[here]]).min(initial=math.inf)
        if self._ahead[vertex] != self._distance[vertex]:
            heapq.heappush(self._queue, (float(min(self._ahead[vertex], self._distance[vertex])), vertex))

    def _search(self, start: int) -> None:
        """Make all vertices consistent that are nearer to the goal than ``start``, and ``start``."""
        distance, ahead, queue = self._distance, self._ahead, self._queue
        while queue and (queue[0][0] <= min(ahead[start], distance[start]) or ahead[start] != distance[start]):
            key, vertex = heapq.heappop(queue)
            if ahead[vertex] == distance[vertex] or key != min(ahead[vertex], distance[vertex]):
                continue
            entering = self._entering[self._starts[vertex] : self._starts[vertex + 1]]
            tails = self.graph.tails[entering]
            if ahead[vertex] < distance[vertex]:
                distance[vertex] = ahead[vertex]
                nearer = self._costs[entering] + distance[vertex]
                better = (nearer < ahead[tails]) & (tails != self.graph.goal)
                ahead[tails[better]] = nearer[better]
                for tail in tails[better].tolist():
                    heapq.heappush(queue, (float(min(ahead[tail], distance[tail])), tail))
            else:
                distance[vertex] = math.inf
                for tail in (vertex, *tails.tolist()):
                    self._update(tail)
