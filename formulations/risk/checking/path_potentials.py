"""Evidence ``path-potentials``: potentials of the vertices that bound weighted sums of a path's mean and variance.

With weights a, b >= 0, and potentials p of the vertices, every simple path from the start s to the goal t has

    a mean + b variance  >=  p_t - p_s + sum_{u != t} min(0, min_{e = (u, v)} a mean_e + b variance_e - p_v + p_u)

since it leaves each vertex once at most. Several such half-planes bound where (mean, variance) of a path can lie, and the cost at risk
mean + z sqrt(variance) is least over that region: it grows in both and is concave, so along an edge of the region it is least at an end.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats
from ...checking.evidence_numbers import numbers
from ...evidence import checker

_EPS = float(np.finfo(np.float64).eps)

_LARGEST, _TINY = 1e300, 1e-300
"""Potentials from the first on overflow in sums; weights of means below the second prove no more than those of variances alone."""

MOST_PAIRS = 10_000
"""Half-planes that are read: each has as many numbers as the graph has vertices."""


@checker("path-potentials", "uncertain-path", "potentials of vertices are", needs="graph")
def check_path_potentials(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the cost at risk that any weights and potentials prove, at least 0, since costs are not negative.

    ``weights`` are pairs [a, b], negative ones counting as 0; ``potentials`` hold for each pair one number a vertex. Raises InputError for
    anything else. Source: duality of shortest paths, and Nikolova et al. (2006) on the extreme points of (mean, variance);
    docs/formulations/uncertain-path.md#evidence. All sums are rounded downwards.
    """
    graph = problem.graph
    weights, potentials = data.get("weights"), data.get("potentials")
    if not isinstance(weights, list) or not isinstance(potentials, list) or len(weights) != len(potentials):
        raise InputError("evidence needs lists weights and potentials of one length", "wrong-shape")
    if len(weights) > MOST_PAIRS:
        raise InputError("evidence has too many weights", "too-large", expected=f"at most {MOST_PAIRS}", found=str(len(weights)))
    planes = []
    for k in range(len(weights)):
        a, b = np.maximum(numbers({"weights": weights[k]}, "weights", 2), 0.0).tolist()
        p = numbers({"potentials": potentials[k]}, "potentials", graph.num_vertices)
        if max(a, b) > 0:
            with np.errstate(over="ignore"):
                scaled = p / max(a, b)
            planes.append(_half_plane(graph, a / max(a, b), b / max(a, b), scaled))
    return _least(problem.z, [plane for plane in planes if plane[2] > 0])


def _half_plane(graph: Any, a: float, b: float, p: Floats) -> tuple[float, float, float]:
    """a, b and the least that a mean + b variance of any simple path comes to."""
    if not (np.abs(p) < _LARGEST).all():
        return a, b, 0.0
    cost = a * graph.mean + b * graph.variance
    size = float(cost.max(initial=0.0)) + float(np.abs(p).max())
    lost = np.zeros(graph.num_vertices)
    np.minimum.at(lost, graph.tails, cost - p[graph.heads] + p[graph.tails] - 8.0 * _EPS * size)
    lost[graph.goal] = 0.0
    return a, b, math.fsum([float(p[graph.goal]), -float(p[graph.start]), *lost.tolist()]) - 8.0 * _EPS * size


def _least(z: float, planes: list[tuple[float, float, float]]) -> float:
    """The least mean + z sqrt(variance) where a mean + b variance >= side in all half-planes.

    The variances are cut into intervals, at any places; on each, one half-plane and the concavity bound the value by its two ends.
    """
    least = max((side / b for a, b, side in planes if a == 0), default=0.0) * (1.0 - 8.0 * _EPS)
    lines = [(b / a, side / a) for a, b, side in planes if a > _TINY and math.isfinite(side / a)]  # mean >= side - slope variance
    corners = _corners(sorted([(0.0, 0.0), *lines]))
    cuts = np.array([least, *(v for v in corners if v > least)])
    slopes, sides = np.array([(0.0, 0.0), *lines]).T[:, :, None]
    with np.errstate(over="ignore"):
        terms = sides, slopes * cuts, z * np.sqrt(cuts)
        worth = terms[0] - terms[1] + terms[2] - 16.0 * _EPS * sum(terms)  # of each half-plane at each cut
    pieces = np.minimum(worth[:, :-1], worth[:, 1:]).max(axis=0)
    beyond = worth[slopes[:, 0] == 0, -1].max()  # the value only grows where the mean has a floor
    return max(0.0, float(min(pieces.min(initial=math.inf), beyond)))


def _corners(lines: list[tuple[float, float]]) -> list[float]:
    """Variances, ascending, at which another of the lines of ascending slope is the highest."""
    kept: list[tuple[float, float, float]] = []  # slope, side, and the variance from which on it is below the one before
    for slope, side in lines:
        if kept and side <= kept[-1][1]:
            continue
        while kept and (slope == kept[-1][0] or (side - kept[-1][1]) / (slope - kept[-1][0]) >= kept[-1][2]):
            kept.pop()
        kept.append((slope, side, (side - kept[-1][1]) / (slope - kept[-1][0]) if kept else math.inf))
    return [end for _, _, end in reversed(kept) if end < math.inf]
