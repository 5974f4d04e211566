"""Parts of the forms over elements and actions: names on demand, constraints, and the way between vectors and selections."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import Evidence
from ...programs.program import Floats, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ...tolerance import INTEGRALITY
from ...verified_bounds import proved
from ..selections import Selection
from ..submodular_selection import SubmodularSelection

Ints = NDArray[np.integer[Any]]

FEATURES = frozenset({f"function:{name}" for name in ("coverage", "facility-location")}) | {
    f"constraint:{name}" for name in ("cardinality", "partition", "knapsack", "rows")
}


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
        raise InputError("the point is fractional, so it chooses nothing", "out-of-range", found=f"an element {worst:g} away from 0 and 1")
    return Selection(tuple(np.nonzero(whole == 1)[0].tolist()))


@dataclass(frozen=True, eq=False)
class Edges:
    """The pairs of element and item of positive weight, by element and then by item; arrays of shape (edges,)."""

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
        best: Ints = order[first]
        return best


def edges_of(problem: SubmodularSelection) -> Edges:
    """The weights of coverage and facility location as edges; coverage is facility location with the items' weights."""
    weights = problem.function.as_item_weights()
    assert weights is not None  # no form takes a function that is known by its values only
    graph = getattr(problem, "graph", None)
    return Edges(
        *weights.edges(), problem.num_elements, weights.num_items, Labels(problem.num_elements, problem.element_name),
        Labels(weights.num_items, (lambda j: str(j + 1)) if graph is None else graph.target_name),
    )  # fmt: skip


def edges_size(problem: SubmodularSelection, each: tuple[float, float, float, float]) -> ProgramSize:
    """Size of a program that has ``each`` = columns an edge, rows an edge, rows an item and entries an edge, beside the choice of
    elements."""
    weights = problem.function.as_item_weights()
    assert weights is not None
    edges = float(len(weights.indices) or np.count_nonzero(weights.matrix))
    limits = problem.constraint.rows(problem.num_elements)
    assert limits is not None
    columns, rows, of_items, entries = each
    return ProgramSize(
        problem.num_elements + columns * edges, len(limits.limit) + rows * edges + of_items * weights.num_items,
        len(limits.row) + entries * edges,
    )  # fmt: skip


def choice(edges: Edges) -> Variables:
    """One binary variable per element."""
    n = edges.elements
    return Variables("x", (np.arange(n),), (edges.names,), lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n), integer=True)


def constraint_rows(problem: SubmodularSelection) -> Rows:
    """The constraint's rows: ``cardinality``, ``budget``, or a row per group (a robot)."""
    limits = problem.constraint.rows(problem.num_elements)
    assert limits is not None  # no form takes a constraint that is known by what it allows only
    size, parts = len(limits.limit), [(limits.row, limits.element, limits.coefficient)]
    if limits.label is None:
        return rows(limits.name, size, parts, upper=limits.limit)
    return rows(limits.name, size, parts, upper=limits.limit, keys=(np.arange(size),), labels=(Labels(size, limits.label),))


@dataclass(frozen=True, eq=False)
class Credits:
    """The pairs of creditor and item that an edge joins; a creditor is a set of elements of which at most one is chosen.

    ``creditor`` and ``item`` have shape (pairs,), ``labels`` names them, and ``of_edge``, of shape (edges,), is the pair of each edge.
    """

    creditor: Ints
    item: Ints
    of_edge: Ints
    labels: tuple[Labels, Labels]


def credits_of(problem: SubmodularSelection, edges: Edges) -> Credits:
    """Creditors are the groups whose limit is at most 1 (a robot's actions), and single elements where there are none."""
    partition, n = problem.constraint.as_partition(edges.elements), edges.elements
    groups, owner = 0, np.arange(n)
    if partition is not None:
        groups = len(partition.limits)
        owner = np.where(partition.limits[partition.groups] <= 1, partition.groups, groups + owner)

    def name(creditor: int) -> str:
        if creditor >= groups or partition is None:
            return problem.element_name(creditor - groups)
        return f"{partition.thing} {creditor + 1}" if partition.label is None else partition.label(creditor)

    keys, of_edge = np.unique(owner[edges.element] * np.int64(max(edges.items, 1)) + edges.item, return_inverse=True)
    creditor, item = np.divmod(keys, max(edges.items, 1))
    return Credits(creditor, item, of_edge, (Labels(groups + n, name), edges.item_names))


def prices_evidence(prices: Floats, limits: Floats, source: str, problem: Any) -> Evidence:
    """Evidence ``item-prices`` from prices of the items and duals of the constraint's rows, which solvers may tell with either sign."""
    data = {"prices": np.maximum(prices if prices.sum() > 0 else -prices, 0.0).tolist()}
    if len(limits) > 1 and problem.constraint.as_partition(problem.num_elements) is None:
        data["multipliers"] = np.abs(limits).tolist()
    return proved(problem, "item-prices", source, data)


def decisions(problem: SubmodularSelection) -> dict[str, Any]:
    """Fields of a ``Compiled`` whose first columns are elements.

    Only decisions can make its relaxation infeasible, which any evidence shows.
    """
    items = edges_of(problem).items

    def ray_evidence(ray: Floats) -> Evidence:
        return Evidence("item-prices", "elements that are decided", -math.inf, {"prices": [0.0] * items})

    return {"ray_evidence": ray_evidence, "at_most": problem.at_most}


def at_most(limit: float = 0.0) -> dict[str, float]:
    """Lower and upper sides of rows ``<= limit``."""
    return {"lower": -math.inf, "upper": limit}
