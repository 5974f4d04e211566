"""Local ratios for generalised assignments of profits: 2 for exact knapsacks."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import knapsack_assignment as families


def _in_random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": tuple(rng.permutation(problem.num_agents).tolist())}


guarantee_study(
    "local-ratio", "agents fill their capacities in turn, stated 2 for profits", 2000,
    [
        Configuration("in order", "local-ratio", lambda problem: 2.0),
        Configuration("random order", "local-ratio", lambda problem: 2.0, _in_random_order),
    ],
    [families.random_profits(), families.stolen_jobs()],
)  # fmt: skip
