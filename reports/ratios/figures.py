"""Figures of the studies: observed ratios beside stated ones, and values of experiments along a parameter."""

import math
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..plots.drawing import COLOURS, open_frame
from ..studies.study import Figure

SHOWN_POINTS = 600
"""Points of a row of a strip plot; more would be one blot."""

PANELS_ACROSS = 5

TITLE_LETTERS = 9.5
"""Letters of a title that fit into an inch."""

STATED = "#CC3377"
INK = "#222222"
QUIET = "#555555"

MARKERS = ("o", "s", "^", "D", "v", "P", "X")


def ratio_figure(name: str, summary: str, rows: Sequence[dict[str, Any]], observations: Sequence[dict[str, Any]]) -> Figure:
    """One panel a configuration, one line a family: every observed ratio, their mean, and the stated ratio.

    Where the stated ratio differs between instances, the share of the stated loss, (ratio - 1) / (stated - 1), stands in its place; it is
    at most 1 unless the guarantee is broken.
    """
    labels = list(dict.fromkeys(row["heuristic"] for row in rows))
    families = list(dict.fromkeys(row["family"] for row in rows))
    varies = any(row["stated_min"] is not None and row["stated_max"] > row["stated_min"] * (1 + 1e-9) for row in rows)
    values: dict[tuple[str, str], list[float]] = {}
    for one in observations:
        value = one["ratio"] if not varies else _used(one["ratio"], one["stated"])
        if value is not None:
            values.setdefault((one["heuristic"], one["family"]), []).append(value)
    across = min(len(labels), PANELS_ACROSS)
    down = math.ceil(len(labels) / across)
    size = (7.5 if across == 1 else 2.4 + 2.5 * across, 1.2 + (0.7 + 0.3 * len(families)) * down)

    def draw(figure: Any) -> None:
        grid = np.atleast_1d(figure.subplots(down, across, sharey=True, sharex=varies)).ravel()
        for spare in grid[len(labels) :]:
            spare.set_axis_off()
        for panel, label in zip(grid, labels, strict=False):
            own = {row["family"]: row for row in rows if row["heuristic"] == label}
            for place, family in enumerate(families):
                if (label, family) in values:
                    stated = 1.0 if varies else own[family]["stated_min"]
                    _strip(panel, place, np.array(values[label, family]), stated)
            panel.set_title(label, fontsize=9.5, color=INK)
            panel.set_yticks(range(len(families)), families, fontsize=8.5)
            panel.set_ylim(len(families) - 0.4, -0.6)
            panel.axvline(0.0 if varies else 1.0, color=QUIET, linewidth=0.6, zorder=0)
            _plain(panel)
        repeats = sorted({row["repeats"] for row in rows})
        kind = "ratio OPT/ALG" if not varies else "share of the stated loss, (OPT/ALG - 1) / (stated - 1)"
        if repeats != [1]:
            kind += f", ALG a mean of {' or '.join(str(r) for r in repeats)} runs"
        below = grid[min(len(labels) - 1, across * (down - 1) + (across - 1) // 2)]
        below.set_xlabel(kind, fontsize=9)
        _entitle(figure, f"{name}: {summary}")
        handles, texts = grid[0].get_legend_handles_labels()
        unique = dict(zip(texts, handles, strict=True))
        figure.legend(unique.values(), unique.keys(), loc="outside lower right", ncols=len(unique), fontsize=8, frameon=False)

    return Figure(name, draw, size)


def _used(ratio: float, stated: float | None) -> float | None:
    return None if stated is None or stated <= 1.0 else (ratio - 1.0) / (stated - 1.0)


def _strip(panel: Any, place: int, values: Any, stated: float | None) -> None:
    finite = values[np.isfinite(values)]
    shown = finite if len(finite) <= SHOWN_POINTS else np.append(finite[:: math.ceil(len(finite) / SHOWN_POINTS)], finite.max())
    # Not random: the same study gives the same figure.
    spread = 0.5 * ((np.arange(len(shown)) * 0.618033988749895) % 1.0) - 0.25
    panel.scatter(shown, place + spread, s=8, color=COLOURS[0], alpha=0.4, linewidths=0, zorder=2, label="observed")
    if len(finite):
        panel.plot(
            finite.mean(), place, marker="D", markersize=4.5, color=COLOURS[1], markeredgecolor=INK, markeredgewidth=0.5, linestyle="",
            zorder=4, label="mean",
        )  # fmt: skip
    if stated is not None:
        panel.plot([stated, stated], [place - 0.34, place + 0.34], color=STATED, linewidth=1.8, zorder=3, label="stated")


def sweep_figure(
    name: str, title: str, panels: Sequence[tuple[str, str, Sequence[str], Sequence[dict[str, Any]]]], quantity: str
) -> Figure:
    """One panel a parameter that is varied: the mean of each method with its range from least to most.

    ``panels`` are (axis label, title, methods, rows); rows have ``x``, ``method``, ``min``, ``mean`` and ``max``. ``quantity`` labels the
    vertical axis.
    """

    def draw(figure: Any) -> None:
        axes = np.atleast_1d(figure.subplots(1, len(panels)))
        shared = all(methods == panels[0][2] for _, _, methods, _ in panels)
        for panel, (axis, head, methods, rows) in zip(axes, panels, strict=True):
            places = sorted({row["x"] for row in rows})
            step = min(np.diff(places), default=1.0)
            for k, method in enumerate(methods):
                own = {row["x"]: row for row in rows if row["method"] == method}
                if not own:
                    continue
                x = [at for at in places if at in own]
                mean = np.array([own[at]["mean"] for at in x])
                reach = np.array([[m - own[at]["min"] for at, m in zip(x, mean, strict=True)],
                                  [own[at]["max"] - m for at, m in zip(x, mean, strict=True)]])  # fmt: skip
                shift = 0.3 * step * (k - (len(methods) - 1) / 2) / len(methods)  # ranges beside each other, not over each other
                panel.errorbar(
                    np.array(x) + shift, mean, yerr=np.maximum(reach, 0.0), color=COLOURS[k % len(COLOURS)],
                    marker=MARKERS[k % len(MARKERS)], markersize=4.5, linewidth=1.4, elinewidth=0.9, capsize=2, label=method,
                )  # fmt: skip
            panel.set_xticks(places)
            panel.set_xlabel(axis, fontsize=9)
            panel.set_title(head, fontsize=9.5, color=INK)
            if not shared:
                panel.legend(loc="upper left", fontsize=8, frameon=False)
            _plain(panel)
        axes[0].set_ylabel(quantity, fontsize=9)
        _entitle(figure, title)
        if shared:
            handles, texts = axes[0].get_legend_handles_labels()
            figure.legend(handles, texts, loc="outside lower center", ncols=min(6, len(texts)), fontsize=8.5, frameon=False)

    return Figure(name, draw, (2.0 + 3.4 * len(panels) if len(panels) > 1 else 7.5, 4.6))


def _entitle(figure: Any, title: str) -> None:
    lines = textwrap.wrap(title, int(TITLE_LETTERS * figure.get_figwidth()))
    figure.suptitle("\n".join(lines), fontsize=11, fontweight="bold", x=0.01, ha="left", color=INK)


def _plain(panel: Any) -> None:
    panel.grid(axis="both", color="#dddddd", linewidth=0.5, zorder=0)
    panel.set_axisbelow(True)
    panel.tick_params(labelsize=8.5)
    open_frame(panel)
