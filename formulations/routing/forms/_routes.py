"""Shared by all forms of routing: building a program block after block, and the way from arcs to routes and back."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...programs.compiled import Compiled
from ...programs.program import Floats, FurtherLevel, Program, Rows, Variables
from ...programs.reductions.units import scaled
from ...programs.rows import Ints, Part, rows
from ...tolerance import INTEGRALITY
from ..objective import Objective
from ..preparation import Preparation, Resource
from ..problem import RoutingProblem
from ..routes import Route


def used(x: Floats) -> NDArray[np.bool_]:
    """Which of the binary values ``x`` are 1; raises InputError where one is fractional or no number."""
    if not (np.abs(x - np.round(x)) <= INTEGRALITY).all():
        worst = float(np.max(np.abs(x - np.round(x)))) if np.isfinite(x).all() else float("nan")
        raise InputError("the point is fractional, so it holds no routes", found=f"an arc {worst:g} away from 0 and 1")
    return np.asarray(np.round(x) == 1)


def routes_of(prep: Preparation, arcs: NDArray[np.integer], names: Sequence[str]) -> list[Route]:
    """The routes that the given arcs make up; raises InputError where they make up none."""
    following: dict[int, int] = {}
    firsts: list[int] = []
    for tail, head in zip(prep.tail[arcs].tolist(), prep.head[arcs].tolist(), strict=True):
        if tail == 0:
            firsts.append(head)
        elif tail in following:
            raise InputError(f"site {names[prep.sites[tail]]} is left twice", "duplicate")
        else:
            following[tail] = head
    routes = []
    for node in firsts:
        visits = []
        while node != prep.end:
            visits.append(int(prep.sites[node]))
            if node not in following:
                raise InputError(f"a route ends at site {names[prep.sites[node]]}, away from the depot")
            node = following.pop(node)
        routes.append(Route(tuple(visits), prep.vehicle))
    if following:
        raise InputError("arcs form a cycle without the depot", found=", ".join(names[prep.sites[k]] for k in sorted(following)[:10]))
    return routes


class ArcIndex:
    """Position of each arc of a preparation, and of each site among its nodes."""

    def __init__(self, prep: Preparation) -> None:
        self.prep = prep
        self._keys = prep.tail.astype(np.int64) * prep.nodes + prep.head
        self._nodes: dict[int, list[int]] = {}
        for node, site in enumerate(prep.sites[1:-1].tolist(), start=1):
            self._nodes.setdefault(int(site), []).append(node)

    def find(self, tail: NDArray[np.integer], head: NDArray[np.integer]) -> NDArray[np.int64]:
        """Position of each arc (tail, head), -1 where there is none."""
        if not len(self._keys):
            return np.full(len(tail), -1)
        keys = tail.astype(np.int64) * self.prep.nodes + head
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return np.where(self._keys[at] == keys, at, -1)

    def nodes_of(self, route: Route, names: Sequence[str], stops: dict[int, int] | None = None) -> NDArray[np.int64]:
        """Nodes of a route, both ends included; of a depot on the way the first copy that is not among the ``stops`` counted so far."""
        path, taken = [0], {} if stops is None else stops
        for site in route.visits:
            nodes = self._nodes.get(site)
            if nodes is None:
                raise InputError(
                    f"a route visits site {names[site] if 0 <= site < len(names) else site}, which is no customer", "unknown-name"
                )
            number = taken.get(site, 0) if len(nodes) > 1 else 0
            if number >= len(nodes):
                raise InputError(
                    f"the answer stops at {names[site]} more often than any answer has to", "unsupported", found=str(number + 1)
                )
            taken[site] = number + 1
            path.append(nodes[number])
        return np.array([*path, self.prep.end], dtype=np.int64)

    def arcs_of(self, nodes: NDArray[np.int64], names: Sequence[str]) -> NDArray[np.int64]:
        """Arcs along ``nodes``; raises InputError for one that no feasible route can use."""
        at = self.find(nodes[:-1], nodes[1:])
        if (at < 0).any():
            k = int(np.argmax(at < 0))
            i, j = (names[self.prep.sites[nodes[p]]] for p in (k, k + 1))
            raise InputError(f"no feasible route goes from {i} to {j}", "contradiction")
        return at


def levels(resource: Resource, nodes: NDArray[np.int64], arcs: NDArray[np.int64], start: float | None = None) -> Floats:
    """Least level at each of ``nodes`` along ``arcs``, from ``start`` or the least level at departure."""
    reached = np.empty(len(nodes))
    reached[0] = resource.lower[0] if start is None else start
    for k, arc in enumerate(arcs.tolist(), start=1):
        reached[k] = max(float(resource.lower[nodes[k]]), reached[k - 1] + float(resource.weight[arc]))
    return reached


class Blocks:
    """Columns and rows of a program, block after block."""

    def __init__(self, problem: RoutingProblem) -> None:
        self.problem = problem
        self.variables: list[Variables] = []
        self.rows: list[Rows] = []
        self.columns = 0

    def add_columns(
        self, name: str, keys: tuple[Ints, ...], labels: tuple[Any, ...], lower: Any, upper: Any, cost: Any = 0.0, integer: bool = False
    ) -> int:
        """Write a block of columns; returns the first of them."""
        size, first = len(keys[0]) if keys else 1, self.columns
        spread = [np.array(np.broadcast_to(np.asarray(v, dtype=np.float64), size)) for v in (lower, upper, cost)]
        self.variables.append(Variables(name, keys, labels, lower=spread[0], upper=spread[1], cost=spread[2], integer=integer))
        self.columns += size
        return first

    def add_groups(self, parts: Iterable[Part]) -> None:
        """At most one site of each group is visited, and exactly one where it is required; ``parts`` are the visits by group."""
        least = np.array([float(g.required) for g in self.problem.sites.groups])
        self.rows.append(rows("group", len(least), list(parts), least, 1.0, (np.arange(1, len(least) + 1),), (None,)))


def point_of(program: Program, x: Floats) -> Floats:
    """``x``, if it keeps all rows; else raises InputError."""
    excess = scaled(program).residual(x)
    if excess > 1e-5:
        raise InputError("the answer is no point of the program", "contradiction", found=f"a row exceeded by {excess:g}")
    return x


def with_levels(problem: RoutingProblem, build: Callable[[RoutingProblem], Compiled]) -> Compiled:
    """The program that ``build`` makes of the first level of the objective, with the costs that it makes of the others.

    All levels are written over the same variables and rows: a term that any level holds has its own.
    """
    compiled, levels = build(problem), problem.objective.levels()
    further = []
    for at in range(1, len(levels)):
        first = (levels[at], *levels[:at], *levels[at + 1 :])
        program = build(replace(problem, objective=Objective(first))).program
        further.append(FurtherLevel(program.sense, program.cost, program.offset))
    return replace(compiled, program=replace(compiled.program, further=tuple(further))) if further else compiled
