"""Maps drawn in text, a character per cell, with the elements of risk in comment lines above; documented in ``docs/formats.md``.

``.`` is free, ``@`` occupied, ``S`` the start, ``G`` a goal, ``~`` mud, and a digit a reward. The last line is the lowest row.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Settings, name_of, settings_of
from ...text import shown
from ..element import RiskElement
from ..elements import LocaleRisk
from ..occupancy import OccupancyGrid, classed, faded
from ..risky_graph import RiskyGraph
from ..traverse_elements import CollectedRisk
from ._settings import COMMON, at_line, element_of, elements_of, graph_settings, numbers_of

KEYS = (*COMMON, "cell", "connectivity", "clearance", "visibility", "scale", "mud")
CELLS = ".@SG~0123456789"


def recognises(text: str) -> bool:
    """True if the first line is ``risk map``."""
    return text.lstrip().split("\n", 1)[0].lstrip("# ").rstrip().lower() == "risk map"


def read(text: str, path: Path) -> RiskyGraph:
    """The instance; see ``Format.read``."""
    settings, first = settings_of(text, KEYS, ("a map",))
    drawn, lines = _cells(text, first)
    occupied, cell = drawn == "@", numbers_of(settings, "cell", 1, 1)[0][0] if "cell" in settings else 1.0
    grid = at_line(settings, "cell", lambda: OccupancyGrid(occupied, cell)) if "cell" in settings else OccupancyGrid(occupied)
    marks = drawn[tuple(grid.cells.T)]
    (start,) = _one(np.nonzero(marks == "S")[0].tolist(), lines)
    neighbours = int(numbers_of(settings, "connectivity", 1, 1)[0][0]) if "connectivity" in settings else 8
    tail, head = at_line(settings, "connectivity", lambda: grid.arcs(neighbours)) if "connectivity" in settings else grid.arcs(neighbours)
    elements = [*_places(settings, grid), *elements_of(settings, grid.boxes, cell)]
    elements += element_of(settings, "mud", 1, 1, lambda risk: CollectedRisk(marks == "~", np.outer((0.0, risk), marks == "~"), "mud"))
    rewards = np.array([float(mark) if mark.isdigit() else 0.0 for mark in marks.tolist()])
    return RiskyGraph(
        len(marks), tail, head, tuple(elements), start, goals=tuple(np.nonzero(marks == "G")[0].tolist()), rewards=rewards,
        positions=grid.positions, obstacles=grid.boxes, state_names=grid.names, format="risk-map",
        name=name_of(settings, path), **graph_settings(settings),
    )  # fmt: skip


def _cells(text: str, first: int) -> tuple[NDArray[np.str_], int]:
    """Characters of the map, the lowest row first, and the line in which it begins."""
    rows = [line.rstrip() for line in text.split("\n")[first:]]
    while rows and not rows[-1]:
        rows.pop()
    for k, row in enumerate(rows):
        strange = next((character for character in row if character not in CELLS), None)
        if strange is not None:
            raise InputError(f"the map holds {shown(strange)}", line=first + 1 + k, expected=f"one of {' '.join(CELLS)}")
        if len(row) != len(rows[0]) or not row:
            raise InputError(
                "row has a wrong length", "wrong-shape", line=first + 1 + k, expected=f"{len(rows[0])} cells", found=f"{len(row)} cells"
            )
    return np.array([list(row) for row in reversed(rows)]), first + 1


def _one(starts: list[int], line: int) -> list[int]:
    if len(starts) != 1:
        raise InputError("the map must hold one start S", "duplicate" if starts else "missing", line=line, found=str(len(starts)))
    return starts


def _places(settings: Settings, grid: OccupancyGrid) -> list[RiskElement]:
    """Locale elements: risks that fade with clearance and visibility, and by class of scale."""

    def clear(most: float, low: float, high: float) -> RiskElement:
        return LocaleRisk(faded(grid.clearance(), low, high, most), "clearance")

    def visible(most: float, near: float, far: float, rays: float = 16) -> RiskElement:
        return LocaleRisk(faded(grid.visibility(int(rays)), near, far, most), "visibility")

    return [
        *element_of(settings, "clearance", 3, 3, clear),
        *element_of(settings, "visibility", 3, 4, visible),
        *element_of(settings, "scale", 3, 4, lambda size, *risks: LocaleRisk(classed(grid.scale(size), *risks), "scale")),
    ]


FORMATS.enter(
    Format(
        "risk-map", "map with risks drawn in text, a character a cell", recognises, read, problem="risky-path", problems=("risky-path",),
        sense="min or max", answer="path", solutions=(".json",), kinds=("risky-graph",),
    )
)  # fmt: skip
