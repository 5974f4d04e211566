from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import SQUARE_4, TW_4, agrees, optimum, routing, small_problems
from program_text import TWO_SITES, expected, written
from small_routing import varied

import waybound as wb
from waybound import RoutingProblem, UnsupportedError, UsageError, VehicleType
from waybound.formulations.programs.program import CIRCUITS, INTEGERS
from waybound.formulations.routing.forms.circuit import arcs_say_enough
from waybound.formulations.routing.objective import Composable, Objective, Reward, TotalCost, Vehicles


def test_circuit_from_text_to_text(tmp_path: Path) -> None:
    """One column an arc, since vehicles are alike. Node 0 is start and end, 1 is a, 2 is b; nobody is at a by 9 after b."""
    assert written(TWO_SITES, "circuit", tmp_path) == expected("""
        circuit, exact
        min 3 x[o,a] + 5 x[o,b] + 4 x[a,b] + 3 x[a,o] + 5 x[b,o]
        fleet: 1 <= x[o,a] + x[o,b] <= 2
        time[a,b]: 9 x[a,b] + time[a] - time[b] <= 4
        time-earliest[b]: - 3 x[a,b] + time[b] >= 5
        time-latest[a]: 5 x[a,b] + time[a] <= 9
        load[a,b]: 4 x[a,b] + load[a] - load[b] <= 3
        load-earliest[b]: - 2 x[a,b] + load[b] >= 1
        load-latest[a]: x[a,b] + load[a] <= 4
        distance[a,b]: 8 x[a,b] + distance[a] - distance[b] <= 4
        distance-earliest[b]: - 2 x[a,b] + distance[b] >= 5
        distance-latest[a]: 6 x[a,b] + distance[a] <= 9
        circuit: circuits through node 0, nodes 0 to 2, 0>1 x[o,a], 0>2 x[o,b], 1>2 x[a,b], 1>0 x[a,o], 2>0 x[b,o]
        x[o,a], x[o,b], x[a,b], x[a,o], x[b,o] binary
        3 <= time[a], distance[a] <= 9
        5 <= time[b] <= 9
        2 <= load[a] <= 4
        1 <= load[b] <= 4
        5 <= distance[b] <= 7
    """)


def test_differences_that_are_rounding_are_no_coefficients() -> None:
    """Sites in a line: what a detour adds is 1e-16, by which a row was scaled so far that CP-SAT's point seemed to break it."""
    problem = routing(xy=np.array([(1, 2), (2, 3), (5, 6), (0, 0), (0, 0)], dtype=float), max_distance=13.0)
    assert np.abs(problem.compile("circuit").program.data).min() > 0.1
    agrees(problem, "circuit", optimum(problem))


OPTIONAL = """
    # vehicles: 1
    # max-duration: 20
    id,x,y,ready,required
    o,0,0,0,
    a,3,0,7,false
    b,3,4,0,true
"""


