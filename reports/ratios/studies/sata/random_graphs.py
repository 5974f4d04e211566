"""Experiments on random sensing graphs: optimum, rounding, greedy, local algorithm and random choice (Sung 2019, figures 3.6 to 3.8)."""

from __future__ import annotations

import math

from .....formulations.sata.bottleneck_sata import BottleneckSATA
from .....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .....instances.sata.sensing_graph import SensingGraph
from ...judging import judge, run_heuristic
from ._experiment import ExperimentPlan, Measured, Sweep, experiment, solved

LOCAL = {"search": "step", "step": 0.1, "ball": False}
"""As in the thesis: levels lowered in steps of 0.1."""

HEIGHTS = (1, 2, 5, 8)
SHARES = tuple(f"h={h}" for h in HEIGHTS)
ROUNDED = tuple(f"h={h} whole" for h in HEIGHTS)


def winner_takes_all(graph: SensingGraph, seed: int) -> Measured:
    """Covered targets of each method on one graph."""
    problem = WinnerTakesAllSATA(graph)
    best = solved(problem)
    greedy = judge(problem, best, run_heuristic(problem, "sequential-greedy", {}, seed), expected=2.0)
    random = judge(problem, best, run_heuristic(problem, "random", {}, seed))
    values = {"exact": best.value, "greedy": greedy.value, "random": random.value}
    return values, [*greedy.faults, *random.faults]


def bottleneck(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target by each method on one graph."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    rounded = judge(whole, best, run_heuristic(whole, "lp-rounding", {}, seed))
    local = judge(shares, relaxed, run_heuristic(shares, "local", {"h": 2, **LOCAL}, seed), expected=math.inf)
    local_whole = judge(whole, best, run_heuristic(whole, "local", {"h": 2, **LOCAL}, seed))
    random = judge(whole, best, run_heuristic(whole, "random", {}, seed))
    values = {
        "LP": relaxed.value, "ILP": best.value, "LP rounded": rounded.value, "local": local.value, "local rounded": local_whole.value,
        "random": random.value,
    }  # fmt: skip
    return values, [fault for run in (rounded, local, local_whole, random) for fault in run.faults]


def layers(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target by the local algorithm of each height, before and after rounding."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    values, faults = {"LP": relaxed.value, "ILP": best.value}, []
    for h in HEIGHTS:
        fractional = judge(shares, relaxed, run_heuristic(shares, "local", {"h": h, **LOCAL}, seed), expected=math.inf)
        rounded = judge(whole, best, run_heuristic(whole, "local", {"h": h, **LOCAL}, seed))
        values[f"h={h}"], values[f"h={h} whole"] = fractional.value, rounded.value
        faults += [*fractional.faults, *rounded.faults]
    return values, faults


experiment(
    "winner-takes-all",
    "optimum, greedy and random choice on random sensing graphs",
    100,
    ExperimentPlan(
        sweeps=(
            Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),
            Sweep("targets", (25, 50, 75, 100, 150), {"robots": 8, "phi": 15.0}),
            Sweep("phi", (15.0, 20.0, 25.0, 30.0, 40.0, 50.0), {"robots": 8, "targets": 50}),
        ),
        methods=("exact", "greedy", "random"),
        measure=winner_takes_all,
        orders=(("greedy", "exact"), ("random", "exact")),
        quantity="covered targets",
        shares=(("greedy", "exact"), ("random", "exact")),
        notes=(
            "after figure 3.6 of Sung (2019), whose swept values and numbers are not in its text; binary weights, two actions a robot",
            "exact: HiGHS; greedy: robot after robot in order, stated 1/2; random: one draw a trial",
        ),
    ),
)
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
        measure=bottleneck,
        orders=(("ILP", "LP"), ("LP rounded", "ILP"), ("local", "LP"), ("local rounded", "ILP"), ("random", "ILP")),
        quantity="coverage of the worst target",
        notes=(
            "after figure 3.7 of Sung (2019), whose numbers are not in its text; binary weights, two actions a robot",
            "ILP, LP: HiGHS; LP rounded: each robot takes its largest share, the last of equal ones; local: h = 2, step 0.1, "
            "shares; local rounded: the same, rounded likewise",
            "nothing is guaranteed after rounding; 0 means that some target is not covered",
        ),
    ),
)
experiment(
    "layers",
    "effect of the number of layers h on the local algorithm",
    100,
    ExperimentPlan(
        sweeps=(Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),),
        methods=("LP", *SHARES, "ILP", *ROUNDED),
        measure=layers,
        orders=(("ILP", "LP"), *((h, "LP") for h in SHARES), *((h, "ILP") for h in ROUNDED)),
        quantity="coverage of the worst target",
        groups=(("shares", ("LP", *SHARES)), ("rounded", ("ILP", *ROUNDED))),
        notes=(
            "after figure 3.8 of Sung (2019), whose numbers are not in its text; 50 targets, phi = 15 %, two actions a robot, step 0.1",
            "the guarantee improves with h, values need not: they are not monotone in h, and nothing is guaranteed after rounding",
        ),
    ),
)
