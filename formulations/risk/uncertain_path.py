"""Paths through a graph of normal edge costs: the least cost that is exceeded with a given probability at most."""

import math
from collections.abc import Mapping
from dataclasses import replace
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.generators.settings import Setting
from ...instances.instance import digest, with_settings
from ...instances.risk.uncertain_graph import UncertainGraph
from ..evaluation import Checklist, Evaluation
from ..problem import PROBLEMS, Problem, refuse_settings

if TYPE_CHECKING:
    import pandas as pd

Path = tuple[int, ...]
"""Vertices from the start to the goal."""

RISK = Setting(0.05, "probability with which the path may cost more than its value: above 0, 1/2 at most (the mean)", float, 0.0, 0.5)


class UncertainPath(Problem):
    """Find the simple path of the least cost at risk: mean + z(risk) x standard deviation.

    The costs of edges are independent and normal, so a path's is normal with the sums of means and of variances, and exceeds its cost
    at risk with probability ``risk``. An answer is a tuple of vertices from the start to the goal.

    Parameters
    ----------
    graph : UncertainGraph
        Vertices, edges with normal costs, start and goal.
    risk : float
        Above 0, 1/2 at most, where the value is the mean.

    Raises
    ------
    UsageError
        For a risk out of range: above 1/2 variance would be an advantage, and longest paths are searched for.

    Notes
    -----
    Source: Nikolova, Kelner, Brand, Mitzenmacher (2006), Stochastic shortest paths via quasi-convex maximization; Skeele (2016),
    section 5.2; docs/formulations/uncertain-path.md#model.
    """

    family: ClassVar[str] = "uncertain-path"
    senses = ("min",)

    def __init__(self, graph: UncertainGraph, risk: float = RISK.default) -> None:
        if isinstance(risk, bool) or not 0.0 < risk <= 0.5:
            raise UsageError(f"the risk must be above 0 and 1/2 at most, where the value is the mean, not {risk!r}", "out-of-range")
        self.graph, self.risk = graph, float(risk)
        self.name, self.problem, self.notes = graph.name, "uncertain-path", graph.notes
        self.z = 0.0 if risk == 0.5 else -NormalDist().inv_cdf(self.risk)

    def digest(self) -> str:
        return digest("uncertain-path", self.graph.digest(), self.risk)

    def features(self) -> frozenset[str]:
        """``normal-costs``, and ``risk-aversion`` where the value is not the mean."""
        return frozenset({"normal-costs", *(["risk-aversion"] if self.z else [])})

    @property
    def size(self) -> int:
        return self.graph.num_vertices

    def facts(self) -> dict[str, Any]:
        return {"objective": f"mean + {self.z:.6g} x standard deviation", "risk": self.risk, "graph": self.graph.facts()}

    def value(self, mean: float, variance: float) -> float:
        """Cost at risk of a normal cost."""
        return mean + self.z * math.sqrt(variance)

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the cost at risk, and test that the path leads from start to goal over edges that exist, through no vertex twice."""
        g = self.graph
        if not isinstance(answer, tuple) or not answer or not all(type(v) is int and 0 <= v < g.num_vertices for v in answer):
            raise InputError("an answer is a tuple of vertices, as numbers from 0", found=str(answer)[:80])
        checks = Checklist()
        for what, vertex, meant in (("start", answer[0], g.start), ("goal", answer[-1], g.goal)):
            message = f"the path's {what} is {g.vertex_name(vertex)}, not {g.vertex_name(meant)}"
            checks.test(what, float(vertex != meant), message, site=g.vertex_name(vertex))
        edges = g.edges_of(answer)
        for k, edge in enumerate(edges.tolist()):
            checks.test("edges", float(edge < 0), f"no edge leads from {g.vertex_name(answer[k])} to {g.vertex_name(answer[k + 1])}")
        seen: set[int] = set()
        for vertex in answer:
            checks.test("simple", float(vertex in seen), f"the path goes through {g.vertex_name(vertex)} twice", site=g.vertex_name(vertex))
            seen.add(vertex)
        used = edges[edges >= 0]
        mean, variance = math.fsum(g.mean[used]), math.fsum(g.variance[used])
        quantities = {"edges": float(len(used)), "mean": mean, "standard_deviation": math.sqrt(variance)}
        names = ("start", "goal", "edges", "simple")
        return Evaluation((self.value(mean, variance),), checks.checks(names), tuple(checks.violations), quantities)

    def answer_at_hand(self) -> Path:
        """A path of the fewest edges."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import breadth_first_order

        g = self.graph
        arcs = csr_matrix((np.ones(g.num_edges), g.heads, g.indptr), shape=(g.num_vertices,) * 2)
        before, path = breadth_first_order(arcs, g.start, return_predecessors=True)[1], [g.goal]
        while path[-1] != g.start:
            path.append(int(before[path[-1]]))
        return tuple(reversed(path))

    def answer_to_json(self, answer: Path) -> dict[str, Any]:
        return {"kind": "path", "vertices": [self.graph.vertex_name(v) for v in answer]}

    def answer_from_json(self, data: Any) -> Path:
        names = data.get("vertices") if isinstance(data, Mapping) and data.get("kind") == "path" else None
        if not isinstance(names, list) or not names:
            raise InputError("not an answer to an uncertain-path problem", expected='an object {"kind": "path", "vertices": [...]}')
        return self._path(names)

    def answer_of(self, given: Any) -> Path:
        """A tuple of vertices as numbers from 0, or a list of their names."""
        if isinstance(given, list) and given:
            return self._path(given)
        if not isinstance(given, tuple):
            raise UsageError("a path is a tuple of vertices as numbers from 0, or a list of their names", "malformed")
        return given

    def _path(self, names: list[Any]) -> Path:
        numbers = self.graph.vertex_numbers
        for name in names:
            if str(name) not in numbers:
                raise InputError(f"the path goes through an unknown vertex {str(name)[:80]!r}", "unknown-name")
        return tuple(numbers[str(name)] for name in names)

    def answer_to_frame(self, answer: Path) -> "pd.DataFrame":
        """One row per edge: from, to, mean, variance, and mean and standard deviation of the cost up to its end."""
        import pandas as pd

        g, edges = self.graph, self.graph.edges_of(answer)
        names = [g.vertex_name(v) for v in answer]
        columns = {"from": names[:-1], "to": names[1:], "mean": g.mean[edges], "variance": g.variance[edges]}
        until = {"mean_so_far": np.cumsum(g.mean[edges]), "deviation_so_far": np.sqrt(np.cumsum(g.variance[edges]))}
        return pd.DataFrame({**columns, **until})

    def to_instance(self) -> UncertainGraph:
        return with_settings(replace(self.graph), {"risk": self.risk})  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return f"<UncertainPath {self.name}: {self.graph.num_vertices} vertices, {self.graph.num_edges} edges, risk {self.risk:g}>"


@PROBLEMS.register("uncertain-path")
def make(instance: Any, name: str, settings: dict[str, Any]) -> UncertainPath:
    """The problem of an instance; setting ``risk``."""
    if not isinstance(instance, UncertainGraph):
        raise UsageError(f"{instance.name} holds no graph of uncertain costs, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings, ("risk",))
    return UncertainPath(instance, RISK.value("risk", settings.get("risk", RISK.default)))
