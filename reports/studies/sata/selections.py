"""Methods for selections against the ratios that are stated for them, on random problems and on those where greed does worst."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ...ratios.families import Family
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Case, Configuration
from .families import selection as random, selection_traps as traps

REPEATS = 30
"""Seeds for each instance, where a guarantee holds in expectation."""

SHARES = {size: (1.0 - math.exp(-1.0)) / (2.0 if size < 2 else 1.0) for size in range(4)}
"""Knapsacks, by the size of the starting sets: the better of greedy and the best element (Khuller, Moss and Naor 1999), pairs (Kulik,
Schwartz and Shachnai 2021), triples (Sviridenko 2004)."""


def greedy_ratio(problem: Any) -> float | None:
    """1 / (1 - (1 - 1/k)^k) for a cardinality limit k, 2 under a partition matroid.

    Source: Nemhauser, Wolsey and Fisher (1978), theorem 4.2; Fisher, Nemhauser and Wolsey (1978), theorem 2.1.
    """
    rule = problem.constraint
    if rule.matroid == "uniform":
        k = min(rule.limit, problem.num_elements)
        return float(1.0 / (1.0 - (1.0 - 1.0 / k) ** k))
    return 2.0 if rule.matroid else None


def _continuous_ratio(steps: int) -> Any:
    """1 / (1 - (1 + 1/T)^-T) for T steps, each along the base that is best after it; 1 / (1 - 1/e) in the limit.

    Source: Calinescu, Chekuri, Pál and Vondrák (2011), Maximizing a monotone submodular function subject to a matroid constraint; for
    steps of finite length Badanidiyuru and Vondrák (2014), lemma 3.2 and 3.3.
    """
    return lambda problem: 1.0 / (1.0 - (1.0 + 1.0 / steps) ** -steps)


def _stochastic_ratio(eps: float) -> Any:
    """1 / (1 - 1/e - eps), in expectation (Mirzasoleiman, Badanidiyuru, Karbasi, Vondrák and Krause 2015, theorem 1)."""
    return lambda problem: 1.0 / (1.0 - math.exp(-1.0) - eps)


def _knapsack_ratio(size: int) -> Any:
    return lambda problem: 1.0 / SHARES[size]


def _reversed_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": list(range(len(problem.constraint.limits)))[::-1]}


def _random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": rng.permutation(len(problem.constraint.limits)).tolist()}


def _limited(problem: Any) -> bool:
    return bool(problem.constraint.matroid == "uniform")


CARDINALITY = (*random.random_families("cardinality"), random.planted_covers("cardinality"), traps.geometric_covers("cardinality"))
PARTITION = (
    *random.random_families("partition"), random.RANDOM_ASSIGNMENTS, random.PLANTED_ASSIGNMENTS, random.planted_covers("partition"),
    traps.HALVES, traps.ORDER_MATTERS, traps.SHARED_TARGETS, traps.geometric_covers("partition"),
)  # fmt: skip
BOTTLENECKS = Family("bottleneck", "whole actions of up to 5 robots", lambda k, rng: Case(BottleneckSATA(random.random_graph(rng, k))))

guarantee_study(
    "brute-force",
    "brute force on all kinds of selections, stated 1",
    2000,
    [Configuration("brute-force", "brute-force", lambda problem: 1.0)],
    (
        *(family.named(f"{family.name}, {rule}") for rule in random.CONSTRAINTS for family in random.random_families(rule)),
        random.RANDOM_ASSIGNMENTS, random.PLANTED_ASSIGNMENTS, traps.ORDER_MATTERS, traps.DENSITY_TRAPS, traps.FREE_ELEMENTS, BOTTLENECKS,
    ),
)  # fmt: skip
guarantee_study(
    "continuous-greedy",
    "T steps and pipage rounding, stated 1 - (1 + 1/T)^-T, in the limit 1 - 1/e",
    2000,
    [
        Configuration(f"{steps} step{'s' * (steps > 1)}", "continuous-greedy", _continuous_ratio(steps), {"steps": steps},
                      takes=lambda problem: problem.function.as_item_weights() is not None)
        for steps in (1, 10, 100)
    ],
    (
        *(family for family in random.random_families("partition") if family.name != "user-function"), random.RANDOM_ASSIGNMENTS,
        random.PLANTED_ASSIGNMENTS, traps.HALVES, traps.ORDER_MATTERS, traps.SHARED_TARGETS, traps.geometric_covers("cardinality"),
        random.planted_covers("cardinality"),
    ),
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
        Configuration("reversed", "sequential-greedy", greedy_ratio, _reversed_order),
        Configuration("random order", "sequential-greedy", greedy_ratio, _random_order),
    ],
    PARTITION,
    source="Sung (2019), Theorem 2",
    claim="half of the optimum at least, in any order of the robots",
)
guarantee_study(
    "knapsack-greedy",
    "gain per cost from starting sets of 0 to 3 elements, stated (1 - 1/e)/2 and 1 - 1/e",
    2000,
    [Configuration(f"sets of {size}", "knapsack-greedy", _knapsack_ratio(size), {"enumerate": size}) for size in SHARES],
    (
        *random.random_families("knapsack"), random.planted_covers("knapsack"), traps.DENSITY_TRAPS, traps.HALF_TRAPS, traps.SHUT_OUTS,
        traps.FREE_ELEMENTS, traps.geometric_covers("knapsack"),
    ),
)  # fmt: skip
guarantee_study(
    "stochastic-greedy",
    "at most k elements from samples, stated 1 - 1/e - eps in expectation",
    600,
    [Configuration(f"eps = {eps:g}", "stochastic-greedy", _stochastic_ratio(eps), {"eps": eps}, REPEATS) for eps in (0.1, 0.3)],
    (
        *random.random_families("cardinality"),
        random.planted_covers("cardinality"),
        replace(traps.geometric_covers("cardinality"), effort=5),
        traps.NEEDLES,
    ),
)
