"""Winner takes all: the optimum, the sequential greedy and random actions, by robots, targets and density (Sung 2019, figure 3.6)."""

from __future__ import annotations

from .....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .....instances.sata.sensing_graph import SensingGraph
from ...judging import judge, run_heuristic
from ._experiment import ExperimentPlan, Measured, Sweep, experiment, solved

NOTES = (
    "after figure 3.6 of Sung (2019), whose swept values and numbers are not in its text; binary weights, two actions a robot",
    "exact: HiGHS; greedy: robot after robot in order, stated 1/2; random: one draw a trial",
)


def measure(graph: SensingGraph, seed: int) -> Measured:
    """Covered targets of each method on one graph."""
    problem = WinnerTakesAllSATA(graph)
    best = solved(problem)
    greedy = judge(problem, best, run_heuristic(problem, "sequential-greedy", {}, seed), expected=2.0)
    random = judge(problem, best, run_heuristic(problem, "random", {}, seed))
    values = {"exact": best.value, "greedy": greedy.value, "random": random.value}
    return values, [*greedy.faults, *random.faults]


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
        measure=measure,
        orders=(("greedy", "exact"), ("random", "exact")),
        quantity="covered targets",
        shares=(("greedy", "exact"), ("random", "exact")),
        notes=NOTES,
    ),
)
