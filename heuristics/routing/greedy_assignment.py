"""Greedy assignment: the vehicle that is free first takes the next site."""

from __future__ import annotations

import math

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .tour_steps.dense import dense

FEATURES = frozenset(
    {
        "objective:makespan", "objective:longest-route", "objective:total-cost", "objective:reward", "objective:priorities",
        "objective:weights", "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "limited-fleet",
        "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "optional-sites",
    }
)  # fmt: skip


def greedy_assignment(problem: RoutingProblem, context: Context) -> Outcome:
    """The vehicle that is free first takes the nearest site that it can still bring home, until no vehicle can take any.

    Parameters
    ----------
    problem : RoutingProblem
    context : Context

    Returns
    -------
    Outcome
        No guarantee. Sites may be left out, required ones too, though a better plan serves them.

    Raises
    ------
    UsageError
        If there are too many sites.

    Notes
    -----
    Ties go to the first vehicle and the first site. Vehicles leave when their depot opens. Source: Mitchell (2020), algorithm 6, corrected
    in docs/formulations/routing.md#approximations.
    """
    return _assigned(problem, context, math.nan)


def pure_greedy(problem: RoutingProblem, context: Context, *, distance_weight: float = 0.0) -> Outcome:
    """The vehicle that is free first takes the site of the largest reward less weighted distance that it can still bring home.

    Parameters
    ----------
    problem : RoutingProblem
    context : Context
    distance_weight : float, reward per distance, >= 0

    Returns
    -------
    Outcome
        No guarantee. Sites may be left out.

    Raises
    ------
    UsageError
        For a weight out of range, or too many sites.

    Notes
    -----
    Source: Mitchell (2020), (6.1), corrected in docs/formulations/routing.md#approximations.
    """
    if not (isinstance(distance_weight, int | float) and 0 <= distance_weight < math.inf):
        raise UsageError(f"distance_weight must be a finite number and not negative, not {distance_weight!r}")
    return _assigned(problem, context, float(distance_weight))


def _assigned(problem: RoutingProblem, context: Context, weight: float) -> Outcome:
    from .insertion_steps.assignment_kernels import earliest_finisher

    stop, sites, customers = context.begin(), problem.sites, problem.customers
    found = _matrices(problem, stop)
    if found is None:
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
    vehicle_of, place = earliest_finisher(stop.flag, of_sites, of_vehicles, *found, weight)
    served = np.nonzero(vehicle_of >= 0)[0]
    served = served[np.lexsort((place[served], vehicle_of[served]))]
    starts = np.nonzero(np.diff(vehicle_of[served], prepend=-1))[0]
    parts = np.split(served, starts[1:]) if len(served) else []
    answer = Routes(tuple(Route(tuple(part.tolist()), int(kinds[vehicle_of[part[0]]])) for part in parts)).canonical()
    left, cut = len(customers) - len(served), stop.reached()
    words = (f"{left:,} sites are left that no vehicle can take any more" if left and not cut else "", CUT_SHORT if cut else "")
    return Outcome(answer, statistics={"routes": len(answer), "left": left}, message="; ".join(w for w in words if w), limit=cut or "none")


def _matrices(problem: RoutingProblem, stop: Stop) -> tuple[np.ndarray, np.ndarray] | None:
    every, travel = np.arange(len(problem.sites)), problem.travel
    distance = dense(travel.distance, every, stop, "greedy assignment")
    time = distance if not travel.own_durations or distance is None else dense(travel.duration, every, stop, "greedy assignment")
    return None if distance is None or time is None else (distance, time)


HEURISTICS.add(
    "greedy-assignment",
    Heuristic(
        name="greedy-assignment",
        families=("routing",),
        features=FEATURES,
        run=greedy_assignment,
        summary="the vehicle that is free first takes the nearest site",
    ),
)
HEURISTICS.add(
    "pure-greedy",
    Heuristic(
        name="pure-greedy",
        families=("routing",),
        features=FEATURES,
        run=pure_greedy,
        summary="the vehicle that is free first takes the site of the largest reward less weighted distance",
    ),
)
