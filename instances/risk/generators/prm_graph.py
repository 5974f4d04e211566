"""Random roadmaps of uncertain edge costs: vertices in a square, joined where they are near, and over synthetic aerial images.

Vertices within the radius of PRM* (Karaman and Frazzoli 2011), in the plane sqrt(6 / pi x area x ln(n) / n), are joined in both
directions. The start lies in one corner of the square, the goal in the opposite one. Graphs in which no path joins them are drawn again.

Source: Skeele (2016), sections 5.5.1 and 5.6; read as in docs/formulations/uncertain-path.md#random-graphs.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...generators import GENERATORS, Draw, Floats, Generator, Integers, Setting
from ..uncertain_graph import UncertainGraph

ATTEMPTS = 100

COMMON = {
    "vertices": Setting(100, "number of vertices, start and goal included", least=2, most=10_000),
    "size": Setting(100.0, "side of the square", least=1e-3, most=1e6),
    "directed": Setting(True, "whether the two directions of an edge cost something different"),
    "name": Setting(None, "name of the instance", type=str),
}

PRM = {
    **COMMON,
    "detour": Setting(100.0, "largest addition to an edge's length in its mean", least=0.0, most=1e9),
    "variance": Setting(20.0, "largest variance of an edge's cost", least=0.0, most=1e9),
}

SCENES = ("empty", "cluster", "small-cluster", "trees")

RASTER = {
    **COMMON,
    "vertices": Setting(150, "number of vertices, start and goal included", least=2, most=10_000),
    "scene": Setting("trees", "what the image shows: an empty field, a large or small cluster of trees, or trees all over", choices=SCENES),
    "pixels": Setting(128, "of a side of the image", least=8, most=2048),
    "blur": Setting(2, "pixels by which the image is blurred", least=0, most=100),
    "spread": Setting(1.0, "variance of an edge's cost in parts of the variance of its pixels", least=0.0, most=1e6),
}


def make_prm(draw: Draw, settings: Mapping[str, Any]) -> UncertainGraph:
    """A roadmap with random costs: the mean is the length and a uniform addition, the variance is uniform."""

    def costs(points: Floats, tails: Integers, heads: Integers, length: Floats) -> tuple[Floats, Floats]:
        return length + draw.uniform(0.0, settings["detour"], len(length)), draw.uniform(0.0, settings["variance"], len(length))

    name = settings["name"] or f"prm-n{settings['vertices']}-v{settings['variance']:g}-s{settings['seed']}"
    return _connected(draw, settings, name, costs)


def make_raster(draw: Draw, settings: Mapping[str, Any]) -> UncertainGraph:
    """A roadmap over an image: to the length comes the mean intensity of the pixels that an edge crosses, whose variance is the cost's."""
    image = raster(draw, settings["scene"], settings["pixels"], settings["blur"])

    def costs(points: Floats, tails: Integers, heads: Integers, length: Floats) -> tuple[Floats, Floats]:
        mean, variance = intensities(image, points[tails] / settings["size"], points[heads] / settings["size"])
        return length + mean, settings["spread"] * variance

    name = settings["name"] or f"raster-{settings['scene']}-n{settings['vertices']}-s{settings['seed']}"
    return _connected(draw, settings, name, costs)


def _connected(
    draw: Draw, settings: Mapping[str, Any], name: str, costs: Callable[[Floats, Integers, Integers, Floats], tuple[Floats, Floats]]
) -> UncertainGraph:
    """The first of some random roadmaps in which a path leads from start to goal."""
    n, size = settings["vertices"], settings["size"]
    for _ in range(ATTEMPTS):
        points = np.vstack([np.zeros((1, 2)), draw.uniform(0.0, size, (n - 2, 2)), np.full((1, 2), size)])
        tails, heads = near_pairs(points, math.sqrt(6.0 / math.pi * size * size * math.log(n) / n))
        length = np.sqrt(((points[tails] - points[heads]) ** 2).sum(axis=1))
        mean, variance = costs(points, tails, heads, length)
        both = [np.concatenate(pair) for pair in ((tails, heads), (heads, tails))]
        if settings["directed"]:
            back = costs(points, heads, tails, length)
            mean, variance = np.concatenate([mean, back[0]]), np.concatenate([variance, back[1]])
            shared = None
        else:
            mean, variance, shared = np.tile(mean, 2), np.tile(variance, 2), np.tile(np.arange(len(tails), dtype=np.int32), 2)
        try:
            return UncertainGraph(
                n, both[0], both[1], mean, variance, 0, n - 1, least=np.tile(length, 2), variable=shared, positions=points,  # type: ignore[arg-type]
                name=name, format="generated",
            )  # fmt: skip
        except InputError:  # no path
            continue
    raise UsageError(f"none of {ATTEMPTS} random graphs of {n} vertices has a path from corner to corner; ask for more vertices")


