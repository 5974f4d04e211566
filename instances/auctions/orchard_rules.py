"""The rules of an orchard's day, and where its groups begin."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError, UsageError
from ..generators import Draw
from ..generators.settings import Setting
from ..number_arrays import Integers
from .orchard_grid import OrchardGrid

RELOCATIONS = ("nearest", "random")

NONE = -1


class Trip(NamedTuple):
    """An order to an idle robot: bring a new bin from the repository to the cell ``deliver``, then fetch the full bin of number ``fetch``.

    -1 stands for none; with neither the robot goes home.
    """

    deliver: int = NONE
    fetch: int = NONE


@dataclass(frozen=True)
class OrchardRules:
    """The data of an orchard that stay the same all day.

    ``bins_per_cell`` is the fruit of a harvest cell in bins, ``fill`` the steps for which a group of ``pickers`` fills a bin. From an empty
    cell a group relocates to the ``nearest`` cell with fruit and without a group (the first of equals), or to the first such cell of an
    order drawn for it at ``random``.
    """

    grid: OrchardGrid
    robots: int
    groups: int
    bins_per_cell: int = 2
    fill: int = 2
    pickers: int = 5
    relocation: str = "nearest"

    def __post_init__(self) -> None:
        if self.groups > len(self.grid.harvested):
            raise UsageError(f"{self.groups} groups do not fit into {len(self.grid.harvested)} harvest cells")

    @property
    def bins(self) -> int:
        """Bins of fruit in the orchard."""
        return len(self.grid.harvested) * self.bins_per_cell


class OrchardStart(NamedTuple):
    """First cells of the groups of pickers, shape (groups,), and the orders in which they prefer cells, shape (groups, cells).

    Orders have no columns where groups go to the nearest cell; -1 stands for no cell.
    """

    cells: Integers
    orders: Integers


def draw_start(rules: OrchardRules, draw: Draw) -> OrchardStart:
    """Distinct harvest cells where groups begin, and orders where they go by chance; as much is drawn either way."""
    cells = rules.grid.harvested
    begin = cells[draw.permutation(len(cells))[: rules.groups]]
    orders = np.array([cells[draw.permutation(len(cells))] for _ in range(rules.groups)])
    return OrchardStart(begin, orders if rules.relocation == "random" else np.empty((rules.groups, 0), np.int64))


def draw_routes(rules: OrchardRules, draw: Draw) -> OrchardStart:
    """Routes that share no cell: the harvest cells along the lanes, one to and one fro, dealt out in equal runs; which way each is gone
    is drawn."""
    rows = rules.grid.harvested.reshape(rules.grid.rows, -1)
    along = np.concatenate([row if k % 2 == 0 else row[::-1] for k, row in enumerate(rows)])
    routes = [
        run if turn < 0.5 else run[::-1]
        for run, turn in zip(np.array_split(along, rules.groups), draw.uniform(0, 1, rules.groups), strict=True)
    ]
    longest = max(len(route) for route in routes)
    orders = np.array([np.pad(route, (0, longest - len(route)), constant_values=NONE) for route in routes])
    return OrchardStart(orders[:, 0], orders)


def checked_start(rules: OrchardRules, start: OrchardStart) -> OrchardStart:
    """``start`` as arrays; raises InputError where it does not fit the rules."""
    cells, orders = np.asarray(start.cells, np.int64), np.asarray(start.orders, np.int64)
    harvested = set(rules.grid.harvested.tolist())
    if cells.shape != (rules.groups,) or len(set(cells.tolist())) < len(cells) or not set(cells.tolist()) <= harvested:
        raise InputError("each group starts in a harvest cell of its own", "contradiction", found=str(cells.tolist())[:80])
    if orders.ndim != 2 or len(orders) != rules.groups or not set(orders.ravel().tolist()) <= harvested | {NONE}:
        raise InputError("the orders of groups name harvest cells, one row a group", "contradiction", found=str(orders.shape))
    return OrchardStart(cells, orders)


def orchard_rules(values: Mapping[str, Any]) -> OrchardRules:
    """Rules of setting values."""
    grid = OrchardGrid(*(values[key] for key in ("rows", "columns")), *(values[key] for key in ("repository", "empty-speed", "full-speed")))
    others = {key.replace("-", "_"): values[key] for key in ("robots", "groups", "bins-per-cell", "fill", "pickers", "relocation")}
    return OrchardRules(grid, **others)


ORCHARD: Mapping[str, Setting] = {
    "rows": Setting(10, "lanes", int, 1, 500),
    "columns": Setting(10, "cells a lane, a headland at each end included", int, 3, 500),
    "repository": Setting(0, "row of the collection point, which lies in the first column", int, 0, 499),
    "robots": Setting(10, "number of robots, which start at the repository", int, 1, 1000),
    "groups": Setting(4, "groups of pickers", int, 1, 1000),
    "pickers": Setting(5, "in a group", int, 1, 1000),
    "bins-per-cell": Setting(2, "fruit of a harvest cell, bins", int, 1, 100),
    "fill": Setting(2, "steps for which a group fills a bin", int, 1, 1000),
    "empty-speed": Setting(2, "cells a step of a robot without a full bin", int, 1, 1000),
    "full-speed": Setting(1, "cells a step of a robot with a full bin", int, 1, 1000),
    "relocation": Setting("nearest", "where groups go from empty cells", choices=RELOCATIONS),
}
