"""Brute force for small routing problems, written from the definitions; it shares no code with the package's judge, forms or checkers.

Also the small instances that tests share, and what every form of a routing problem has to fulfil.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from waybound.formulations.programs.program import Program
from waybound.formulations.routing.objective import Objective, Reward, TotalCost, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import Travel

SLACK = 1e-9


def route_is_feasible(problem: RoutingProblem, kind: VehicleType, visits: tuple[int, ...]) -> bool:
    """Whether one vehicle can drive this route."""
    sites, stops = problem.sites, (kind.start, *visits, kind.end)
    d = [float(problem.travel.distances[i, j]) for i, j in itertools.pairwise(stops)]
    move = [float(problem.travel.durations[i, j]) for i, j in itertools.pairwise(stops)]
    serve = [0.0] + [float(sites.service[i]) for i in visits]
    busy = [s + m for s, m in zip(serve, move, strict=True)]
    if sum(float(sites.demand[i]) for i in visits) > kind.capacity + SLACK or sum(d) > kind.max_distance + SLACK:
        return False
    opens, closes = [float(sites.ready[i]) for i in stops], [float(sites.due[i]) for i in stops]
    clock = opens[0]
    for k, site in enumerate(visits, start=1):
        clock = max(clock + busy[k - 1], float(sites.ready[site]))
        if clock > closes[k] + SLACK:
            return False
    home = clock + busy[-1]
    if home > closes[-1] + SLACK:
        return False
    latest = closes[-1]
    for k in range(len(stops) - 2, -1, -1):
        latest = min(closes[k], latest - busy[k])
    shortest = max(home - latest, sum(busy))
    if shortest > kind.max_duration + SLACK:
        return False
    if kind.energy is None:
        return True
    charged = {
        "travel": sum(move),
        "elapsed": shortest,
        "elapsed-fixed-start": home - opens[0],
        "windows": sum(max(b, opens[k + 1] - opens[k]) if k < len(visits) else b for k, b in enumerate(busy)),
    }[kind.energy.charge]
    return kind.energy.rate * charged <= kind.energy.capacity + SLACK


def route_value(problem: RoutingProblem, kind: VehicleType, visits: tuple[int, ...]) -> float:
    """Share of one route in the first level of the objective."""
    stops = (kind.start, *visits, kind.end)
    length = sum(float(problem.travel.distances[i, j]) for i, j in itertools.pairwise(stops))
    terms = {
        "total-cost": kind.fixed_cost + kind.unit_cost * length,
        "vehicles": 1.0,
        "reward": sum(float(problem.sites.reward[i]) for i in visits),
    }
    return sum(w * terms[t.name] for w, t in problem.objective.levels()[0].terms)


def best_routes(problem: RoutingProblem) -> list[dict[frozenset[int], float]]:
    """For each vehicle type, the value of the best feasible route through each set of customers."""
    better = min if problem.sense == "min" else max
    customers = [k for k in range(len(problem.sites)) if not problem.sites.depot[k]]
    tables = []
    for kind in problem.fleet:
        table: dict[frozenset[int], float] = {}
        for size in range(1, len(customers) + 1):
            for visits in itertools.permutations(customers, size):
                if route_is_feasible(problem, kind, visits):
                    value, key = route_value(problem, kind, visits), frozenset(visits)
                    table[key] = better(table.get(key, value), value)
        tables.append(table)
    return tables


def optimum(problem: RoutingProblem) -> float | None:
    """Value of the best answer by enumeration; None if there is none."""
    better = min if problem.sense == "min" else max
    customers = frozenset(k for k in range(len(problem.sites)) if not problem.sites.depot[k])
    must = frozenset(k for k in customers if problem.sites.required[k])
    # (sites served, routes used) -> best value; each set of routes is met once, by its smallest site first
    states: dict[tuple[frozenset[int], int], float] = {(frozenset(), 0): 0.0}
    for kind, table in zip(problem.fleet, best_routes(problem), strict=True):
        count = len(customers) if kind.count is None else min(kind.count, len(customers))
        layer = dict(states)
        for _ in range(count):
            following: dict[tuple[frozenset[int], int], float] = {}
            for (served, routes), value in layer.items():
                for visits, cost in table.items():
                    if not visits & served:
                        key = (served | visits, routes + 1)
                        following[key] = better(following.get(key, value + cost), value + cost)
            for key, value in following.items():
                states[key] = better(states.get(key, value), value)
            layer = following
    found = [value for (served, routes), value in states.items() if must <= served and routes >= problem.min_vehicles]
    return better(found) if found else None


def set_partitioning_bound(problem: RoutingProblem) -> float:
    """LP value of choosing routes from all feasible ones (one vehicle type, all customers required, total cost)."""
    from scipy.optimize import linprog

    (table,) = best_routes(problem)
    customers = [k for k in range(len(problem.sites)) if not problem.sites.depot[k]]
    columns = list(table)
    visits = np.array([[float(i in s) for s in columns] for i in customers])
    count = problem.fleet[0].count
    found = linprog(
        [table[s] for s in columns], A_eq=visits, b_eq=np.ones(len(customers)),
        A_ub=np.ones((1, len(columns))), b_ub=[len(customers) if count is None else count],
    )  # fmt: skip
    return math.inf if found.fun is None else float(found.fun)


# -- forms -----------------------------------------------------------------------------------------------------------

TWO_INDEX = ("two-index-mtz", "two-index-load-flow", "two-index-time-flow")
ROUTING_FORMS = ("three-index", *TWO_INDEX)


def solved(program: Program) -> tuple[str, float, Any]:
    """HiGHS' status (``optimal`` or ``infeasible``), optimum and point."""
    import highspy

    if program.num_variables == 0:  # HiGHS judges no rows without columns
        x = np.zeros(0)
        return ("optimal", program.offset, x) if program.residual(x) == 0 else ("infeasible", math.nan, None)
    model = program.to_highs()
    model.setOptionValue("mip_rel_gap", 0.0)
    model.setOptionValue("mip_abs_gap", 0.0)
    model.setOptionValue("threads", 1)
    model.run()
    status = model.getModelStatus()
    if status == highspy.HighsModelStatus.kOptimal:
        return "optimal", float(model.getInfo().objective_function_value), np.array(model.getSolution().col_value)
    assert status in (highspy.HighsModelStatus.kInfeasible, highspy.HighsModelStatus.kUnboundedOrInfeasible), status
    return "infeasible", math.nan, None


