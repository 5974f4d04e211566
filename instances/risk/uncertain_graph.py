"""Directed graphs whose edge costs are independent normal random variables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]

PROBLEMS = ("uncertain-path",)
"""What may be asked of such a graph."""

LARGEST = 1e150
"""Of a mean or a variance: sums and squares stay finite."""


@dataclass(frozen=True, eq=False)
class UncertainGraph:
    """Vertices, directed edges with normal costs, a start and a goal.

    ``from_frame`` and ``from_networkx`` make one from the user's own names; the constructor takes numbers from 0.

    Parameters
    ----------
    num_vertices : int
    tails, heads : arrays of shape (edges,)
        Vertices from 0; no edge twice, none from a vertex to itself. They are put into the order of tails, then heads.
    mean, variance : arrays of shape (edges,)
        Of each edge's cost, in any unit and its square; not negative.
    start, goal : int
    least : array of shape (edges,), optional
        What a cost that came true is raised to where it was drawn below, such as an edge's length; planning leaves it aside.
    variable : array of shape (edges,), optional
        Which random variable is the edge's cost: the two directions of an undirected edge share one. By default each edge has its own.
    vertex_names : tuple of str, optional
        None stands for "1", "2", ...
    positions : array of shape (vertices, 2), optional
        For maps.
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If an array has the wrong length or holds what it must not, or no path leads from the start to the goal.

    Notes
    -----
    Source: Skeele (2016), Planning Under Uncertainty for Unmanned Aerial Vehicles, section 5.2;
    docs/formulations/uncertain-path.md#model.
    """

    kind: ClassVar[str] = "uncertain-graph"
    num_vertices: int
    tails: Indices
    heads: Indices
    mean: Floats
    variance: Floats
    start: int
    goal: int
    least: Floats | None = None
    variable: Indices | None = None
    vertex_names: tuple[str, ...] | None = None
    positions: Floats | None = None
    name: str = "uncertain-graph"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    @classmethod
    def from_frame(
        cls, edges: pd.DataFrame, *, start: Any, goal: Any, undirected: bool = False, name: str = "uncertain-graph"
    ) -> UncertainGraph:
        """A graph from a pandas frame; see ``uncertain_sources.graph_from_frame``."""
        from .uncertain_sources import graph_from_frame

        return graph_from_frame(edges, start=start, goal=goal, undirected=undirected, name=name)

    @classmethod
    def from_networkx(cls, graph: Any, *, start: Any = None, goal: Any = None, name: str | None = None) -> UncertainGraph:
        """A graph from one of networkx; see ``uncertain_sources.graph_from_networkx``."""
        from .uncertain_sources import graph_from_networkx

        return graph_from_networkx(graph, start=start, goal=goal, name=name)

    def to_frame(self) -> pd.DataFrame:
        """One row an edge: from, to, mean, variance, and least where it is given."""
        from .uncertain_sources import graph_to_frame

        return graph_to_frame(self)

    def to_networkx(self) -> Any:
        """As a ``networkx.DiGraph``; see ``uncertain_sources.graph_to_networkx``."""
        from .uncertain_sources import graph_to_networkx

        return graph_to_networkx(self)

    def __post_init__(self) -> None:
        n = arrays.size("num_vertices", self.num_vertices)
        arrays.refuse_unused("vertices", n, 2 * len(self.tails), "ends of edges")
        tails, heads = arrays.whole_numbers("tails", self.tails), arrays.whole_numbers("heads", self.heads)
        if heads.shape != tails.shape:
            raise InputError("tails and heads must have one entry an edge", expected=str(len(tails)), found=str(len(heads)))
        arrays.refuse_outside("the tail of edge {}", tails, n, "vertex")
        arrays.refuse_outside("the head of edge {}", heads, n, "vertex")
        object.__setattr__(self, "vertex_names", arrays.names("vertex", self.vertex_names, n))
        object.__setattr__(self, "positions", arrays.positions("vertex", self.positions, n, self.vertex_names))
        object.__setattr__(self, "name", label(self.name))
        for what in ("start", "goal"):
            vertex = arrays.whole_numbers(what, [getattr(self, what)], "the number of a vertex")
            arrays.refuse_outside(f"the {what}", vertex, n, "vertex")
            object.__setattr__(self, what, int(vertex[0]))
        if self.start == self.goal:
            raise InputError("start and goal are the same vertex", found=self.vertex_name(self.start))
        for key in ("mean", "variance", *(() if self.least is None else ("least",))):
            object.__setattr__(self, key, self._costs(key, len(tails), tails, heads))
        self._order(tails, heads)
        self._refuse_shared()
        reached = np.isfinite(self.costs_to(self.goal, np.ones(len(tails))))
        if not reached[self.start]:
            found = f"{int(reached.sum()) - 1} other vertices lead there"
            raise InputError(f"no path leads from {self.vertex_name(self.start)} to {self.vertex_name(self.goal)}", found=found)

    def _costs(self, key: str, count: int, tails: NDArray[np.int64], heads: NDArray[np.int64]) -> Floats:
        values = arrays.reals(key, getattr(self, key))
        if values.shape != (count,):
            raise InputError(f"there must be one {key} an edge", expected=str(count), found=str(values.shape))
        wrong = ~((values >= 0) & (values <= LARGEST))
        if wrong.any():
            k = int(np.argmax(wrong))
            what = f"the {'least cost' if key == 'least' else key} of edge {self._named(tails[k], heads[k])}"
            raise InputError(f"{what} must be from 0 to {LARGEST:g}", found=str(values[k]))
        return values

    def _order(self, tails: NDArray[np.int64], heads: NDArray[np.int64]) -> None:
        """Put the edges in order, and refuse those that stand twice."""
        loops = tails == heads
        if loops.any():
            raise InputError(f"an edge leads from {self.vertex_name(int(tails[np.argmax(loops)]))} to itself")
        key = tails * np.int64(max(self.num_vertices, 1)) + heads
        order = np.argsort(key, kind="stable")
        twice = np.nonzero(np.diff(key[order]) == 0)[0]
        if len(twice):
            k = int(order[twice[0]])
            raise InputError(f"edge {self._named(tails[k], heads[k])} stands twice")
        made: dict[str, NDArray[Any]] = {"tails": tails.astype(np.int32), "heads": heads.astype(np.int32)}
        if self.variable is not None:
            made["variable"] = arrays.indices("variable", self.variable)
            if made["variable"].shape != tails.shape:
                raise InputError("there must be one variable an edge", expected=str(len(tails)), found=str(len(made["variable"])))
        for column in ("mean", "variance", *(() if self.least is None else ("least",))):
            made[column] = getattr(self, column)
        for column, values in made.items():
            object.__setattr__(self, column, arrays.frozen(values[order]))

    def _refuse_shared(self) -> None:
        """Raise InputError where edges of one random cost are not the two directions of one, or differ in what they cost."""
        if self.variable is None:
            return
        order = np.argsort(self.variable, kind="stable")
        a, b = order[:-1], order[1:]
        alike = self.variable[a] == self.variable[b]
        other = (self.tails[a] != self.heads[b]) | (self.heads[a] != self.tails[b])
        faults = {"are not the two directions of one": other}
        for key in ("mean", "variance", *(() if self.least is None else ("least",))):
            faults[f"differ in {key}"] = getattr(self, key)[a] != getattr(self, key)[b]
        for fault, marks in faults.items():
            if (alike & marks).any():
                k = int(np.argmax(alike & marks))
                first, second = (self._named(self.tails[e], self.heads[e]) for e in (a[k], b[k]))
                raise InputError(f"edges {first} and {second} share one random cost, but {fault}")

    def _named(self, tail: Any, head: Any) -> str:
        return f"{self.vertex_name(int(tail))} -> {self.vertex_name(int(head))}"

    # -- lookups -----------------------------------------------------------------------------------------------------

    @property
    def num_edges(self) -> int:
        return len(self.tails)

    def vertex_name(self, vertex: int) -> str:
        return str(vertex + 1) if self.vertex_names is None else self.vertex_names[vertex]

    @cached_property
    def vertex_numbers(self) -> dict[str, int]:
        """The number of each vertex, by its name."""
        return {self.vertex_name(v): v for v in range(self.num_vertices)}

    @cached_property
    def indptr(self) -> Indices:
        """The edges that leave vertex v are ``indptr[v]`` to ``indptr[v + 1]``, their heads ascending."""
        return np.searchsorted(self.tails, np.arange(self.num_vertices + 1)).astype(np.int32)

    @property
    def variables(self) -> Indices:
        """Which random variable is the cost of each edge."""
        return np.arange(self.num_edges, dtype=np.int32) if self.variable is None else self.variable

    def edges_of(self, path: Iterable[int]) -> NDArray[np.int64]:
        """Numbers of the edges between consecutive vertices, -1 where there is none."""
        vertices = np.fromiter(path, dtype=np.int64)
        return self.edges_of_pairs(vertices[:-1], vertices[1:])

    def edges_of_pairs(self, tails: NDArray[np.integer[Any]], heads: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
        """Numbers of the edges from each of ``tails`` to each of ``heads``, -1 where there is none."""
        n = self.num_vertices
        known = (tails >= 0) & (tails < n) & (heads >= 0) & (heads < n)
        keys = np.where(known, tails * np.int64(n) + heads, -1)
        at = np.minimum(np.searchsorted(self._keys, keys), self.num_edges - 1)
        return np.where(self._keys[at] == keys, at, -1)

    @cached_property
    def _keys(self) -> NDArray[np.int64]:
        return self.tails.astype(np.int64) * self.num_vertices + self.heads

    def costs_to(self, vertex: int, costs: Floats) -> Floats:
        """Least sum of ``costs`` >= 0, one an edge, from each vertex to ``vertex``; infinite where no path leads there (Dijkstra 1959)."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        backwards = csr_matrix((costs, self.heads, self.indptr), shape=(self.num_vertices,) * 2).T.tocsr()
        return np.asarray(dijkstra(backwards, indices=vertex))

    def seen_from(self, start: int, mean: Floats, variance: Floats) -> UncertainGraph:
        """The same graph from another start, with what is known of its costs now."""
        return replace(self, start=start, mean=mean, variance=variance, variable=None, notes=())

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        return digest(
            "uncertain-graph", self.num_vertices, self.tails, self.heads, self.mean, self.variance, self.start, self.goal
        )  # fmt: skip

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        degree = np.diff(self.indptr)
        return {
            "vertices": self.num_vertices,
            "edges": self.num_edges,
            "out_degree": [int(degree.min()), int(degree.max())],
            "means": [float(self.mean.min()), float(self.mean.max())],
            "variances": [float(self.variance.min()), float(self.variance.max())],
            "shared_costs": self.num_edges - len(np.unique(self.variables)),
            "start": self.vertex_name(self.start),
            "goal": self.vertex_name(self.goal),
            "positions": self.positions is not None,
        }

    def __repr__(self) -> str:
        ends = f"{self.vertex_name(self.start)} to {self.vertex_name(self.goal)}"
        return f"<UncertainGraph {self.name}: {self.num_vertices} vertices, {self.num_edges} edges, {ends}>"
