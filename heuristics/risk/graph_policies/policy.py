"""The contract of policies, and those that need no more than a shortest path."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from typing import Self

import numpy as np

from ....instances.errors import InputError
from ....instances.risk.uncertain_graph import Floats, UncertainGraph
from ....solvers.engines.risk.path_search.non_dominated_paths import NonDominated
from ....solvers.engines.risk.path_search.supported_paths import shortest_path


class Policy(ABC):
    """Says where to go next from each vertex. What it computes of the graph alone is computed once; ``fresh`` begins a walk."""

    graph: UncertainGraph

    def fresh(self) -> Self:
        """The same policy at the start of a walk."""
        return copy.copy(self)

    @abstractmethod
    def next_vertex(self, at: int, known: Floats) -> int:
        """Where to go from vertex ``at``, which is not the goal.

        Parameters
        ----------
        at : int
            The vertex that the last call returned; the graph's start at first.
        known : array of shape (edges,)
            Costs that are observed, NaN elsewhere; those of the edges that leave ``at`` are.
        """


class LeastMean(Policy):
    """The path of the least mean, whatever is observed: A* on means, and no replanning."""

    def __init__(self, graph: UncertainGraph) -> None:
        self.graph = graph
        self._path = shortest_path(graph, (1.0, 0.0)).path

    def next_vertex(self, at: int, known: Floats) -> int:
        return self._path[self._path.index(at) + 1]


class Hindsight(LeastMean):
    """The cheapest path of all, by one who knows all true costs from the start: what the others are compared with."""

    def __init__(self, graph: UncertainGraph, costs: Floats) -> None:
        super().__init__(graph.seen_from(graph.start, costs, graph.variance))


class Following(Policy):
    """A policy that keeps to a set of paths, of which those stay that begin as the walk has gone."""

    def __init__(self, graph: UncertainGraph, paths: NonDominated) -> None:
        self.graph, self.paths = graph, paths
        self._walked = [graph.start]
        self._left = list(range(len(paths.paths)))

    def fresh(self) -> Self:
        made = copy.copy(self)
        made._walked, made._left = [self.graph.start], list(range(len(self.paths.paths)))
        return made

    def ways(self, at: int) -> dict[int, list[int]]:
        """The paths that are left, by the vertex to which they go next, in ascending order of these."""
        if at != self._walked[-1]:
            raise InputError("the walk left the path that was chosen", expected=str(self._walked[-1]), found=str(at))
        step, found = len(self._walked), dict[int, list[int]]()
        for k in self._left:
            found.setdefault(self.paths.paths[k][step], []).append(k)
        return dict(sorted(found.items()))

    def take(self, vertex: int, ways: dict[int, list[int]]) -> int:
        """Go to ``vertex``."""
        self._walked.append(vertex)
        self._left = ways[vertex]
        return vertex


class Greedy(Following):
    """The observed edge of the least cost, among those by which a non-dominated path goes on."""

    def next_vertex(self, at: int, known: Floats) -> int:
        ways = self.ways(at)
        edges = self.graph.edges_of_pairs(np.full(len(ways), at), np.array(list(ways)))
        costs = np.where(np.isnan(known[edges]), self.graph.mean[edges], known[edges])
        return self.take(list(ways)[int(np.argmin(costs))], ways)