def agrees(problem: RoutingProblem, form: str, expected: float | None) -> None:
    """``form`` finds ``expected`` (None: no answer); its answer passes the judge, and can be written back as a point of the program."""
    made = problem.compile(form)
    program = made.program
    status, value, x = solved(program)
    if expected is None:
        assert status == "infeasible", (form, value, made.decode(x))
        return
    assert status == "optimal", (form, expected)
    assert value == pytest.approx(expected, abs=1e-6), form
    answer = made.decode(x)
    verdict = problem.evaluate(answer)
    assert verdict.feasible, verdict.violations
    assert verdict.values[0] == pytest.approx(expected, abs=1e-6)
    assert made.encode is not None
    back = made.encode(answer)
    assert program.residual(back) <= 1e-7
    assert program.value(back) == pytest.approx(expected, abs=1e-6)
    assert made.decode(back).canonical() == answer.canonical()


# -- instances -------------------------------------------------------------------------------------------------------

SQUARE_4 = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)
GAP_5 = np.array([(5, 5), (0, 7), (1, 6), (2, 10), (0, 2), (1, 8)], dtype=float)
OCTO_8 = np.array([(0, 0), (2, 7), (5, 3), (8, 8), (-4, 6), (-7, 1), (-3, -5), (4, -6), (9, -2)], dtype=float)
ASYM_5 = np.array(
    [[0, 4, 7, 3, 6, 5], [5, 0, 2, 6, 4, 8], [6, 3, 0, 5, 2, 7], [3, 5, 4, 0, 7, 2], [7, 4, 3, 6, 0, 3], [4, 9, 6, 2, 3, 0]], dtype=float
)
TW_4 = {"ready": [0, 0, 0, 10, 0], "due": [math.inf, 20, 6, 12, 4]}


