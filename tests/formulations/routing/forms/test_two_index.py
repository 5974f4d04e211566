"""Two-index forms: what they write, row by row, duals as evidence, and the real files."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import HealthCheck, assume, given, settings
from oracles import SQUARE_4, TW_4, TWO_INDEX, agrees, optimum, routing, small_problems, solved
from program_text import expected, program_text, written
from small_routing import WHOLE_FAMILY, varied

from waybound import Energy, Group, InputError, Objective, Penalties, Program, Reward, RoutingProblem, TotalCost, TotalDuration
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.reading import read_instance

TWO_SITES = """
    # vehicles: 2
    # capacity: 4
    id,x,y,demand,service,due
    o,0,0,0,0,16
    a,3,0,2,1,12
    b,3,4,1,2,10
"""
"""Begin of service: at a from 3 to 12, at b from 5 to 9 (7 later the vehicle must be home). Load after service: 2 to 4, and 1 to 4."""


VISITS = expected("""
    min 3 x[o,a] + 5 x[o,b] + 4 x[a,b] + 3 x[a,o] + 4 x[b,a] + 5 x[b,o]
    visit-out[a]: x[a,b] + x[a,o] = 1
    visit-out[b]: x[b,a] + x[b,o] = 1
    visit-in[a]: x[o,a] + x[b,a] = 1
    visit-in[b]: x[o,b] + x[a,b] = 1
    fleet: 1 <= x[o,a] + x[o,b] <= 2
""")
TIME_LEVELS = expected("""
    time[a,b]: 12 x[a,b] + time[a] - time[b] <= 7
    time[b,a]: 12 x[b,a] - time[a] + time[b] <= 6
    time-earliest[a]: - 8 x[b,a] + time[a] >= 3
    time-earliest[b]: - 3 x[a,b] + time[b] >= 5
    time-latest[a]: 8 x[a,b] + time[a] <= 12
    time-latest[b]: 3 x[b,a] + time[b] <= 9
""")
LOAD_LEVELS = expected("""
    load[a,b]: 4 x[a,b] + x[b,a] + load[a] - load[b] <= 3
    load[b,a]: x[a,b] + 4 x[b,a] - load[a] + load[b] <= 2
    load-earliest[a]: - x[b,a] + load[a] >= 2
    load-earliest[b]: - 2 x[a,b] + load[b] >= 1
    load-latest[a]: x[a,b] + load[a] <= 4
    load-latest[b]: 2 x[b,a] + load[b] <= 4
""")
LOAD_FLOW = expected("""
    load-link[a,b]: - x[a,b] + load-flow[a,b] <= 0
    load-link[a,o]: - 2 x[a,o] + load-flow[a,o] <= 0
    load-link[b,a]: - x[b,a] + load-flow[b,a] <= 0
    load-link[b,o]: - 3 x[b,o] + load-flow[b,o] <= 0
    load-balance[a]: - 2 x[o,a] + 2 x[a,b] + 2 x[a,o] - 3 x[b,a] + load-flow[a,b] + load-flow[a,o] - load-flow[b,a] >= 0
    load-balance[b]: - x[o,b] - 3 x[a,b] + x[b,a] + x[b,o] - load-flow[a,b] + load-flow[b,a] + load-flow[b,o] >= 0
