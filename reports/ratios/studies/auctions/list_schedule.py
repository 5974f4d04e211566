"""Lists of full bins against what they state: for the last step of a day, and for the sum of all bins' steps."""

from __future__ import annotations

from typing import Any

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import orchard as families


def _any_list(problem: Any) -> float:
    return 2.0 - 1.0 / float(problem.jobs.num_robots)


def _longest_first(problem: Any) -> float:
    return 4.0 / 3.0 - 1.0 / (3.0 * float(problem.jobs.num_robots))


guarantee_study(
    "list-schedule", "bins one after the other, the last step stated 2 - 1/m, longest first 4/3 - 1/(3 m)", 500,
    [
        Configuration("nearest first", "list-schedule", _any_list),
        Configuration("longest first", "list-schedule", _longest_first, {"order": "longest"}),
    ],
    [families.full_bins("makespan"), families.shortest_first(), families.longest_first()],
)  # fmt: skip
guarantee_study(
    "list-schedule-sum", "bins one after the other, the sum of their steps stated 1 nearest first", 500,
    [Configuration("nearest first", "list-schedule", lambda problem: 1.0)], [families.full_bins("completion")],
)  # fmt: skip