def routing(
    *, xy: Any = None, matrix: Any = None, metric: str = "euclidean", objective: Any = None, durations: Any = None, fleet: Any = None,
    min_vehicles: int = 0, sites: dict[str, Any] | None = None, **vehicle: Any,
) -> RoutingProblem:  # fmt: skip
    """A routing problem from plain numbers; ``vehicle`` are the keywords of one VehicleType."""
    travel = (
        Travel(metric, coordinates=xy, duration_matrix=durations)
        if matrix is None
        else Travel("EXPLICIT", matrix=matrix, duration_matrix=durations)
    )
    places = Sites.of(range(len(travel)), coordinates=xy, **(sites or {}))
    return RoutingProblem(places, travel, fleet or (VehicleType(**vehicle),), Objective.of(objective or TotalCost()), min_vehicles)


@st.composite
def small_problems(draw: st.DrawFn, most: int = 4, hetero: bool = False) -> RoutingProblem:
    """Small routing problems with any mix of features; matrices may be asymmetric, break the triangle inequality, and hold zeros."""
    n = draw(st.integers(1, most)) + 1
    whole = lambda low, high, size=n: np.array(draw(st.lists(st.integers(low, high), min_size=size, max_size=size)), dtype=float)  # noqa: E731
    maybe = lambda: draw(st.booleans())  # noqa: E731
    xy = None
    if maybe():
        xy = np.column_stack([whole(0, 6), whole(0, 6)])
        matrix = np.sqrt(((xy[:, None] - xy[None]) ** 2).sum(-1))
    else:
        matrix = whole(0, 9, n * n).reshape(n, n)
        if maybe():
            matrix = np.minimum(matrix, matrix.T)
    np.fill_diagonal(matrix, 0.0)
    durations = whole(0, 9, n * n).reshape(n, n) if draw(st.integers(0, 3)) == 0 else None
    sites: dict[str, Any] = {"demand": whole(0, 5), "reward": whole(0, 9)}
    if maybe():
        sites["service"] = whole(0, 3)
    if maybe():
        ready = whole(0, 15)
        due = ready + whole(0, 25)
        if maybe():
            ready[0] = draw(st.integers(-3, 3))
            due[0] = ready[0] + draw(st.integers(0, 50))
        else:
            ready[0], due[0] = 0.0, math.inf
        due[1:][whole(0, 2, n - 1) == 0] = math.inf
        sites["ready"], sites["due"] = ready, due
    if draw(st.integers(0, 3)) == 0:
        sites["required"] = whole(0, 1) > 0

    def vehicle(name: str) -> VehicleType:
        energy = None
        if draw(st.integers(0, 2)) == 0:
            charge = draw(st.sampled_from(["travel", "elapsed", "elapsed-fixed-start", "windows"]))
            energy = Energy(draw(st.integers(5, 60)), draw(st.sampled_from([0.5, 1.0, 2.0])), charge)
        limit = lambda low, high: float(draw(st.integers(low, high))) if draw(st.integers(0, 3)) == 0 else math.inf  # noqa: E731
        return VehicleType(
            count=draw(st.one_of(st.none(), st.integers(1, n))), capacity=limit(5, 12), max_duration=limit(5, 40),
            max_distance=limit(5, 30), energy=energy, fixed_cost=float(draw(st.integers(0, 5))),
            unit_cost=draw(st.sampled_from([1.0, 1.0, 0.5, 0.0])), name=name,
        )  # fmt: skip

    fleet = tuple(vehicle(f"type {k}") for k in range(draw(st.integers(2, 3)) if hetero else 1))
    total = [v.count for v in fleet]
    top = n - 1 if None in total else min(n - 1, sum(c or 0 for c in total))
    objective = draw(
        st.sampled_from([TotalCost(), TotalCost(), Vehicles(), Vehicles() * 10 + TotalCost(), Reward() - 0.5 * TotalCost(), Reward()])
    )
    least = draw(st.integers(0, top)) if maybe() else 0
    travel = Travel("EXPLICIT", coordinates=xy, matrix=matrix, duration_matrix=durations)
    places = Sites.of(range(n), coordinates=xy, **sites)
    return RoutingProblem(places, travel, fleet, Objective.of(objective), least, name="drawn")
