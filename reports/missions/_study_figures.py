"""Figures of studies: made without a display, plain axes, saved whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...instances.atomic import atomic_write
from ..plots.drawing import figure_without_display, open_frame, png_of


def _figure(width: float, height: float) -> Any:
    return figure_without_display(width, height)


def _plain(ax: Any, title: str) -> None:
    ax.set_title(title, loc="left", fontsize=10, color="#222222")
    ax.tick_params(labelsize=8, colors="#555555")
    open_frame(ax)


def _band(ax: Any, x: Any, mean: Any, half: Any, alpha: float = 0.25, **line: Any) -> None:
    """A line of means, and their intervals as a band."""
    ax.plot(x, mean, linewidth=1.6, **line)
    ax.fill_between(x, mean - half, mean + half, color=line["color"], alpha=alpha, linewidth=0)


def _save(figure: Any, path: Path) -> None:
    atomic_write(path, png_of(figure, 140))
