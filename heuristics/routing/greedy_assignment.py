"""Greedy assignment: the vehicle that is free first takes the next site."""

import math

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .tour_steps.cutting import ended, visits_by_route
from .tour_steps.distance_matrices import travel_matrices

FEATURES = frozenset(
    {
        "objective:makespan", "objective:longest-route", "objective:total-cost", "objective:reward", "objective:priorities",
        "objective:weights", "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "limited-fleet",
        "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "optional-sites",
    }
)  # fmt: skip


@heuristic("greedy-assignment", "routing", FEATURES, "the vehicle that is free first takes the nearest site")
def greedy_assignment(problem: RoutingProblem, context: Context) -> Outcome:
    """The vehicle that is free first takes the nearest site that it can still bring home, until no vehicle can take any.

    No guarantee: sites may be left out, required ones too, though a better plan serves them. Ties go to the first vehicle and the first
    site; vehicles leave when their depot opens.

    Source: Mitchell (2020), algorithm 6, corrected in docs/formulations/routing.md#approximations.
    """
    return _assigned(problem, context, math.nan)


@heuristic("pure-greedy", "routing", FEATURES, "the vehicle that is free first takes the site of the largest reward less weighted distance")
def pure_greedy(problem: RoutingProblem, context: Context, *, distance_weight: float = 0.0) -> Outcome:
    """The vehicle that is free first takes the site of the largest reward less weighted distance that it can still bring home.

    ``distance_weight`` is in rewards per distance, and not negative. No guarantee: sites may be left out.

    Source: Mitchell (2020), (6.1), corrected in docs/formulations/routing.md#approximations.
    """
    if not (isinstance(distance_weight, int | float) and 0 <= distance_weight < math.inf):
        raise UsageError(f"distance_weight must be a finite number and not negative, not {distance_weight!r}", "out-of-range")
    return _assigned(problem, context, float(distance_weight))


def _assigned(problem: RoutingProblem, context: Context, weight: float) -> Outcome:
    from .insertion_steps.assignment_kernels import earliest_finisher

    stop, sites, customers = context.begin(), problem.sites, problem.customers
    matrices = travel_matrices(problem, np.arange(len(sites)), stop, "greedy assignment")
    if matrices is None:
        return Outcome(Routes(()), message=f"nobody was sent out: {CUT_SHORT}", limit=stop.reached())
    kinds = np.repeat(
        np.arange(len(problem.fleet)), [len(customers) if v.count is None else min(v.count, len(customers)) for v in problem.fleet]
    )  # fmt: skip
    fleet = [problem.fleet[k] for k in kinds]
    of_sites = (~sites.depot, sites.demand, sites.service, sites.ready, sites.due, sites.reward)
    of_vehicles = (
        np.array([v.start for v in fleet], dtype=np.int64), np.array([v.end for v in fleet], dtype=np.int64),
        np.array([v.capacity for v in fleet]), np.array([v.max_duration for v in fleet]), np.array([v.max_distance for v in fleet]),
    )  # fmt: skip
    vehicle_of, place = earliest_finisher(stop.flag, of_sites, of_vehicles, *matrices, weight)
    parts = visits_by_route(vehicle_of, place)
    answer = Routes(tuple(Route(tuple(part.tolist()), int(kinds[vehicle_of[part[0]]])) for part in parts)).canonical()
    unserved, cut = len(customers) - sum(map(len, parts)), stop.reached()
    message = f"{unserved:,} sites are left that no vehicle can take any more" if unserved and not cut else ""
    return ended(answer, cut, {"routes": len(answer), "left": unserved}, message)
