"""Steiner trees with the fewest Steiner points: relays such that every link is short enough."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ....formulations.evidence import Guarantee
from ....formulations.stop import NEVER, Stop, Stopped
from ....instances.errors import InputError
from ....instances.number_arrays import Flags, Floats, Integers

SAME = 1e-9
"""Share of the reach by which a link may be longer, so that multiples of the reach need no further relay."""

SOURCE = "Chen, Du, Hu, Lin, Wang, Xue (2000), Approximations for Steiner trees with minimum number of Steiner points"


@dataclass(frozen=True)
class RelayTree:
    """Relays, and a tree that joins them and all terminals by links within reach.

    Parameters
    ----------
    relays : array of shape (relays, 2)
        Positions, in the unit of the terminals'.
    links : array of shape (terminals + relays - 1, 2)
        Pairs of numbers: terminals first, then relays.
    guarantee : Guarantee
        The stated ratio to the fewest relays, with its assumptions.
    """

    relays: Floats
    links: Integers
    guarantee: Guarantee


def spanning_tree_relays(terminals: ArrayLike, reach: float, *, strict: bool = False) -> RelayTree:
    """Relays at equal distances along the edges of a minimum spanning tree of the terminals.

    Parameters
    ----------
    terminals : array of shape (terminals, 2)
        The base and the robots that are to be connected.
    reach : float
        Longest link, positive.
    strict : bool
        Whether links must be shorter than the reach, not just as long.

    Returns
    -------
    RelayTree
        At most 4 times the fewest relays, and a regular pentagon around its centre shows that it may be as many.

    Raises
    ------
    InputError
        If there is no terminal, a coordinate is not finite, or the reach not positive.

    Notes
    -----
    Source: Zhang (2015), section 5.4.1; Lin and Xue (1999) for the heuristic, Chen et al. (2000) for its ratio;
    docs/formulations/relays.md#model.
    """
    points = np.asarray(terminals, dtype=np.float64)
    if points.ndim != 2 or points.shape[1:] != (2,) or not len(points) or not np.isfinite(points).all():
        raise InputError("terminals must be points of the plane, at least one", "wrong-shape", found=f"shape {points.shape}")
    if not 0.0 < reach < math.inf:
        raise InputError("the reach must be positive and finite", "out-of-range", found=str(reach))
    relays: list[Floats] = []
    links: list[tuple[int, int]] = []
    near = np.hypot(*(points - points[0]).T)
    joined, waiting = np.zeros(len(points), dtype=np.int64), np.arange(len(points)) > 0
    for _ in range(len(points) - 1):
        node = int(np.where(waiting, near, math.inf).argmin())
        chain = [int(joined[node])]
        for share in _shares(float(near[node]) / reach, strict):
            relays.append(points[joined[node]] + share * (points[node] - points[joined[node]]))
            chain.append(len(points) + len(relays) - 1)
        links += itertools.pairwise([*chain, node])
        waiting[node] = False
        away = np.hypot(*(points - points[node]).T)
        joined, near = np.where(away < near, node, joined), np.minimum(near, away)
    guarantee = Guarantee(4.0, "relays <= 4 OPT", ("links of the Euclidean plane",), SOURCE)
    return RelayTree(np.array(relays).reshape(-1, 2), np.array(links, dtype=np.int64).reshape(-1, 2), guarantee)


def _shares(ratio: float, strict: bool) -> list[float]:
    """Places of relays on an edge ``ratio`` reaches long, as shares of it."""
    pieces = math.floor(ratio * (1.0 + SAME)) + 1 if strict else max(1, math.ceil(ratio * (1.0 - SAME)))
    return [k / pieces for k in range(1, pieces)]


def fewest_relays(linked: ArrayLike, terminals: ArrayLike, most: int | None = None, stop: Stop = NEVER) -> tuple[int, ...] | None:
    """The fewest nodes of a graph that connect the terminals, by trying all sets of one, two, ... others.

    Parameters
    ----------
    linked : array of shape (nodes, nodes)
        Whether two nodes are within reach of each other.
    terminals : sequence of int
        Nodes to be connected, by number from 0.
    most : int, optional
        Relays at most; by default all other nodes.
    stop : Stop
        Deadline and wish to end.

    Returns
    -------
    tuple of int, or None where no such set connects them
        The first of equal ones in lexicographic order.

    Raises
    ------
    InputError
        If the table is not square and symmetric, or a terminal does not exist.
    Stopped
        If ``stop`` comes first.

    Notes
    -----
    docs/formulations/relays.md#model.
    """
    links = np.asarray(linked, dtype=bool)
    if links.ndim != 2 or links.shape[0] != links.shape[1] or (links != links.T).any():
        raise InputError("links must be a square symmetric table", "wrong-shape", found=f"shape {links.shape}")
    ends = np.unique(np.asarray(terminals, dtype=np.int64))
    if len(ends) == 0 or ends[0] < 0 or ends[-1] >= len(links):
        raise InputError(
            "terminals must be nodes of the graph, at least one", "unknown-name", expected=f"0 to {len(links) - 1}",
            found=str(terminals)[:40],
        )  # fmt: skip
    within = _component(links, np.ones(len(links), dtype=bool), int(ends[0]))
    if not within[ends].all():
        return None
    others = np.setdiff1d(np.nonzero(within)[0], ends)
    for count in range(min(len(others), len(others) if most is None else most) + 1):
        for k, chosen in enumerate(itertools.combinations(others.tolist(), count)):
            if k % 256 == 0 and stop.reached():
                raise Stopped
            among = np.zeros(len(links), dtype=bool)
            among[ends], among[list(chosen)] = True, True
            if _component(links, among, int(ends[0]))[ends].all():
                return chosen
    return None


def _component(links: Flags, among: Flags, node: int) -> Flags:
    """Nodes connected to ``node`` through nodes ``among`` the graph's."""
    reached = np.zeros(len(links), dtype=bool)
    reached[node] = True
    while True:
        more = reached | (links[reached].any(axis=0) & among)
        if (more == reached).all():
            return reached
        reached = more


