"""Greedy orienteering: the site of the largest reward, or reward for the distance it adds, while any fits."""

from __future__ import annotations

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .insertion_steps.site_data import site_data

FEATURES = frozenset(
    {
        "objective:reward", "optional-sites", "capacity", "time-windows", "depot-windows", "service-times",
        "max-duration", "max-distance", "limited-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations",
    }
)  # fmt: skip
RULES = ("density", "reward")


def greedy_orienteering(problem: RoutingProblem, context: Context, *, by: str | None = None) -> Outcome:
    """Add one site after the other where it adds the least distance, while any fits.

    Parameters
    ----------
    problem : RoutingProblem
        One vehicle type.
    context : Context
    by : str
        What is added first: the largest ``reward``, or ``density``, reward for the distance that is added. Both, and the better answer,
        where it is not given.

    Returns
    -------
    Outcome
        No guarantee: both rules can be arbitrarily bad, see docs/formulations/routing.md#approximations.

    Raises
    ------
    UsageError
        For a rule that there is not, or too many sites.
    """
    if by is not None and by not in RULES:
        raise UsageError(f"by must be one of {', '.join(RULES)}, not {by!r}")
    from .insertion_steps.insertion_kernels import best_insertion

    stop, vehicle, features = context.begin(), problem.fleet[0], problem.features()
    given = site_data(problem, stop, "greedy orienteering")
    if given is None:
        return Outcome(Routes(()), message=f"nobody was sent out: {CUT_SHORT}", limit=stop.reached())
    nodes, data, limits = given
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
        visited = np.nonzero(route_of >= 0)[0]
        visited = visited[np.lexsort((place[visited], route_of[visited]))]
        ends = np.nonzero(np.diff(route_of[visited]))[0] + 1
        answer = Routes(tuple(Route(tuple(nodes[part].tolist())) for part in np.split(visited, ends) if len(part))).canonical()
        found = float(problem.sites.reward[nodes[visited]].sum())
        if not used or found > value:
            best, value, used = answer, found, rule
            context.publish(best)
    cut = stop.reached()
    return Outcome(best, statistics={"routes": len(best), "by": used}, message=CUT_SHORT if cut else "", limit=cut or "none")


HEURISTICS.add(
    "greedy-orienteering",
    Heuristic(
        name="greedy-orienteering",
        families=("routing",),
        features=FEATURES,
        run=greedy_orienteering,
        summary="the site of the largest reward, or reward for the distance it adds, while any fits",
    ),
)
