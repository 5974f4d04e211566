import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from coded import coded
from oracles import GAP_5, SQUARE_4, agrees, optimum, routing, set_partitioning_bound, solved
from program_text import TWO_SITES, expected, program_text, written
from small_routing import at_risk

from waybound import Exactness, InputError, LatestReturn, LongestRoute, Makespan, Reward, Route, Routes, TotalCost, VehicleType
from waybound.formulations.forms import FORMS
from waybound.formulations.routing.forms.set_partitioning import over


def test_set_partitioning_from_text_to_text(tmp_path: Path) -> None:
    """b before a reaches a after 9: of both together there is one route."""
    assert written(TWO_SITES, "set-partitioning", tmp_path) == expected("""
        set-partitioning, exact
        min 6 y[a] + 12 y[a-b] + 10 y[b]
        visit[a]: y[a] + y[a-b] = 1
        visit[b]: y[a-b] + y[b] = 1
        vehicles[vehicle]: y[a] + y[a-b] + y[b] <= 2
        fleet: y[a] + y[a-b] + y[b] >= 1
        y[a], y[a-b], y[b] binary
    """)


def test_a_maximum_has_a_row_a_site_and_one_for_each_way_straight_home() -> None:
    """Two sites on a line, the fleet under way to a depot 5 further on: each of both must at least go there."""
    xy = np.array([(0, 0), (1, 0), (2, 0), (5, 0)], dtype=float)
    fleet = (VehicleType(2, start=0, end=3, committed=True, name="car"),)
    problem = routing(xy=xy, sites={"depot": [True, False, False, True]}, fleet=fleet, objective=Makespan())
    lines = program_text(problem.compile("set-partitioning").program).splitlines()
    assert lines == [
        "min makespan",
        "visit[1]: y[1] + y[1-2] = 1",
        "visit[2]: y[1-2] + y[2] = 1",
        "vehicles[car]: y[1] + y[1-2] + y[2] + z[car] = 2",
        "home[car]: z[car] - 2 b[car] <= 0",
        "fleet: y[1] + y[1-2] + y[2] >= 1",
        "makespan[1]: - 5 y[1] - 5 y[1-2] + makespan >= 0",
        "makespan[2]: - 5 y[1-2] - 5 y[2] + makespan >= 0",
        "makespan-home[car]: - 5 b[car] + makespan >= 0",
        "y[1], y[1-2], y[2], b[car] binary",
        "0 <= z[car] <= 2 integer",
        "0 <= makespan <= 5",
    ]
    agrees(problem, "set-partitioning", 5.0)


@pytest.mark.parametrize(("name", "limit", "partition"), [("SQUARE-4", 12.0, 24.0), ("SQUARE-4", 14.0, 20.0), ("GAP-5", 26.0, 30.6667)])
def test_its_relaxation_is_the_set_partitioning_bound(name: str, limit: float, partition: float) -> None:
    places = {"SQUARE-4": {"xy": SQUARE_4}, "GAP-5": {"xy": GAP_5, "metric": "manhattan"}}[name]
    problem = routing(**places, count=2, max_distance=limit)
    root = solved(problem.compile("set-partitioning", relax=True).program)[1]
    assert root == pytest.approx(partition, abs=1e-3) == set_partitioning_bound(problem)


@pytest.mark.parametrize("objective", [TotalCost(), Makespan(), LongestRoute(), LatestReturn(), TotalCost() + 2.0 * Makespan()])
def test_routes_that_are_left_out_are_written_as_those_kept(objective: object) -> None:
    problem = routing(xy=SQUARE_4, count=2, max_distance=14.0, objective=objective)
    made = problem.compile("set-partitioning")
    assert made.encode is not None
    answers = [Routes.of(r) for r in ([[1, 2, 3], [4]], [[3, 2, 1], [4]], [[1], [4, 3, 2]])]
    for answer in answers:
        verdict = problem.evaluate(answer)
        if verdict.feasible:
            kept = problem.evaluate(made.decode(made.encode(answer)))
            assert kept.feasible and kept.values[0] <= verdict.values[0] + 1e-9
    agrees(problem, "set-partitioning", optimum(problem))


def test_given_routes_are_put_together_best() -> None:
    problem = routing(xy=SQUARE_4, count=4, max_distance=14.0)
    made = over(problem, [Route((1,)), Route((2,)), Route((3,)), Route((4,)), Route((2, 1)), Route((3, 4))])
    assert made.exactness is Exactness.RESTRICTION
    status, value, x = solved(made.program)
    assert status == "optimal"
    assert made.decode(x).canonical() == Routes.of([[2, 1], [3, 4]]).canonical()
    assert value == pytest.approx(problem.evaluate(made.decode(x)).values[0], abs=1e-9)
    for wrong in (Route((1, 2, 3, 4)), Route((1, 1)), Route((0,)), Route((9,)), Route((1,), 3), Route(())):
        with pytest.raises(InputError):
            over(problem, [wrong])
    assert made.encode is not None
    with pytest.raises(InputError, check=coded("unsupported")):
        made.encode(Routes.of([[1, 4], [2], [3]]))


def test_it_refuses_what_has_many_routes_and_maxima_that_should_be_large() -> None:
    form = FORMS["set-partitioning"]
    xy = np.arange(28.0).reshape(14, 2)
    assert form.missing(routing(xy=xy, count=2)) == {"more than 20000 orders of stops"}
    assert form.missing(routing(xy=xy[:13], count=2)) == set(), "12 sites, where what counts adds up"
    for sites, missing in ((8, set()), (9, {"more than 20000 orders of stops"})):
        assert form.missing(routing(xy=xy[:sites], count=2, sites={"ready": np.arange(float(sites))})) == missing
    assert form.missing(routing(xy=xy[:4], count=2, objective=Reward() + Makespan())) == {"objective:makespan"}


@pytest.mark.parametrize(
    ("risk", "team_risk", "cost"),
    [(None, None, 26), (0.15, None, 26), (None, 0.15, 34), (0.06, None, 36), (None, 0.06, None), (0.05, None, None)],
)
def test_the_example_of_risks(risk: float | None, team_risk: float | None, cost: float | None) -> None:
    """Probabilities to overrun: 0.0105 for a-c, 0.1425 for b-e, 0.0544 for e, and less for the others alone."""
    agrees(at_risk(risk, team_risk), "set-partitioning", cost)


def test_the_risk_of_the_team_is_a_row_in_parts_of_what_there_may_be() -> None:
    """Going straight home counts too; a route that is beyond the team's risk by itself is no column."""
    xy = np.array([(0, 0), (1, 0), (2, 0), (0, 0)], dtype=float)
    fleet = (VehicleType(2, start=0, end=3, committed=True, max_duration=4.0, name="car"),)
    problem = routing(xy=xy, sites={"depot": [True, False, False, True]}, fleet=fleet)
    variances = np.ones((4, 4))
    problem = replace(problem, travel=replace(problem.travel, variances=variances), team_risk=0.45)
    program = problem.compile("set-partitioning").program
    assert [program.variable_name(k) for k in range(program.num_variables)] == ["y[1]", "z[car]"]
    row = next(k for k in range(program.num_rows) if program.row_name(k) == "risk")
    share = [np.log1p(-0.5 * math.erfc(slack / math.sqrt(2 * variance))) / math.log1p(-0.45) for slack, variance in ((2, 2), (4, 1))]
    assert program.matrix.toarray()[row] == pytest.approx(share) and program.row_upper[row] == 1.0
