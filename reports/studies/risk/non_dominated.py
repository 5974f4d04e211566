"""Sets of non-dominated paths on random roadmaps: how many there are, and how long searches take, after Skeele (2016), section 5.5.1."""

import time
from typing import Any

import numpy as np

from ....heuristics.risk._graph_policies import LeastMean
from ....instances.generating import generate
from ....instances.risk.uncertain_graph import UncertainGraph
from ....solvers.engines.risk.non_dominated_paths import non_dominated_paths
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, frame_table, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, figure, study

VARIANCES = (5.0, 10.0, 20.0)

PATHS = 69
"""Section 5.5.1: paths in the set, on average."""


def searches(seed: int, variance: float) -> list[dict[str, Any]]:
    """The set of one graph, and the seconds of its search and of that of the least mean."""
    graph = generate("prm-graph", seed, variance=variance)
    assert isinstance(graph, UncertainGraph)
    began = time.process_time()
    paths = non_dominated_paths(graph)
    swept = time.process_time()
    LeastMean(graph)
    ended = time.process_time()
    edges = float(np.mean([len(path) - 1 for path in paths.paths]))
    row: dict[str, Any] = {"variance": variance, "seed": seed, "paths": len(paths.paths), "edges": edges, "labels": paths.labels}
    return [row | {"sweep_seconds": swept - began, "mean_seconds": ended - swept}]


@study(
    "non-dominated-paths",
    "how many paths no other one dominates, and how long it takes to find and to follow them",
    100,
    short=3,
    source="Skeele (2016), section 5.5.1 and Table 5.3",
    claim="69 paths on average, found 0.13 s after the path of A*",
)
def non_dominated(setting: StudySetting) -> Report:
    """See ``Study.run``; seconds differ from run to run, so that they are in no row."""
    levels = VARIANCES if setting.full else VARIANCES[-1:]
    tasks = [(seed, variance) for seed in setting.seeds for variance in levels]
    done = spread(searches, tasks, setting.jobs, setting.told, lambda task: f"graph {task[0]}, variances to {task[1]:g}")
    rows = []
    for variance in levels:
        own = [row for row in done.rows if row["variance"] == variance]
        row: dict[str, Any] = {"variance": variance, "graphs": len(own)}
        for key in ("paths", "edges", "labels"):
            row[key], row[key + HALF] = mean_interval([float(one[key]) for one in own])
        rows.append(row | {"fewest": min(one["paths"] for one in own), "most": max(one["paths"] for one in own)})
    every = [float(row["paths"]) for row in done.rows]
    mean, half = mean_interval(every)
    late = [1e3 * (row["sweep_seconds"] - row["mean_seconds"]) for row in done.rows]
    findings = [
        Finding.of_near("paths of a set, against 69", "69", mean / PATHS - 1.0, half / PATHS, 0.05,
                        f"a correct set has {mean:.0f}; a queue ordered by dominance itself, which is no order, keeps dominated paths"),
        Finding.of_lead("seconds of the sweep above A*'s", "0.13 s longer", *mean_interval(late), "ms"),
        Finding("seconds of Table 5.3: RAGS, A*, greedy, D*", "2.06, 0.42, 0.81, 1.51 to 2.92, 0.36, 0.70, 1.48", "-", LOST,
                "another machine and implementation; whole walks last milliseconds here"),
    ]  # fmt: skip
    timed = [{key: value for key, value in row.items() if not key.endswith("_seconds")} for row in done.rows]
    return Report(
        "non-dominated-paths", non_dominated.summary, frame_table("Non-dominated paths of random roadmaps, means of graphs", rows),
        tuple(rows), tuple(timed), figures=(_figure(every),), findings=tuple(findings),
        **done.progress(),
    )  # fmt: skip


@figure("non-dominated-paths", 7.0, 3.2)
def _figure(figure: Any, counts: list[float]) -> None:
    """How many graphs have how many paths."""
    ax = figure.subplots()
    ax.hist(counts, bins=np.arange(0.0, max(*counts, PATHS) + 4.0, 2.0), color=COLOURS[0])
    ax.axvline(PATHS, color=COLOURS[3], linewidth=1.2)
    ax.annotate("printed mean", (PATHS, 0.9), xycoords=("data", "axes fraction"), xytext=(-4, 0), textcoords="offset points",
                fontsize=8.5, color=COLOURS[3], ha="right")  # fmt: skip
    ax.set_xlabel("non-dominated paths", fontsize=9)
    plain(ax, "graphs")
