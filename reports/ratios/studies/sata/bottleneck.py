"""The bottleneck problem: whole actions, shares, rounding, the local algorithm and random actions (Sung 2019, figure 3.7)."""

from __future__ import annotations

import math

from .....formulations.sata.bottleneck_sata import BottleneckSATA
from .....instances.sata.sensing_graph import SensingGraph
from ...judging import judge, run_heuristic
from ._experiment import ExperimentPlan, Measured, Sweep, experiment, solved

LOCAL = {"h": 2, "search": "step", "step": 0.1, "ball": False}
"""As in the thesis: two layers, levels lowered in steps of 0.1."""

NOTES = (
    "after figure 3.7 of Sung (2019), whose numbers are not in its text; binary weights, two actions a robot",
    "ILP, LP: HiGHS; LP rounded: each robot takes its largest share, the last of equal ones; local: h = 2, step 0.1, "
    "shares; local rounded: the same, rounded likewise",
    "nothing is guaranteed after rounding; 0 means that some target is not covered",
)


def measure(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target by each method on one graph."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    rounded = judge(whole, best, run_heuristic(whole, "lp-rounding", {}, seed))
    local = judge(shares, relaxed, run_heuristic(shares, "local", LOCAL, seed), expected=math.inf)
    local_whole = judge(whole, best, run_heuristic(whole, "local", LOCAL, seed))
    random = judge(whole, best, run_heuristic(whole, "random", {}, seed))
    values = {
        "LP": relaxed.value, "ILP": best.value, "LP rounded": rounded.value, "local": local.value, "local rounded": local_whole.value,
        "random": random.value,
    }  # fmt: skip
    return values, [fault for run in (rounded, local, local_whole, random) for fault in run.faults]


experiment(
    "bottleneck",
    "whole actions, shares, rounding, local algorithm and random choice",
    100,
    ExperimentPlan(
        sweeps=(
            Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),
            Sweep("phi", (15.0, 20.0, 25.0, 30.0, 40.0), {"robots": 12, "targets": 50}),
            Sweep("targets", (25, 50, 75, 100), {"robots": 12, "phi": 15.0}),
        ),
        methods=("LP", "ILP", "LP rounded", "local", "local rounded", "random"),
        measure=measure,
        orders=(("ILP", "LP"), ("LP rounded", "ILP"), ("local", "LP"), ("local rounded", "ILP"), ("random", "ILP")),
        quantity="coverage of the worst target",
        notes=NOTES,
    ),
)
