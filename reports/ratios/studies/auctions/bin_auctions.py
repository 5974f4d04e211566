"""Auctions of bins against what they state, on assignments that are enumerated or known by construction."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import assignment as families


def _in_random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": rng.permutation(problem.num_robots).tolist()}


def _serial(problem: Any) -> float:
    return float(2.0**problem.num_robots - 1.0)


def _optimum(problem: Any) -> float:
    from scipy.optimize import linear_sum_assignment

    matrix = problem.matrix()
    return float(matrix[linear_sum_assignment(matrix)].sum())


def _within(part: float) -> Configuration:
    """An epsilon so large that n epsilon is 1 / ``part`` of the optimum."""

    def options(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
        return {"epsilon": _optimum(problem) / (part * max(problem.num_robots, problem.num_bins))}

    return Configuration(
        f"n epsilon = OPT / {part:g}", "bertsekas", lambda problem: part / (part - 1.0), options,
        takes=lambda problem: _optimum(problem) > 0.0,
    )  # fmt: skip


guarantee_study(
    "auction", "the cheapest bid wins a bin, stated 2 n^(log2 3/2) - 1 on costs of travel", 2000,
    [Configuration("deferred", "auction", families.greedy_bound)],
    [families.travel(), families.serial_lines(), families.greedy_lines()],
)  # fmt: skip
guarantee_study(
    "online-greedy", "robots in turn, stated 2^n - 1 on costs of travel", 2000,
    [
        Configuration("in order", "online-greedy", _serial),
        Configuration("random order", "online-greedy", _serial, _in_random_order),
    ],
    [families.travel(fewer_robots=True), families.serial_lines(), families.greedy_lines()],
)  # fmt: skip
guarantee_study(
    "bertsekas", "prices rise by bids, optimal for whole costs, or n epsilon more for a given epsilon", 2000,
    [
        Configuration("default", "bertsekas", lambda problem: 1.0 if (problem.cost % 1.0 == 0.0).all() else 1.0 + 1e-6),
        _within(4.0),
        _within(1000.0),
    ],
    [families.travel(), families.arbitrary(), families.serial_lines(), families.greedy_lines()],
)  # fmt: skip
