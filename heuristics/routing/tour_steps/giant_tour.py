"""A tour through the depot and all customers, and what is proved of its length."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....formulations.evidence import Guarantee
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import Stop
from ....formulations.tolerance import EQUAL
from ....instances.errors import UsageError
from .distance_matrices import STRIP, Floats, Sites, dense, takes_savings

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
    """Costs of the moves between the depot, node 0, and the customers; ``nodes`` are the sites of all nodes.

    ``moves`` are as they are driven, ``both_ways`` the mean of both directions (``moves`` where they are symmetric), each of shape (nodes,
    nodes). ``known``: symmetric by themselves, with the triangle inequality but for the rounding of doubles.
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

    ``order`` are the nodes of the customers, from 1 on; ``length`` is that of the tour as it is driven, ``proved`` that along shortest
    paths before it was improved, at most ``ratio`` times the shortest tour along shortest paths (None where nothing is proved). ``paths``,
    shape (nodes, nodes), are lengths of shortest paths, or of moves where nothing is proved; ``metric`` says whether moves are such.
    ``message`` tells why nothing is proved, or what was done instead of what was asked for.
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
    """Unit cost times distance, and half of a vehicle's fixed cost at the depot, so that routes cost what their moves do; None without
    time.

    ``busy``: durations in place of costs, with half of the service at either end; ``distance``: distances in place of costs. Raises
    UsageError where there are too many sites, or no memory for them.
    """
    vehicle, travel = problem.fleet[0], problem.travel
    nodes = np.concatenate([[vehicle.start], problem.customers])
    moves = dense(travel.duration if busy else travel.distance, nodes, stop, "a tour", savings=takes_savings(problem))
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
    """A tour by one of ``TOURS``, improved by 2-opt and Or-opt where wanted; cut short, it is no more than the nodes in some order."""
    if method not in TOURS:
        raise UsageError(f"tour must be one of {', '.join(TOURS)}, not {method!r}", "unknown-name")
    from .tour_kernels import improve, nearest_neighbour

    paths, metric, ratio, source = costs.both_ways, costs.known, None, ""
    messages: list[str] = []
    if method == "nearest-neighbour":
        tour = nearest_neighbour(stop.flag, paths)
    else:
        paths, metric, proven, unproven = _shortest_paths(costs, stop)
        tour, times, source, doubled = _tree_tour(paths, method == "christofides", stop)
        ratio, messages = times if proven else None, [unproven, doubled]
    proved = _length(paths, tour)
    if improved and len(tour) > 4 and not stop.reached():
        near = _nearest(costs.both_ways, stop)
        if near is not None:
            improve(stop.flag, tour, costs.both_ways, near)
    tour = np.roll(tour, -int(np.argmin(tour)))
    length, other = _length(costs.moves, tour), _length(costs.moves, tour[::-1])
    order = tour[1:] if length <= other else tour[:0:-1].copy()
    message = "; ".join(words for words in messages if words)
    return GiantTour(order, min(length, other), ratio, proved, paths, metric, source, message)


def _shortest_paths(costs: Costs, stop: Stop) -> tuple[Floats, bool, bool, str]:
    """Lengths of shortest paths, whether moves are such, whether tours along them have a ratio, and why not."""
    from .tour_kernels import close

    n = len(costs.nodes)
    if costs.known:
        return costs.both_ways, True, True, ""
    if not costs.symmetric or n > MOST_CLOSED:
        why = "distances are not symmetric" if not costs.symmetric else f"{n:,} sites are too many to look at the triangle inequality"
        return costs.both_ways, False, False, f"no guarantee: {why}"
    paths = costs.moves.copy()
    if not close(stop.flag, paths):
        return costs.both_ways, False, False, ""
    return paths, bool((costs.moves - paths <= EQUAL * paths).all()), True, ""


def _tree_tour(paths: Floats, christofides: bool, stop: Stop) -> tuple[Sites, float | None, str, str]:
    """A tour around a minimum spanning tree and a matching, or around the tree twice; its ratio, source, and why nothing was matched."""
    from .tour_kernels import shortcut, spanning_tree

    n, parent = len(paths), spanning_tree(stop.flag, paths)
    if len(parent) < n:  # it was asked to stop
        return np.arange(n), None, DOUBLE_TREE, ""
    child, parent, message = np.arange(1, n), parent[1:], ""
    if christofides:
        degrees = np.bincount(np.concatenate([child, parent]), minlength=n)
        odd = np.nonzero(degrees % 2)[0]
        matched = _matching(paths, odd, stop) if len(odd) <= MOST_MATCHED else None
        if matched is not None:
            tour = shortcut(np.concatenate([child, matched[0]]), np.concatenate([parent, matched[1]]), n)
            return tour, 1.5, CHRISTOFIDES, ""
        if not stop.reached():
            message = f"{len(odd):,} nodes of odd degree are too many to match: double tree in place of christofides"
    return shortcut(np.concatenate([child, child]), np.concatenate([parent, parent]), n), 2.0, DOUBLE_TREE, message


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
    """The nearest nodes of each, in order; None where it was asked to stop."""
    n = len(costs)
    count = min(NEIGHBOURS, n - 1)
    near = np.empty((n, count), dtype=np.int64)
    step = max(1, STRIP // n)
    for first in range(0, n, step):
        if stop.reached():
            return None
        rows = costs[first : first + step].copy()
        rows[np.arange(len(rows)), np.arange(first, first + len(rows))] = np.inf
        nearest = np.argpartition(rows, count - 1, axis=1)[:, :count]
        order = np.argsort(np.take_along_axis(rows, nearest, axis=1), axis=1, kind="stable")
        near[first : first + step] = np.take_along_axis(nearest, order, axis=1)
    return near


def in_rows(costs: Floats, order: Sites) -> Floats:
    """Moves from the depot, on to the next customer and back, of each customer in the order of the tour; shape (3, customers)."""
    rows = np.zeros((3, len(order)))
    rows[0], rows[2] = costs[0, order], costs[order, 0]
    rows[1, :-1] = costs[order[:-1], order[1:]]
    return rows


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
