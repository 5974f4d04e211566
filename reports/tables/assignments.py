"""Facts of problems over sensing graphs, selections and max-min programs, for ``waybound info``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...formulations.max_min.bottleneck_sata import BottleneckSATA
from ...formulations.max_min.max_min_lp import MaxMinLP
from ...formulations.problem import Problem
from ...formulations.selection.submodular_selection import SubmodularSelection
from ...formulations.selection.winner_takes_all_sata import WinnerTakesAllSATA
from ...instances.max_min.instance import SparseMatrix
from ...instances.sensing.graph import SensingGraph

SHOWN_NAMES = 10
"""Names that a row of the table holds; the facts hold them all."""

Row = tuple[str, str]


def assignment_facts(problem: Problem) -> dict[str, Any]:
    """What a problem of these families holds, as plain JSON values; empty for others."""
    if isinstance(problem, BottleneckSATA | WinnerTakesAllSATA):
        return {"graph": _graph(problem.graph)}
    if isinstance(problem, SubmodularSelection):
        return {"function": problem.function.facts(), "constraint": problem.constraint.facts(problem.num_elements)}
    if isinstance(problem, MaxMinLP):
        return {
            "variables": problem.num_variables,
            "packing": _matrix(problem.packing),
            "covering": _matrix(problem.covering),
            "one_packing_row": problem.one_packing_row,
        }
    return {}


def _graph(g: SensingGraph) -> dict[str, Any]:
    """Delta_R and Delta_T are those of the cleaned graph: actions that see nothing do not count."""
    degree = np.diff(g.indptr)
    own = np.bincount(g.robot_of_action, minlength=g.num_robots)
    return {
        "robots": g.num_robots,
        "actions": g.num_actions,
        "actions_of_a_robot": [int(own.min()), int(own.max())],
        "seeing_actions": int((degree > 0).sum()),
        "targets": g.num_targets,
        "edges": g.num_edges,
        "phi": g.density,
        "delta_r": int(np.bincount(g.robot_of_action[degree > 0], minlength=1).max()),
        "delta_t": int(np.bincount(g.indices, minlength=1).max()),
        "weights": [float(g.weights.min()), float(g.weights.max())] if g.num_edges else None,
        "positions": g.action_positions is not None and g.target_positions is not None,
        "idle_robots": [g.robot_name(int(r)) for r in g.idle_robots],
        "unseen_targets": [g.target_name(int(t)) for t in g.unseen_targets],
    }


def _matrix(a: SparseMatrix) -> dict[str, Any]:
    return {"rows": a.rows, "entries": len(a.data), "longest_row": int(np.diff(a.indptr).max(initial=0))}


# -- rows of the table -----------------------------------------------------------------------------------------------------


def assignment_rows(data: dict[str, Any]) -> list[Row]:
    """The same facts for people."""
    if "graph" in data:
        return _graph_rows(data["graph"])
    if "function" in data:
        return [("function", _function_text(data["function"])), ("constraint", _constraint_text(data["constraint"]))]
    if "packing" in data:
        rows = [("variables", str(data["variables"]))]
        for key in ("packing", "covering"):
            rows.append((key, "{rows} rows, {entries} entries, at most {longest_row} in a row".format(**data[key])))
        rows.append(("structure", "one packing row a variable" if data["one_packing_row"] else "some variables in several packing rows"))
        return rows
    return []


def _graph_rows(g: dict[str, Any]) -> list[Row]:
    least, most = g["actions_of_a_robot"]
    each = f"{least} actions each" if least == most else f"{least} to {most} actions each"
    blind = g["actions"] - g["seeing_actions"]
    rows = [
        ("robots", f"{g['robots']}, {each} ({g['actions']} in all" + (f", {blind} see nothing)" if blind else ")")),
        ("targets", str(g["targets"])),
        ("edges", f"{g['edges']}, density phi {g['phi']:.4g} %" + _weights_text(g["weights"])),
        ("degrees", f"Delta_R {g['delta_r']}: seeing actions of one robot; Delta_T {g['delta_t']}: actions that see one target"),
    ]
    rows += [(label, _some(g[key])) for label, key in (("idle robots", "idle_robots"), ("unseen targets", "unseen_targets")) if g[key]]
    return [*rows, ("positions", "of actions and targets" if g["positions"] else "none")]


def _weights_text(weights: list[float] | None) -> str:
    if weights is None:
        return ""
    least, most = weights
    return f", all of weight {least:g}" if least == most else f", weights {least:g} to {most:g}"


def _some(names: list[str]) -> str:
    shown = ", ".join(names[:SHOWN_NAMES])
    return f"{len(names)}: {shown}" + (", ..." if len(names) > SHOWN_NAMES else "")


def _function_text(f: dict[str, Any]) -> str:
    if "items" in f:
        return f"{f['kind']} of {f['items']} items by {f['elements']} elements, {f['entries']} entries"
    name = "the user's own" if f["kind"] == "user" else f["kind"]
    return f"{name}, of {f['elements']} elements"


def _constraint_text(c: dict[str, Any]) -> str:
    if c["kind"] == "cardinality":
        return f"cardinality: at most {c['limit']} elements"
    if c["kind"] == "knapsack":
        return f"knapsack: costs up to {c['budget']:g} of {c['cost']:g} in all"
    if c["kind"] != "partition":  # one that is not of this house
        return ", ".join([c["kind"], *(f"{key.replace('_', ' ')} {value}" for key, value in c.items() if key != "kind")])
    limits = c["limits"]
    each = f"{limits[0]}" if len(limits) == 1 else f"{limits[0]} to {limits[-1]}" if limits else "0"
    return f"partition matroid: at most {each} of each of {c['groups']} groups, {c['rank']} elements in all"
