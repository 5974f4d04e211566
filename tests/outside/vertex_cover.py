"""Weighted vertex cover, a family that waybound knows nothing of: vertices that meet every edge, at the least weight.

Guarantee and bound: Bar-Yehuda and Even (1981), "A linear-time approximation algorithm for the weighted vertex cover problem". Prices of
edges that charge no vertex more than its weight add up to at most any cover's weight; vertices that are paid in full are a cover of at
most twice that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from waybound.extending import (
    BOUNDS,
    CHECKERS,
    FORMATS,
    FORMS,
    HEURISTICS,
    PROBLEMS,
    BoundMethod,
    Compiled,
    Context,
    Evaluation,
    Evidence,
    Form,
    Format,
    Guarantee,
    Heuristic,
    InputError,
    Outcome,
    Problem,
    Program,
    Stop,
    Variables,
    digest,
    judge,
    rows,
    verified_bound,
)

# -- instance and format ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Graph:
    """Vertices with weights, and edges as pairs of vertex numbers."""

    name: str
    vertices: tuple[str, ...]
    weights: tuple[float, ...]
    edges: tuple[tuple[int, int], ...]
    kind: ClassVar[str] = "vertex-cover"
    format: str = "vertex-cover"
    problem: str = "vertex-cover"
    problems: tuple[str, ...] = ("vertex-cover",)
    notes: tuple[str, ...] = ()


def recognises(text: str) -> bool:
    """Whether the first line says so."""
    return text.startswith("vertex-cover")


def read(text: str, path: Path) -> Graph:
    """``vertex NAME WEIGHT`` and ``edge NAME NAME``, one a line, after the title ``vertex-cover``."""
    vertices: dict[str, float] = {}
    edges = []
    for number, line in enumerate(text.splitlines()[1:], start=2):
        match line.split():
            case []:
                continue
            case ["vertex", name, weight] if name not in vertices and weight.replace(".", "", 1).isdigit():
                vertices[name] = float(weight)
            case ["edge", a, b] if a in vertices and b in vertices and a != b:
                edges.append((list(vertices).index(a), list(vertices).index(b)))
            case _:
                raise InputError("no vertex and no edge", line=number, expected="vertex NAME WEIGHT, or edge NAME NAME", found=line)
    return Graph(path.stem, tuple(vertices), tuple(vertices.values()), tuple(edges))


FORMATS.add(
    "vertex-cover",
    Format(
        "vertex-cover", "vertices and edges, one a line", recognises, read, suffixes=(".cover",), problem="vertex-cover",
        problems=("vertex-cover",), answer="vertices", solutions=(".json",), kinds=("vertex-cover",),
    ),
)  # fmt: skip

# -- problem and judge --------------------------------------------------------------------------------------------------------


class VertexCover(Problem):
    """Its answer is a tuple of vertex numbers."""

    family = "vertex-cover"
    senses = ("min",)
    convention = "exact"

    def __init__(self, graph: Graph) -> None:
        self.graph, self.name, self.problem, self.notes = graph, graph.name, "vertex-cover", ()
        self.weights = np.array(graph.weights)
        self.ends = np.array(graph.edges, dtype=np.int64).reshape(-1, 2)

    def digest(self) -> str:
        return digest("vertex-cover", self.weights, self.ends)

    def features(self) -> frozenset[str]:
        return frozenset({"edges"})

    def evaluate(self, answer: Any) -> Evaluation:
        if not isinstance(answer, tuple) or not all(isinstance(v, int) and 0 <= v < len(self.weights) for v in answer):
            raise InputError("a cover is a tuple of vertex numbers", found=str(answer)[:80])
        chosen = np.zeros(len(self.weights), dtype=bool)
        chosen[list(answer)] = True
        names = self.graph.vertices
        open_ = 1.0 - chosen[self.ends].any(axis=1)
        check, faults = judge("edges", open_, lambda k: f"edge {names[self.ends[k, 0]]} {names[self.ends[k, 1]]} is not met")
        return Evaluation((math.fsum(self.weights[chosen]),), (check,), tuple(faults), {"vertices": float(chosen.sum())})

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        return {"kind": "vertices", "vertices": [self.graph.vertices[v] for v in answer]}

    def answer_from_json(self, data: Any) -> Any:
        names = data.get("vertices") if isinstance(data, Mapping) else None
        if not isinstance(names, list) or not all(name in self.graph.vertices for name in names):
            raise InputError("not a cover", expected='{"kind": "vertices", "vertices": [names]}')
        return tuple(self.graph.vertices.index(name) for name in names)

    def answer_to_frame(self, answer: Any) -> pd.DataFrame:
        return pd.DataFrame({"vertex": [self.graph.vertices[v] for v in answer], "weight": self.weights[list(answer)]})


PROBLEMS.add("vertex-cover", lambda graph, name, settings: VertexCover(graph))

# -- form ---------------------------------------------------------------------------------------------------------------------


def build(problem: VertexCover) -> Compiled:
    """min w x,  x_a + x_b >= 1 for each edge, x binary."""
    n, every = len(problem.weights), np.arange(len(problem.ends))
    x = Variables("x", (np.arange(n),), lower=np.zeros(n), upper=np.ones(n), cost=problem.weights, integer=True)
    met = rows("edge", len(every), [(every, problem.ends[:, 0], 1.0), (every, problem.ends[:, 1], 1.0)], lower=1.0, keys=(every,))

    def encode(answer: Any) -> Any:
        return np.isin(np.arange(n), answer).astype(float)

    def dual_evidence(duals: Any) -> Evidence:
        return proved(problem, np.abs(duals), "edge prices of the linear relaxation")

    program = Program("vertex-cover", "min", (x,), (met,))
    return Compiled(program, problem, lambda v: tuple(np.nonzero(v > 0.5)[0].tolist()), encode, dual_evidence)


FORMS.add("vertex-cover", Form("vertex-cover", "vertex-cover", frozenset({"edges"}), build))

# -- evidence: prices of edges ------------------------------------------------------------------------------------------------


@CHECKERS.register("edge-prices")
def check_edge_prices(problem: VertexCover, data: Mapping[str, Any]) -> float:
    """The sum of the prices, scaled down until they charge no vertex more than its weight."""
    prices = np.maximum(np.array(data["prices"], dtype=np.float64), 0.0)
    if prices.shape != (len(problem.ends),) or not np.isfinite(prices).all():
        raise InputError("evidence needs one price an edge", expected=str(len(problem.ends)))
    weights = np.array(problem.graph.weights)
    paid = np.zeros(len(weights))
    for (a, b), price in zip(problem.graph.edges, prices, strict=True):
        paid[a] += price
        paid[b] += price
    over = max((p / w if w > 0 else math.inf for p, w in zip(paid, weights, strict=True) if p > 0), default=1.0)
    return 0.0 if over == math.inf else math.fsum(prices) / max(over, 1.0) * (1.0 - 1e-12)


def proved(problem: VertexCover, prices: Any, source: str) -> Evidence:
    """Evidence with the bound that its checker derives."""
    made = Evidence("edge-prices", source, 0.0, {"prices": [float(p) for p in prices]})
    return replace(made, value=verified_bound(problem, made))


def pay(problem: VertexCover) -> tuple[Any, Any]:
    """Prices of the edges, each raised until one of its ends is paid in full; and what the vertices have left."""
    left, prices = problem.weights.copy(), np.zeros(len(problem.ends))
    for k, ends in enumerate(problem.ends):
        prices[k] = left[ends].min()
        left[ends] -= prices[k]
    return prices, left


def bound(problem: VertexCover, stop: Stop, linear: Any) -> Evidence:
    """Prices as ``pay`` sets them."""
    return proved(problem, pay(problem)[0], "edges paid one after the other")


def missing(problem: Problem) -> frozenset[str]:
    """Nothing for vertex covers."""
    return frozenset() if problem.family == "vertex-cover" else frozenset({f"{problem.family} problems"})


BOUNDS.add("edge-prices", BoundMethod("edge-prices", missing, bound))

# -- heuristic ----------------------------------------------------------------------------------------------------------------


def local_ratio(problem: VertexCover, context: Context) -> Outcome:
    """All vertices that are paid in full."""
    prices, left = pay(problem)
    used = np.zeros(len(left), dtype=bool)
    used[problem.ends] = True
    answer = tuple(np.nonzero((left == 0.0) & used)[0].tolist())
    guarantee = Guarantee(2.0, "w(C) <= 2 w(OPT)", ("weights are not negative",), "Bar-Yehuda and Even (1981), Theorem 1")
    return Outcome(answer, guarantee, (proved(problem, prices, "edges paid one after the other"),))


HEURISTICS.add(
    "edge-payments",
    Heuristic("edge-payments", ("vertex-cover",), frozenset({"edges"}), local_ratio, "pays edges one after the other", "2"),
)
