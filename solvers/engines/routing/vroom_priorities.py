"""Rewards as VROOM's priorities: it assigns as much priority as it can, then as many sites, and then looks at costs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....formulations.checking.granularity import grain
from ....formulations.routing.objective import Objective, TotalCost

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

Floats = NDArray[np.float64]

HIGHEST = 100
"""Of VROOM's priorities, which are whole numbers from 0 on."""

PRIZES = frozenset({"reward", "penalties"})
"""Terms that count sites."""


@dataclass(frozen=True)
class Priorities:
    """Who is to be visited, and what is minimised then.

    Parameters
    ----------
    problem : RoutingProblem
        Its objective is what comes after the rewards.
    of : dict
        Priority of each site that is worth a visit. Required ones have the highest, where others are optional.
    required : frozenset of int
        Sites without which there is no answer.
    """

    problem: RoutingProblem
    of: Mapping[int, int]
    required: frozenset[int]

    @property
    def choosing(self) -> bool:
        """Whether any site may be left out."""
        return len(self.required) < len(self.of)

    def without_choice(self) -> Priorities:
        """The same for the required sites alone."""
        return replace(self, of={site: self.of[site] for site in self.required})


def priorities(problem: RoutingProblem) -> Priorities | frozenset[str]:
    """What VROOM is asked for, or the features in its way.

    Rewards, or penalties, have to be the first level of the objective, and become priorities where they are multiples, up to the 100th,
    of one number, or of the form p b + 1 for priorities p and a b that is larger than the number of sites: which is what an instance in
    VROOM's own JSON has. Sites that earn nothing are left out.
    """
    sites = problem.sites
    first, *later = problem.objective.levels()
    required = frozenset(site for site in problem.customers.tolist() if sites.required[site])
    prized = {term.name for _, term in first.terms} & PRIZES
    behind = {term.name for level in later for _, term in level.terms} & PRIZES
    if behind or (prized and len(first.terms) > 1):
        return frozenset(f"objective:{name} beside or after others" for name in behind | prized)
    if not prized:
        return Priorities(problem, dict.fromkeys(sorted(required), 0), required)
    after = replace(problem, objective=Objective(tuple(later) or TotalCost().levels()))
    earned = np.where(sites.depot, 0.0, sites.reward if prized == {"reward"} else sites.penalty)
    for shipment in sites.shipments:  # VROOM counts both ends
        earned[[shipment.pickup, shipment.delivery]] = (earned[shipment.pickup] + earned[shipment.delivery]) / 2.0
    choices = [site for site in problem.customers.tolist() if site not in required and earned[site] > 0.0]
    steps = _steps(earned[choices])
    if steps is None:
        return frozenset({f"objective:{next(iter(prized))} in more than {HIGHEST} steps"})
    of = dict.fromkeys(required, HIGHEST if choices else 0) | dict(zip(choices, steps, strict=True))
    return Priorities(after, dict(sorted(of.items())), required)


def _steps(earned: Floats) -> list[int] | None:
    """Priorities in whose order sums of them have to be; None where there are none."""
    found = grain(earned)
    if found is None:
        return None if len(earned) else []
    counts = np.rint(earned / found.size)
    if counts.max() > HIGHEST:
        whole = np.rint(earned)
        if (whole != earned).any() or whole.max() >= 2.0**53:
            return None
        base = int(np.gcd.reduce((whole - 1.0).astype(np.int64)))
        counts = (whole - 1.0) / max(base, 1)
        if base <= len(earned) or counts.max() > HIGHEST:
            return None
    return [int(count) for count in counts]
