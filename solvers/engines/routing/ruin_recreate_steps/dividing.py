"""Division of the plane into parts of about equal weight that lie close together."""

from __future__ import annotations

import numpy as np

from ..integer_scales import Floats, Integers


def divided(points: Floats, weights: Integers, many: int, random: np.random.Generator) -> list[Integers]:
    """Numbers of the points of each of ``many`` parts of about equal weight, ascending; each point is in one of them.

    Points are cut in two across a direction that is drawn at random, the likelier the farther they reach in it, where the weights on the
    two sides are those of whole parts. An odd number of parts leaves the larger half to either side. Thus no border stays where it is when
    the points are divided anew.
    """
    parts: list[Integers] = []
    todo = [(np.arange(len(points)), many)]
    while todo:
        held, many = todo.pop()
        weight, many = weights[held], min(many, len(held))
        if many <= 1:
            parts.append(np.sort(held))
            continue
        place = points[held] - np.average(points[held], axis=0, weights=weight)
        direction = (place * weight[:, None]).T @ place @ random.standard_normal(points.shape[1])
        held = held[np.argsort(place @ direction, kind="stable")]
        before = np.cumsum(weights[held]) - weights[held] / 2.0
        first = (many + int(random.integers(2))) // 2
        cut = int(np.clip(np.searchsorted(before, first / many * weight.sum()), 1, len(held) - 1))
        todo += [(held[cut:], many - first), (held[:cut], first)]
    return parts


def positions(distances_to: Floats | None, coordinates: Floats | None, geographic: bool) -> Floats:
    """Points whose distances are about those of the sites: their coordinates, on a globe in space, or else their distances to landmarks."""
    if coordinates is None:
        assert distances_to is not None
        return distances_to
    if not geographic:
        return coordinates
    east, north = np.radians(coordinates).T
    return np.column_stack([np.cos(north) * np.cos(east), np.cos(north) * np.sin(east), np.sin(north)])
