import dataclasses
import itertools
import math

import pytest
from coded import coded

import waybound as wb
from waybound.formulations.verified_bounds import verified_bound


@pytest.fixture(scope="module")
def problem():
    made = wb.read("demo-tiny")
    assert isinstance(made, wb.RoutingProblem)
    return made


@pytest.fixture(scope="module")
def mixed(problem):
    return dataclasses.replace(problem, fleet=(wb.VehicleType(3, 100, name="old"), wb.VehicleType(1, 5, name="new")))


ROUTES = wb.Routes((wb.Route((1,)), wb.Route((2, 3, 4), vehicle=1), wb.Route((5,)), wb.Route((), vehicle=1), wb.Route((6,), vehicle=7)))


def test_vehicles_are_numbered_within_their_type(mixed):
    assert mixed.vehicle_names(ROUTES) == ["old 1", "new 1", "old 2", "new 2", "old 3"]


def test_one_type_is_numbered_by_routes(problem):
    assert problem.vehicle_names(wb.Routes.of([[1], [2], [3]])) == ["vehicle 1", "vehicle 2", "vehicle 3"]


def test_violations_and_tables_name_the_same_vehicles(mixed):
    found = {v.vehicle for v in mixed.evaluate(ROUTES).violations if v.check == "load"}
    assert found == {"new 1"}
    assert list(mixed.answer_to_frame(wb.Routes(ROUTES.routes[:3]))["vehicle"]) == ["old 1", "new 1", "new 1", "new 1", "old 2"]


def test_the_json_of_an_answer_names_types_and_reads_back(mixed):
    data = mixed.answer_to_json(wb.Routes(ROUTES.routes[:3]))
    assert [route["vehicle"] for route in data["routes"]] == ["old", "new", "old"]
    assert mixed.answer_from_json(data) == wb.Routes(ROUTES.routes[:3])


def test_facts_name_depots_and_count_what_is_out_of_reach(problem):
    assert wb.read("demo-tiny", capacity=9).facts()["sites"]["unreachable"] > 0
    assert problem.facts()["sites"]["unreachable"] == 0
    assert problem.facts()["fleet"][0]["start"] == problem.sites.ids[0]
    alone = wb.RoutingProblem(wb.Sites.of(["d"]), wb.Travel("euclidean", [[0, 0]]), (wb.VehicleType(),))
    assert alone.facts()["demand"] == {"total": 0.0, "least": 0.0, "largest": 0.0}


@pytest.mark.parametrize(("settings", "kind"), [({"capacity": 9}, "site"), ({"vehicles": 1}, "fleet")])
def test_reasons_are_proofs_that_the_checker_confirms(settings, kind):
    problem = wb.read("demo-tiny", **settings)
    reasons = list(problem.infeasibility_reasons())
    assert {reason.kind for reason in reasons} == {kind}
    assert all(verified_bound(problem, reason.evidence) == math.inf for reason in reasons)


def test_a_search_for_reasons_can_be_given_up():
    assert list(wb.read("demo-tiny", vehicles=1).infeasibility_reasons(lambda: True)) == []


@pytest.mark.parametrize("suffix", [".sol", ".tour"])
def test_solution_files_read_back_the_same(problem, suffix):
    one = dataclasses.replace(problem, fleet=(wb.VehicleType(1),))
    answer = wb.Routes.of([one.customers.tolist()])
    one.check_answer_suffix(suffix)
    assert one.answer_from_text(one.answer_to_text(answer, suffix, 12.5)) == (answer, 12.5 if suffix == ".sol" else None)


