"""Small graphs of uncertain edge costs, and their paths by brute force."""

import numpy as np

from waybound.instances.risk.uncertain_graph import UncertainGraph

Edge = tuple[str, str, float, float]

WORKED: list[Edge] = [
    ("S", "A", 75, 7), ("A", "G", 75, 8), ("S", "B", 50, 1), ("B", "G", 102, 9), ("B", "C", 40, 2), ("C", "G", 61, 9), ("C", "D", 30, 1),
    ("D", "G", 33, 4), ("D", "E", 10, 1), ("E", "G", 24, 2),
]  # fmt: skip
"""Edges with the path totals of Skeele (2016), Table 5.2."""

CROSSED: list[Edge] = [("S", "a", 1, 4), ("S", "b", 2, 1), ("a", "b", 1, 1), ("b", "a", 1, 1), ("a", "G", 2, 1), ("b", "G", 3, 2)]


def graph_of(edges: list[Edge], **further) -> UncertainGraph:
    """From S to G; vertices in the order in which they appear."""
    names = list(dict.fromkeys(name for edge in edges for name in edge[:2]))
    number = {name: k for k, name in enumerate(names)}
    tails, heads = ([number[edge[k]] for edge in edges] for k in (0, 1))
    mean, variance = (np.array([edge[k] for edge in edges], dtype=float) for k in (2, 3))
    return UncertainGraph(
        len(names), tails, heads, mean, variance, number["S"], number["G"], vertex_names=tuple(names), **{"name": "small", **further}
    )


def random_graph(rng: np.random.Generator, vertices: int, density: float = 0.5, whole: bool = False) -> UncertainGraph:
    """A graph with the path 0, 1, ..., n - 1 and random edges; whole moments make ties."""
    tails, heads = np.nonzero((rng.random((vertices, vertices)) < density) | np.eye(vertices, k=1, dtype=bool))
    tails, heads = tails[tails != heads], heads[tails != heads]
    mean, variance = rng.uniform(0.0, 10.0, (2, len(tails)))
    if whole:
        mean, variance = rng.integers(0, 4, (2, len(tails))).astype(float)
    return UncertainGraph(vertices, tails, heads, mean, variance, 0, vertices - 1)


def all_paths(graph: UncertainGraph) -> dict[tuple[int, ...], tuple[float, float]]:
    """Every simple path from start to goal, with mean and variance."""
    found, open_ = {}, [((graph.start,), 0.0, 0.0)]
    edges = list(zip(graph.tails.tolist(), graph.heads.tolist(), graph.mean.tolist(), graph.variance.tolist(), strict=True))
    while open_:
        path, mean, variance = open_.pop()
        if path[-1] == graph.goal:
            found[path] = mean, variance
            continue
        open_ += [((*path, b), mean + m, variance + v) for a, b, m, v in edges if a == path[-1] and b not in path]
    return found


def named(graph: UncertainGraph, path: tuple[int, ...]) -> str:
    return "-".join(map(graph.vertex_name, path))
