"""Moving pictures of missions: GIF files, or HTML pages with buttons."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ...formulations.rendering import number
from ...instances.atomic import atomic_write
from ...instances.errors import UsageError
from ...instances.worlds import World
from .mission import Mission, Scene

MOST_FRAMES = 400
"""Of longer runs every second, third, ... step is shown, so that a film keeps a size that can be sent."""

FRAMES_A_SECOND = 8

AGENT, MARKED, OPEN = "#332288", "#117733", "#CC3377"
"""Distinct for all common kinds of colour vision, after Tol (2021); open points are crosses besides."""


class Film:
    """Collects pictures while a mission is played: ``run(mission, watch=film)``.

    Parameters
    ----------
    mission : Mission
        One that can be drawn.

    Raises
    ------
    UsageError
        If it cannot.
    """

    def __init__(self, mission: Mission) -> None:
        if not mission.drawable:
            raise UsageError(f"mission {mission.name} has no pictures")
        self.mission = mission
        self.shots: list[tuple[Scene, float]] = []

    def __call__(self, world: World, row: dict[str, Any]) -> None:
        scene = self.mission.scene(world)
        assert scene is not None
        self.shots.append((scene, float((row or world.metrics())[self.mission.headline])))

    @property
    def values(self) -> list[float]:
        """The headline metric at the start and after each step."""
        return [value for _, value in self.shots]

    def frames(self) -> list[int]:
        """Steps that are shown, the last one always."""
        every = math.ceil(len(self.shots) / MOST_FRAMES)
        last = len(self.shots) - 1
        return [*range(0, last, every), last]

    def save(self, path: str | PathLike[str]) -> None:
        """Write a ``.gif`` or ``.html`` file, whole or not at all; needs no display.

        Raises
        ------
        UsageError
            For another suffix, or if nothing was played.
        InputError
            If the file cannot be written.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in (".gif", ".html"):
            raise UsageError(f"{path}: an animation is written as .gif or .html")
        if not self.shots:
            raise UsageError("nothing was played, so there is nothing to show")
        picture = _Picture(self)
        if suffix == ".gif":
            atomic_write(path, picture.gif(self.frames()))
            return
        from matplotlib import rc_context
        from matplotlib.animation import FuncAnimation

        made = FuncAnimation(picture.figure, picture.show, frames=self.frames(), interval=1000 / FRAMES_A_SECOND, blit=False)
        with rc_context({"animation.embed_limit": 1000.0}):  # MB; frames beyond it would be left out
            atomic_write(path, made.to_jshtml(fps=FRAMES_A_SECOND, default_mode="once"))

    def save_frame(self, step: int, path: str | PathLike[str]) -> None:
        """Write the picture of one step (0 is the start) as a PNG file."""
        picture, buffer = _Picture(self), io.BytesIO()
        picture.show(step)
        picture.figure.savefig(buffer, format="png", dpi=100)
        atomic_write(path, buffer.getvalue())


class _Picture:
    """One figure whose contents change: the area to the left, the headline value over time to the right."""

    def __init__(self, film: Film) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import EllipseCollection
        from matplotlib.figure import Figure
        from matplotlib.ticker import MaxNLocator

        self.film, self.values = film, film.values
        first = film.shots[0][0]
        left, bottom, right, top = first.area
        self.figure = Figure(figsize=(9.0, 4.8), layout="constrained")
        self.canvas = FigureCanvasAgg(self.figure)
        self.figure.set_dpi(80)
        world, chart = self.figure.subplots(1, 2, width_ratios=(1.25, 1.0))
        world.set_aspect("equal")
        world.set_xlim(left, right)
        world.set_ylim(bottom, top)
        world.tick_params(labelsize=8, colors="#555555")
        size = np.full(len(first.agents), 2.0 * first.reach)
        self.discs = EllipseCollection(
            size, size, np.zeros(len(size)), units="xy", offsets=first.agents, offset_transform=world.transData, facecolor=AGENT,
            edgecolor=AGENT, alpha=0.10, linewidth=0.8,
        )  # fmt: skip
        world.add_collection(self.discs)
        agent, marked, unmarked = first.labels
        (self.agents,) = world.plot([], [], "s", color=AGENT, markersize=6, label=agent, clip_on=False)
        (self.marked,) = world.plot([], [], "o", color=MARKED, markersize=5, label=marked, clip_on=False)
        (self.open,) = world.plot([], [], "x", color=OPEN, markersize=6, markeredgewidth=1.6, label=unmarked, clip_on=False)
        world.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, fontsize=8, handletextpad=0.3)
        self.title = self.figure.suptitle("", fontsize=11, fontweight="bold", color="#222222")
        chart.set_xlim(0, max(len(film.shots) - 1, 1))
        chart.set_ylim(0, 1.05 * max(float(len(first.points)), *self.values, 1.0))
        chart.axhline(len(first.points), color="#999999", linewidth=0.8, linestyle=(0, (5, 3)))
        chart.text(0.01 * len(film.shots), len(first.points), "all", fontsize=8, color="#777777", va="bottom")
        (self.past,) = chart.plot([], [], color=MARKED, linewidth=1.6)
        (self.now,) = chart.plot([], [], "o", color=MARKED, markersize=5)
        chart.set_xlabel("step", fontsize=9)
        chart.set_ylabel(film.mission.headline, fontsize=9)
        chart.yaxis.set_major_locator(MaxNLocator(integer=True))
        chart.tick_params(labelsize=8, colors="#555555")
        for side in ("top", "right"):
            chart.spines[side].set_visible(False)
        self.show(0)
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")  # the layout of the first frame holds; finding it anew takes most of a frame's time

    def gif(self, steps: list[int]) -> bytes:
        """Pictures of these steps as a GIF file. Pillow, which matplotlib needs anyway, takes them as they are drawn: its writer
        within matplotlib would draw each three times."""
        from PIL import Image

        def pictures() -> Iterator[Image.Image]:
            for step in steps:
                self.show(step)
                self.canvas.draw()
                yield Image.fromarray(np.asarray(self.canvas.buffer_rgba())).convert("RGB")

        drawn, buffer = pictures(), io.BytesIO()
        next(drawn).save(buffer, "GIF", save_all=True, append_images=drawn, duration=1000 // FRAMES_A_SECOND, loop=0)
        return buffer.getvalue()

    def show(self, step: int) -> list[Any]:
        mission, values, scene = self.film.mission, self.values, self.film.shots[step][0]
        self.discs.set_offsets(scene.agents)
        self.agents.set_data(*scene.agents.T)
        self.marked.set_data(*scene.points[scene.marked].T)
        self.open.set_data(*scene.points[~scene.marked].T)
        self.past.set_data(range(step + 1), values[: step + 1])
        self.now.set_data([step], [values[step]])
        self.title.set_text(f"{mission.name}, step {step}: {mission.headline} {number(values[step])} of {len(scene.points)}")
        return [self.discs, self.agents, self.marked, self.open, self.past, self.now, self.title]
