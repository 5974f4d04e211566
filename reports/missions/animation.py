"""Moving pictures of missions: GIF files, or HTML pages with buttons."""

import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ...instances.atomic import atomic_write
from ...instances.errors import UsageError
from ...instances.worlds import World
from ..plots.drawing import png_of
from .film_picture import FRAMES_A_SECOND, Picture
from .mission import Mission, Scene

MOST_FRAMES = 400
"""Frames of a film; of longer runs every second, third, ... step is shown."""


class Film:
    """Collects pictures while a mission is played: ``run(mission, watch=film)``. Raises UsageError if the mission cannot be drawn."""

    def __init__(self, mission: Mission) -> None:
        if not mission.drawable:
            raise UsageError(f"mission {mission.name} has no pictures", "unsupported")
        self.mission = mission
        self.shots: list[tuple[Scene, float]] = []
        self.over = False

    def __call__(self, world: World, row: dict[str, Any]) -> None:
        scene = self.mission.scene(world)
        assert scene is not None
        self.shots.append((scene, float((row or world.metrics())[self.mission.headline])))
        self.over = world.over

    @property
    def values(self) -> list[float]:
        """The headline metric at the start and after each step."""
        return [value for _, value in self.shots]

    def held(self, count: int) -> "Film":
        """The same film with its last picture repeated until there are ``count``."""
        longer = Film(self.mission)
        longer.shots = self.shots + self.shots[-1:] * (count - len(self.shots))
        return longer

    def frames(self) -> list[int]:
        """Steps that are shown, the last one always among them."""
        every = math.ceil(len(self.shots) / MOST_FRAMES)
        last = len(self.shots) - 1
        return [*range(0, last, every), last]

    def pictures(self, most: int = MOST_FRAMES) -> list[bytes]:
        """At most ``most`` pictures as PNG files, evenly over the steps, the last one always among them."""
        picture, steps = Picture({"": self}), self.frames()
        shown = []
        for k in np.unique(np.linspace(0, len(steps) - 1, min(most, len(steps))).round().astype(int)):
            picture.show(steps[k])
            shown.append(png_of(picture.figure, 80))
        return shown

    def save(self, path: str | PathLike[str]) -> None:
        """Write a ``.gif`` or ``.html`` file, whole or not at all; needs no display."""
        save_side_by_side({"": self}, path)

    def save_frame(self, step: int, path: str | PathLike[str]) -> None:
        """Write the picture of one step (0 is the start) as a PNG file."""
        picture = Picture({"": self})
        picture.show(step)
        atomic_write(path, png_of(picture.figure, 100))


def save_side_by_side(films: Mapping[str, Film], path: str | PathLike[str]) -> None:
    """Write films of the same mission beside each other as .gif or .html: a map for each, and all curves in one chart.

    The worlds are of equal size and the films of equal length; of a world that is over before the others the last picture stays.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".gif", ".html"):
        raise UsageError(f"{path}: an animation is written as .gif or .html", "unsupported")
    lengths = {len(film.shots) for film in films.values()}
    if lengths <= {0}:
        raise UsageError("nothing was played, so there is nothing to show", "missing")
    longest = max(lengths)
    if any(len(film.shots) < longest and not film.over for film in films.values()):
        raise UsageError(
            f"films side by side must be of one length, not of {' and '.join(map(str, sorted(lengths)))} pictures", "wrong-shape"
        )
    held = {name: film.held(longest) for name, film in films.items()}
    picture, steps = Picture(held), next(iter(held.values())).frames()
    if suffix == ".gif":
        atomic_write(path, picture.gif(steps))
        return
    from matplotlib import rc_context
    from matplotlib.animation import FuncAnimation

    animation = FuncAnimation(picture.figure, picture.show, frames=steps, interval=1000 / FRAMES_A_SECOND, blit=False)
    with rc_context({"animation.embed_limit": 1000.0}):  # MB; frames beyond it would be left out
        atomic_write(path, animation.to_jshtml(fps=FRAMES_A_SECOND, default_mode="once"))
