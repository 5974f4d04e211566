"""Policies that say how to go through a graph of uncertain edge costs, vertex by vertex, while costs are observed."""

import copy
import heapq
import math
from abc import ABC, abstractmethod
from typing import Self

import numpy as np

from ...instances.errors import InputError
from ...instances.risk.uncertain_graph import Floats, UncertainGraph
from ...solvers.engines.risk.non_dominated_paths import NonDominated
from ...solvers.engines.risk.supported_paths import shortest_path

LEAST = 1e-10
"""Least cost of edges in D* Lite, in parts of the largest mean: circles of cost 0 would keep each other's distances low."""


class Policy(ABC):
    """Says where to go next from each vertex. What it computes of the graph alone is computed once; ``fresh`` begins a walk."""

    graph: UncertainGraph

    def fresh(self) -> Self:
        """The same policy at the start of a walk."""
        return copy.copy(self)

    @abstractmethod
    def next_vertex(self, at: int, known: Floats) -> int:
        """The vertex to go to from ``at``, which is not the goal: what the last call returned, the graph's start at first.

        ``known`` of shape (edges,) holds costs that are observed, those of the edges that leave ``at`` among them, and NaN elsewhere.
        """


class LeastMean(Policy):
    """The path of the least mean, whatever is observed: A* on means, and no replanning."""

    def __init__(self, graph: UncertainGraph) -> None:
        self.graph = graph
        self._path = shortest_path(graph, (1.0, 0.0)).path

    def next_vertex(self, at: int, known: Floats) -> int:
        return self._path[self._path.index(at) + 1]


class Hindsight(LeastMean):
    """The cheapest path of all, by one who knows all true costs from the start: the others are compared with it."""

    def __init__(self, graph: UncertainGraph, costs: Floats) -> None:
        super().__init__(graph.seen_from(graph.start, costs, graph.variance))


class Following(Policy):
    """A policy that keeps to a set of paths: those that begin with the vertices walked so far."""

    def __init__(self, graph: UncertainGraph, paths: NonDominated) -> None:
        self.graph, self.paths = graph, paths
        self._walked = [graph.start]
        self._left = list(range(len(paths.paths)))

    def fresh(self) -> Self:
        policy = copy.copy(self)
        policy._walked, policy._left = [self.graph.start], list(range(len(self.paths.paths)))
        return policy

    def ways(self, at: int) -> dict[int, list[int]]:
        """The paths that are left, by the vertex to which they go next, in ascending order of these."""
        if at != self._walked[-1]:
            raise InputError("the walk left the path that was chosen", "contradiction", expected=str(self._walked[-1]), found=str(at))
        step, ways = len(self._walked), dict[int, list[int]]()
        for k in self._left:
            ways.setdefault(self.paths.paths[k][step], []).append(k)
        return dict(sorted(ways.items()))

    def take(self, vertex: int, ways: dict[int, list[int]]) -> int:
        """Go to ``vertex``."""
        self._walked.append(vertex)
        self._left = ways[vertex]
        return vertex


class Greedy(Following):
    """The observed edge of the least cost, among those on which a non-dominated path goes on."""

    def next_vertex(self, at: int, known: Floats) -> int:
        ways = self.ways(at)
        edges = self.graph.edges_of_pairs(np.full(len(ways), at), np.array(list(ways)))
        costs = np.where(np.isnan(known[edges]), self.graph.mean[edges], known[edges])
        return self.take(list(ways)[int(np.argmin(costs))], ways)


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
        policy = copy.copy(self)
        for name in ("_costs", "_distance", "_ahead", "_queue"):
            setattr(policy, name, getattr(self, name).copy())
        return policy

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
        """Look ahead from a vertex anew, and queue it where it is inconsistent; older entries of it in the queue are stale."""
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
