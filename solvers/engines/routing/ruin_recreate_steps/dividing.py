"""Division of the plane into parts of about equal weight that lie close together."""

from __future__ import annotations

import math

import numpy as np

from ..integer_scales import Floats, Integers


def divided(points: Floats, weights: Integers, most: int, random: np.random.Generator) -> list[Integers]:
    """Numbers of the points of each part, ascending: parts weigh about ``most``, each point being in one of them.

    A part that is too heavy is cut in two across a direction that is drawn at random, the likelier the farther its points reach in it, and
    where the weights on the two sides are those of whole parts. An odd number of parts leaves the larger half to either side. Thus no
    border stays where it is when the points are divided anew.
    """
    parts, todo = [], [np.arange(len(points))]
    while todo:
        held = todo.pop()
        weight = weights[held]
        many = min(len(held), math.ceil(int(weight.sum()) / most))
        if many <= 1:
            parts.append(np.sort(held))
            continue
        place = points[held] - np.average(points[held], axis=0, weights=weight)
        direction = (place * weight[:, None]).T @ place @ random.standard_normal(points.shape[1])
        held = held[np.argsort(place @ direction, kind="stable")]
        before = np.cumsum(weights[held]) - weights[held] / 2.0
        share = (many + int(random.integers(2))) // 2 / many
        cut = int(np.clip(np.searchsorted(before, share * before[-1]), 1, len(held) - 1))
        todo += [held[cut:], held[:cut]]
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
