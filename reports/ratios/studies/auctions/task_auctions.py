"""Auctions of tasks that state a ratio, on instances whose best paths are enumerated."""

from __future__ import annotations

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import tasks as families

guarantee_study(
    "sequential-single-item", "sum of all paths under the triangle inequality, stated 2", 5000,
    [
        Configuration("by insertion", "sequential-single-item", lambda problem: 2.0),
        Configuration("by best paths", "sequential-single-item", lambda problem: 2.0, {"paths": "optimal"}),
    ],
    [*families.random_families(), families.traps()],
)  # fmt: skip
guarantee_study(
    "fixed-order-auction", "one robot, stated the number of tasks", 2000,
    [Configuration("as numbered", "fixed-order-auction", lambda problem: float(problem.num_tasks))],
    [*families.random_families(1), families.zigzags()],
)  # fmt: skip
