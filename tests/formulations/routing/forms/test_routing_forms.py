import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import ALL, draws
from file_cases import check_refused
from hypothesis import HealthCheck, given, settings
from oracles import (
    ASYM_5,
    EVERY_FORM,
    GAP_5,
    MIN_COST,
    OCTO_8,
    ROUTING_FORMS,
    SQUARE_4,
    TW_4,
    TWO_INDEX,
    agrees,
    optimum,
    routing,
    set_partitioning_bound,
    small_problems,
    solved,
)
from small_routing import WHOLE_FAMILY, varied

from waybound import Energy, Exactness, LongestRoute, Makespan, Objective, Reward, Routes, RoutingProblem, TotalCost, Vehicles
from waybound.formulations.forms import FORMS
from waybound.instances.errors import InputError, UnsupportedError
from waybound.instances.routing.features import RISKS

DRAWN = settings(max_examples=draws(40), deadline=None, suppress_health_check=[HealthCheck.too_slow])
PLACES: dict[str, dict[str, Any]] = {
    "SQUARE-4": {"xy": SQUARE_4}, "GAP-5": {"xy": GAP_5, "metric": "manhattan"}, "ASYM-5": {"matrix": ASYM_5}, "OCTO-8": {"xy": OCTO_8},
}  # fmt: skip


@DRAWN
@given(problem=small_problems())
def test_all_forms_agree_with_enumeration_whatever_the_features(problem: RoutingProblem) -> None:
    expected = optimum(problem)
    names = problem.forms()
    assert "three-index" in names
    for form in names:
        agrees(problem, form, expected)


@settings(DRAWN, max_examples=draws(30))
@given(problem=small_problems(most=3, hetero=True))
def test_three_index_agrees_with_enumeration_on_mixed_fleets(problem: RoutingProblem) -> None:
    assert problem.forms() == ["three-index", "set-partitioning", "circuit"]
    for form in problem.forms():
        agrees(problem, form, optimum(problem))


def one_level(feature: str, seed: int) -> RoutingProblem:
    """Three sites in which a feature of the family matters; of the objective the first level."""
    problem = varied(feature, seed, 3)
    return replace(problem, objective=Objective(problem.objective.levels()[:1]))


def exact_forms(problem: RoutingProblem) -> list[str]:
    return [form for form in problem.forms() if FORMS[form].exactness is Exactness.EXACT]


@pytest.mark.share(6)
@pytest.mark.parametrize("feature", [name for name in WHOLE_FAMILY if name not in ("recharging", "initial-energy")])
def test_forms_agree_with_enumeration_on_every_feature_of_the_family(feature: str) -> None:
    taken = 0
    for seed in range(6):
        problem = one_level(feature, seed)
        names, expected = exact_forms(problem), optimum(problem)
        assert "set-partitioning" in names
        for form in names:
            agrees(problem, form, expected)
        taken += "three-index" in names
    assert (
        taken >= 4 or feature in RISKS
    )  # where early returns and short durations both count, several windows are for set partitioning alone


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("feature", ["recharging", "initial-energy"])
def test_forms_agree_with_enumeration_where_vehicles_recharge(feature: str, seed: int) -> None:
    problem = varied(feature, seed, 2)
    problem = replace(problem, objective=Objective(problem.objective.levels()[:1]))
    expected = optimum(problem)
    for form in ("three-index", "set-partitioning"):
        agrees(problem, form, expected)


@pytest.mark.long
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_forms_agree_with_enumeration_on_many_problems_of_the_family(feature: str) -> None:
    for seed in range(6, 60):
        problem = one_level(feature, seed)
        expected = optimum(problem)
        for form in exact_forms(problem):
            agrees(problem, form, expected)


@pytest.mark.long
@settings(DRAWN, max_examples=draws(1500))
@given(problem=small_problems(most=5))
def test_all_forms_agree_with_enumeration_on_many_instances(problem: RoutingProblem) -> None:
    expected = optimum(problem)
    for form in problem.forms():
        agrees(problem, form, expected)


@pytest.mark.long
@settings(DRAWN, max_examples=draws(500))
@given(problem=small_problems(most=4, hetero=True))
def test_three_index_agrees_with_enumeration_on_many_mixed_fleets(problem: RoutingProblem) -> None:
    agrees(problem, "three-index", optimum(problem))