def test_solution_files_that_name_no_types_are_refused_for_a_mixed_fleet(mixed):
    for suffix in (".sol", ".tour"):
        with pytest.raises(wb.UsageError, match=r"which of the 2 vehicle types drives a route; use \.json"):
            mixed.check_answer_suffix(suffix)
    with pytest.raises(wb.UsageError, check=coded("unsupported")):
        mixed.answer_from_text("Route #1: 1\n")
    mixed.check_answer_suffix(".json")


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    """A tour of length 14 at most, whose depot has a score."""
    path = tmp_path_factory.mktemp("scored") / "t.oplib"
    path.write_text(
        "NAME : t\nTYPE : OP\nDIMENSION : 5\nCOST_LIMIT : 14\nEDGE_WEIGHT_TYPE : EUC_2D\n"
        "NODE_COORD_SECTION\n1 0 0\n2 3 0\n3 0 4\n4 5 5\n5 -2 -1\n"
        "NODE_SCORE_SECTION\n1 100\n2 7\n3 5\n4 9\n5 4\nDEPOT_SECTION\n1\n-1\nEOF\n"
    )
    return wb.read(path)


def test_the_reward_of_a_depot_counts_without_a_visit(scored):
    assert scored.constant == 100
    assert scored.evaluate(wb.Routes.of([])).objective == 100
    assert scored.evaluate(wb.Routes.of([[1, 2]])).quantities["reward"] == 112
    assert dataclasses.replace(scored, objective=3 * wb.Reward() - wb.TotalCost()).constant == 300
    assert dataclasses.replace(scored, objective=wb.TotalCost()).constant == 0


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("solver", "options"),
    [("highs", {}), ("highs", {"form": "three-index"}), ("ortools", {"iterations": 60}), ("pyvrp", {"iterations": 300})],
)
def test_the_reward_of_a_depot_is_part_of_what_solvers_find_and_prove(scored, solver, options):
    tours = [list(order) for n in range(5) for order in itertools.permutations(range(1, 5), n)]
    judged = [scored.evaluate(wb.Routes.of([tour] if tour else [])) for tour in tours]
    best = max(each.objective for each in judged if each.feasible)
    made = wb.solve(scored, solver, time_limit=60, bound_time=0, **options)
    assert (made.objective, made.faults) == (best, ())
    assert made.bound is None or made.bound == best


def test_a_problem_of_a_frame_is_saved_with_its_objective_moves_and_clock(tmp_path):
    import pandas as pd

    sites = pd.DataFrame(
        {
            "name": ["h", "n", "e"], "due": pd.to_datetime(["2026-05-04 18:00"] * 3), "reward": [0, 2, 3], "required": False,
            "phone": list("123"),
        }
    )  # fmt: skip
    matrix = [[0, 1, 2], [3, 0, math.inf], [1, 1, 0]]
    problem = wb.RoutingProblem.from_frame(sites, travel=matrix, vehicles=1, time_unit="h", objective="reward then total-cost")
    problem.save(tmp_path / "p.json")
    again = wb.read(tmp_path / "p.json")
    assert again.digest() == problem.digest() and again.clock == problem.clock and again.sites.attributes == {"phone": ("1", "2", "3")}
    assert str(again.objective) == "reward, then total-cost" and again.forbidden.sum() == 1 and again.notes == problem.notes
    with pytest.raises(wb.UsageError, match="cannot be written as"):
        problem.save(tmp_path / "p.vrp")
    assert not (tmp_path / "p.vrp").exists()


def test_a_usual_objective_is_no_hindrance_to_other_formats(tmp_path):
    problem = wb.read("demo-tiny")
    problem.save(tmp_path / "p.csv")
    assert wb.read(tmp_path / "p.csv", problem=problem.problem).digest() == problem.digest()


def test_each_level_of_priority_is_shown_with_its_sense() -> None:
    shown = repr(wb.read("demo-tiny", objective="vehicles then total-cost"))
    assert ", min vehicles, then min total-cost, convention" in shown


def test_other_parts_leave_nothing_behind_of_the_former_ones(problem) -> None:
    distances = problem.travel_of(0).distances
    asked = problem.features()
    made = problem.altered(fleet=(wb.VehicleType(speed=2.0, max_duration=50.0),), min_vehicles=1)
    assert made.features() == (asked - {"capacity", "limited-fleet"}) | {"vehicle-speeds", "max-duration", "min-vehicles"}
    assert made.travel_of(0).durations == pytest.approx(distances / 2.0)
    assert problem.features() == asked and problem.travel_of(0).distances is distances