def fermat_weber(points: ArrayLike, weights: ArrayLike | None = None, steps: int = 10_000) -> Floats:
    """The point of the least weighted sum of distances to all points (1-median).

    It is no Steiner point of the fewest relays: where links are short, one relay at it may connect nothing.

    Parameters
    ----------
    points : array of shape (points, 2)
        Positions in the plane, in any unit.
    weights : array of shape (points,), optional
        Positive; equal by default.
    steps : int
        At most; each comes nearer by a share.

    Returns
    -------
    array of shape (2,)

    Raises
    ------
    InputError
        If there is no point, or a weight is not positive.

    Notes
    -----
    Source: Weiszfeld (1937), with the step of Vardi and Zhang (2000) at a given point; Zhang (2015), section 5.4.1, describes it as if it
    were the placement of relays (docs/formulations/relays.md#model).
    """
    at = np.asarray(points, dtype=np.float64)
    heavy = np.ones(len(at)) if weights is None else np.asarray(weights, dtype=np.float64)
    if at.ndim != 2 or at.shape[1:] != (2,) or not len(at) or heavy.shape != (len(at),) or not (heavy > 0).all():
        raise InputError("there must be points of the plane, and a positive weight each", "wrong-shape", found=f"shape {at.shape}")
    size = float(np.abs(at - at.mean(axis=0)).max())
    here: Floats = (heavy[:, None] * at).sum(axis=0) / heavy.sum()
    for _ in range(steps):
        away = np.hypot(*(at - here).T)
        on = away <= 1e-15 * size
        pull = np.divide(heavy, away, out=np.zeros(len(at)), where=~on)
        if not pull.any():
            return here
        toward = (pull[:, None] * at).sum(axis=0) / pull.sum()
        held = float(heavy[on].sum())
        force = float(np.hypot(*(toward - here))) * float(pull.sum())
        if held and force <= held:  # the pull of the others does not move it away from where it is
            return here
        after: Floats = here + (1.0 - (held / force if held else 0.0)) * (toward - here)
        if float(np.abs(after - here).max()) <= 1e-16 * size:
            return after
        here = after
    return here
