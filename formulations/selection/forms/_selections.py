"""What the forms over elements and actions share: names on demand, constraints, and the way between vectors and selections."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast, overload

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.selection.instance import Cardinality, DenseFacilityLocation, Knapsack, PartitionMatroid
from ...certificate import verified_bound
from ...evidence import Evidence
from ...programs.program import Floats, Rows, Variables
from ...programs.rows import rows
from ...routing.forms._routes import INTEGRALITY
from ..selections import Selection

if TYPE_CHECKING:
    from ....instances.selection.instance import SetFunction
    from ...problem import Problem
    from ..submodular_selection import SubmodularSelection

Ints = NDArray[np.integer[Any]]

FEATURES = frozenset(
    {"function:coverage", "function:facility-location", "constraint:cardinality", "constraint:partition", "constraint:knapsack"}
)


class Labels(Sequence[str]):
    """Names of ``size`` things, each made by ``name`` when it is asked for."""

    def __init__(self, size: int, name: Callable[[int], str]) -> None:
        self._size, self._name = size, name

    def __len__(self) -> int:
        return self._size

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (list(self),)  # programs go to other processes, functions do not

    @overload
    def __getitem__(self, k: int) -> str: ...
    @overload
    def __getitem__(self, k: slice) -> list[str]: ...
    def __getitem__(self, k: int | slice) -> str | list[str]:
        places = range(self._size)[k]
        return self._name(places) if isinstance(places, int) else [self._name(j) for j in places]


def chosen(x: Floats) -> Selection:
    """The selection that binary values ``x`` stand for; raises InputError where one is fractional or no number."""
    whole = np.round(x)
    if not (np.abs(x - whole) <= INTEGRALITY).all():
        worst = float(np.max(np.abs(x - whole))) if np.isfinite(x).all() else float("nan")
        raise InputError("the point is fractional, so it chooses nothing", found=f"an element {worst:g} away from 0 and 1")
    return Selection(tuple(np.nonzero(whole == 1)[0].tolist()))


def indicator(answer: Selection, size: int) -> Floats:
    """1 for each chosen element, else 0; raises InputError where one does not exist."""
    x = np.zeros(size)
    elements = np.asarray(answer.elements, dtype=np.int64)
    if ((elements < 0) | (elements >= size)).any():
        raise InputError("the start chooses an element that does not exist", expected=f"0 to {size - 1}")
    x[elements] = 1.0
    return x


def proved(problem: Problem, kind: str, source: str, data: dict[str, Any]) -> Evidence:
    """Evidence with the value that its checker derives."""
    made = Evidence(kind, source, 0.0, data)
    return replace(made, value=verified_bound(problem, made))


@dataclass(frozen=True, eq=False)
class Edges:
    """The pairs of element and item of positive weight, by element and then by item.

    Parameters
    ----------
    element, item, weight : arrays of shape (edges,)
    elements, items : int
    names, item_names : Labels
    """

    element: Ints
    item: Ints
    weight: Floats
    elements: int
    items: int
    names: Labels
    item_names: Labels

    @property
    def size(self) -> int:
        return len(self.element)

    def best(self, x: Floats) -> Ints:
        """For each item that a chosen element serves, the edge of largest weight (the first of equal ones)."""
        mine = np.nonzero(x[self.element] > 0.5)[0]
        order = mine[np.lexsort((mine, -self.weight[mine], self.item[mine]))]
        first = np.append(True, self.item[order][1:] != self.item[order][:-1]) if len(order) else np.zeros(0, dtype=bool)
        found: Ints = order[first]
        return found


def edges_of(problem: SubmodularSelection) -> Edges:
    """The weights of coverage and facility location as edges; coverage is facility location with the items' weights."""
    f = cast("SetFunction", problem.function)  # a user's function has no forms
    if isinstance(f, DenseFacilityLocation):
        element, item = np.nonzero(f.matrix)
        weight = f.matrix[element, item].astype(np.float64)
    else:
        element, item = np.repeat(np.arange(f.num_elements), np.diff(f.indptr)), f.indices.astype(np.int64)
        weight = f.edge_weights
        if not weight.all():
            keep = weight > 0
            element, item, weight = element[keep], item[keep], weight[keep]
    graph = getattr(problem, "graph", None)
    return Edges(
        element, item, weight, problem.num_elements, f.num_items, Labels(problem.num_elements, problem.element_name),
        Labels(f.num_items, (lambda j: str(j + 1)) if graph is None else graph.target_name),
    )  # fmt: skip


def choice(edges: Edges) -> Variables:
    """One binary variable an element."""
    n = edges.elements
    return Variables("x", (np.arange(n),), (edges.names,), lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n), integer=True)


def constraint_rows(problem: SubmodularSelection) -> Rows:
    """What may be chosen together: ``cardinality``, ``budget``, or a row a group (a robot)."""
    c, every = problem.constraint, np.arange(problem.num_elements)
    none = np.zeros(len(every), dtype=np.int64)
    if isinstance(c, Cardinality):
        return rows("cardinality", 1, [(none, every, 1.0)], upper=float(c.limit))
    if isinstance(c, Knapsack):
        paid = np.nonzero(c.costs)[0]
        return rows("budget", 1, [(none[paid], paid, c.costs[paid])], upper=c.budget)
    graph, size = getattr(problem, "graph", None), len(c.limits)
    name, label = ("group", lambda g: str(g + 1)) if graph is None else ("robot", graph.robot_name)
    return rows(name, size, [(c.groups, every, 1.0)], upper=c.limits, keys=(np.arange(size),), labels=(Labels(size, label),))


@dataclass(frozen=True, eq=False)
class Credits:
    """The pairs of creditor and item that an edge joins; a creditor is a set of elements of which at most one is chosen.

    Parameters
    ----------
    creditor, item : arrays of shape (pairs,)
    of_edge : array of shape (edges,)
        The pair that each edge belongs to.
    labels : names of creditors and items
    """

    creditor: Ints
    item: Ints
    of_edge: Ints
    labels: tuple[Labels, Labels]


def credits_of(problem: SubmodularSelection, edges: Edges) -> Credits:
    """Creditors are the groups whose limit is at most 1 (a robot's actions), and single elements where there are none."""
    c, n = problem.constraint, edges.elements
    groups, owner = 0, np.arange(n)
    if isinstance(c, Cardinality) and c.limit == 1:
        groups, owner = 1, np.zeros(n, dtype=np.int64)
    elif isinstance(c, PartitionMatroid):
        groups = len(c.limits)
        owner = np.where(c.limits[c.groups] <= 1, c.groups, groups + owner)
    graph = getattr(problem, "graph", None)

    def name(creditor: int) -> str:
        if creditor >= groups:
            return problem.element_name(creditor - groups)
        return f"group {creditor + 1}" if graph is None else str(graph.robot_name(creditor))

    keys, of_edge = np.unique(owner[edges.element] * np.int64(max(edges.items, 1)) + edges.item, return_inverse=True)
    creditor, item = np.divmod(keys, max(edges.items, 1))
    return Credits(creditor, item, of_edge, (Labels(groups + n, name), edges.item_names))


def prices_evidence(prices: Floats, source: str, problem: SubmodularSelection) -> Evidence:
    """Evidence ``item-prices`` from prices of the items, which solvers may tell with either sign."""
    p = np.maximum(prices if prices.sum() > 0 else -prices, 0.0)
    return proved(problem, "item-prices", source, {"prices": p.tolist()})


def at_most(limit: float = 0.0) -> dict[str, float]:
    """Sides of rows ``<= limit``."""
    return {"lower": -math.inf, "upper": limit}
