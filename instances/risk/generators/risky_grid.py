"""Random maps with obstacles, mud and rewards, on which a robot finds its way from one corner to the opposite one."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Setting
from ...instance import Instance
from ..element import RiskElement
from ..elements import LengthRisk, LocaleRisk, TurnRisk
from ..occupancy import OccupancyGrid, faded
from ..risky_graph import RiskyGraph
from ..tether import Tether
from ..traverse_elements import CollectedRisk, TetherRisk

SETTINGS = {
    "rows": Setting(12, "rows of cells", least=2, most=1000),
    "columns": Setting(16, "columns of cells", least=2, most=1000),
    "occupied": Setting(0.2, "share of the cells that is occupied, in blocks", least=0.0, most=0.8),
    "block": Setting(3, "longest side of a block, in cells", least=1, most=100),
    "cell": Setting(0.4, "side of a cell", least=1e-6, most=1e6),
    "connectivity": Setting(8, "neighbours of a cell: 4 or 8", least=4, most=8),
    "clearance": Setting(0.04, "risk beside an obstacle, which fades over three cells", least=0.0, most=1.0),
    "length": Setting(0.09, "risk per unit of length, as 1 - exp(-length)", least=0.0, most=1e6),
    "turn": Setting(0.02, "risk of each 45 degrees of a turn", least=0.0, most=0.25),
    "mud": Setting(0.0, "share of the free cells that are muddy: each costs a risk once a wheel is", least=0.0, most=1.0),
    "mud-risk": Setting(0.1, "risk of a muddy cell once a wheel is", least=0.0, most=1.0),
    "tether": Setting(False, "a tether from the start, at a risk of 0.01 per cell's side and 0.03 per contact"),
    "rewards": Setting(0, "cells with a reward; with any the end is free and the reward per risk counts", least=0, most=1_000_000),
    "discount": Setting(1.0, "what a reward keeps at each move that follows", least=0.0, most=1.0),
    "name": Setting(None, "name of the instance", type=str),
}

MOST_CELLS = 250_000


def make(draw: Draw, settings: Mapping[str, Any]) -> Instance:
    """One random map: obstacles are rectangles of cells that leave all free cells, start and goal among them, connected."""
    rows, columns, cell = settings["rows"], settings["columns"], settings["cell"]
    if rows * columns > MOST_CELLS:
        raise UsageError(f"rows={rows} and columns={columns} are {rows * columns} cells; at most {MOST_CELLS} are made", "too-large")
    if settings["connectivity"] not in (4, 8):
        raise UsageError(f"connectivity must be 4 or 8, not {settings['connectivity']}", "out-of-range")
    occupied = _blocks(draw, rows, columns, settings["occupied"], settings["block"], settings["connectivity"])
    grid = OccupancyGrid(occupied, cell)
    tail, head = grid.arcs(settings["connectivity"])
    n, start, goal = len(grid.cells), grid.state((0, 0)), grid.state((rows - 1, columns - 1))
    elements: list[RiskElement] = []
    if settings["clearance"]:
        elements.append(LocaleRisk(faded(grid.clearance(), cell, 4.0 * cell, settings["clearance"]), "clearance"))
    if settings["length"]:
        elements.append(LengthRisk(settings["length"]))
    if settings["turn"]:
        elements.append(TurnRisk(settings["turn"]))
    if settings["mud"]:
        muddy = draw.chosen(round(settings["mud"] * n), n)
        elements.append(CollectedRisk(muddy, np.array([np.zeros(n), np.where(muddy, settings["mud-risk"], 0.0)]), "mud"))
    if settings["tether"]:
        tether = Tether(tuple(grid.positions[start].tolist()), grid.boxes, cell)
        elements.append(TetherRisk(tether, 0.01 / cell / max(rows, columns), 0.03))
    rewards = np.zeros(n)
    if settings["rewards"]:
        others = np.setdiff1d(np.arange(n), [start])
        chosen = others[draw.permutation(len(others))[: settings["rewards"]]]
        rewards[chosen] = draw.integers(1, 9, len(chosen))
    return RiskyGraph(
        n, tail, head, tuple(elements), start, True, () if settings["rewards"] else (goal,), rewards, settings["discount"],
        positions=grid.positions, obstacles=grid.boxes, state_names=grid.names, format="generated",
        name=settings["name"] or f"risky-grid-{rows}x{columns}-s{settings['seed']}",
    )  # fmt: skip


def _blocks(draw: Draw, rows: int, columns: int, share: float, block: int, connectivity: int) -> Any:
    """Blocks until ``share`` of the cells is occupied, but for those that would cut the map in two."""
    from scipy.ndimage import label

    near = np.ones((3, 3)) if connectivity == 8 else None
    occupied = np.zeros((rows, columns), dtype=bool)
    for _ in range(rows * columns):
        if occupied.sum() >= share * rows * columns:
            break
        row, column = draw.integer(0, rows - 1), draw.integer(0, columns - 1)
        more = occupied.copy()
        more[row : row + draw.integer(1, block), column : column + draw.integer(1, block)] = True
        if not more[0, 0] and not more[-1, -1] and label(~more, near)[1] == 1:
            occupied = more
    return occupied


GENERATORS.enter(Generator("risky-grid", "maps with obstacles for risky paths", SETTINGS, make))
