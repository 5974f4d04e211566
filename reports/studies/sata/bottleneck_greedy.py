"""Greedy on the bottleneck problem, after Sung (2019), appendix A.3: the printed counterexample, and some that are."""

from typing import Any

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.selections import Selection
from ...plots.drawing import COLOURS, plain
from ...ratios.judged_runs import run_heuristic
from ..findings import Finding
from ..frames import frame_table
from ..study import Report, StudySetting, figure, study
from .experiments import solved
from .families.max_min import robots

PRINTED: list[list[Any]] = [[[0], {0: 0.0}], [{0: 0.0}, [1]]]
"""A.3: robot 1 sees target 1 or nothing, robot 2 nothing or target 2."""

CORRECTED = {f"d = {d:g}": [[{0: d, 1: d}, {0: 1.0}], [{1: 1.0}]] for d in (0.5, 0.1, 0.01, 0.001)}
"""Robot 1 prefers both targets at d to one at 1, and robot 2 sees the other alone."""

BINARY: list[list[Any]] = [[[1], [0]], [[1], [0]], [{0: 0.0}, [0]], [[0], {0: 0.0}]]
"""Weights of 0 and 1, on which greedy fails however ties are broken."""


@study(
    "bottleneck-greedy",
    "how far below the optimum greedy ends when the worst-covered target counts",
    1,
    source="Sung (2019), appendix A.3",
    claim="greedy has no guarantee on the bottleneck: on two robots of two actions it takes 0 where 2 is possible",
)
def bottleneck_greedy(setting: StudySetting) -> Report:
    """See ``Study.run``; nothing is random."""
    cases = {"A.3 as printed": PRINTED, **CORRECTED, "weights 0 and 1": BINARY}
    rows: list[dict[str, Any]] = []
    for name, actions in cases.items():
        problem = BottleneckSATA(robots(actions, name).graph)
        best = solved(problem).value
        greedy = float(problem.evaluate(run_heuristic(problem, "greedy", {}, setting.seed).answer).values[0])
        rows.append({"instance": name, "optimum": best, "greedy": greedy, "ratio": best / greedy if greedy else float("inf")})
    alone = BottleneckSATA(robots(PRINTED, "first-step").graph)
    first = [float(alone.evaluate(Selection((action,))).values[0]) for action in (0, 1)]
    known = {row["instance"]: row for row in rows}
    printed, last, binary = known["A.3 as printed"], rows[-2], known["weights 0 and 1"]
    findings = (
        Finding.of_fact("optimum of the printed instance", "2", f"{printed['optimum']:g}", printed["optimum"] == 2,
                        "each target is seen once by the best choice", exact=True),
        Finding.of_fact("values of robot 1's actions on it", "1 against 0", "{:g} against {:g}".format(*first), first == [1.0, 0.0],
                        "one target stays uncovered by either, so that ties decide", exact=True),
        Finding.of_fact("greedy is arbitrarily bad", "yes", f"ratio {last['ratio']:.0f} at {last['instance']}", last["ratio"] > 100),
        Finding.of_fact("it fails with weights 0 and 1, whatever the ties", "yes", f"{binary['greedy']:g} of {binary['optimum']:g}",
                        binary["greedy"] < binary["optimum"]),
    )  # fmt: skip
    return Report(
        "bottleneck-greedy", bottleneck_greedy.summary, frame_table("Coverage of the worst target", rows), tuple(rows),
        figures=(_figure(rows[1:-1]),), findings=findings, done=1, asked=1,
    )  # fmt: skip


@figure("bottleneck-greedy", 6.0, 3.0)
def _figure(figure: Any, rows: list[dict[str, Any]]) -> None:
    """Optimum and greedy on the corrected instances."""
    ax = figure.subplots()
    for k, key in enumerate(("optimum", "greedy")):
        ax.plot([row["instance"] for row in rows], [row[key] for row in rows], "os"[k] + "-", color=COLOURS[2 * k], label=key)
    ax.set_yscale("log")
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "coverage of the worst target")
