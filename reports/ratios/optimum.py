"""Optima of small instances, each with an answer that attains it, found without any heuristic of the toolkit."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Evidence
from ...formulations.problem import Problem
from ...formulations.routing.objective import LongestRoute, Makespan, Reward, TotalCost
from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.feasibility import allowed
from ...formulations.sata.max_min_lp import MaxMinLP
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.verified_bounds import verified_bound
from ...instances.errors import CheckFailedError, UsageError

Floats = NDArray[np.float64]

MOST_ELEMENTS = 16
"""Ground sets up to this size are enumerated: 65536 sets."""

MOST_SELECTIONS = 200_000
"""Combinations of robots' actions up to which they are enumerated."""

AGREE = 1e-6
"""Relative difference allowed between the primal and dual value of a linear program."""


MOST_CUSTOMERS = 10
"""Customers up to which all ways to share them among routes are compared: 59049."""


@dataclass(frozen=True)
class Optimum:
    """The optimum, recomputed from an answer by ``problem.evaluate``, and its source."""

    value: float
    answer: Any
    source: str


def attained(problem: Problem, answer: Any, source: str) -> Optimum:
    """The value of ``answer``, which is said to be optimal. Raises CheckFailedError if it fails its check."""
    judged = problem.evaluate(answer)
    if not judged.feasible:
        raise CheckFailedError(f"the answer of {source} to {problem.name} fails its check: {judged.violations[0].message}")
    return Optimum(judged.values[0], answer, source)


def optimum(problem: Problem) -> Optimum:
    """The optimum of a small problem: by enumeration, or by a linear program whose duals are multiplied out.

    Raises UsageError if the problem is too large or of another family, CheckFailedError if the two sides of a linear program disagree.
    """
    if isinstance(problem, SubmodularSelection):
        return best_selection(problem)
    if isinstance(problem, BottleneckSATA):
        return best_shares(problem) if problem.fractional else best_actions(problem)
    if isinstance(problem, MaxMinLP) and problem.sense == "max":
        return best_vector(problem)
    if isinstance(problem, RoutingProblem):
        return best_routes(problem)
    raise UsageError(f"no optimum is known for {problem.problem} problems")


# -- selections -------------------------------------------------------------------------------------------------------


def set_values(problem: SubmodularSelection) -> Floats:
    """f of every subset of the ground set, shape (2^elements,); bit e of the position is element e."""
    n, f = problem.num_elements, problem.function
    weights = f.as_item_weights()
    if weights is None:
        return f.values(_members(n))
    worth = np.zeros((n, weights.num_items))
    element, item, weight = weights.edges()
    worth[element, item] = weight
    best = np.zeros((1, worth.shape[1]))
    for row in worth:  # the sets with one element more, beside those without it
        best = np.concatenate([best, np.maximum(best, row)])
    return np.asarray(best.sum(axis=1))


def allowed_sets(problem: SubmodularSelection) -> NDArray[np.bool_]:
    """Whether the constraint allows each subset, in the order of ``set_values``."""
    return allowed(problem.constraint, _members(problem.num_elements))


def best_selection(problem: SubmodularSelection) -> Optimum:
    """The best subset that the constraint allows."""
    if problem.num_elements > MOST_ELEMENTS:
        raise UsageError(f"{problem.num_elements} elements are too many to enumerate; at most {MOST_ELEMENTS} are")
    values = np.where(allowed_sets(problem), set_values(problem), -math.inf)
    best = int(values.argmax())
    return attained(problem, Selection(tuple(e for e in range(problem.num_elements) if best >> e & 1)), "enumeration")


@functools.lru_cache(maxsize=MOST_ELEMENTS + 1)
def _members(n: int) -> NDArray[np.bool_]:
    members: NDArray[np.bool_] = (np.arange(1 << n)[:, None] >> np.arange(n)) & 1 == 1
    members.setflags(write=False)
    return members


# -- robots and targets -----------------------------------------------------------------------------------------------


