"""The effect of the height h on the local algorithm, before and after rounding (Sung 2019, figure 3.8)."""

from __future__ import annotations

import math

from .....formulations.sata.bottleneck_sata import BottleneckSATA
from .....instances.sata.sensing_graph import SensingGraph
from ...judging import judge, run_heuristic
from ._experiment import ExperimentPlan, Measured, Sweep, experiment, solved

HEIGHTS = (1, 2, 5, 8)

SHARES = tuple(f"h={h}" for h in HEIGHTS)
ROUNDED = tuple(f"h={h} whole" for h in HEIGHTS)

NOTES = (
    "after figure 3.8 of Sung (2019), whose numbers are not in its text; 50 targets, phi = 15 %, two actions a robot, step 0.1",
    "the guarantee improves with h, values need not: they are not monotone in h, and nothing is guaranteed after rounding",
)


def measure(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target for each height."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    values, faults = {"LP": relaxed.value, "ILP": best.value}, []
    for h in HEIGHTS:
        options = {"h": h, "search": "step", "step": 0.1, "ball": False}
        fractional = judge(shares, relaxed, run_heuristic(shares, "local", options, seed), expected=math.inf)
        rounded = judge(whole, best, run_heuristic(whole, "local", options, seed))
        values[f"h={h}"], values[f"h={h} whole"] = fractional.value, rounded.value
        faults += [*fractional.faults, *rounded.faults]
    return values, faults


experiment(
    "layers",
    "effect of the number of layers h on the local algorithm",
    100,
    ExperimentPlan(
        sweeps=(Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),),
        methods=("LP", *SHARES, "ILP", *ROUNDED),
        measure=measure,
        orders=(("ILP", "LP"), *((h, "LP") for h in SHARES), *((h, "ILP") for h in ROUNDED)),
        quantity="coverage of the worst target",
        groups=(("shares", ("LP", *SHARES)), ("rounded", ("ILP", *ROUNDED))),
        notes=NOTES,
    ),
)
