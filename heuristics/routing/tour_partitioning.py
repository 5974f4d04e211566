"""Iterated tour partitioning: a tour through all customers, cut wherever a vehicle is full."""

import math
from dataclasses import dataclass

import numpy as np

from ...formulations.evidence import Guarantee
from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...formulations.tolerance import widened
from ..heuristic import Context, Outcome, heuristic
from .tour_steps.cutting import ended, in_turn, no_time, routes_of, too_many
from .tour_steps.distance_matrices import Flags, Floats
from .tour_steps.giant_tour import GiantTour, giant_tour, guaranteed, in_rows, moving_costs

FEATURES = frozenset({"objective:total-cost", "capacity", "service-times", "limited-fleet", "fixed-cost", "separate-durations"})

EQUAL_DEMANDS = (
    "Haimovich and Rinnooy Kan (1985), Bounds and heuristics for capacitated routing problems; Altinkemer and Gavish (1990), Heuristics "
    "for delivery problems with constant error guarantees"
)
ANY_DEMANDS = "Altinkemer and Gavish (1987), Heuristics for unequal weight delivery problems with a fixed error guarantee"


@dataclass(frozen=True)
class Pieces:
    """How a tour is cut by demands, and what the theorem says of it.

    ``segment`` is how much demand lies between cuts; ``alone`` are customers with more than that. The cost is at most ``times`` the
    averaged distances and ``share`` times the tour; ``statement`` has a place for the ratio ``a`` of that tour. ``demand`` and ``capacity``
    are in the unit that all demands are multiples of.
    """

    demand: Floats
    capacity: float
    segment: float
    alone: Flags
    times: float
    share: float
    statement: str
    assumptions: tuple[str, ...]
    source: str


def pieces_of(problem: RoutingProblem) -> Pieces:
    """The pieces of equal demands, of whole multiples of a unit, or of any others."""
    demand, capacity = problem.sites.demand[problem.customers], problem.fleet[0].capacity
    none, whole = np.zeros(len(demand), dtype=bool), bool((demand == np.floor(demand)).all()) and float(demand.max(initial=0.0)) < 2.0**53
    if demand.sum() <= capacity:
        return Pieces(demand, capacity, math.inf, none, 0.0, 1.0, "cost <= {a} OPT", ("one vehicle carries all demand",), "")
    unit = float(demand[0]) if (demand == demand[0]).all() else float(np.gcd.reduce(demand.astype(np.int64))) if whole else 1.0
    if whole or unit == demand[0]:
        demand, capacity = np.rint(demand / unit), math.floor(float(widened(capacity)) / unit)
    if (demand == 1).all():
        size = int(capacity)
        share = 1.0 - 1.0 / max(1, size)
        statement = f"cost <= (1 + (1 - 1/{size}) {{a}}) OPT"
        unlike = (f"demands are equal, {size} to a vehicle",)
        return Pieces(demand, capacity, float(size), demand > size, 1.0, share, statement, unlike, EQUAL_DEMANDS)
    if whole and (demand > 0).all():
        size = int(capacity) if capacity % 2 == 0 else 2 * int(capacity)  # of the vehicle, in units half of which it holds too
        statement = f"cost <= (2 + (1 - 2/{size}) {{a}}) OPT"
        share = 1.0 - 2.0 / max(2, size)
    else:
        statement, share = "cost <= (2 + {a}) OPT", 1.0
    return Pieces(demand, capacity, capacity / 2, demand > capacity / 2, 2.0, share, statement, ("demands are not split",), ANY_DEMANDS)


def radial_guarantee(problem: RoutingProblem, tour: GiantTour, value: float, *, plain: bool = True) -> Guarantee | None:
    """The guarantee of iterated tour partitioning for routes that cost ``value``, if it holds for them: see ``guaranteed``."""
    pieces = pieces_of(problem)
    averaged = 2.0 * float(pieces.demand @ tour.paths[0, 1:]) / pieces.capacity if 0 < pieces.capacity < math.inf else 0.0
    source = f"{pieces.source}, with {tour.source}" if pieces.source else tour.source
    statement = pieces.statement.format(a=tour.ratio)
    return guaranteed(tour, value, averaged, pieces.times, pieces.share, statement, pieces.assumptions, source, plain)


@heuristic(
    "tour-partitioning",
    "routing", FEATURES, "a tour through all customers, cut wherever a vehicle is full",
    stated="5/2 - 3/(2Q) for equal demands, 7/2 - 3/Q for others, with Christofides' tour, where distances are metric",
)  # fmt: skip
def tour_partitioning(problem: RoutingProblem, context: Context, *, tour: str = "christofides", improve: bool = True) -> Outcome:
    """Build one tour, cut it after every full vehicle from each customer on in turn, and keep the cheapest way.

    Takes one depot and one vehicle type, every site required, no windows and no limits but capacity. The guarantee holds where distances
    are symmetric and keep the triangle inequality, or miss it by little. May use more vehicles than the fleet has.

    Unequal demands: segments of half a vehicle; a customer across a cut belongs to the route before it, and customers above half a vehicle
    are served alone. Source: Haimovich and Rinnooy Kan (1985), Mathematics of Operations Research 10; Altinkemer and Gavish (1987, 1990),
    Operations Research Letters 6, Transportation Science 24; docs/formulations/routing.md#approximations.

    Parameters
    ----------
    tour : str
        ``christofides``, ``double-tree`` (twice the shortest tour in place of one and a half times), or ``nearest-neighbour`` (no
        ratio).
    improve : bool
        Shorten the tour by 2-opt and Or-opt before it is cut.
    """
    from .tour_steps.splitting_kernels import cheapest_cut

    stop = context.begin()
    costs = moving_costs(problem, stop)
    if costs is None:
        return no_time(in_turn(problem), stop)
    giant = giant_tour(costs, tour, bool(improve), stop)
    pieces, order = pieces_of(problem), giant.order
    small = order[~pieces.alone[order - 1]]
    routes = [Route((site,)) for site in costs.nodes[1:][pieces.alone].tolist()]
    limit = problem.vehicle_limit
    most = len(order) if limit is None else max(0, limit - len(routes))
    if math.isinf(pieces.segment):
        routes = [Route(tuple(costs.nodes[order].tolist()))]
    elif not pieces.demand[small - 1].any():
        routes += [Route(tuple(costs.nodes[small].tolist()))] if len(small) else []
    else:
        last = cheapest_cut(stop.flag, pieces.demand[small - 1], pieces.segment, pieces.capacity, most, in_rows(costs.moves, small))
        routes += routes_of(costs.nodes[small], last)
    answer = Routes(tuple(routes)).canonical()
    cut, guarantee = stop.reached(), None
    if not cut and (judged := problem.evaluate(answer)).feasible:
        guarantee = radial_guarantee(problem, giant, judged.values[0], plain=limit is None)
    statistics = {"tour": giant.length, "routes": len(answer)}
    return ended(answer, cut, statistics, giant.message, too_many(problem, answer, "tour partitioning"), guarantee=guarantee)
