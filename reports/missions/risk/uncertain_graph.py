"""Uncertain graph: a robot goes to its goal through a graph whose edge costs it learns on the way."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.risk.path_sets import FIRST_EDGES
from ....formulations.risk.uncertain_path import RISK, UncertainPath
from ....heuristics.risk._graph_policies import DStarLite, Greedy, Hindsight, LeastMean, Policy
from ....heuristics.risk.rags import COMPARISONS, RULES, RiskAware
from ....instances.risk.uncertain_graph import UncertainGraph
from ....instances.risk.worlds.uncertain_graph import ROBOT, UncertainGraphObservation, UncertainGraphWorld
from ....instances.worlds import WORLDS, Setting, World
from ....solvers.engines.risk.non_dominated_paths import DOMINANCE, NonDominated, non_dominated_paths
from ...plots.risk.uncertain_path import places
from ..mission import MISSIONS, Actions, Mission, Scene

POLICIES = ("rags", "a-star", "greedy", "d-star-lite", "hindsight")


class UncertainGraphMission(Mission):
    """Reach the goal at a small cost: at each vertex the robot sees what the edges that leave it cost, and goes along one.

    Source: Skeele (2016), sections 5.4 and 5.5; readings of what it leaves open: docs/missions.md#uncertain-graph.
    """

    name: ClassVar[str] = "uncertain-graph"
    summary: ClassVar[str] = "a robot goes through a graph whose edge costs it learns on the way"
    headline: ClassVar[str] = "cost"
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["uncertain-graph"].settings,
        "risk": Setting(0.5, RISK.help + "; of what solvers and heuristics plan", float, 0.0, 0.5),
        "rule": Setting("best", "of rags: the largest probability, or the champion of pairwise comparisons", choices=RULES),
        "observe": Setting(True, "whether rags uses the costs that it sees"),
        "comparison": Setting("independent", "of rags: paths as if they shared no edge, or jointly", choices=COMPARISONS),
        "first-edges": Setting("separate", "of rags, where it observes nothing: copies of an edge's cost, or one", choices=FIRST_EDGES),
        "dominance": Setting("weak", "of the paths that rags and greedy keep to", choices=DOMINANCE),
    }

    def world(self, seed: int, **settings: Any) -> UncertainGraphWorld:
        world = self.made(UncertainGraphWorld, seed, settings)
        self._world = world
        self._walks: dict[str, Policy] = {}
        return world

    def problem(self, observation: UncertainGraphObservation) -> Problem | None:
        """A path from here to the goal, with known costs in place of uncertain ones; None at the goal."""
        o = observation
        if o.arrived:
            return None
        seen = ~np.isnan(o.known)
        mean, variance = np.where(seen, o.known, o.graph.mean), np.where(seen, 0.0, o.graph.variance)
        return UncertainPath(o.graph.seen_from(o.at, mean, variance), self.values["risk"])

    def actions(self, observation: UncertainGraphObservation, problem: Problem | None, answer: Any) -> Actions:
        """The first edge of the path."""
        return {} if answer is None else {ROBOT: answer[1]}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``rags``, ``a-star`` (the least mean), ``greedy``, ``d-star-lite`` and ``hindsight``."""
        return {name: lambda observation, name=name: self._go(name, observation) for name in POLICIES}  # type: ignore[misc]

    def _go(self, name: str, o: UncertainGraphObservation) -> Actions:
        if o.arrived:
            return {}
        if name not in self._walks:
            self._walks[name] = self._policy(name, o.graph)
        known = np.full_like(o.known, np.nan) if name == "rags" and not self.values["observe"] else o.known
        return {ROBOT: self._walks[name].next_vertex(o.at, known)}

    def _policy(self, name: str, graph: UncertainGraph) -> Policy:
        if name == "hindsight":
            return Hindsight(graph, self._world.costs)
        v = self.values
        return _prepared(name, graph, v["dominance"], v["rule"], v["comparison"], v["first-edges"]).fresh()

    def scene(self, world: World) -> Scene:
        assert isinstance(world, UncertainGraphWorld)
        points = places(world.graph)
        visited = np.zeros(len(points), dtype=bool)
        visited[world.path] = True
        low, high = points.min(axis=0), points.max(axis=0)
        edge = 0.05 * float((high - low).max())
        area = (*(low - edge).tolist(), *(high + edge).tolist())
        return Scene(area, points[world.path[-1:]], 0.0, points, visited, ("the robot", "visited", "vertices"))


@lru_cache(maxsize=16)
def _paths(graph: UncertainGraph, dominance: str) -> NonDominated:
    return non_dominated_paths(graph, dominance)


@lru_cache(maxsize=64)
def _prepared(name: str, graph: UncertainGraph, dominance: str, rule: str, comparison: str, first_edges: str) -> Policy:
    """A policy before its first walk: runs on one graph share what it computes of the graph alone."""
    if name == "a-star":
        return LeastMean(graph)
    if name == "d-star-lite":
        return DStarLite(graph)
    paths = _paths(graph, dominance)
    return Greedy(graph, paths) if name == "greedy" else RiskAware(graph, paths, rule, comparison, first_edges)


MISSIONS.add("uncertain-graph", UncertainGraphMission)
