"""Allocation of observations to cells after Mitchell (2020), chapter 4: which cells to look at where travel and occlusion do not count."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.generators import Draw, Floats, Integers
from ....instances.routing.occupancy import RangeSensor, divergence, entropy
from ....instances.routing.occupancy_maps import MarkovMap, cell_worth
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import apart, frame_table, framed, intervals, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, figure, study

if TYPE_CHECKING:
    import pandas as pd

CELLS, STEP = 1073, 10.0
"""Cells, and seconds of a step."""

STEADY = 200
"""Steps at the end of a run that count."""

DEFAULTS: dict[str, Any] = {"objective": "proposed", "looks": 150, "weight": 100.0, "window": 3000.0, "share": 30}

OBJECTIVES = ("random", "information", "misfit", "proposed")

RUNS: dict[str, dict[str, Any]] = {
    **{f"{name}, {looks}": {"objective": name, "looks": looks} for name in OBJECTIVES for looks in (100, 150, 200)},
    **{f"weight {weight:g}, {share} %": {"weight": weight, "share": share} for share in (10, 30, 50) for weight in (10.0, 100.0, 200.0)},
    **{f"window {window:g} s": {"window": window} for window in (1000.0, 5000.0)},
}
"""Tables 4.1, 4.3 and 4.2 with the levels that their claims name."""

MEASURES = ("entropy", "divergence", "response", "unobserved")

PRINTED = {"random, 100": 0.2644, "random, 150": 0.1634, "random, 200": 0.1238}
"""Response of random allocation: the one column of Table 4.1 that depends on nothing that is lost."""

NOTES = (
    "means over the last 2,000 of 10,000 s, then over seeds, with intervals of confidence 95 %; all runs of a seed meet the same cells",
    "response: the longest time since a change that nobody saw, over the period; mean over the cells that change",
    "lost in the source: sensor (ours 0.9, 0.05), rates at the start (0.02 a step), forgetting (0.005), how transitions are counted",
)


def allocated(seed: int, steps: int, objective: str, looks: int, weight: float, window: float, share: int) -> dict[str, float]:
    """A run: in each step the ``looks`` cells of the largest worth are read, which is the best choice of as many, and all are updated.

    ``share`` percent of the cells change, free for half of a period of 300 to 2,000 s, then occupied; of the others half are occupied.
    """
    draw = Draw(np.random.Generator(np.random.PCG64(seed)))
    periods, fixed = draw.uniform(300.0, 2000.0, CELLS), draw.uniform(0.0, 1.0, CELLS) < 0.5
    change = np.arange(CELLS) < round(CELLS * share / 100.0)
    sensor = RangeSensor()
    map_ = MarkovMap(np.full(CELLS, 0.5), sensor, seconds=STEP, window=window)
    truth, since, last, worst = fixed & ~change, np.full(CELLS, np.nan), np.zeros(CELLS), np.zeros(CELLS)
    sums, first = np.zeros(2), steps - min(STEADY, steps // 2)
    for step in range(1, steps + 1):
        clock, (noise, order) = step * STEP, draw.uniform(0.0, 1.0, (2, CELLS))
        now = np.where(change, clock % periods >= periods / 2.0, fixed)
        since[(now != truth) & np.isnan(since)] = clock
        truth = now
        seen = _chosen(map_, objective, weight, looks, order)
        if step > first:
            worst = np.maximum(worst, np.nan_to_num(clock - since) / periods)
        map_.update(seen, noise[seen] < np.where(truth[seen], sensor.hit, sensor.false_hit))
        since[seen], last[seen] = np.nan, step
        if step > first:
            sums += [entropy(map_.p).sum(), divergence(map_.p, truth).sum()]
    bits = sums / (steps - first)
    return {
        "entropy": float(bits[0]), "divergence": float(bits[1]), "response": float(worst[change].mean()),
        "unobserved": float((last <= first).sum()),
    }  # fmt: skip


def _chosen(map_: MarkovMap, objective: str, weight: float, looks: int, order: Floats) -> Integers:
    """Cells of the largest worth, ties by ``order``."""
    if objective == "random":
        worth = np.zeros(CELLS)
    elif objective == "misfit":
        worth = cell_worth(map_, "chi-square", 0.0)
    else:
        worth = cell_worth(map_, "mutual-information", weight if objective == "proposed" else 0.0)
    return np.sort(np.lexsort((order, -worth))[:looks])


def task(seed: int, steps: int, names: Sequence[str]) -> list[dict[str, Any]]:
    """All runs of a seed, in a process that has this function's name alone."""
    return [{"seed": seed, "method": name, **allocated(seed, steps, **{**DEFAULTS, **RUNS[name]})} for name in names]


