"""Tour splitting: one tour, cut so that the longest of a given number of routes is short."""

import numpy as np

from ...formulations.routing.objective import LongestRoute
from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ..heuristic import Context, Outcome, heuristic
from .tour_steps.cutting import ended, in_turn, no_time, routes_of
from .tour_steps.giant_tour import giant_tour, guaranteed, in_rows, moving_costs

FEATURES = frozenset(
    {"objective:makespan", "objective:longest-route", "service-times", "limited-fleet", "fixed-cost", "separate-durations"}
)

SOURCE = "Frederickson, Hecht and Kim (1978), Approximation algorithms for some routing problems, SIAM Journal on Computing 7, theorem 4"


@heuristic(
    "tour-splitting",
    "routing", FEATURES, "a tour through all customers, cut so that the longest route is short",
    stated="5/2 - 1/k for k vehicles, with Christofides' tour, where moves are metric",
)  # fmt: skip
def tour_splitting(problem: RoutingProblem, context: Context, *, tour: str = "christofides", improve: bool = True) -> Outcome:
    """Build one tour, and cut it into as many routes as there are vehicles so that the longest is as short as this order allows.

    Takes one depot and one vehicle type, every site required; the longest route, by duration or distance, is what counts. The guarantee
    holds where moves are symmetric and keep the triangle inequality, or miss it by little.

    Source: Frederickson, Hecht and Kim (1978), whose cuts, at ``(j/k) (T - 2 d_max) + d_max`` along a tour of length T, are one of the ways
    that are compared here. Half of each service is counted in the moves before and after it. docs/formulations/routing.md#approximations.

    Parameters
    ----------
    tour : str
        ``christofides``, ``double-tree`` (twice the shortest tour in place of one and a half times), or ``nearest-neighbour`` (no
        ratio).
    improve : bool
        Shorten the tour by 2-opt and Or-opt before it is cut.
    """
    from .tour_steps.splitting_kernels import even_split

    stop = context.begin()
    distance = problem.objective.is_only(LongestRoute)
    costs = moving_costs(problem, stop, busy=not distance, distance=distance)
    if costs is None:
        return no_time(in_turn(problem), stop)
    giant = giant_tour(costs, tour, bool(improve), stop)
    n, limit = len(giant.order), problem.vehicle_limit
    most = max(1, n if limit is None else min(limit, n))
    sites = costs.nodes[giant.order]
    last = even_split(stop.flag, in_rows(costs.moves, giant.order), most)
    if n and not last[-1]:  # it was asked to stop: as many customers to each vehicle
        last[np.ceil(np.arange(1, most + 1) * n / most).astype(np.int64) - 1] = True
    answer = Routes(tuple(routes_of(sites, last))).canonical()
    value, cut = problem.evaluate(answer).values[0], stop.reached()
    farthest = float(giant.paths[0].max(initial=0.0))
    statement = f"longest route <= ({giant.ratio} + 1 - 1/{most}) OPT"
    # (T - 2 d_max)/k + 2 d_max, of which 2 d_max <= OPT and T <= ratio k OPT
    guarantee = guaranteed(
        giant, value, 2.0 * farthest, 1.0 - 1.0 / most, 1.0 / most, statement, (f"{most} vehicles",), f"{SOURCE}, with {giant.source}",
        vehicles=most,
    )  # fmt: skip
    return ended(answer, cut, {"tour": giant.length, "routes": len(answer)}, giant.message, guarantee=guarantee)