def near_pairs(points: Floats, radius: float) -> tuple[Integers, Integers]:
    """Pairs of points, the lower number first, that lie at most ``radius`` apart."""
    a, b = [], []
    for k in range(len(points) - 1):
        near = np.nonzero(((points[k + 1 :] - points[k]) ** 2).sum(axis=1) <= radius * radius)[0] + k + 1
        a.append(np.full(len(near), k, dtype=np.int64))
        b.append(near)
    return np.concatenate(a), np.concatenate(b)


# -- synthetic images ---------------------------------------------------------------------------------------------------


def raster(draw: Draw, scene: str, pixels: int, blur: int) -> Floats:
    """A grey image, 0 to 255, of shape (pixels, pixels): crowns of trees, brighter where an obstacle is likelier.

    A stand-in for aerial images after greyscale, blur and contrast; the first index is y, from the start's corner.
    """
    count, radius = {"empty": (0, 0.0), "small-cluster": (12, 0.08), "cluster": (60, 0.22), "trees": (60, 0.0)}[scene]
    if radius:
        angle, away = draw.uniform(0.0, 2.0 * math.pi, count), radius * np.sqrt(draw.uniform(0.0, 1.0, count))
        centres = 0.5 + away[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    else:
        centres = draw.uniform(0.0, 1.0, (count, 2))
    sizes, shades = draw.uniform(0.015, 0.05, count), draw.uniform(120.0, 255.0, count)
    at = (np.arange(pixels) + 0.5) / pixels
    image = draw.uniform(0.0, 30.0, (pixels, pixels))  # grass
    for (x, y), size, shade in zip(centres, sizes, shades, strict=True):
        crown = (at[None, :] - x) ** 2 + (at[:, None] - y) ** 2 <= size * size
        image = np.where(crown, np.maximum(image, shade), image)
    for _ in range(2):
        for axis in (0, 1):
            image = _blurred(image, blur, axis)
    return image


def _blurred(image: Floats, radius: int, axis: int) -> Floats:
    """Means over windows of ``2 radius + 1`` pixels along an axis, the border repeated."""
    wide = np.pad(image, [(radius + 1, radius) if k == axis else (0, 0) for k in range(2)], mode="edge").cumsum(axis=axis)
    size, width = image.shape[axis], 2 * radius + 1
    return np.asarray((wide.take(np.arange(width, width + size), axis) - wide.take(np.arange(size), axis)) / width)


def intensities(image: Floats, tails: Floats, heads: Floats) -> tuple[Floats, Floats]:
    """Mean and variance of the pixels along straight lines, sampled a pixel apart; ends in [0, 1] x [0, 1], shape (lines, 2)."""
    pixels = len(image)
    counts = np.ceil(np.sqrt(((heads - tails) ** 2).sum(axis=1)) * pixels).astype(np.int64) + 1
    first = np.cumsum(counts) - counts
    line = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(line)) - first[line]) / np.maximum(counts - 1, 1)[line]
    at = np.minimum(((tails[line] + share[:, None] * (heads - tails)[line]) * pixels).astype(np.int64), pixels - 1)
    shades = image[at[:, 1], at[:, 0]]
    mean = np.bincount(line, shades, minlength=len(counts)) / counts
    variance = np.bincount(line, (shades - mean[line]) ** 2, minlength=len(counts)) / counts
    return mean, variance


GENERATORS.enter(Generator("prm-graph", "random roadmaps with normal edge costs (risk-aware graph search)", PRM, make_prm))
GENERATORS.enter(Generator("raster-graph", "roadmaps of normal edge costs over synthetic aerial images", RASTER, make_raster))