def best_actions(problem: BottleneckSATA) -> Optimum:
    """The best way to give each robot one action."""
    g = problem.graph
    starts, actions = g.by_robot
    own = [actions[starts[i] : starts[i + 1]].tolist() for i in range(g.num_robots) if starts[i] < starts[i + 1]]
    if math.prod(len(o) for o in own) > MOST_SELECTIONS:
        raise UsageError(f"{g.name} has too many robots to enumerate")
    chosen = np.array(list(itertools.product(*own)), dtype=np.int64).reshape(-1, len(own))
    worth = np.zeros((g.num_actions, g.num_targets))
    worth[g.action_of_edge, g.indices] = g.weights
    least = np.zeros((len(chosen), g.num_targets))
    for column in chosen.T:
        least += worth[column]
    return attained(problem, Selection.of(chosen[least.min(axis=1).argmax()]), "enumeration")


def best_shares(problem: BottleneckSATA) -> Optimum:
    """The optimum of the max-min LP (3.5) of Sung (2019)."""
    g = problem.graph
    packing, covering = np.zeros((g.num_robots, g.num_actions)), np.zeros((g.num_targets, g.num_actions))
    packing[g.robot_of_action, np.arange(g.num_actions)] = 1.0
    covering[g.indices, g.action_of_edge] = g.weights
    x, y = _max_min(packing, covering)
    shares = x / np.maximum(packing @ x, 1.0)[g.robot_of_action]  # the solver keeps rows up to a tolerance only
    evidence = {"targets": list(range(g.num_targets)), "weights": y.tolist()}
    best = attained(problem, shares, "linear program")
    _agree(problem, best.value, verified_bound(problem, Evidence("target-weights", "linear program", math.nan, evidence)))
    return best


def best_vector(problem: MaxMinLP) -> Optimum:
    """The optimum of a general max-min LP."""
    packing, covering = problem.packing.scipy.toarray(), problem.covering.scipy.toarray()
    x, y = _max_min(packing, covering)
    values = x / max(1.0, float((packing @ x).max()))
    best = attained(problem, values, "linear program")
    # By duality the optimum of covering is that of: min sum z, A'z >= C'y, sum y = 1. Solved for z alone with y fixed, it bounds.
    from scipy.optimize import linprog

    total = float(y.sum())
    if total > 0:
        other: Any = linprog(np.ones(len(packing)), A_ub=-packing.T, b_ub=-(covering.T @ (y / total)), method="highs")
        _agree(problem, best.value, float(other.fun))
    return best


def _max_min(packing: Floats, covering: Floats) -> tuple[Floats, Floats]:
    """A point that maximises the least entry of ``covering x`` subject to ``packing x <= 1``, and its dual weights of the covering rows."""
    from scipy.optimize import linprog

    n = covering.shape[1]
    scale = float(covering.max(initial=0.0)) or 1.0  # tolerances are absolute
    rows = np.block([[packing, np.zeros((len(packing), 1))], [-covering / scale, np.ones((len(covering), 1))]])
    right = np.concatenate([np.ones(len(packing)), np.zeros(len(covering))])
    cost = np.zeros(n + 1)
    cost[n] = -1.0
    options: Any = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    solved: Any = linprog(cost, A_ub=rows, b_ub=right, method="highs-ds", options=options)
    if solved.status != 0:
        raise CheckFailedError(f"the linear program of the optimum was not solved: {solved.message}")
    return np.maximum(solved.x[:n], 0.0), np.maximum(-solved.ineqlin.marginals[len(packing) :], 0.0)


def _agree(problem: Problem, value: float, bound: float) -> None:
    """Raise CheckFailedError unless a value that some answer attains meets a bound; where nothing is covered, no weights bound it."""
    if not (value == 0.0 and math.isinf(bound)) and abs(bound - value) > AGREE * max(abs(value), abs(bound), 1e-9):
        raise CheckFailedError(f"the linear program of {problem.name} has an answer of {value!r} and a bound of {bound!r}")


