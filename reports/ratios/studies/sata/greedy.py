"""Greedy, plain, lazy and group by group, against the ratios of Nemhauser, Wolsey and Fisher."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import planted
from .families import selection as random
from .families import selection_traps as traps


def greedy_ratio(problem: Any) -> float | None:
    """1 / (1 - (1 - 1/k)^k) for a cardinality limit k, 2 under a partition matroid.

    Notes
    -----
    Source: Nemhauser, Wolsey and Fisher (1978), theorem 4.2; Fisher, Nemhauser and Wolsey (1978), theorem 2.1.
    """
    rule = problem.constraint
    if rule.matroid == "uniform":
        k = min(rule.limit, problem.num_elements)
        return float(1.0 / (1.0 - (1.0 - 1.0 / k) ** k))
    return 2.0 if rule.matroid else None


def reversed_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    """The last group first."""
    return {"order": list(range(len(problem.constraint.limits)))[::-1]}


def random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    """Any order of the groups keeps the guarantee."""
    return {"order": rng.permutation(len(problem.constraint.limits)).tolist()}


def _limited(problem: Any) -> bool:
    return bool(problem.constraint.matroid == "uniform")


CARDINALITY = (*random.random_families("cardinality"), planted.planted_covers("cardinality"), traps.geometric_covers("cardinality"))
PARTITION = (
    *random.random_families("partition"), random.random_assignments(), planted.planted_assignments(), planted.planted_covers("partition"),
    traps.halves(), traps.order_matters(), traps.geometric_covers("partition"),
)  # fmt: skip

guarantee_study(
    "greedy-cardinality", "greedy with at most k elements, stated 1 - (1 - 1/k)^k", 2000, [Configuration("greedy", "greedy", greedy_ratio)],
    CARDINALITY,
)  # fmt: skip
guarantee_study(
    "greedy-partition", "greedy under a partition matroid, stated 1/2", 2000, [Configuration("greedy", "greedy", greedy_ratio)], PARTITION
)
guarantee_study(
    "lazy-greedy",
    "lazy greedy: the answer and the ratios of greedy",
    2000,
    [
        Configuration("at most k", "lazy-greedy", greedy_ratio, takes=_limited),
        Configuration("partition", "lazy-greedy", greedy_ratio, takes=lambda problem: not _limited(problem)),
    ],
    (*CARDINALITY, *PARTITION),
)
guarantee_study(
    "sequential-greedy",
    "one robot after the other, in three orders, stated 1/2 for every order",
    2000,
    [
        Configuration("in order", "sequential-greedy", greedy_ratio),
        Configuration("reversed", "sequential-greedy", greedy_ratio, reversed_order),
        Configuration("random order", "sequential-greedy", greedy_ratio, random_order),
    ],
    PARTITION,
)
