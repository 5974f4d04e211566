"""The local algorithm for max-min LPs: heights, searches and smoothings against Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .....formulations.sata.max_min_lp import MaxMinLP
from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import max_min as families

EPS = 0.01
"""Finer than the default, so that it hides little of how tight the rest of the bound is."""


def degrees(problem: Any) -> tuple[int, int]:
    """Delta_R and Delta_T: most live actions of a robot, most actions that see a target; both at least 2."""
    if isinstance(problem, MaxMinLP):
        live = np.unique(problem.covering.indices)
        rows = np.repeat(np.arange(problem.packing.rows), np.diff(problem.packing.indptr))
        owner = np.zeros(problem.num_variables, dtype=np.int64)
        owner[problem.packing.indices] = rows
        return max(2, int(np.bincount(owner[live]).max())), max(2, int(np.diff(problem.covering.indptr).max()))
    graph = problem.graph
    live = np.unique(graph.action_of_edge)
    return max(2, int(np.bincount(graph.robot_of_action[live]).max())), max(2, int(np.bincount(graph.indices).max()))


def _ratio(h: int, eps: float = EPS) -> Any:
    """Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) (Floréen et al. 2011, corollary 4.7; Sung 2019, theorem 1), of shares alone."""

    def expected(problem: Any) -> float:
        delta_r, delta_t = degrees(problem)
        return delta_r * (1.0 + eps) * (1.0 + 1.0 / h) * (1.0 - 1.0 / delta_t)

    return expected


def _some(problem: Any) -> float:
    """The additive search must state a guarantee, with whatever eps its step amounts to."""
    return math.inf


def _configuration(label: str, expected: Any, **options: Any) -> Configuration:
    return Configuration(label, "local", expected, {"eps": EPS, "ball": False, **options})


guarantee_study(
    "local",
    "the local algorithm, stated Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) on shares",
    1000,
    [
        *(_configuration(f"h={h}", _ratio(h), h=h) for h in (1, 2, 3, 5, 10)),
        _configuration("h=3 raw", _ratio(3), h=3, normalise=False),
        _configuration("h=3 ball", _ratio(3), h=3, smoothing="ball"),
        _configuration("h=2 step", _some, h=2, search="step"),
        _configuration("h=1..4", _ratio(4), heights=4),
        Configuration("default", "local", _ratio(3, 0.1)),
    ],
    (
        *families.RANDOM_FAMILIES, families.RANDOM_PROGRAMS, families.REFERENCE_GRAPHS, families.TIGHT, families.PRIVATE,
        families.CYCLES, families.REGULAR_TREES,
    ),
)  # fmt: skip
