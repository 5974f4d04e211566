"""What a sensing graph holds, for the tables of the families over them."""

from __future__ import annotations

from typing import Any

from ..facts import some
from ..table import Row


def graph_rows(g: dict[str, Any]) -> list[Row]:
    """Sizes, degrees and what is idle or unseen."""
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
