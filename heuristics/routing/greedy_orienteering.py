"""Greedy orienteering: the site of the largest reward, or reward for the distance it adds, while any fits."""

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .tour_steps.cutting import ended, visits_by_route
from .tour_steps.distance_matrices import site_data

FEATURES = frozenset(
    {
        "objective:reward", "optional-sites", "capacity", "time-windows", "depot-windows", "service-times",
        "max-duration", "max-distance", "limited-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations",
    }
)  # fmt: skip
RULES = ("density", "reward")


@heuristic("greedy-orienteering", "routing", FEATURES, "the site of the largest reward, or reward for the distance it adds, while any fits")
def greedy_orienteering(problem: RoutingProblem, context: Context, *, by: str | None = None) -> Outcome:
    """Add one site after the other where it adds the least distance, while any fits.

    ``by`` says which site is next: that of the largest ``reward``, or ``density``, reward for the distance that is added; by default both
    are tried, and the better answer counts. Takes one vehicle type. No guarantee: both rules can be arbitrarily bad, see
    docs/formulations/routing.md#approximations.
    """
    if by is not None and by not in RULES:
        raise UsageError(f"by must be one of {', '.join(RULES)}, not {by!r}", "unknown-name")
    from .insertion_steps.insertion_kernels import best_insertion

    stop, vehicle, features = context.begin(), problem.fleet[0], problem.features()
    node_data = site_data(problem, stop, "greedy orienteering")
    if node_data is None:
        return Outcome(Routes(()), message=f"nobody was sent out: {CUT_SHORT}", limit=stop.reached())
    nodes, data, limits = node_data
    fleet = len(problem.customers) if vehicle.count is None else min(vehicle.count, len(problem.customers))
    timed, distance = bool(features & {"time-windows", "depot-windows"}), data[4]
    inward = distance if (distance == distance.T).all() else np.ascontiguousarray(distance.T)
    kept = not timed and (data[5] is distance or vehicle.max_duration == np.inf)
    wanted = np.where(problem.sites.required, np.inf, problem.sites.reward)[nodes]  # whoever must be visited comes first
    best, value, used = Routes(()), -np.inf, ""
    for rule in RULES if by is None else (by,):
        if used and stop.reached():
            break
        route_of, place = best_insertion(stop.flag, data, inward, wanted, fleet, vehicle.capacity, limits, timed, kept, rule == "density")
        answer = Routes(tuple(Route(tuple(nodes[part].tolist())) for part in visits_by_route(route_of, place))).canonical()
        reward = float(problem.sites.reward[nodes[route_of >= 0]].sum())
        if not used or reward > value:
            best, value, used = answer, reward, rule
            context.publish(best)
    return ended(best, stop.reached(), {"routes": len(best), "by": used})
