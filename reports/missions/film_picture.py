"""One figure of a film whose contents change: a map for each run, and the headline value of all over time."""

import io
import itertools
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.rendering import number
from ..plots.drawing import figure_without_display, open_frame
from .mission import Scene

if TYPE_CHECKING:
    from .animation import Film

FRAMES_A_SECOND = 8

TRAIL = 12
"""Steps that a trail goes back; those in which nothing moves do not count."""

FULL = 140.0
"""Area of the ring around a point with a level, in square points."""

AGENT, MARKED, OPEN, LINK = "#332288", "#117733", "#CC3377", "#33AADD"
"""Distinct for all common kinds of colour vision, after Tol (2021); open points are crosses besides."""

CURVES = ("#117733", "#EE7733", "#332288", "#33AADD")
"""Colours of the runs."""

AGENTS = (AGENT, "#EE7733", "#33AADD", "#AA4499", "#999933", "#882255")
"""Colours of agents that have one each, in turn."""

OWN = "#777777"
"""Colour that stands for these in a legend."""


class Picture:
    """The figure; ``show`` sets it to a step. ``films`` are of equal lengths; one alone has no name on its map."""

    def __init__(self, films: "Mapping[str, Film]") -> None:
        self.films = dict(films)
        shots = ((shot[0], value) for film in self.films.values() for shot, value in zip(film.shots, film.values, strict=True))
        self.counts = all(value == int(scene.marked.sum()) for scene, value in shots)
        """Whether the headline counts the points that are marked; else it has no largest value that a picture could tell."""
        several = len(self.films) > 1
        self.limits = [[math.nan if scene.limit is None else scene.limit for scene, _ in film.shots] for film in self.films.values()]
        count = len(self.films)
        size = (4.6 * count, 6.6) if several else (9.0, 4.8)
        self.figure = figure_without_display(*size, layout=None)  # margins are fixed: a layout found anew jumps
        self.figure.set_dpi(80)
        if several:
            rows = self.figure.add_gridspec(2, count, height_ratios=(2.6, 1.0), left=0.07, right=0.98, top=0.9, bottom=0.14, hspace=0.22)
            worlds, chart = [self.figure.add_subplot(rows[0, k]) for k in range(count)], self.figure.add_subplot(rows[1, :])
        else:
            row = self.figure.add_gridspec(1, 2, width_ratios=(1.25, 1.0), left=0.05, right=0.98, top=0.91, bottom=0.19, wspace=0.18)
            worlds, chart = [self.figure.add_subplot(row[0, 0])], self.figure.add_subplot(row[0, 1])
        self.stages = [
            _Stage(ax, film, name, CURVES[k % len(CURVES)])
            for k, (ax, (name, film)) in enumerate(zip(worlds, self.films.items(), strict=True))
        ]
        self.title = self.figure.suptitle("", fontsize=11, fontweight="bold", color="#222222")
        self._chart(chart)
        handles, labels = worlds[0].get_legend_handles_labels()
        self.figure.legend(handles, labels, loc="lower center", ncols=5, frameon=False, fontsize=8, handletextpad=0.4)
        self.show(0)

    def _chart(self, chart: Any) -> None:
        from matplotlib.ticker import MaxNLocator

        first = next(iter(self.films.values()))
        count, steps = len(first.shots[0][0].points), len(first.shots)
        chart.set_xlim(0, max(steps - 1, 1))
        highest = np.nanmax([1.0, *itertools.chain(*(film.values for film in self.films.values()), *self.limits)])
        chart.set_ylim(0, 1.05 * max(float(count) if self.counts else 0.0, float(highest)))
        if self.counts:
            chart.axhline(count, color="#999999", linewidth=0.8, linestyle=(0, (5, 3)))
            chart.text(0.01 * steps, count, "all", fontsize=8, color="#777777", va="bottom")
        self.past, self.now, self.most = [], [], []
        self.areas: list[Any] = []
        shares = first.shots[0][0].shares
        if len(self.films) == 1 and shares is not None:
            for k in range(len(shares)):
                self.areas += chart.fill([0], [0], color=AGENTS[k % len(AGENTS)], alpha=0.35, linewidth=0, label=f"by robot {k + 1}")
        for k in range(len(self.films)):
            colour = CURVES[k % len(CURVES)]
            self.past += chart.plot([], [], color=colour, linewidth=1.6)
            self.now += chart.plot([], [], "o", color=colour, markersize=5)
            label = "at most" if not k and not np.isnan(self.limits[k]).all() else None
            self.most += chart.plot([], [], color=colour, linewidth=1.0, linestyle=(0, (5, 3)), label=label)
        if chart.get_legend_handles_labels()[0]:
            chart.legend(loc="upper left", fontsize=8, frameon=False)
        chart.set_xlabel("step", fontsize=9)
        chart.set_ylabel(first.mission.headline, fontsize=9)
        for axis in (chart.xaxis, chart.yaxis):
            axis.set_major_locator(MaxNLocator(integer=True))
        chart.tick_params(labelsize=8, colors="#555555")
        open_frame(chart)

    def gif(self, steps: list[int]) -> bytes:
        """The given steps as a GIF file. Pillow takes each picture as it is drawn; matplotlib's own writer would draw it three times."""
        from PIL import Image

        def pictures() -> Iterator[Image.Image]:
            for step in steps:
                self.show(step)
                self.figure.canvas.draw()
                yield Image.fromarray(np.asarray(self.figure.canvas.buffer_rgba())).convert("RGB")

        drawn, buffer = pictures(), io.BytesIO()
        next(drawn).save(buffer, "GIF", save_all=True, append_images=drawn, duration=1000 // FRAMES_A_SECOND, loop=0)
        return buffer.getvalue()

    def show(self, step: int) -> list[Any]:
        """Set all maps, curves and the title to a step, 0 being the start."""
        changed = [artist for stage in self.stages for artist in stage.show(step)]
        for k, film in enumerate(self.films.values()):
            values = film.values
            self.past[k].set_data(range(step + 1), values[: step + 1])
            self.now[k].set_data([step], [values[step]])
            self.most[k].set_data(range(step + 1), self.limits[k][: step + 1])
        film = next(iter(self.films.values()))
        now = " and ".join(_short(film.values[step]) for film in self.films.values())
        of = f" of {len(film.shots[step][0].points)}" if self.counts else ""
        if self.areas:
            shares = np.array([scene.shares for scene, _ in film.shots[: step + 1]])
            sums = np.pad(np.cumsum(shares, axis=1), ((0, 0), (1, 0)))
            for k, area in enumerate(self.areas):
                there = np.column_stack([np.arange(step + 1), sums[:, k + 1]])
                area.set_xy(np.vstack([there, np.column_stack([there[::-1, 0], sums[::-1, k]])]))
        limit = self.limits[0][step]
        if len(self.films) == 1 and limit > 0:
            of = f" of at most {_short(limit)}"
        self.title.set_text(f"{film.mission.name}, step {step}: {film.mission.headline} {now}{of}")
        return [*changed, *self.past, *self.now, *self.most, *self.areas, self.title]


def _short(value: float) -> str:
    """A number of five digits, for a title."""
    return number(float(f"{value:.5g}"))


class _Stage:
    """One map: discs that agents see, agents with headings and trails, points with trails, and links between them."""

    def __init__(self, ax: Any, film: "Film", name: str, colour: str) -> None:
        from matplotlib.collections import EllipseCollection, LineCollection

        self.film = film
        scenes = [scene for scene, _ in film.shots]
        self._moved = [
            False,
            *(not (np.array_equal(a.agents, b.agents) and np.array_equal(a.points, b.points)) for a, b in itertools.pairwise(scenes)),
        ]
        first = film.shots[0][0]
        left, bottom, right, top = first.area
        ax.set_aspect("equal")
        ax.set_xlim(left, right)
        ax.set_ylim(bottom, top)
        ax.tick_params(labelsize=8, colors="#555555")
        if name:
            ax.set_title(name, fontsize=10, fontweight="bold", color=colour)  # that of its curve
        size = np.full(len(first.agents), 2.0 * first.reach)
        self.discs = EllipseCollection(
            size, size, np.zeros(len(size)), units="xy", offsets=first.agents, offset_transform=ax.transData, facecolor=AGENT,
            edgecolor=AGENT, alpha=0.08, linewidth=0.8,
        )  # fmt: skip
        own = first.shares is not None
        self.colours = [AGENTS[k % len(AGENTS)] if own else AGENT for k in range(len(first.agents))]
        self.trails = LineCollection([], colors=AGENT, linewidths=1.3, alpha=0.45, zorder=2)
        self.wakes = LineCollection([], colors="#999999", linewidths=0.8, alpha=0.6, zorder=1.5)
        self.links = LineCollection([], colors=LINK, linewidths=1.0, alpha=0.85, linestyles=(0, (3, 1.5)), zorder=1.8)
        ways = LineCollection([first.points[list(way)] for way in first.ways], colors="#BBBBBB", linewidths=2.5, zorder=1)
        for collection in (self.discs, self.trails, self.wakes, self.links, ways):
            ax.add_collection(collection)
        agent, marked, unmarked = first.labels
        self.agents = ax.scatter(*first.agents.T, marker="s", s=36, c=self.colours, label=agent, clip_on=False, zorder=4)
        self.fills = ax.scatter([], [], s=[], color=MARKED, alpha=0.35, linewidth=0, clip_on=False, zorder=2.5)
        self.rims = ax.scatter([], [], s=FULL, facecolor="none", edgecolor="#999999", linewidth=0.8, clip_on=False, zorder=2.5)
        self.notes = [
            ax.annotate("", at, xytext=(5, 5), textcoords="offset points", fontsize=8, color=colour, zorder=5, clip_on=False)
            for at, colour, _ in zip(first.agents, self.colours, first.notes, strict=False)
        ]
        (self.marked,) = ax.plot([], [], "o", color=MARKED, markersize=5, label=marked, clip_on=False, zorder=3)
        (self.open,) = ax.plot([], [], "x", color=OPEN, markersize=6, markeredgewidth=1.6, label=unmarked, clip_on=False, zorder=3)
        ax.plot([], [], color=OWN if own else AGENT, linewidth=1.3, alpha=0.6, label=f"their last {TRAIL} moves")
        if any(scene.links for scene, _ in film.shots):
            ax.plot([], [], color=OWN if own else LINK, linewidth=1.0, linestyle=(0, (3, 1.5)), label="assigned")
        self.headings: Any = None
        if first.headings is not None:
            self.length = 0.045 * max(right - left, top - bottom)
            at, towards = first.agents, self._towards(first)
            self.headings = ax.quiver(
                at[:, 0], at[:, 1], towards[:, 0], towards[:, 1], color=AGENT, angles="xy", scale_units="xy", scale=1.0, width=0.006,
                headwidth=4.0, headlength=4.0, zorder=4,
            )  # fmt: skip

    def _towards(self, scene: Scene) -> NDArray[np.float64]:
        assert scene.headings is not None
        return self.length * np.stack([np.cos(scene.headings), np.sin(scene.headings)], axis=1)

    def show(self, step: int) -> list[Any]:
        scene = self.film.shots[step][0]
        moves = [k for k in range(1, step + 1) if self._moved[k]]
        past = [self.film.shots[k][0] for k in range(moves[-TRAIL] - 1 if len(moves) >= TRAIL else 0, step + 1)]
        self.discs.set_offsets(scene.agents)
        self.agents.set_offsets(scene.agents)
        for text, note, at in zip(self.notes, scene.notes, scene.agents, strict=False):
            text.set_text(note)
            text.xy = tuple(at)
        if scene.levels is not None:
            self.rims.set_offsets(scene.points)
            self.fills.set_offsets(scene.points)
            self.fills.set_sizes(FULL * scene.levels)
        self.marked.set_data(*scene.points[scene.marked].T)
        self.open.set_data(*scene.points[~scene.marked].T)
        trails = _ways([one.agents for one in past])
        self.trails.set_segments(list(trails.values()))
        self.wakes.set_segments(list(_ways([one.points for one in past]).values()))
        self.links.set_segments([[scene.agents[a], scene.points[p]] for a, p in scene.links])
        if scene.shares is not None:
            self.trails.set_color([self.colours[k] for k in trails])
            self.links.set_color([self.colours[a] for a, _ in scene.links])
        if self.headings is not None:
            self.headings.set_offsets(scene.agents)
            self.headings.set_UVC(*self._towards(scene).T)
        shown = [self.discs, self.agents, self.marked, self.open, self.trails, self.wakes, self.links, self.fills, self.rims, *self.notes]
        return shown if self.headings is None else [*shown, self.headings]


def _ways(places: list[NDArray[np.float64]]) -> dict[int, NDArray[np.float64]]:
    """The way through the last steps of each thing that moved; none of things that come and go."""
    if len(places) < 2 or len({len(at) for at in places}) > 1:
        return {}
    ways = np.stack(places, axis=1)
    moved = np.abs(np.diff(ways, axis=1)).sum(axis=(1, 2)) > 1e-12 * (1.0 + math.fabs(float(np.abs(ways).max(initial=0.0))))
    return {int(k): ways[k] for k in np.flatnonzero(moved)}