@study(
    "observation-allocation",
    "allocation of observations to changing cells: random, by information, by misfit, and by both",
    100,
    short=3,
    source="Mitchell (2020), chapter 4, Tables 4.1 to 4.3",
    claim="information and misfit together respond faster, with less entropy and divergence, than random allocation or either alone",
)
def observation_allocation(setting: StudySetting) -> Report:
    steps = 1000 if setting.full else 500
    names = tuple(RUNS) if setting.full else tuple(name for name in RUNS if name.endswith(", 200"))
    tasks = [(seed, steps, names) for seed in setting.seeds]
    done = spread(task, tasks, setting.jobs, setting.told, lambda one: f"seed {one[0]}")
    observed = done.rows
    table = framed(observed)
    rows = [{"run": name, **intervals(table[table["method"] == name], MEASURES)} for name in names]
    return Report(
        "observation-allocation", observation_allocation.summary, frame_table("Means of runs", rows), tuple(rows), tuple(observed),
        figures=(allocation_figure(table, names),), notes=NOTES, findings=tuple(findings(table, names)), **done.progress(),
    )  # fmt: skip


UNTOLD = "the source's sensor and counts are lost"

SURE = "a cell that is told often enough for sure loses its misfit too"

EARLY = "which cells change is learnt early here, and information alone keeps looking at these; those that it abandons do not change"

CLAIMS: tuple[tuple[str, str, str, str, str, int, str], ...] = (
    *((f"Table 4.1, {looks} looks: {key} of both, against random", "less", key, f"proposed, {looks}", f"random, {looks}", -1, UNTOLD)
      for looks in (100, 150, 200) for key in ("entropy", "divergence", "response")),
    *((f"Table 4.1, {looks} looks: cells that information alone abandons", "some", "unobserved", f"information, {looks}",
       f"proposed, {looks}", 1, UNTOLD) for looks in (100, 150, 200)),
    *((f"Table 4.1, {looks} looks: entropy of both, against misfit alone", "less, but at 100", "entropy", f"proposed, {looks}",
       f"misfit, {looks}", -1, UNTOLD) for looks in (100, 150, 200)),
    *((f"Table 4.1, {looks} looks: {key} of both, against information alone", "less", key, f"proposed, {looks}", f"information, {looks}",
       -1, EARLY) for looks in (100, 150, 200) for key in ("entropy", "divergence", "response")),
    ("Table 4.3, 10 % change: response with weight 10, against 200", "less", "response", "weight 10, 10 %", "weight 200, 10 %", -1, SURE),
    ("Table 4.3, 50 % change: response with weight 200, against 10", "less", "response", "weight 200, 50 %", "weight 10, 50 %", -1,
     "as with information alone, few cells are abandoned that change"),
    ("Table 4.3, 50 % change: cells unobserved with weight 10, against 200", "more", "unobserved", "weight 10, 50 %", "weight 200, 50 %", 1,
     UNTOLD),
)  # fmt: skip


def findings(table: "pd.DataFrame", names: Sequence[str]) -> list[Finding]:
    """Claims by pairs of the same seeds, and the printed responses of random allocation."""
    found = [Finding("Table 4.1: entropy and divergence", "130 to 690 bits", "see the table", LOST, UNTOLD)]
    for name, printed in PRINTED.items() if "random, 100" in names else ():
        lead, half = mean_interval(table[table["method"] == name]["response"] / printed - 1.0)
        found.append(Finding.of_near(f"Table 4.1: response, {name} looks", f"{printed:g}", lead, half, 0.12, "one run of the source"))
    for what, claim, key, method, other, sign, why in CLAIMS:
        if method in names and other in names:
            lead, half = apart(table, key, method, other)
            found.append(Finding.of_lead(f"{what}, {'above' if sign > 0 else 'below'} by", claim, sign * lead, half, "", why))
    for window in ("window 1000 s", "window 5000 s") if "window 1000 s" in names else ():
        pairs = table.pivot_table(index="seed", columns="method", values="entropy")
        lead, half = mean_interval(pairs[window] / pairs["proposed, 150"] - 1.0)
        found.append(Finding.of_near(f"Table 4.2: entropy, {window} against 3000 s", "hardly matters", lead, half, 0.05, UNTOLD))
    return found


@figure("observation-allocation", 11.0, 3.6)
def allocation_figure(figure: Any, table: "pd.DataFrame", names: Sequence[str]) -> None:
    """Measures of the four objectives by the number of looks, with intervals."""
    for ax, key in zip(figure.subplots(1, len(MEASURES)), MEASURES, strict=True):
        for colour, objective in zip(COLOURS, OBJECTIVES, strict=False):
            levels = [looks for looks in (100, 150, 200) if f"{objective}, {looks}" in names]
            shown = [mean_interval(table[table["method"] == f"{objective}, {looks}"][key]) for looks in levels]
            ax.errorbar(levels, [m for m, _ in shown], [h for _, h in shown], color=colour, marker="o", markersize=3, label=objective)
        ax.set_xlabel("looks a step", fontsize=9)
        plain(ax, key)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
