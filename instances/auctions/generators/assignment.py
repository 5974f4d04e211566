"""Random assignments: uniform and whole costs, points of the plane, idle robots and bins of an orchard, dense or sparse.

Source: Zhang (2015), sections 3.2 and 3.4; read as in docs/formulations/bin-assignment.md#orchard.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Integers, Setting
from ..assignment import AssignmentInstance

COSTS = ("uniform", "whole", "euclidean", "orchard")

SETTINGS = {
    "robots": Setting(10, "number of robots", least=1, most=200_000),
    "bins": Setting(10, "number of bins", least=1, most=200_000),
    "costs": Setting(
        "uniform", "uniform in [0, 1), whole from 0, distances in a unit square, or times of travel in an orchard", choices=COSTS
    ),
    "largest": Setting(1000, "largest of the whole costs", least=0, most=1_000_000_000),
    "arcs": Setting(0, "bins that each robot may be sent to, drawn at random; 0 for all of them", least=0, most=200_000),
    "rows": Setting(10, "lanes of the orchard", least=1, most=1000),
    "columns": Setting(10, "cells of a lane, two of them headland", least=3, most=1000),
    "fill": Setting(2, "steps in which a bin of the orchard is filled, some of which have passed", least=0, most=1000),
    "name": Setting(None, "name of the instance", type=str),
}

MOST_PAIRS = 50_000_000


def orchard_distance(a: Integers, b: Integers, columns: int) -> Integers:
    """Cells from each of the cells ``a`` to each of ``b``, shape (n, 2) and (m, 2) of lane and column, by the nearer headland.

    Lanes are changed in the first and the last column only.
    """
    lanes, across = np.abs(a[:, None, 0] - b[None, :, 0]), a[:, None, 1] + b[None, :, 1]
    around = lanes + np.minimum(across, 2 * (columns - 1) - across)
    return np.asarray(np.where(lanes == 0, np.abs(a[:, None, 1] - b[None, :, 1]), around))


def make(draw: Draw, settings: Mapping[str, Any]) -> AssignmentInstance:
    """Costs of the kind that is asked for."""
    n, m, kind, arcs = (settings[key] for key in ("robots", "bins", "costs", "arcs"))
    if n * (arcs or m) > MOST_PAIRS:
        raise UsageError(f"{n} robots x {arcs or m} bins are more than {MOST_PAIRS:,} pairs; set arcs", "too-large")
    name = settings["name"] or f"assignment-{kind}-{n}x{m}{f'-a{arcs}' * bool(arcs)}-s{settings['seed']}"
    places: list[NDArray[Any]] = []
    further: dict[str, Any] = {"name": name, "format": "generated"}
    if kind == "orchard":
        lanes, columns = settings["rows"], settings["columns"]
        places = [np.column_stack([draw.integers(0, lanes - 1, n), draw.integers(0, columns - 1, n)])]
        places.append(np.column_stack([draw.integers(0, lanes - 1, m), draw.integers(1, columns - 2, m)]))
        further["filled"] = draw.integers(0, settings["fill"], m).astype(np.float64)
    elif kind == "euclidean":
        places = [draw.uniform(0.0, 1.0, (n, 2)), draw.uniform(0.0, 1.0, (m, 2))]
    if kind in ("orchard", "euclidean"):
        further |= {
            key: points[:, ::-1].astype(np.float64) for key, points in zip(("robot_positions", "bin_positions"), places, strict=True)
        }
    robots, bins = _pairs(draw, n, m, arcs)
    if kind == "orchard":
        cost = np.ceil(np.concatenate([orchard_distance(places[0][i : i + 1], places[1], columns)[0] for i in range(n)]) / 2.0)
        cost = cost[robots * m + bins]
    elif kind == "euclidean":
        cost = np.sqrt(((places[0][robots] - places[1][bins]) ** 2).sum(axis=1))
    elif kind == "whole":
        cost = draw.integers(0, settings["largest"], len(robots)).astype(np.float64)
    else:
        cost = draw.uniform(0.0, 1.0, len(robots))
    return AssignmentInstance.from_pairs(n, m, robots, bins, cost, **further)


def _pairs(draw: Draw, n: int, m: int, arcs: int) -> tuple[Integers, Integers]:
    """All pairs, or ``arcs`` a robot: random permutations of the bins beside each other, so that as many as possible can be matched."""
    if not arcs or arcs >= m:
        return np.repeat(np.arange(n), m), np.tile(np.arange(m), n)
    robots = np.repeat(np.arange(n), arcs)
    columns = []
    for _ in range(arcs):
        whole = [draw.permutation(m) for _ in range(-(-n // m))]
        columns.append(np.concatenate(whole)[:n])
    keys = np.unique(robots * np.int64(m) + np.stack(columns, axis=1).ravel())
    return keys // m, keys % m


GENERATORS.enter(Generator("assignment", "robots and bins with random costs (assignment problems, bin auctions)", SETTINGS, make))
