"""Continuous greedy with pipage rounding, which is better than greedy's 1/2 under a matroid."""

from __future__ import annotations

from typing import Any

from ...families import Family
from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import planted
from .families import selection as random
from .families import selection_traps as traps


def _ratio(steps: int) -> Any:
    """1 / (1 - (1 + 1/T)^-T) for T steps, each along the base that is best after it; 1 / (1 - 1/e) in the limit.

    Notes
    -----
    Source: Calinescu, Chekuri, Pál and Vondrák (2011), Maximizing a monotone submodular function subject to a matroid constraint; for
    steps of finite length Badanidiyuru and Vondrák (2014), lemma 3.2 and 3.3.
    """
    return lambda problem: 1.0 / (1.0 - (1.0 + 1.0 / steps) ** -steps)


def _closed_form(families: tuple[Family, ...]) -> tuple[Family, ...]:
    return tuple(family for family in families if family.name != "user-function")


guarantee_study(
    "continuous-greedy",
    "T steps and pipage rounding, stated 1 - (1 + 1/T)^-T, in the limit 1 - 1/e",
    2000,
    [
        Configuration(f"{steps} step{'s' * (steps > 1)}", "continuous-greedy", _ratio(steps), {"steps": steps},
                      takes=lambda problem: problem.function.as_item_weights() is not None)
        for steps in (1, 10, 100)
    ],
    (
        *_closed_form(random.random_families("partition")), random.random_assignments(), planted.planted_assignments(), traps.halves(),
        traps.order_matters(), traps.geometric_covers("cardinality"), planted.planted_covers("cardinality"),
    ),
)  # fmt: skip