LONG_MIN_COST = [
    ("OCTO-8", 1, math.inf, 56.606765), ("OCTO-8", 2, 40.0, 65.254137), ("OCTO-8", 2, 35.0, 69.351820), ("OCTO-8", 3, 30.0, 73.662587),
    ("OCTO-8", 4, 24.0, 86.496481), ("OCTO-8", 2, 32.0, None), ("OCTO-8", 3, 26.0, None), ("OCTO-8", 3, 24.0, None),
]  # fmt: skip
LIMITS: dict[str, Any] = {
    "distance": lambda limit: {"max_distance": limit},
    "duration": lambda limit: {"max_duration": limit},
    **{
        charge: (lambda limit, c=charge: {"energy": Energy(2.0 * limit, 2.0, c)} if math.isfinite(limit) else {})
        for charge in ("travel", "elapsed", "elapsed-fixed-start", "windows")
    },
}


@pytest.mark.share(4)
@pytest.mark.parametrize("limit", LIMITS)
@pytest.mark.parametrize("form", ROUTING_FORMS)
def test_reference_values_of_min_cost_hold_for_every_way_to_limit_a_route(form: str, limit: str) -> None:
    """Each value in two of the ways, for every form; in all of them where all is drawn."""
    first = list(LIMITS).index(limit) % 3
    for name, vehicles, bound, expected in MIN_COST if ALL else MIN_COST[first::3]:
        agrees(routing(**PLACES[name], count=vehicles, **LIMITS[limit](bound)), form, expected)


@pytest.mark.parametrize("form", ["two-index-load-flow", "two-index-time-flow"])
def test_reference_values_of_min_cost_on_eight_sites(form: str) -> None:
    for name, vehicles, bound, expected in LONG_MIN_COST:
        agrees(routing(**PLACES[name], count=vehicles, max_distance=bound), form, expected)


TW_4_TABLE = {  # store: travel, elapsed-fixed-start, windows
    12: (24, None, None), 14: (24, 24, 26), 16: (22, 24, 26), 18: (22, 22, 24), 20: (22, 22, 24), 23: (22, 22, 22),
}  # fmt: skip


@pytest.mark.share(5)
@pytest.mark.parametrize("form", EVERY_FORM)
@pytest.mark.parametrize("store", TW_4_TABLE)
def test_windows_and_energy_give_the_reference_values_in_every_charge(store: int, form: str) -> None:
    for charge, expected in zip(("travel", "elapsed-fixed-start", "windows"), TW_4_TABLE[store], strict=True):
        problem = routing(xy=SQUARE_4, sites=dict(TW_4), count=4, energy=Energy(store, 1.0, charge))
        assert optimum(problem) == expected
        agrees(problem, form, expected)


@pytest.mark.parametrize("form", EVERY_FORM)
def test_tightened_openings_make_the_window_charge_looser(form: str) -> None:
    sites = {**TW_4, "ready": [0, 3, 5, 10, 3]}
    agrees(routing(xy=SQUARE_4, sites=sites, count=4, energy=Energy(18, 1.0, "windows")), form, 22.0)
    agrees(routing(xy=SQUARE_4, sites=dict(TW_4), count=4, energy=Energy(18, 1.0, "windows")), form, 24.0)


@pytest.mark.parametrize("form", EVERY_FORM)
def test_windows_alone_need_two_vehicles(form: str) -> None:
    agrees(routing(xy=SQUARE_4, sites=dict(TW_4), count=1), form, None)
    agrees(routing(xy=SQUARE_4, sites=dict(TW_4), count=2), form, 22.0)


def test_charges_are_ordered_from_loosest_to_strictest() -> None:
    order = ("travel", "elapsed", "elapsed-fixed-start", "windows")
    for store in (12, 14, 16, 17, 18, 23):
        values = []
        for charge in order:
            status, value, _ = solved(
                routing(xy=SQUARE_4, sites=dict(TW_4), count=4, energy=Energy(store, 1.0, charge)).compile("three-index").program
            )
            values.append(value if status == "optimal" else math.inf)
        assert all(a <= b + 1e-6 for a, b in itertools.pairwise(values)), (store, values)


ROOTS = [  # problem, vehicles, limit, node levels without and with the other direction of an arc, distance flow, set partitioning
    ("SQUARE-4", 2, 12.0, 18.0, 24.0, 24.0, 24.0),
    ("SQUARE-4", 2, 14.0, 18.0, 19.0, 20.0, 20.0),
    ("SQUARE-4", 4, 10.0, 20.9907, 29.0, 30.0, 30.0),
    ("GAP-5", 2, 26.0, 18.8571, 20.0, 27.2581, 30.6667),
]


