"""Directed graphs whose edge costs are independent normal random variables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..declared import CountOf, Declared, NameOf, Names, extent
from ..errors import InputError
from ..frames import columns_of, name_of, numbers_of
from ..number_arrays import Floats as Floats
from ..parts import Axis, Count, Numbers, Whole, Wholes

if TYPE_CHECKING:
    import pandas as pd

Indices = NDArray[np.int32]

COLUMNS = ("from", "to", "mean", "variance", "least")
"""Columns of a frame of edges; the last may be left out."""

PROBLEMS = ("uncertain-path",)
"""Problems that such data allow."""


@dataclass(frozen=True, eq=False, repr=False)
class UncertainGraph(Declared):
    """Vertices, directed edges with normal costs, a start and a goal.

    ``from_frame`` and ``from_networkx`` make one from the user's own names; the constructor takes numbers from 0.

    Parameters
    ----------
    num_vertices : int
        Vertices are numbered from 0.
    tails, heads : arrays of shape (edges,)
        Vertices from 0; no edge twice, none from a vertex to itself. They are put into the order of tails, then heads.
    mean, variance : arrays of shape (edges,)
        Of each edge's cost, in any unit and its square; not negative.
    start, goal : int
        Where paths begin and end.
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

    kind = "uncertain-graph"
    problem_names = PROBLEMS
    content = "graphs with uncertain costs"
    axes = (Axis("vertex", "vertices", least=0, positions="positions"), Axis("edge", least=0, counted=False))
    hashed = ("num_vertices", "tails", "heads", "mean", "variance", "start", "goal")
    num_vertices: Annotated[int, Count("vertex")]
    tails: Annotated[Indices, Wholes("edge", "vertex", "the tail of edge {}", key="from")]
    heads: Annotated[Indices, Wholes("edge", "vertex", "the head of edge {}", key="to")]
    mean: Annotated[Floats, Numbers("edge", what="mean")]
    variance: Annotated[Floats, Numbers("edge", what="variance")]
    start: Annotated[int, Whole(0, "vertex")]
    goal: Annotated[int, Whole(0, "vertex")]
    least: Annotated[Floats | None, Numbers("edge", what="least cost")] = None
    variable: Annotated[Indices | None, Wholes("edge")] = None
    vertex_names: Names = None
    positions: Floats | None = None
    num_edges = CountOf("edge")
    vertex_name = NameOf("vertex")

    @classmethod
    def from_names(
        cls, tails: list[str], heads: list[str], costs: dict[str, Floats], start: str, goal: str, *, vertices: list[str] | None = None,
        undirected: bool = False, **further: Any,
    ) -> UncertainGraph:  # fmt: skip
        """A graph from the names of its vertices, one tail and one head an edge, and costs by ``mean``, ``variance`` and perhaps ``least``.

        Without ``vertices``, these come in ascending order where all are whole numbers, else as they first appear. Each edge of an
        undirected graph leads both ways, at one random cost.

        Parameters
        ----------
        tails, heads : list of str
            The ends of each edge.
        costs : mapping of str to array of shape (edges,)
            As of the class, by name.
        start, goal : str
            Where paths begin and end.
        vertices : list of str, optional
            Their order.
        undirected : bool
            Whether edges lead both ways.
        **further
            As of the class.
        """
        names = list(dict.fromkeys(name for ends in zip(tails, heads, strict=True) for name in ends)) if vertices is None else vertices
        if vertices is None and all(name.isascii() and name.isdigit() and len(name) < 19 for name in names):
            names.sort(key=int)
        number = {name: k for k, name in enumerate(names)}
        for what, name in (("start", start), ("goal", goal)):
            if name not in number:
                raise InputError(f"the {what} {name[:80]!r} is no vertex of any edge", "unknown-name")
        a, b = (np.array([number[name] for name in column], dtype=np.int64) for column in (tails, heads))
        if undirected:
            further["variable"] = np.tile(np.arange(len(a), dtype=np.int32), 2)
            a, b = np.concatenate([a, b]), np.concatenate([b, a])
            costs = {key: np.tile(values, 2) for key, values in costs.items()}
        usual = names == [str(k + 1) for k in range(len(names))]
        return cls(
            len(names), a, b, costs["mean"], costs["variance"], number[start], number[goal], least=costs.get("least"),  # type: ignore[arg-type]
            vertex_names=None if usual else tuple(names), **further,
        )  # fmt: skip

    @classmethod
    def from_frame(
        cls, edges: pd.DataFrame, *, start: Any, goal: Any, undirected: bool = False, name: str = "uncertain-graph"
    ) -> UncertainGraph:
        """A graph from a pandas frame, with its own names of vertices.

        Parameters
        ----------
        edges : DataFrame
            Columns ``from``, ``to``, ``mean``, ``variance`` and optionally ``least``; one row per edge.
        start, goal : str or int
            Vertices where paths begin and end.
        undirected : bool
            Whether each edge leads both ways, at one random cost.
        name : str
            For tables and files.

        Raises
        ------
        InputError
            Naming the column, edge or vertex that is wrong.
        """
        columns = columns_of("edges", edges, COLUMNS, COLUMNS[:4])
        ends = [[name_of(value) for value in columns[title].tolist()] for title in COLUMNS[:2]]
        costs = {title: numbers_of("edges", title, columns[title]) for title in COLUMNS[2:] if title in columns}
        return cls.from_names(ends[0], ends[1], costs, name_of(start), name_of(goal), undirected=undirected, name=name, format="frame")

    @classmethod
    def from_networkx(cls, graph: Any, *, start: Any = None, goal: Any = None, name: str | None = None) -> UncertainGraph:
        """A graph from one of networkx, whose vertices come in the order of its nodes.

        Parameters
        ----------
        graph : networkx.Graph or DiGraph
            Each edge has the attributes ``mean`` and ``variance``, and may have ``least``. An undirected edge leads both ways at one random
            cost. A node may have a position ``pos``.
        start, goal : node, optional
            The graph's attributes ``start`` and ``goal`` by default.
        name : str, optional
            The graph's own by default.

        Raises
        ------
        InputError
            Naming the node or edge that is wrong.
        """
        if not callable(getattr(graph, "edges", None)) or not callable(getattr(graph, "nodes", None)):
            raise InputError("not a networkx graph", found=type(graph).__name__)
        nodes = list(graph.nodes)
        ends = {"start": graph.graph.get("start") if start is None else start, "goal": graph.graph.get("goal") if goal is None else goal}
        for what, node in ends.items():
            if node is None or node not in graph:
                raise InputError(f"the {what} is no node of the graph", "unknown-name", found=repr(node)[:80])
        edges = list(graph.edges(data=True))
        keys = [key for key in COLUMNS[2:] if key != "least" or any("least" in data for _, _, data in edges)]
        costs = {key: np.array([_cost(u, v, data, key) for u, v, data in edges], dtype=np.float64) for key in keys}
        places = [graph.nodes[node].get("pos") for node in nodes]
        names = {node: str(node).strip() for node in nodes}
        return cls.from_names(
            [names[u] for u, _, _ in edges], [names[v] for _, v, _ in edges], costs, names[ends["start"]], names[ends["goal"]],
            vertices=list(names.values()), undirected=not graph.is_directed(), name=name or str(graph.name) or "uncertain-graph",
            positions=None if any(pos is None for pos in places) else np.array(places, dtype=np.float64), format="networkx",
        )  # fmt: skip

    def to_frame(self) -> pd.DataFrame:
        """One row per edge: from, to, mean, variance, and least where it is given."""
        import pandas as pd

        names = np.array([self.vertex_name(v) for v in range(self.num_vertices)], dtype=object)
        columns = {"from": names[self.tails], "to": names[self.heads], "mean": self.mean, "variance": self.variance}
        return pd.DataFrame(columns if self.least is None else {**columns, "least": self.least})

    def to_networkx(self) -> Any:
        """As a ``networkx.DiGraph``, or a ``Graph`` where all edges lead both ways at one cost; ``from_networkx`` reads it back."""
        import networkx as nx

        both = self.undirected
        result = nx.Graph() if both else nx.DiGraph()
        result.graph.update(name=self.name, start=self.vertex_name(self.start), goal=self.vertex_name(self.goal))
        for v in range(self.num_vertices):
            result.add_node(self.vertex_name(v), **({} if self.positions is None else {"pos": tuple(self.positions[v].tolist())}))
        keys = [key for key in COLUMNS[2:] if getattr(self, key) is not None]
        ends = zip(self.tails.tolist(), self.heads.tolist(), strict=True)
        for (tail, head), *costs in zip(ends, *(getattr(self, key).tolist() for key in keys), strict=True):
            result.add_edge(self.vertex_name(tail), self.vertex_name(head), **dict(zip(keys, costs, strict=True)))
        return result

    def refuse_counts(self) -> None:
        super().refuse_counts()
        arrays.refuse_unused("vertices", self.num_vertices, 2 * len(self.tails), "ends of edges")

    def check_rest(self) -> None:
        if self.start == self.goal:
            raise InputError("start and goal are the same vertex", "contradiction", found=self.vertex_name(self.start))
        self._order()
        self._refuse_shared()
        reached = np.isfinite(self.costs_to(self.goal, np.ones(self.num_edges)))
        if not reached[self.start]:
            found = f"{int(reached.sum()) - 1} other vertices lead there"
            raise InputError(
                f"no path leads from {self.vertex_name(self.start)} to {self.vertex_name(self.goal)}", "contradiction", found=found
            )

    def name_of(self, axis: str, number: int) -> str:
        if axis == "vertex":
            return super().name_of(axis, number)
        return f"{self.vertex_name(int(self.tails[number]))} -> {self.vertex_name(int(self.heads[number]))}"

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the arrays of edge data that are present."""
        return tuple(key for key in ("mean", "variance", "least") if getattr(self, key) is not None)

    def _order(self) -> None:
        """Put the edges in order, and refuse those that stand twice."""
        tails, heads = self.tails, self.heads
        if (tails == heads).any():
            raise InputError(f"an edge leads from {self.vertex_name(int(tails[np.argmax(tails == heads)]))} to itself", "contradiction")
        key = tails * np.int64(max(self.num_vertices, 1)) + heads
        order = np.argsort(key, kind="stable")
        twice = np.nonzero(np.diff(key[order]) == 0)[0]
        if len(twice):
            raise InputError(f"edge {self.name_of('edge', int(order[twice[0]]))} stands twice", "duplicate")
        for column in ("tails", "heads", *(["variable"] if self.variable is not None else [])):
            self.put(**{column: arrays.frozen(getattr(self, column)[order].astype(np.int32))})
        self.put(**{key: arrays.frozen(getattr(self, key)[order]) for key in self.columns})

    def _refuse_shared(self) -> None:
        """Raise InputError where edges of one random cost are not the two directions of one, or differ in what they cost."""
        if self.variable is None:
            return
        order = np.argsort(self.variable, kind="stable")
        a, b = order[:-1], order[1:]
        alike = self.variable[a] == self.variable[b]
        other = (self.tails[a] != self.heads[b]) | (self.heads[a] != self.tails[b])
        faults = {"are not the two directions of one": other}
        for key in self.columns:
            faults[f"differ in {key}"] = getattr(self, key)[a] != getattr(self, key)[b]
        for fault, marks in faults.items():
            if (alike & marks).any():
                k = int(np.argmax(alike & marks))
                first, second = (self.name_of("edge", int(edges[k])) for edges in (a, b))
                raise InputError(f"edges {first} and {second} share one random cost, but {fault}", "contradiction")

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
        """Number of the random variable that is the cost of each edge."""
        return np.arange(self.num_edges, dtype=np.int32) if self.variable is None else self.variable

    @property
    def undirected(self) -> bool:
        """True if every edge shares its random cost with the edge the other way, and with no other."""
        if self.variable is None:
            return False
        back = self.edges_of_pairs(self.heads, self.tails)
        _, counts = np.unique(self.variable, return_counts=True)
        return bool((back >= 0).all() and (self.variable[back] == self.variable).all() and (counts == 2).all())

    def edges_of(self, path: Iterable[int]) -> NDArray[np.int64]:
        """The indices of the edges between consecutive vertices, -1 where there is none."""
        vertices = np.fromiter(path, dtype=np.int64)
        return self.edges_of_pairs(vertices[:-1], vertices[1:])

    def edges_of_pairs(self, tails: NDArray[np.integer[Any]], heads: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
        """The index of the edge from each of ``tails`` to the same entry of ``heads``, -1 where there is none."""
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

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        degree = np.diff(self.indptr)
        return {
            **self.sizes(),
            "out_degree": [int(degree.min()), int(degree.max())],
            "means": extent(self.mean),
            "variances": extent(self.variance),
            "shared_costs": self.num_edges - len(np.unique(self.variables)),
            "start": self.vertex_name(self.start),
            "goal": self.vertex_name(self.goal),
            "positions": self.positions is not None,
        }

    def summary(self) -> Iterable[str]:
        return (*super().summary(), f"{self.vertex_name(self.start)} to {self.vertex_name(self.goal)}")


def _cost(tail: Any, head: Any, data: dict[str, Any], key: str) -> float:
    try:
        return float(data[key])
    except KeyError:
        raise InputError(f"edge {tail!r} - {head!r} has no {key}", "missing", expected="mean and variance, or least of all edges") from None
    except (TypeError, ValueError):
        raise InputError(f"the {key} of edge {tail!r} - {head!r} must be a number", found=repr(data[key])[:40]) from None
