"""Random generalised assignments: classes C and D of the literature, and retrievals of full bins within a horizon."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Generator, Setting
from ..generalised_assignment import GeneralisedAssignmentInstance
from .assignment import orchard_distance

CLASSES = ("c", "d", "orchard")

SETTINGS = {
    "agents": Setting(5, "number of agents", least=1, most=10_000),
    "jobs": Setting(20, "number of jobs", least=1, most=100_000),
    "costs": Setting(
        "c", "class C: costs and consumption drawn apart; D: what consumes little costs much; or bins of an orchard, a profit of 1 each",
        choices=CLASSES,
    ),
    "rows": Setting(10, "lanes of the orchard", least=1, most=1000),
    "columns": Setting(10, "cells of a lane, two of them headland", least=3, most=1000),
    "horizon": Setting(50, "steps that each robot of the orchard has", least=0, most=1_000_000),
    "name": Setting(None, "name of the instance", type=str),
}  # fmt: skip


def make(draw: Draw, settings: Mapping[str, Any]) -> GeneralisedAssignmentInstance:
    """Classes as in Chu and Beasley (1997): capacities are 0.8 of an even share of what the jobs consume.

    C: consumption 5 to 25, costs 10 to 50. D: consumption a of 1 to 100, costs 111 - a and up to 10 more or less. Orchard: robots begin and
    end at the repository in the corner, so that a full bin takes each the same ceil(d / 2) + d steps.
    """
    m, n, kind = (settings[key] for key in ("agents", "jobs", "costs"))
    name = settings["name"] or f"generalised-assignment-{kind}-{m}x{n}-s{settings['seed']}"
    further: dict[str, Any] = {"name": name, "format": "generated"}
    if kind == "orchard":
        cells = np.column_stack([draw.integers(0, settings["rows"] - 1, n), draw.integers(1, settings["columns"] - 2, n)])
        away = orchard_distance(np.zeros((1, 2), dtype=np.int64), cells, settings["columns"])[0]
        taken = np.ceil(away / 2.0) + away
        return GeneralisedAssignmentInstance(np.ones((m, n)), taken, np.full(m, float(settings["horizon"])), "profit", **further)
    least, most = (5, 25) if kind == "c" else (1, 100)
    used = draw.integers(least, most, m * n).reshape(m, n).astype(np.float64)
    costs = draw.integers(*((10, 50) if kind == "c" else (-10, 10)), m * n).reshape(m, n).astype(np.float64)
    if kind == "d":
        costs += 111.0 - used
    return GeneralisedAssignmentInstance(costs, used, np.floor(0.8 * used.sum(axis=1) / m), **further)


GENERATORS.enter(Generator("generalised-assignment", "agents of limited capacity and jobs (generalised assignment)", SETTINGS, make))
