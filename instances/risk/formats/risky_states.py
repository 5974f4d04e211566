"""States with their places and risks from CSV, one row each; moves join states within reach. Documented in ``docs/formats.md``.

Titles are ``state``, ``easting``, ``northing``, perhaps ``height`` and ``reward``, and ``risk`` or ``risk-NAME``, one locale element a
column.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, name_of, settings_of, table_of, titles_of
from ...number_arrays import Floats
from ...text import shown
from ..elements import LocaleRisk
from ..risky_graph import RiskyGraph, named_states
from ._settings import COMMON, elements_of, graph_settings, numbers_of

Indices = NDArray[np.integer[Any]]

FARTHEST = 1e150
"""Largest coordinate and reach; squares of much larger ones overflow."""

KEYS = (*COMMON, "reach", "start", "goals")
AXES = ("easting", "northing", "height")
COLUMNS = ("state", *AXES, "reward")


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds ``state``, ``easting``, ``northing`` and a title that begins with ``risk``."""
    titles = titles_of(text)
    return {"state", *AXES[:2]} <= titles and any(title.startswith("risk") for title in titles)


def read(text: str, path: Path) -> RiskyGraph:
    """The instance; see ``Format.read``."""
    risks = sorted(title for title in titles_of(text) if title == "risk" or title.startswith("risk-"))
    settings, start = settings_of(text, KEYS, (*COLUMNS, "risk"))
    table = table_of(text, start, (*COLUMNS, *(risks or ["risk"])), "states")
    names = table.column("state") or []
    axes = [axis for axis in AXES if table.column(axis) is not None]
    positions = np.column_stack([table.numbers(axis) for axis in axes])
    for key in ("reach", "start"):
        if key not in settings:
            raise InputError(f"setting {key} is missing", "missing", line=1, expected=f"a line '# {key}: ...'")
    (reach,), _ = numbers_of(settings, "reach", 1, 1)
    if not reach > 0.0:
        raise InputError("the reach of a move must be positive", "out-of-range", line=settings["reach"][0], found=f"{reach:g}")
    tail, head = _within(positions, reach)
    elements = [LocaleRisk(_probabilities(table, title), title.partition("-")[2] or "risk") for title in risks]
    ends = {}
    for key in ("start", "goals"):
        if key in settings:
            line, listed = settings[key]
            chosen = [part.strip() for part in listed.replace(";", ",").split(",") if part.strip()]
            try:
                ends[key] = named_states(names, chosen, key.removesuffix("s") if key == "goals" else key)
            except InputError as error:
                raise error.at(line=line) from None
    if len(ends["start"]) != 1:
        raise InputError(
            "there must be one start", "duplicate" if ends["start"] else "missing", line=settings["start"][0], found=str(len(ends["start"]))
        )
    return RiskyGraph(
        len(names), tail, head, (*elements, *elements_of(settings, [], None)), ends["start"][0],
        goals=ends.get("goals", ()), rewards=table.numbers("reward") if table.column("reward") is not None else None,
        positions=positions, state_names=tuple(names), format="risk-states",
        name=name_of(settings, path), **graph_settings(settings),
    )  # fmt: skip


def _probabilities(table: Table, title: str) -> Floats:
    risk = table.numbers(title)
    wrong = ~((risk >= 0.0) & (risk <= 1.0))
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{title} must lie in [0, 1]", "out-of-range", line=table.at[k], found=shown(f"{risk[k]:g}"))
    return risk


def _within(positions: Floats, reach: float) -> tuple[Indices, Indices]:
    """Pairs of states no farther apart than ``reach``, both ways."""
    from scipy.spatial import cKDTree

    largest = max(reach, float(np.abs(positions).max(initial=0.0)))
    if largest > FARTHEST:
        raise InputError(
            "places and reach are too large for distances", "out-of-range", expected=f"at most {FARTHEST:g}", found=f"{largest:g}"
        )
    pairs = cKDTree(positions).query_pairs(reach * (1.0 + 1e-12), output_type="ndarray")
    return np.concatenate([pairs[:, 0], pairs[:, 1]]), np.concatenate([pairs[:, 1], pairs[:, 0]])


FORMATS.enter(
    Format(
        "risk-states", "states with places and risks from CSV, one row each", recognises, read, problem="risky-path",
        problems=("risky-path",), sense="min or max", answer="path", solutions=(".json",), kinds=("risky-graph",),
    )
)  # fmt: skip
