"""Graphs of uncertain edge costs in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...document import fields, integer, json_numbers, reals, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..uncertain_graph import PROBLEMS, UncertainGraph

KEYS = ("name", "problem", "vertices", "edges", "start", "goal", "notes")
VERTEX_KEYS = ("count", "name", "x", "y")
EDGE_KEYS = ("from", "to", "mean", "variance", "least", "variable")


def encode(graph: UncertainGraph) -> dict[str, Any]:
    """The keys of a graph; columns that hold nothing but defaults are left out."""
    vertices: dict[str, Any] = {"count": graph.num_vertices}
    if graph.vertex_names is not None:
        vertices["name"] = list(graph.vertex_names)
    if graph.positions is not None:
        vertices["x"], vertices["y"] = (json_numbers(column) for column in graph.positions.T)
    edges: dict[str, Any] = {"from": graph.tails.tolist(), "to": graph.heads.tolist()}
    for key in ("mean", "variance", "least"):
        values = getattr(graph, key)
        if values is not None:
            edges[key] = json_numbers(values)
    if graph.variable is not None:
        edges["variable"] = graph.variable.tolist()
    data = {"name": graph.name, "problem": graph.problem, "vertices": vertices, "edges": edges, "start": graph.start, "goal": graph.goal}
    return {**data, "notes": list(graph.notes)} if graph.notes else data


def decode(data: dict[str, Any]) -> UncertainGraph:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "vertices", "edges", "start", "goal"))
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of graphs with uncertain costs", expected=", ".join(PROBLEMS), found=problem)
    vertices = fields(data["vertices"], "vertices", VERTEX_KEYS, ("count",))
    count = integer(vertices["count"], "vertices.count", 0)
    names = strings(vertices["name"], "vertices.name") if "name" in vertices else None
    positions = None
    if ("x" in vertices) != ("y" in vertices):
        raise InputError("vertices has one coordinate alone", expected="x and y")
    if "x" in vertices:
        positions = np.column_stack([reals(vertices[key], f"vertices.{key}", count) for key in ("x", "y")])
    edges = fields(data["edges"], "edges", EDGE_KEYS, ("from", "to", "mean", "variance"))
    tails = wholes(edges["from"], "edges.from")
    size = len(tails)
    return UncertainGraph(
        count, tails, wholes(edges["to"], "edges.to", size), reals(edges["mean"], "edges.mean", size),  # type: ignore[arg-type]
        reals(edges["variance"], "edges.variance", size), integer(data["start"], "start", 0), integer(data["goal"], "goal", 0),
        least=reals(edges["least"], "edges.least", size) if "least" in edges else None,
        variable=wholes(edges["variable"], "edges.variable", size) if "variable" in edges else None,  # type: ignore[arg-type]
        vertex_names=names, positions=positions, name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


KINDS.add("uncertain-graph", Kind("uncertain-graph", encode, decode))
