"""A tour through the depot and all customers, and what is proved of its length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.evidence import Guarantee
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import Stop
from ....formulations.tolerance import EQUAL
from ....instances.errors import UsageError
from ...heuristic import HEURISTICS
from .dense import STRIP, dense

Floats = NDArray[np.float64]
Sites = NDArray[np.int64]

TOURS = ("christofides", "double-tree", "nearest-neighbour")
MOST_MATCHED = 1_500
"""Nodes of odd degree up to which they are matched: some ten seconds of work."""

MOST_CLOSED = 2_500
"""Sites up to which the triangle inequality is looked at: some ten seconds of work."""

NEIGHBOURS = 10
"""Nearest nodes that moves of the improvement are tried with (Johnson and McGeoch 1997)."""

CHRISTOFIDES = "Christofides (1976), Worst-case analysis of a new heuristic for the travelling salesman problem"
DOUBLE_TREE = "Rosenkrantz, Stearns and Lewis (1977), An analysis of several heuristics for the traveling salesman problem"
SYMMETRIC, METRIC = "distances are symmetric", "the triangle inequality holds"


@dataclass(frozen=True)
class Costs:
    """What moves between the depot, node 0, and the customers cost.

    Parameters
    ----------
    nodes : array of int
        Site of each node.
    moves : array of shape (nodes, nodes)
        As they are driven.
    both_ways : array of shape (nodes, nodes)
        The mean of both directions: that of moves, where they are symmetric.
    known : bool
        Symmetric by themselves, with the triangle inequality but for the rounding of doubles.
    """

    nodes: Sites
    moves: Floats
    both_ways: Floats
    known: bool

    @property
    def symmetric(self) -> bool:
        return self.moves is self.both_ways


@dataclass(frozen=True)
class GiantTour:
    """A tour from the depot through all customers.

    Parameters
    ----------
    order : array of int
        Nodes of the customers, from 1 on.
    length : float
        Of the tour as it is driven.
    ratio : float or None
        ``proved`` is at most so many times the shortest tour along shortest paths; None where nothing is proved.
    proved : float
        Length of the tour along shortest paths before it was improved.
    paths : array of shape (nodes, nodes)
        Lengths of shortest paths; those of the moves where nothing is proved.
    metric : bool
        Whether moves are shortest paths.
    source : str
    message : str
        Why nothing is proved, or what was done instead of what was asked for.
    """

    order: Sites
    length: float
    ratio: float | None
    proved: float
    paths: Floats
    metric: bool
    source: str
    message: str


def moving_costs(problem: RoutingProblem, stop: Stop, *, busy: bool = False, distance: bool = False) -> Costs | None:
    """What moves cost: unit cost times distance, and half of a vehicle's fixed cost at the depot, so that routes cost what their moves do.

    Parameters
    ----------
    busy : bool
        Durations in place of costs, with half of the service at either end.
    distance : bool
        Distances in place of costs.

    Returns
    -------
    Costs or None
        None where it was asked to stop.

    Raises
    ------
    UsageError
        If there are too many sites, or no memory for them.
    """
    vehicle, travel = problem.fleet[0], problem.travel
    nodes = np.concatenate([[vehicle.start], problem.customers])
    moves = dense(travel.duration if busy else travel.distance, nodes, stop, "a tour", savings=not HEURISTICS["savings"].missing(problem))
    if moves is None:
        return None
    half = np.zeros(len(nodes))
    if busy:
        half[1:] = problem.sites.service[nodes[1:]] / 2
    elif not distance:
        moves *= vehicle.unit_cost
    if busy and half.any():
        moves += half[:, None] + half[None, :]
    if not busy and not distance and vehicle.fixed_cost:
        moves[0] += vehicle.fixed_cost / 2
        moves[:, 0] += vehicle.fixed_cost / 2
    np.fill_diagonal(moves, 0.0)
    own = travel.duration_matrix if busy and travel.duration_matrix is not None else travel.matrix
    if own is None or (moves == moves.T).all():
        return Costs(nodes, moves, moves, own is None and _by_nature(travel))
    return Costs(nodes, moves, (moves + moves.T) / 2, False)


def _by_nature(travel: Any) -> bool:
    """Whether distances keep the triangle inequality whatever the coordinates: unrounded ones, and those rounded up."""
    return (travel.convention == "exact" and travel.metric != "GEO") or (travel.metric, travel.convention) == ("CEIL_2D", "file")


def giant_tour(costs: Costs, method: str, improved: bool, stop: Stop) -> GiantTour:
    """A tour by ``method``, improved by 2-opt and Or-opt where it is wanted; cut short, it is no more than the nodes in some order.

    Raises
    ------
    UsageError
        For a method that there is not.
    """
    if method not in TOURS:
        raise UsageError(f"tour must be one of {', '.join(TOURS)}, not {method!r}")
    from .tour_kernels import close, improve, nearest_neighbour, shortcut, spanning_tree

    n, messages, ratio = len(costs.nodes), [], None
    paths, metric = costs.both_ways, costs.known
    if method != "nearest-neighbour" and costs.symmetric and not costs.known and n <= MOST_CLOSED:
        paths = costs.moves.copy()
        if close(stop.flag, paths):
            metric = bool((costs.moves - paths <= EQUAL * paths).all())
            ratio = 2.0
        else:
            paths = costs.both_ways
    elif method != "nearest-neighbour" and costs.known:
        ratio = 2.0
    elif method != "nearest-neighbour":
        why = "distances are not symmetric" if not costs.symmetric else f"{n:,} sites are too many to look at the triangle inequality"
        messages.append(f"no guarantee: {why}")
    source = DOUBLE_TREE
    if method == "nearest-neighbour":
        tour, source = nearest_neighbour(stop.flag, paths), ""
    else:
        parent = spanning_tree(stop.flag, paths)
        child = np.arange(1, n)
        if len(parent) < n:  # it was asked to stop
            tour, ratio = np.arange(n), None
        else:
            tails, heads = np.concatenate([child, child]), np.concatenate([parent[1:], parent[1:]])
            if method == "christofides":
                odd = np.nonzero(np.bincount(heads[: n - 1], minlength=n) % 2 == (np.arange(n) == 0))[0] if n > 1 else child
                matched = _matching(paths, odd, stop) if len(odd) <= MOST_MATCHED else None
                if matched is not None:
                    tails, heads = np.concatenate([child, matched[0]]), np.concatenate([parent[1:], matched[1]])
                    source, ratio = CHRISTOFIDES, None if ratio is None else 1.5
                elif not stop.reached():
                    messages.append(f"{len(odd):,} nodes of odd degree are too many to match: double tree in place of christofides")
            tour = shortcut(tails, heads, n)
    proved = _length(paths, tour)
    if improved and n > 4 and not stop.reached():
        near = _nearest(costs.both_ways, stop)
        if near is not None:
            improve(stop.flag, tour, costs.both_ways, near)
    tour = np.roll(tour, -int(np.argmin(tour)))
    length, other = _length(costs.moves, tour), _length(costs.moves, tour[::-1])
    order = tour[1:] if length <= other else tour[:0:-1].copy()
    return GiantTour(order, min(length, other), ratio, proved, paths, metric, source, "; ".join(messages))


def _length(matrix: Floats, tour: Sites) -> float:
    return float(matrix[tour, np.roll(tour, -1)].sum())


def _matching(paths: Floats, odd: Sites, stop: Stop) -> tuple[Sites, Sites] | None:
    """The pairs of nodes whose edges weigh least together; weights are whole numbers, up to 2^-40 of the largest one."""
    from .matching_kernels import minimum_weight_perfect_matching

    weights = paths[np.ix_(odd, odd)]
    largest = float(weights.max(initial=0.0))
    partner = minimum_weight_perfect_matching(stop.flag, np.rint(np.ldexp(weights, 40 - int(np.frexp(largest)[1]))).astype(np.int64))
    if (partner < 0).any():
        return None
    first = np.nonzero(np.arange(len(odd)) < partner)[0]
    return odd[first], odd[partner[first]]


def _nearest(costs: Floats, stop: Stop) -> Sites | None:
    """The nearest nodes of each, in order."""
    n = len(costs)
    count = min(NEIGHBOURS, n - 1)
    near = np.empty((n, count), dtype=np.int64)
    step = max(1, STRIP // n)
    for first in range(0, n, step):
        if stop.reached():
            return None
        rows = costs[first : first + step].copy()
        rows[np.arange(len(rows)), np.arange(first, first + len(rows))] = np.inf
        found = np.argpartition(rows, count - 1, axis=1)[:, :count]
        order = np.argsort(np.take_along_axis(rows, found, axis=1), axis=1, kind="stable")
        near[first : first + step] = np.take_along_axis(found, order, axis=1)
    return near


def in_rows(costs: Floats, order: Sites) -> Floats:
    """The moves from the depot, on to the next customer and back, of each customer in the order of the tour."""
    made = np.zeros((3, len(order)))
    made[0], made[2] = costs[0, order], costs[order, 0]
    made[1, :-1] = costs[order[:-1], order[1:]]
    return made


def guaranteed(
    tour: GiantTour, value: float, bound: float, times: float, share: float, statement: str, assumptions: tuple[str, ...], source: str,
    plain: bool = True, vehicles: int = 1,
) -> Guarantee | None:  # fmt: skip
    """The guarantee of routes that cost ``value``, where a theorem has ``times * bound + share * (length of the tour)`` for it.

    ``bound`` and the shortest tour, shared by so many ``vehicles``, both along shortest paths, are at most the optimum. Where moves are
    longer than shortest paths, the ratio grows by as much as the routes cost more than the theorem says. None where they do so for other
    reasons (``plain`` is False, or the triangle inequality holds), or nothing is proved of the tour.
    """
    if tour.ratio is None:
        return None
    allowed = times * bound + share * tour.proved
    excess = value / allowed if allowed > 0 else 1.0 if value <= 0 else np.inf
    ratio = times + share * vehicles * tour.ratio
    if excess <= 1.0 + EQUAL:
        excess = 1.0
    elif tour.metric or not plain or not np.isfinite(excess):
        return None
    holds: tuple[str, ...] = (SYMMETRIC, METRIC) if tour.metric else (SYMMETRIC,)
    if not tour.metric:
        words = "moves longer than shortest paths " + (f"make up {excess:.9g} times" if excess > 1 else "stay within")
        holds += (f"{words} what the theorem allows",)
    return Guarantee(float(ratio * excess), statement, (*holds, *assumptions), source)
