"""A robot that goes through a graph whose edge costs it learns on the way."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...generating import generate
from ...generators import Draw, Floats
from ...reading import read_instance
from ...worlds import WORLDS, Setting, World, WorldKind
from ..generators.prm_graph import PRM, RASTER
from ..uncertain_graph import UncertainGraph

ROBOT = 0
"""The number of the only agent."""

ROADMAPS = {"prm-graph": PRM, "raster-graph": RASTER}
"""Generators, and their settings."""


@dataclass(frozen=True, eq=False)
class UncertainGraphObservation:
    """The vertex ``at`` which the robot is, and the costs that it knows: of each edge seen from its tail, shape (edges,), NaN elsewhere."""

    time: int
    graph: UncertainGraph
    at: int
    known: Floats

    @property
    def arrived(self) -> bool:
        return self.at == self.graph.goal


class UncertainGraphWorld(World):
    """Edge costs are drawn once and hold for the whole run; at a vertex the robot sees what the edges that leave it cost.

    ``costs``, shape (edges,), are the true ones: normal, raised to ``least`` of the graph, or to 0. ``path`` holds the vertices visited so
    far. Source: Skeele (2016), section 5.5.1; docs/missions.md#uncertain-graph.
    """

    def __init__(self, graph: UncertainGraph, rng: np.random.Generator) -> None:
        self.graph, self.time = graph, 0
        _, first, variable = np.unique(graph.variables, return_index=True, return_inverse=True)
        standard = Draw(rng).normal(0.0, 1.0, len(first))[variable]
        least = 0.0 if graph.least is None else graph.least
        self.costs: Floats = np.maximum(graph.mean + np.sqrt(graph.variance) * standard, least)
        self.hindsight = float(graph.costs_to(graph.goal, self.costs)[graph.start])
        self.path, self.cost = [graph.start], 0.0
        self._variable = variable
        self._seen = np.zeros(len(first), dtype=bool)
        self._look()

    def _look(self) -> None:
        here = self.path[-1]
        self._seen[self._variable[self.graph.indptr[here] : self.graph.indptr[here + 1]]] = True
        known = np.where(self._seen[self._variable], self.costs, np.nan)
        self._observation = UncertainGraphObservation(self.time, self.graph, here, known)

    def observe(self) -> UncertainGraphObservation:
        return self._observation

    def step(self, actions: Mapping[int, int]) -> None:
        """Go to the vertex that ``actions`` gives for the robot, along an edge; stay where it gives none."""
        for agent, vertex in actions.items():
            if agent != ROBOT:
                raise InputError(f"agent {agent} does not exist", "unknown-name", expected=str(ROBOT))
            edge = int(self.graph.edges_of((self.path[-1], vertex))[0])
            if edge < 0:
                raise InputError(f"no edge leads from {self.graph.vertex_name(self.path[-1])} to vertex number {vertex}", "unknown-name")
            self.path.append(int(vertex))
            self.cost += float(self.costs[edge])
        self.time += 1
        self._look()

    @property
    def over(self) -> bool:
        """True if the robot is at the goal."""
        return self.path[-1] == self.graph.goal

    def metrics(self) -> dict[str, float]:
        """``cost`` so far; ``arrived``: 1 at the goal; ``hindsight``: the least cost of any path, all costs known; ``excess``: at the goal,
        by how many percent of that the robot's path cost more."""
        excess = np.nan
        if self.over:
            above = max(self.cost - self.hindsight, 0.0)  # sums in another order
            excess = 100.0 * above / self.hindsight if self.hindsight > 0 else 0.0 if self.cost == 0 else np.inf
        return {"cost": self.cost, "arrived": float(self.over), "hindsight": self.hindsight, "excess": float(excess)}


@lru_cache(maxsize=32)
def _drawn(roadmap: str, seed: int, settings: tuple[tuple[str, Any], ...]) -> UncertainGraph:
    graph = generate(roadmap, seed, **dict(settings))
    assert isinstance(graph, UncertainGraph)
    return graph


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> UncertainGraphWorld:
    if values["file"] is None:
        own = tuple((key, values[key]) for key in ROADMAPS[values["roadmap"]] if key != "name")
        return UncertainGraphWorld(_drawn(values["roadmap"], values["graph"], own), rng)
    graph = read_instance(values["file"])
    if not isinstance(graph, UncertainGraph):
        raise UsageError(f"{values['file']} holds no graph of uncertain costs", "foreign")
    return UncertainGraphWorld(graph, rng)


WORLDS.enter(
    WorldKind(
        "uncertain-graph",
        "a robot goes through a graph whose edge costs it learns on the way",
        {
            "file": Setting(None, "a file with the graph; without it, one is drawn", str),
            "graph": Setting(1, "seed of the drawn graph: that of the run draws the costs", int, 0, 2**31),
            "roadmap": Setting("prm-graph", "generator of the drawn graph, whose settings these are besides", choices=tuple(ROADMAPS)),
            **{key: setting for key, setting in {**RASTER, **PRM}.items() if key != "name"},
        },
        _make,
    ),
)
