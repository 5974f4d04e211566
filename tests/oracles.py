"""The small routing instances that tests share, and what every form has to fulfil."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from scipy.optimize import linprog
from truth.routing import RoutingTruth, best_values

from waybound import Energy, Objective, Program, Reward, RoutingProblem, Sites, TotalCost, Travel, UnsupportedError, Vehicles, VehicleType
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.cpsat import CpSat
from waybound.solvers.backends.outer_approximation import OuterApproximation


def optimum(problem: RoutingProblem) -> float | None:
    """Value of the best answer in the first level of the objective; None if there is none."""
    found = best_values(problem)
    return None if found is None else found[0]


def set_partitioning_bound(problem: RoutingProblem, fewest: int = 0) -> float:
    """LP value of choosing ``fewest`` routes or more from all feasible ones (one vehicle type, all customers required, total cost)."""
    truth = RoutingTruth(problem)
    columns = list(truth.driven)
    visits = np.array([[float(i in route) for _, route in columns] for i in problem.customers])
    count = problem.fleet[0].count
    found = linprog(
        [float(truth.values([c])[0]) for c in columns], A_eq=visits, b_eq=np.ones(len(visits)),
        A_ub=np.outer([1.0, -1.0], np.ones(len(columns))), b_ub=[len(visits) if count is None else count, -fewest],
    )  # fmt: skip
    return math.inf if found.fun is None else float(found.fun)


# -- forms -----------------------------------------------------------------------------------------------------------

TWO_INDEX = ("two-index-mtz", "two-index-load-flow", "two-index-time-flow", "two-index-unit-flow")
ROUTING_FORMS = ("three-index", *TWO_INDEX)
EVERY_FORM = (*ROUTING_FORMS, "circuit")


def solved(program: Program) -> tuple[str, float, Any]:
    """HiGHS' status (``optimal`` or ``infeasible``), optimum and point; of programs with circuits CP-SAT's, or that it refuses them; of
    those with cones that of outer approximation."""
    import highspy

    if program.circuits:
        try:
            result = CpSat().run(program, Options(gap=0.0), Control())
        except UnsupportedError:
            return "refused", math.nan, None
        assert result.status in ("optimal", "infeasible"), result
        return result.status, math.nan if result.objective is None else result.objective, result.answer
    if program.cones:
        result = OuterApproximation().run(program, Options(gap=0.0), Control())
        assert result.status in ("optimal", "infeasible"), result
        return result.status, math.nan if result.objective is None else result.objective, result.answer
    if program.num_variables == 0:  # HiGHS judges no rows without columns
        x = np.zeros(0)
        return ("optimal", program.offset, x) if program.residual(x) == 0 else ("infeasible", math.nan, None)
    model = program.to_highs()
    model.setOptionValue("mip_rel_gap", 0.0)
    model.setOptionValue("mip_abs_gap", 0.0)
    model.setOptionValue("threads", 1)
    for tolerance in ("primal_feasibility_tolerance", "mip_feasibility_tolerance"):  # what a row of time is broken by has a price
        model.setOptionValue(tolerance, 1e-9)
    model.setOptionValue("presolve_rule_off", 4096)  # HiGHS 1.12 to 1.15 cut optima of tiny routing programs off with it (HiGHS#3090)
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
    if status == "refused":
        return
    if expected is None:
        assert status == "infeasible", (form, value, made.decode(x))
        return
    assert status == "optimal", (form, expected)
    assert value == pytest.approx(expected, abs=1e-6), form
    answer = made.decode(x)
    verdict = problem.evaluate(answer)
    assert verdict.feasible, verdict.violations
    assert verdict.values[0] == pytest.approx(expected, abs=1e-6)
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
MIN_COST = [
    ("SQUARE-4", 4, 10.0, 30.0), ("SQUARE-4", 2, 12.0, 24.0), ("SQUARE-4", 2, 14.0, 20.0), ("SQUARE-4", 1, 18.0, 18.0),
    ("SQUARE-4", 4, 9.99, None), ("SQUARE-4", 2, 11.9, None), ("SQUARE-4", 2, math.inf, 18.0),
    ("GAP-5", 1, 28.0, 28.0), ("GAP-5", 1, 27.9, None), ("GAP-5", 2, 26.0, 36.0), ("GAP-5", 2, 20.0, 36.0),
    ("ASYM-5", 1, math.inf, 16.0), ("ASYM-5", 1, 16.0, 16.0), ("ASYM-5", 2, 14.0, 26.0), ("ASYM-5", 3, 14.0, 26.0),
    ("ASYM-5", 5, 13.0, 31.0), ("ASYM-5", 5, 12.0, None),
]  # fmt: skip
"""Instance, vehicles, the longest route that is allowed, and the least cost."""
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