""")


def test_two_index_mtz_from_text_to_text(tmp_path: Path) -> None:
    told = "two-index-mtz, exact\n" + VISITS + TIME_LEVELS + LOAD_LEVELS
    assert written(TWO_SITES, "two-index-mtz", tmp_path) == told + expected("""
        x[o,a], x[o,b], x[a,b], x[a,o], x[b,a], x[b,o] binary
        3 <= time[a] <= 12
        5 <= time[b] <= 9
        2 <= load[a] <= 4
        1 <= load[b] <= 4
    """)


def test_two_index_load_flow_from_text_to_text(tmp_path: Path) -> None:
    """Times as levels of nodes, loads as flows beyond the least load of their tail."""
    told = "two-index-load-flow, exact\n" + VISITS + TIME_LEVELS + LOAD_FLOW
    assert written(TWO_SITES, "two-index-load-flow", tmp_path) == told + expected("""
        x[o,a], x[o,b], x[a,b], x[a,o], x[b,a], x[b,o] binary
        3 <= time[a] <= 12
        5 <= time[b] <= 9
        0 <= load-flow[a,b], load-flow[b,a] <= 1
        0 <= load-flow[a,o] <= 2
        0 <= load-flow[b,o] <= 3
    """)


def test_two_index_time_flow_from_text_to_text(tmp_path: Path) -> None:
    flow = expected("""
        time-link[a,b]: - x[a,b] + time-flow[a,b] <= 0
        time-link[a,o]: - 9 x[a,o] + time-flow[a,o] <= 0
        time-link[b,a]: - x[b,a] + time-flow[b,a] <= 0
        time-link[b,o]: - 4 x[b,o] + time-flow[b,o] <= 0
        time-balance[a]: - 3 x[o,a] + 3 x[a,b] + 3 x[a,o] - 11 x[b,a] + time-flow[a,b] + time-flow[a,o] - time-flow[b,a] >= 0
        time-balance[b]: - 5 x[o,b] - 8 x[a,b] + 5 x[b,a] + 5 x[b,o] - time-flow[a,b] + time-flow[b,a] + time-flow[b,o] >= 0
    """)
    told = "two-index-time-flow, exact\n" + VISITS + flow + LOAD_FLOW
    assert written(TWO_SITES, "two-index-time-flow", tmp_path) == told + expected("""
        x[o,a], x[o,b], x[a,b], x[a,o], x[b,a], x[b,o] binary
        0 <= time-flow[a,b], time-flow[b,a], load-flow[a,b], load-flow[b,a] <= 1
        0 <= time-flow[a,o] <= 9
        0 <= time-flow[b,o] <= 4
        0 <= load-flow[a,o] <= 2
        0 <= load-flow[b,o] <= 3
    """)


def test_two_index_unit_flow_from_text_to_text(tmp_path: Path) -> None:
    """Times and loads as levels of nodes, and how many were visited as a flow beyond the least of its tail: 1 of 2 on the way between."""
    flow = expected("""
        order-link[a,b]: order-flow[a,b] <= 0
        order-link[a,o]: - x[a,o] + order-flow[a,o] <= 0
        order-link[b,a]: order-flow[b,a] <= 0
        order-link[b,o]: - x[b,o] + order-flow[b,o] <= 0
        order-balance[a]: - x[o,a] + x[a,b] + x[a,o] - 2 x[b,a] + order-flow[a,b] + order-flow[a,o] - order-flow[b,a] >= 0
        order-balance[b]: - x[o,b] - 2 x[a,b] + x[b,a] + x[b,o] - order-flow[a,b] + order-flow[b,a] + order-flow[b,o] >= 0
    """)
    told = "two-index-unit-flow, exact\n" + VISITS + TIME_LEVELS + LOAD_LEVELS + flow
    assert written(TWO_SITES, "two-index-unit-flow", tmp_path) == told + expected("""
        x[o,a], x[o,b], x[a,b], x[a,o], x[b,a], x[b,o] binary
        3 <= time[a] <= 12
        5 <= time[b] <= 9
        2 <= load[a] <= 4
        1 <= load[b] <= 4
        order-flow[a,b], order-flow[b,a] = 0
        0 <= order-flow[a,o], order-flow[b,o] <= 1
    """)


def test_optional_sites_have_a_row_of_flow_in_place_of_a_visit(tmp_path: Path) -> None:
    text = """
        # vehicles: 1
        id,x,y,required
        o,0,0,false
        a,3,0,true
        b,3,4,false
    """
    lines = written(text, "two-index-mtz", tmp_path).splitlines()
    assert lines[2:8] == [
        "visit-out[a]: x[a,b] + x[a,o] = 1",
        "visit-out[b]: 0 <= x[b,a] + x[b,o] <= 1",
        "visit-in[a]: x[o,a] + x[b,a] = 1",
        "flow[b]: x[o,b] + x[a,b] - x[b,a] - x[b,o] = 0",
        "fleet: x[o,a] + x[o,b] = 1",
        "order[a,b]: 2 x[a,b] + order[a] - order[b] <= 1",
    ]


def duals_of(program: Program) -> tuple[float, np.ndarray]:
    model = program.to_highs()
    model.run()
    return float(model.getInfo().objective_function_value), np.array(model.getSolution().row_dual)


@settings(max_examples=draws(40), deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(problem=small_problems(most=4))
def test_duals_of_the_flow_relaxation_prove_its_value_and_no_more_than_the_optimum(problem: RoutingProblem) -> None:
    assume("two-index-time-flow" in problem.forms())
    made = problem.compile("two-index-time-flow", relax=True)
    program = made.program
    assume(made.dual_evidence is not None)
    best = optimum(problem)
    assume(best is not None)
    assert made.dual_evidence is not None and best is not None
    value, duals = duals_of(program)
    evidence = made.dual_evidence(duals)
    assert evidence.kind == "arc-multipliers"
    assert evidence.value == pytest.approx(value, abs=1e-6)
    bound = verified_bound(problem, evidence)
    assert bound <= best + 1e-6
    # With moves of no length the checker can prove less than the relaxation: 1 against 1.25 was seen, with elapsed energy.
    lengths = problem.travel.durations[~np.eye(len(problem.sites), dtype=bool)]
    if "order" not in {b.name.split("-")[0] for b in program.rows} and lengths.all():
        assert bound >= value - 1e-4 * max(1.0, abs(value))


@settings(max_examples=draws(30), deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(problem=small_problems(most=3))
def test_wrong_duals_prove_no_more_than_the_optimum(problem: RoutingProblem) -> None:
    assume("two-index-time-flow" in problem.forms())
    made = problem.compile("two-index-time-flow", relax=True)
    program = made.program
    best = optimum(problem)
    assume(made.dual_evidence is not None and best is not None)
    assert made.dual_evidence is not None and best is not None
    duals = np.random.default_rng(7).normal(0.0, 5.0, program.num_rows)
    assert verified_bound(problem, made.dual_evidence(duals)) <= best + 1e-6


def test_evidence_lists_one_number_a_site_with_zeros_at_the_depot() -> None:
    problem = routing(xy=SQUARE_4, sites={**TW_4, "demand": [0, 1, 2, 1, 1]}, count=3, capacity=3, max_distance=30.0)
    made = problem.compile("two-index-time-flow", relax=True)
    data = made.dual_evidence(duals_of(made.program)[1]).data
    assert set(data) == {"out", "in", "fleet", "resources"}
    assert set(data["resources"]) == {"time", "load", "distance"}
    for values in (data["out"], data["in"], *data["resources"].values()):
        assert len(values) == 5 and values[0] == 0.0
    assert all(v >= 0 for values in data["resources"].values() for v in values)


def test_only_the_flow_form_of_a_plain_minimisation_gives_evidence() -> None:
    problem = routing(xy=SQUARE_4, count=2, capacity=2, sites={"demand": 1.0})
    assert [problem.compile(form).dual_evidence is not None for form in TWO_INDEX] == [False, False, True, False]
    optional = routing(xy=SQUARE_4, count=2, sites={"required": False}, objective=Reward())
    assert optional.compile("two-index-time-flow").dual_evidence is None


def test_order_is_a_resource_only_where_nothing_else_forbids_cycles() -> None:
    def resources(problem: RoutingProblem) -> set[str]:
        return {b.name for b in problem.compile("two-index-mtz").program.variables} - {"x"}

    assert resources(routing(xy=SQUARE_4, count=2)) == {"order"}
    assert resources(routing(xy=SQUARE_4, count=2, max_distance=14.0)) == {"distance"}
    assert resources(routing(xy=SQUARE_4, count=2, sites={"demand": 1.0}, capacity=2)) == {"load"}
    assert resources(routing(xy=SQUARE_4, count=2, sites=dict(TW_4))) == {"time"}
    assert resources(routing(xy=SQUARE_4, count=2, sites={"demand": [0, 1, 0, 0, 0]}, capacity=2)) == {"load", "order"}


def test_a_start_that_breaks_a_limit_is_refused_with_the_reason() -> None:
    problem = routing(xy=SQUARE_4, count=2, sites={"demand": 1.0}, capacity=2)
    for form in TWO_INDEX:
        made = problem.compile(form)
        program = made.program
        assert made.encode is not None
        from waybound.formulations.routing.routes import Routes

        with pytest.raises(InputError, check=coded("contradiction")):
            made.encode(Routes.of([[1, 2, 3, 4]]))
        x = made.encode(Routes.of([[2, 1], [4, 3]]))
        assert program.residual(x) <= 1e-9 and program.value(x) == pytest.approx(24.0)


REAL = {"C101": (191.3, 3), "R101": (617.1, 8), "RC101": (461.1, 4)}


@pytest.mark.parametrize("form", ["two-index-load-flow", "two-index-mtz"])
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.long) if n == "RC101" else n for n in REAL])
def test_first_25_customers_of_solomon_files(name: str, form: str, benchmarks: Path) -> None:
    problem = problem_from_instance(read_instance(benchmarks / "vrptw-solomon" / f"{name}.txt"), None, customers=25, convention="trunc1")
    value, routes = REAL[name]
    agrees(problem, form, value)
    made = problem.compile(form)
    answer = made.decode(solved(made.program)[2])
    assert isinstance(problem, RoutingProblem) and len(answer) == routes


def test_flow_relaxation_of_a_real_file_is_verified_and_strong(benchmarks: Path) -> None:
    problem = problem_from_instance(read_instance(benchmarks / "vrptw-solomon" / "C101.txt"), None, customers=25, convention="trunc1")
    made = problem.compile("two-index-time-flow", relax=True)
    value, duals = duals_of(made.program)
    bound = verified_bound(problem, made.dual_evidence(duals))
    assert value - 1e-3 <= bound <= 191.3 + 1e-6
    assert bound >= 0.9 * 191.3 and math.isfinite(bound)


def test_unit_flow_connects_every_customer_to_the_depot() -> None:
    """Nothing is limited: on leaving a customer the flow is 1 and, less 1, what ``order-flow`` holds."""
    problem = routing(xy=SQUARE_4[:3], count=2)
    lines = program_text(problem.compile("two-index-unit-flow").program).splitlines()
    assert [line for line in lines if line.startswith("order")] == [
        "order-link[1,2]: order-flow[1,2] <= 0",
        "order-link[1,0]: - x[1,0] + order-flow[1,0] <= 0",
        "order-link[2,1]: order-flow[2,1] <= 0",
        "order-link[2,0]: - x[2,0] + order-flow[2,0] <= 0",
        "order-balance[1]: - x[0,1] + x[1,2] + x[1,0] - 2 x[2,1] + order-flow[1,2] + order-flow[1,0] - order-flow[2,1] >= 0",
        "order-balance[2]: - x[0,2] - 2 x[1,2] + x[2,1] + x[2,0] - order-flow[1,2] + order-flow[2,1] + order-flow[2,0] >= 0",
        "order-flow[1,2], order-flow[2,1] = 0",
    ]
    agrees(problem, "two-index-unit-flow", optimum(problem))


@pytest.mark.share(6)
@pytest.mark.parametrize("feature", [name for name in WHOLE_FAMILY if name not in ("recharging", "reloads", "initial-energy")])
def test_two_index_forms_agree_with_enumeration_on_features_of_one_type(feature: str) -> None:
    for seed in range(4):
        problem = varied(feature, seed, 3)
        for aim in (TotalCost(), TotalDuration(), TotalCost() + Penalties()):
            alone = replace(problem, fleet=problem.fleet[-1:], objective=Objective.of(aim))
            names = [form for form in alone.forms() if form in TWO_INDEX]
            expected = optimum(alone) if names else None
            for form in names:
                agrees(alone, form, expected)


def test_groups_of_alternatives_and_a_store_that_is_not_full() -> None:
    xy = np.array([(0, 0), (1, 0), (2, 0)], dtype=float)
    for form in TWO_INDEX:
        agrees(routing(xy=xy, count=1, sites={"groups": [Group((1, 2))]}), form, 2.0)
        agrees(routing(xy=xy, count=2, energy=Energy(9.0, initial=4.0)), form, 4.0)
        agrees(routing(xy=xy, count=2, energy=Energy(9.0, initial=3.0)), form, None)
