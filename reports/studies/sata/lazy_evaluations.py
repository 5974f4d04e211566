"""Evaluations of lazy greedy beside plain greedy on coverage, after Mitchell (2020), section 5.3 and Algorithm 5."""

from typing import Any

import numpy as np

from ....formulations.sata.submodular_selection import SubmodularSelection
from ....instances.sata.constraints import Cardinality
from ....instances.sata.set_functions import Coverage
from ...plots.drawing import COLOURS, plain
from ...ratios.judged_runs import run_heuristic
from ..findings import Finding
from ..frames import HALF, frame_table, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, broken, figure, study

SIZES, PICKS, ITEMS, SEEN = (50, 100, 200, 400), 12, 300, 20
"""Candidate views, views taken, cells of the map, and cells that a view sees."""


def views(seed: int, count: int) -> list[dict[str, Any]]:
    """Views of a random map, each of neighbouring cells with random worths: what both versions take and evaluate."""
    rng = np.random.default_rng([seed, count])
    starts = rng.integers(0, ITEMS - SEEN, count)
    problem = SubmodularSelection(
        Coverage.from_sets([np.arange(s, s + SEEN) for s in starts], rng.uniform(1.0, 5.0, ITEMS)), Cardinality(PICKS)
    )
    plain_run, lazy = (run_heuristic(problem, "greedy", {"evaluation": how}, seed) for how in ("plain", "lazy"))
    counts = {"plain": plain_run.statistics["evaluations"], "lazy": lazy.statistics["evaluations"]}
    return [{"candidates": count, "seed": seed, **counts, "same": plain_run.answer == lazy.answer}]


@study(
    "lazy-evaluations",
    "gains that lazy greedy evaluates beside those of plain greedy, on views of a map",
    40,
    short=4,
    source="Mitchell (2020), section 5.3, Algorithm 5",
    claim="lazy greedy takes the same waypoints with far fewer evaluations",
)
def lazy_evaluations(setting: StudySetting) -> Report:
    tasks = [(seed, count) for seed in setting.seeds for count in SIZES]
    done = spread(views, tasks, setting.jobs, setting.told, lambda task: f"map {task[0]}, {task[1]} views")
    rows = []
    for count in sorted({row["candidates"] for row in done.rows}):
        own = [row for row in done.rows if row["candidates"] == count]
        row: dict[str, Any] = {"candidates": count, "maps": len(own), "plain": own[0]["plain"]}
        row["lazy"], row[f"lazy{HALF}"] = mean_interval([float(o["lazy"]) for o in own])
        rows.append(row | {"share": row["lazy"] / row["plain"], "same": sum(o["same"] for o in own)})
    alike = sum(row["same"] for row in done.rows)
    same = Finding.of_fact("waypoints taken", "the same", f"on {alike} of {len(done.rows)} maps", alike == len(done.rows), exact=True)
    most = max(row["share"] for row in rows)
    findings = (same, Finding.of_fact("evaluations", "far fewer", f"{most:.0%} of plain greedy's at most", most < 0.5))
    return Report(
        "lazy-evaluations", lazy_evaluations.summary, frame_table(f"Evaluations for {PICKS} views", rows), tuple(rows), tuple(done.rows),
        figures=(_figure(rows),), findings=findings, **broken([same]),
        notes=(
            "Algorithm 5 as printed never resets its best gain and does not end; with coverage or mutual information lazy and plain agree,",
            "with the Cauchy-Schwarz information of the source, which is not submodular, they need not",
        ),
        **done.progress(),
    )  # fmt: skip


@figure("lazy-evaluations", 6.5, 3.2)
def _figure(figure: Any, rows: list[dict[str, Any]]) -> None:
    """Evaluations of both over the number of candidates."""
    ax = figure.subplots()
    for k, key in enumerate(("plain", "lazy")):
        ax.plot([row["candidates"] for row in rows], [row[key] for row in rows], "o-", color=COLOURS[k], label=key)
    ax.set_xlabel("candidate views", fontsize=9)
    ax.set_yscale("log")
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "evaluations")
