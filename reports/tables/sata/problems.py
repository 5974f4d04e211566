"""Facts of max-min and selection problems, and of the sensing graphs that both may stand on, as rows of tables."""

from functools import partial
from typing import Any

from .. import TABLES, Tables
from ..facts import plain_text, some
from ..table import Row


def graph_rows(g: dict[str, Any]) -> list[Row]:
    """Rows on sizes, degrees and what is idle or unseen."""
    least, most = g["actions_of_a_robot"]
    each = f"{least} actions each" if least == most else f"{least} to {most} actions each"
    blind = g["actions"] - g["seeing_actions"]
    rows = [
        ("robots", f"{g['robots']}, {each} ({g['actions']} in all" + (f", {blind} see nothing)" if blind else ")")),
        ("targets", str(g["targets"])),
        ("edges", f"{g['edges']}, density phi {g['phi']:.4g} %" + _weights_text(g["weights"])),
        ("degrees", f"Delta_R {g['delta_r']}: seeing actions of one robot; Delta_T {g['delta_t']}: actions that see one target"),
    ]
    for label, key in (("idle robots", "idle_robots"), ("unseen targets", "unseen_targets")):
        rows += [(label, f"{len(g[key])}: {some(g[key])}")] if g[key] else []
    return [*rows, ("positions", "of actions and targets" if g["positions"] else "none")]


def _weights_text(weights: list[float] | None) -> str:
    if weights is None:
        return ""
    least, most = weights
    return f", all of weight {least:g}" if least == most else f", weights {least:g} to {most:g}"


def _matrix(name: str, sizes: dict[str, Any]) -> list[Row]:
    return [(name, "{rows} rows, {entries} entries, at most {longest_row} in a row".format(**sizes))]


def _structure(one_packing_row: bool) -> list[Row]:
    return [("structure", "one packing row a variable" if one_packing_row else "some variables in several packing rows")]


def _function(f: dict[str, Any]) -> list[Row]:
    text = "{kind} of {items} items by {elements} elements, {entries} entries" if "items" in f else "{kind}, of {elements} elements"
    return [("function", text.format(**{**f, "kind": "the user's own" if f["kind"] == "user" else f["kind"]}))]


def _constraint(c: dict[str, Any]) -> list[Row]:
    words = {
        "cardinality": "cardinality: at most {limit} elements",
        "knapsack": "knapsack: costs up to {budget:g} of {cost:g} in all",
        "partition": "partition matroid: at most {each} of each of {groups} groups, {rank} elements in all",
    }
    limits = c.get("limits")
    each = f"{limits[0]}" + (f" to {limits[-1]}" if len(limits) > 1 else "") if limits else "0"
    return [("constraint", words[c["kind"]].format(each=each, **c) if c["kind"] in words else plain_text(c))]


TABLES.add(
    "max-min",
    Tables(
        {
            "graph": graph_rows, "packing": partial(_matrix, "packing"), "covering": partial(_matrix, "covering"),
            "one_packing_row": _structure,
        }
    ),
)  # fmt: skip
TABLES.add("selection", Tables({"graph": graph_rows, "function": _function, "constraint": _constraint}))