def _shortest_paths(moves: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Lengths of shortest paths from stop 0 through every set of the others to each of them, and the stop before; shape (2^n, n)."""
    n = len(moves) - 1
    ends, before = np.full((1 << n, n), math.inf), np.full((1 << n, n), -1)
    for k in range(n):
        ends[1 << k, k] = moves[0, k + 1]
    for chosen in range(1, 1 << n):
        for k in range(n):
            if chosen >> k & 1 and chosen != 1 << k:
                ways = ends[chosen ^ 1 << k] + moves[1:, k + 1]
                before[chosen, k] = ways.argmin()
                ends[chosen, k] = ways.min()
    return ends, before


# -- routes -----------------------------------------------------------------------------------------------------------


def best_routes(problem: RoutingProblem) -> Optimum:
    """The best routes of vehicles of one type whose only limits are capacity and distance.

    The shortest tour of every set of customers (Held and Karp 1962), and the best way to share all customers among such sets, or some of
    them where rewards are collected. Raises UsageError for other limits or objectives and too many customers, CheckFailedError if there is
    no answer.
    """
    longest = problem.objective.is_only(LongestRoute) or problem.objective.is_only(Makespan)
    rewarded = problem.objective.is_only(Reward)
    known = {
        "objective:total-cost", "objective:longest-route", "objective:makespan", "capacity", "max-distance", "limited-fleet", "fixed-cost",
        "service-times", "separate-durations", *(("objective:reward", "optional-sites") if rewarded else ()),
    }  # fmt: skip
    limits = problem.features() - known
    if limits or not (longest or rewarded or problem.objective.is_only(TotalCost)):
        raise UsageError(f"no optimum is known of routes with {', '.join(sorted(limits)) or str(problem.objective)}")
    customers, vehicle, sites = problem.customers, problem.fleet[0], problem.sites
    n = len(customers)
    if n > MOST_CUSTOMERS:
        raise UsageError(f"{n} customers are too many to enumerate; at most {MOST_CUSTOMERS} are")
    stops = np.concatenate([[vehicle.start], customers])
    timed = problem.objective.is_only(Makespan)
    moves = (problem.travel.durations if timed else problem.travel.distances)[np.ix_(stops, stops)]
    every = 1 << n
    ends, before = _shortest_paths(moves)
    tour = (ends + moves[1:, 0]).min(axis=1)
    members = _members(n)
    cost = tour + members @ sites.service[customers] if timed else tour if longest else vehicle.fixed_cost + vehicle.unit_cost * tour
    cost[members @ sites.demand[customers] > vehicle.capacity * (1 + 1e-12)] = math.inf
    cost[tour > vehicle.max_distance * (1 + 1e-12)] = math.inf
    most = n if problem.vehicle_limit is None else min(n, problem.vehicle_limit)
    best, first = np.full((most + 1, every), math.inf), np.zeros((most + 1, every), dtype=np.int64)
    best[:, 0] = 0.0
    for chosen in range(1, every):
        rest = chosen ^ (chosen & -chosen)
        part = rest
        while True:  # the sets with the first of the chosen, and any of the others
            route = chosen ^ part
            ways = np.maximum(best[:-1, part], cost[route]) if longest else best[:-1, part] + cost[route]
            better = ways < best[1:, chosen]
            best[1:, chosen][better], first[1:, chosen][better] = ways[better], route
            if part == 0:
                break
            part = (part - 1) & rest
    served = every - 1
    if rewarded:
        served = int(np.where(np.isfinite(best[most]), members @ sites.reward[customers], -math.inf).argmax())
    if not math.isfinite(best[most, served]):
        raise CheckFailedError(f"no {most} routes serve all customers of {problem.name}")
    routes, unserved, k = [], served, most
    while unserved:
        route = int(first[k, unserved])
        chosen, at, visits = route, int((ends[route] + moves[1:, 0]).argmin()), []
        while at >= 0:
            visits.append(int(customers[at]))
            chosen, at = chosen ^ 1 << at, int(before[chosen, at])
        routes.append(visits[::-1])
        unserved, k = unserved ^ route, k - 1
    return attained(problem, Routes.of(routes), "enumeration")