@pytest.mark.parametrize(("name", "vehicles", "limit", "plain", "lifted", "flow", "partition"), ROOTS)
def test_linear_relaxations_are_ordered_and_as_strong_as_published(
    name: str, vehicles: int, limit: float, plain: float, lifted: float, flow: float, partition: float
) -> None:
    """The fleet row and the reduced ranges only add to the published roots of the same kind of form."""
    problem = routing(**PLACES[name], count=vehicles, max_distance=limit)
    root = {form: solved(problem.compile(form, relax=True).program)[1] for form in ROUTING_FORMS}
    assert set_partitioning_bound(problem) == pytest.approx(partition, abs=1e-3)
    assert root["three-index"] >= 18.0 - 1e-6
    assert root["three-index"] <= root["two-index-mtz"] + 1e-6
    assert plain - 1e-3 <= lifted - 1e-3 <= root["two-index-mtz"] <= partition + 1e-3
    assert flow - 1e-3 <= root["two-index-time-flow"] <= partition + 1e-3


def test_first_form_of_a_plain_problem_is_the_one_measured_best() -> None:
    assert routing(xy=SQUARE_4, count=2).forms() == [
        "two-index-load-flow", "two-index-time-flow", "two-index-mtz", "two-index-unit-flow", "three-index", "set-partitioning", "circuit",
    ]  # fmt: skip


def test_forms_say_what_they_lack() -> None:
    waits = routing(xy=SQUARE_4, sites=dict(TW_4), count=2, max_duration=20.0)
    assert waits.forms() == ["three-index", "set-partitioning", "circuit"]
    with pytest.raises(
        UnsupportedError,
        match=r"form two-index-mtz cannot take this problem: it does not handle max-duration; can take it: three-index, set-",
    ):
        waits.compile("two-index-mtz")
    assert routing(xy=SQUARE_4, objective=LongestRoute()).forms() == ["three-index", "set-partitioning", "circuit"]
    assert routing(xy=SQUARE_4, objective=Reward() + LongestRoute()).forms() == []
    assert routing(xy=SQUARE_4, objective=Vehicles().then(TotalCost())).forms() == routing(xy=SQUARE_4).forms()
    assert routing(xy=SQUARE_4, objective=Reward().then(Makespan())).forms() == ["three-index", "set-partitioning", "circuit"]
    assert routing(xy=SQUARE_4, objective=Reward().then(Vehicles() - Makespan())).forms() == []
    with pytest.raises(UnsupportedError):
        routing(xy=SQUARE_4, objective=Reward() + LongestRoute()).compile()


@pytest.mark.share(2)
@pytest.mark.parametrize("form", EVERY_FORM)
def test_coincident_sites_and_a_site_on_the_depot_make_no_cycles(form: str) -> None:
    xy = np.array([(0, 0), (0, 0), (3, 4), (3, 4), (3, 4), (6, 8)], dtype=float)
    agrees(routing(xy=xy, count=2), form, 20.0)
    agrees(routing(xy=xy, count=2, sites={"demand": [0, 0, 0, 0, 0, 1]}, capacity=1), form, 20.0)
    agrees(routing(xy=np.zeros((4, 2)), count=1), form, 0.0)


@pytest.mark.parametrize("form", EVERY_FORM)
def test_more_vehicles_than_sites_no_rewards_and_a_least_number_of_routes(form: str) -> None:
    agrees(routing(xy=SQUARE_4, count=9), form, 18.0)
    agrees(routing(xy=SQUARE_4), form, 18.0)
    agrees(routing(xy=SQUARE_4, count=4, min_vehicles=4), form, 30.0)
    agrees(routing(xy=SQUARE_4, count=4, sites={"required": False}), form, 0.0)
    agrees(routing(xy=SQUARE_4, count=4, sites={"required": False}, objective=Reward()), form, 0.0)
    agrees(
        routing(xy=SQUARE_4, count=2, max_distance=12.0, sites={"required": False, "reward": [0, 4, 10, 5, 3]}, objective=Reward()),
        form,
        22.0,
    )


@pytest.mark.parametrize("form", EVERY_FORM)
def test_a_fleet_too_small_for_the_load_is_an_infeasible_program(form: str) -> None:
    agrees(routing(xy=SQUARE_4, sites={"demand": [0, 2, 2, 2, 2]}, count=3, capacity=3), form, None)
    agrees(routing(xy=SQUARE_4, sites={"demand": [0, 2, 2, 2, 4]}, count=9, capacity=3), form, None)


