"""Brute force, which is optimal, against an enumeration that shares nothing with it."""

from __future__ import annotations

from .....formulations.sata.bottleneck_sata import BottleneckSATA
from ...families import Family
from ...guarantees import guarantee_study
from ...judging import Case, Configuration
from .families import planted
from .families import selection as random
from .families import selection_traps as traps

BOTTLENECKS = Family("bottleneck", "whole actions of up to 5 robots", lambda k, rng: Case(BottleneckSATA(random.random_graph(rng, k))))

guarantee_study(
    "brute-force",
    "brute force on all kinds of selections, stated 1",
    2000,
    [Configuration("brute-force", "brute-force", lambda problem: 1.0)],
    (
        *(family.named(f"{family.name}, {rule}") for rule in random.CONSTRAINTS for family in random.random_families(rule)),
        random.random_assignments(), planted.planted_assignments(), traps.order_matters(), traps.density_traps(), traps.free_elements(),
        BOTTLENECKS,
    ),
)  # fmt: skip