def test_one_circuit_a_vehicle_where_sites_may_be_left_out_or_durations_count(tmp_path: Path) -> None:
    """Of the order of arcs no row is left; a is on the circuit or has its loop, and an idle vehicle drives from 0 to 3 and back."""
    assert written(OPTIONAL, "circuit", tmp_path) == expected("""
        circuit, exact
        min 3 x[o,a,1] + 5 x[o,b,1] + 4 x[a,b,1] + 3 x[a,o,1] + 4 x[b,a,1] + 5 x[b,o,1]
        visit[a]: 0 <= x[a,b,1] + x[a,o,1] <= 1
        visit[b]: x[b,a,1] + x[b,o,1] = 1
        fleet: x[o,a,1] + x[o,b,1] >= 1
        duration[1]: - departure[1] + return[1] <= 20
        time[o,a,1]: 11 x[o,a,1] + departure[1] - t[a,1] <= 8
        time[o,b,1]: 15 x[o,b,1] + departure[1] - t[b,1] <= 10
        time[a,b,1]: 17 x[a,b,1] + t[a,1] - t[b,1] <= 13
        time[a,o,1]: 21 x[a,o,1] + t[a,1] - return[1] <= 18
        time[b,a,1]: 13 x[b,a,1] - t[a,1] + t[b,1] <= 9
        time[b,o,1]: 21 x[b,o,1] + t[b,1] - return[1] <= 16
        circuit[1]: one circuit, nodes 0 to 3, 0>1 x[o,a,1], 0>2 x[o,b,1], 0>3 x[o,o,1], 1>2 x[a,b,1], 1>3 x[a,o,1], 2>1
            x[b,a,1], 2>3 x[b,o,1], 1>1 off[a,1], 2>2 off[b,1], 3>0 back[1]
        x[o,a,1], x[o,b,1], x[o,o,1], x[a,b,1], x[a,o,1], x[b,a,1], x[b,o,1], off[a,1], off[b,1] binary
        0 <= departure[1] <= 15
        7 <= t[a,1] <= 18
        5 <= t[b,1] <= 16
        0 <= return[1] <= 21
        back[1] = 1 integer
    """)


@settings(max_examples=15, deadline=None)
@given(problem=small_problems(most=3))
def test_it_agrees_with_enumeration(problem: RoutingProblem) -> None:
    agrees(problem, "circuit", optimum(problem))


@pytest.mark.share(3)
@pytest.mark.parametrize("seed", range(3))
def test_it_agrees_with_enumeration_where_stores_are_filled_up_on_the_way(seed: int) -> None:
    """``test_routing_forms`` has the other features of the family."""
    problem = varied("recharging", seed, 3)
    problem = replace(problem, objective=Objective(problem.objective.levels()[:1]))
    assert "circuit" in problem.forms()
    agrees(problem, "circuit", optimum(problem))


@pytest.mark.parametrize(("objective", "required", "best"), [(Vehicles(), True, [2, 22]), (Reward(), False, [10, 22])])
def test_levels_of_an_objective_have_the_same_columns(objective: Composable, required: bool, best: list[float]) -> None:
    sites = {**TW_4, "reward": [0, 1, 2, 3, 4], "required": required}
    problem = routing(xy=SQUARE_4, sites=sites, count=2, objective=Objective.of(objective).then(TotalCost()))
    assert arcs_say_enough(problem) == required
    assert wb.solve(problem, "cpsat", form="circuit", bound_time=0.0).objective == pytest.approx(best)


def test_start_and_end_of_several_vehicle_types_lie_on_their_circuits() -> None:
    fleet = (VehicleType(1, start=0, end=3, name="open"), VehicleType(1, start=3, end=3, name="closed"))
    problem = routing(xy=SQUARE_4, fleet=fleet, sites={"depot": [True, False, False, True, False]})
    assert not arcs_say_enough(problem)
    agrees(problem, "circuit", optimum(problem))


def test_a_customer_that_no_arc_reaches_leaves_no_answer() -> None:
    problem = routing(xy=SQUARE_4, count=4, sites={"due": [99, 99, 2, 99, 99]})
    assert arcs_say_enough(problem)
    agrees(problem, "circuit", None)


def test_only_solvers_that_know_circuits_take_it() -> None:
    problem = routing(xy=SQUARE_4, count=2)
    assert problem.compile("circuit").program.features() == INTEGERS | CIRCUITS
    assert "circuit" in next(row for row in wb.solvers(problem) if row.name == "cpsat").forms
    assert "circuit" not in next(row for row in wb.solvers(problem) if row.name == "highs").forms
    with pytest.raises(UnsupportedError, match="highs cannot take this problem: it does not handle circuits; can take it: cpsat"):
        wb.solve(problem, "highs", form="circuit")
    with pytest.raises(UsageError, match="form circuit is not linear"):
        problem.compile("circuit", relax=True)
    assert wb.solve(problem, form="circuit", bound_time=0.0).solver == "cpsat"