@pytest.mark.parametrize("form", EVERY_FORM)
def test_open_routes_between_two_depots(form: str) -> None:
    """From one depot to another through two sites on the way, or two vehicles of which each visits one."""
    xy = np.array([(0, 0), (1, 0), (2, 0), (3, 0)], dtype=float)
    sites = {"depot": [True, False, False, True], "demand": [0, 1, 1, 0]}
    agrees(routing(xy=xy, sites=sites, start=0, end=3, count=2, capacity=2), form, 3.0)
    agrees(routing(xy=xy, sites=sites, start=0, end=3, count=2, capacity=1), form, 6.0)


# -- points that are no answers --------------------------------------------------------------------------------------


def point(program: Any, arcs: list[tuple[int, int]]) -> Any:
    """A vector that uses the given arcs (with 5 for the end) of SQUARE-4."""
    block = program.variables[0]
    x = program.lower.copy()
    x[: block.size] = 0.0
    for i, j in arcs:
        at = np.nonzero((block.keys[0] == i) & (block.keys[1] == j))[0]
        x[at[0]] = 1.0
    return x


@pytest.mark.parametrize("form", EVERY_FORM)
def test_detached_cycles_are_no_routes_and_their_fragments_are_rejected(form: str) -> None:
    """Optima of the uncorrected rows: 0 from no arcs, 18 from two cycles, and from a triangle with one honest route."""
    problem = routing(xy=SQUARE_4, count=2, max_distance=14.0)
    made = problem.compile(form)
    program = made.program
    check_refused(InputError, "cycle without the depot", made.decode, point(program, [(1, 4), (4, 1), (2, 3), (3, 2)]))
    check_refused(InputError, "cycle without the depot", made.decode, point(program, [(1, 3), (3, 2), (2, 1), (0, 4), (4, 5)]))
    for fragment in ([], [[4]]):
        verdict = problem.evaluate(Routes.of(fragment))
        assert not verdict.feasible and {v.check for v in verdict.violations} == {"visits"}


def test_sites_visited_twice_are_rejected() -> None:
    """The uncorrected visit rows made two vehicles pass the same sites, at a cost of 30 where 18 is optimal."""
    verdict = routing(xy=SQUARE_4, count=2).evaluate(Routes.of([[1, 2, 3, 4], [1, 2]]))
    assert verdict.values[0] == pytest.approx(30.0)
    assert [v.message for v in verdict.violations] == ["1 is visited 2 times", "2 is visited 2 times"]


@pytest.mark.parametrize(("charge", "fits"), [("travel", 16.0), ("elapsed", 17.0), ("elapsed-fixed-start", 18.0), ("windows", 23.0)])
def test_a_route_is_charged_as_stated_and_rejected_just_below(charge: str, fits: float) -> None:
    for store, feasible in ((fits, True), (fits - 1e-3, False)):
        problem = routing(xy=SQUARE_4, sites=dict(TW_4), count=4, energy=Energy(store, 1.0, charge))
        assert problem.evaluate(Routes.of([[2, 3, 1], [4]])).feasible is feasible


@pytest.mark.parametrize("form", EVERY_FORM)
def test_fractional_points_and_infeasible_starts_are_refused(form: str) -> None:
    made = routing(xy=SQUARE_4, count=2, max_distance=14.0).compile(form)
    program = made.program
    with pytest.raises(InputError, match="fractional"):
        made.decode(np.full(program.num_variables, 0.5))
    assert made.encode is not None
    for routes in ([[1, 2, 3, 4]], [[1, 2]], [[1], [2], [3], [4]], [[1, 2, 3], [4, 4]], [[1, 2, 3], [0]], [[1, 2, 3], [7]]):
        with pytest.raises(InputError):
            made.encode(Routes.of(routes))


def test_names_of_rows_and_columns_are_made_when_asked_for() -> None:
    problem = routing(xy=SQUARE_4, count=2, sites=dict(TW_4))
    program = problem.compile("three-index").program
    rows = [program.row_name(k) for k in range(program.num_rows)]
    columns = [program.variable_name(k) for k in range(program.num_variables)]
    assert "time[1,3,2]" in rows and "visit[4]" in rows and "flow[3,1]" in rows and "depart[2]" in rows
    assert "x[0,1,1]" in columns and "t[4,2]" in columns and "departure[1]" in columns and "x[0,0,2]" in columns
    assert len(set(rows)) == len(rows) and len(set(columns)) == len(columns)
    for form in TWO_INDEX:
        program = problem.compile(form).program
        rows = [program.row_name(k) for k in range(program.num_rows)]
        columns = [program.variable_name(k) for k in range(program.num_variables)]
        assert "visit-out[1]" in rows and "fleet" in rows and "x[1,0]" in columns
        assert len(set(rows)) == len(rows) and len(set(columns)) == len(columns)
