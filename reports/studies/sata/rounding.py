"""Whole actions by rounding: no ratio is known, and each is to be the largest share of its robot."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....heuristics.heuristic import Outcome
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import TOLERANCE, Configuration, run_heuristic
from .families import max_min as families
from .families.optima import least_coverage

ALIKE = 1e-9
"""Shares no further apart are equal."""

Faults = Iterator[tuple[str, str]]


def _of_optimal_shares(problem: Any, options: Mapping[str, Any], seed: int, outcome: Outcome) -> Faults:
    """Some optimal shares of the linear program have these actions as the largest of their robots: its optimum is the same with that asked
    for."""
    chosen = list(outcome.answer.elements)
    best, rounded = least_coverage(problem.graph), least_coverage(problem.graph, chosen)
    if best - rounded > TOLERANCE * best:
        yield "order", f"the linear program has {best!r}, and at most {rounded!r} where the actions taken have the largest shares"


def _of_local_shares(problem: Any, options: Mapping[str, Any], seed: int, outcome: Outcome) -> Faults:
    """The shares on the same graph, divided: no other action of the robot has a larger one, and of equal ones the last is taken."""
    shares = run_heuristic(BottleneckSATA(problem.graph, fractional=True), "local", options, seed).answer
    for one in outcome.answer.elements:
        others = np.nonzero(problem.graph.robot_of_action == problem.graph.robot_of_action[one])[0]
        largest = others[shares[others] >= shares[others].max() - ALIKE]
        if one != largest[-1]:
            yield (
                "order",
                f"action {one + 1} is taken at a share of {shares[one]!r}, where action {largest[-1] + 1} has {shares[largest[-1]]!r}",
            )


guarantee_study(
    "rounding", "the largest share of each robot, of the linear program and of the local algorithm, no ratio stated", 500,
    [
        Configuration("linear program", "lp-rounding", lambda problem: None, checks=_of_optimal_shares),
        Configuration("local, h=2", "local", lambda problem: None, {"h": 2, "ball": False}, checks=_of_local_shares),
    ],
    [families.WHOLE, families.WHOLE_REFERENCES],
)  # fmt: skip
