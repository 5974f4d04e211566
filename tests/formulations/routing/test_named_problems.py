from dataclasses import replace

import numpy as np
import pytest
from coded import coded

import waybound as wb
from waybound import Energy, Group, InputError, RoutingInstance, RoutingProblem, Shipment, Sites, Travel, UsageError, VehicleType
from waybound.formulations.problem import PROBLEMS, problem_from_instance
from waybound.formulations.routing.objective import DEFAULT_OBJECTIVE, TERMS, Objective, Reward, TotalCost, default_objective
from waybound.instances.routing.fleet import with_problems

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4)], dtype=float)
TRAVEL = Travel("euclidean", XY)
PLAIN = Sites.of("oabc", demand=[0, 1, 2, 3], reward=[0, 4, 10, 5])
NAMES = {
    "vrptw": (wb.vrptw, Sites.of("oabc", due=50.0), {"capacity": 9}, "total-cost"),
    "cvrp": (wb.cvrp, PLAIN, {"capacity": 9}, "total-cost"),
    "tsp": (wb.tsp, PLAIN, {}, "total-cost"),
    "mdvrp": (wb.mdvrp, Sites.of("oabc", depot=[True, True, False, False]), {"vehicles": 2}, "total-cost"),
    "min-cost-vrp": (wb.min_cost_vrp, PLAIN, {"max_duration": 14}, "total-cost"),
    "min-makespan-vrp": (wb.min_makespan_vrp, PLAIN, {"vehicles": 2}, "makespan"),
    "orienteering": (wb.orienteering, PLAIN, {"max_duration": 9}, "reward"),
    "team-orienteering": (wb.team_orienteering, PLAIN, {"max_duration": 9, "vehicles": 2}, "reward"),
    "makespan-orienteering": (wb.makespan_orienteering, PLAIN, {"max_duration": 9, "vehicles": 2}, "reward, then makespan"),
    "recharging-vrp": (wb.recharging_vrp, PLAIN, {"energy": 12}, "makespan"),
    "pdptw": (wb.pdptw, Sites.of("oabc", shipments=[Shipment(1, 2)]), {"capacity": 9}, "vehicles, then total-cost"),
}


@pytest.mark.parametrize("name", NAMES)
def test_each_has_its_name_and_its_objective(name):
    build, sites, given, objective = NAMES[name]
    problem = build(sites, TRAVEL, **given)
    assert (problem.problem, str(problem.objective)) == (name, objective)
    assert str(DEFAULT_OBJECTIVE[name]) == objective and name in PROBLEMS


@pytest.mark.parametrize("name", NAMES)
def test_each_can_be_asked_of_data_that_suit_it(name):
    build, sites, given, objective = NAMES[name]
    made = build(sites, TRAVEL, **given)
    instance = with_problems(RoutingInstance("i", "test", made.sites, TRAVEL, made.fleet))
    assert name in instance.problems
    assert str(problem_from_instance(instance, name).objective) == objective


def test_the_objective_of_a_file_is_that_of_its_own_problem():
    names = ("vrptw", "min-cost-vrp", "min-makespan-vrp")
    instance = RoutingInstance("i", "test", PLAIN, TRAVEL, (VehicleType(2),), "vrptw", names, objective=("vehicles", "total-cost"))
    asked = {name: str(problem_from_instance(instance, name).objective) for name in instance.problems}
    assert asked == {"vrptw": "vehicles, then total-cost", "min-cost-vrp": "vehicles, then total-cost", "min-makespan-vrp": "makespan"}


@pytest.mark.parametrize(
    ("sites", "objective"),
    [
        ({"required": [False] * 4, "reward": [0, 2, 3, 4]}, "total-cost - reward"),
        ({"required": [False] * 4, "penalty": [0, 2, 3, 4]}, "total-cost + penalties"),
        ({"required": [0, 1, 0, 0], "penalty": [0, 0, 3, 4], "reward": [0, 0, 0, 1]}, "total-cost + penalties - reward"),
        ({"required": [0, 1, 1, 1], "penalty": [0, 2, 3, 4], "reward": [0, 1, 1, 1]}, "total-cost"),
        ({"required": [0, 1, 1, 0], "reward": [0, 1, 1, 0]}, "total-cost"),
        ({"groups": [Group((1, 2))], "required": [0, 0, 0, 1]}, "total-cost"),
        ({"groups": [Group((1, 2))], "required": [0, 0, 0, 1], "reward": [0, 1, 2, 0]}, "total-cost - reward"),
        ({"groups": [Group((1, 2), required=False)], "required": [0, 0, 0, 1], "reward": [0, 1, 2, 0]}, "total-cost - reward"),
    ],
)
def test_what_sites_that_may_be_left_out_are_worth_counts_by_default(sites, objective):
    made = Sites.of("oabc", **{**sites, "required": np.array(sites["required"], dtype=bool)})
    assert str(default_objective("min-cost-vrp", made)) == objective
    assert str(wb.min_cost_vrp(made, TRAVEL).objective) == objective
    assert str(default_objective("min-makespan-vrp", made)) == "makespan"
    pairs = replace(made, groups=(), shipments=(Shipment(2, 3),)) if made.required[2] == made.required[3] else None
    if pairs is not None and objective != "total-cost":
        assert str(wb.pdptw(pairs, TRAVEL, capacity=9).objective) == objective


def test_a_problem_keeps_its_objective_in_its_file():
    made = Sites.of("oabc", required=False, reward=[0, 9, 9, 9])
    for aim in (None, TotalCost(), TotalCost() - Reward()):
        problem = wb.min_cost_vrp(made, TRAVEL, objective=aim)
        again = RoutingProblem.from_instance(problem.to_instance())
        assert str(again.objective) == str(problem.objective) and again.digest() == problem.digest()
    idle = wb.min_cost_vrp(Sites.of("oabc", required=False), TRAVEL)
    assert idle.to_instance().objective == ("total-cost",)


def test_whatever_a_vehicle_type_takes_may_be_added():
    problem = wb.cvrp(PLAIN, TRAVEL, capacity=9, vehicles=2, shift=(1, 50), skills={"cold"}, unit_duration_cost=2, min_vehicles=1, name="x")
    assert (problem.fleet[0].shift, problem.fleet[0].skills, problem.min_vehicles, problem.name) == ((1, 50), {"cold"}, 1, "x")
    own = wb.min_cost_vrp(PLAIN, TRAVEL, fleet=[VehicleType(1, speed=2)], objective=Objective.of(TotalCost()))
    assert own.fleet[0].speed == 2


@pytest.mark.parametrize(
    ("build", "given", "message"),
    [
        (wb.vrptw, {}, "no site has a time window"),
        (wb.mdvrp, {}, "there is one depot only"),
        (wb.pdptw, {"capacity": 5}, "there are no shipments"),
        (wb.makespan_orienteering, {"vehicles": 1, "weight": "printed"}, "the printed weight needs a limit of duration"),
    ],
)
def test_data_that_lack_what_the_name_stands_for_are_refused(build, given, message):
    with pytest.raises(InputError, match=message):
        build(PLAIN, TRAVEL, **given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"wheels": 4}, "min-cost-vrp does not know wheels"),
        ({"fleet": [VehicleType()], "vehicles": 3}, "fleet tells the vehicles already"),
        ({"fleet": [VehicleType()], "max_duration": 3}, "fleet tells the vehicles already; leave out vehicles, max_duration"),
    ],
)
def test_settings_that_mean_nothing_are_refused(given, message):
    with pytest.raises(UsageError, match=message):
        wb.min_cost_vrp(PLAIN, TRAVEL, **given)


@pytest.mark.parametrize("build", [wb.orienteering, wb.team_orienteering])
def test_orienteering_needs_rewards(build):
    with pytest.raises(InputError, check=coded("missing")):
        build(Sites.of("oabc"), TRAVEL, **({} if build is wb.orienteering else {"vehicles": 1}))


def test_an_unknown_weight_is_refused():
    with pytest.raises(UsageError, match="unknown weight 'large'"):
        wb.makespan_orienteering(PLAIN, TRAVEL, vehicles=1, max_duration=9, weight="large")


@pytest.mark.parametrize(("limits", "weight"), [({"max_duration": 10}, 0.4), ({"energy": Energy(16, rate=2)}, 0.5)])
def test_the_printed_weight_is_the_least_reward_over_the_longest_route(limits, weight):
    problem = wb.makespan_orienteering(PLAIN, TRAVEL, vehicles=2, weight="printed", **limits)
    assert str(problem.objective) == f"reward - {weight}*makespan"


def test_homes_of_recharging_vehicles_are_counted():
    sites = Sites.of("oabc", depot=[True, True, False, False])
    problem = wb.recharging_vrp(sites, TRAVEL, energy=9, homes=[1, 0, 1], rate=2)
    assert [(v.start, v.end, v.count, v.stations) for v in problem.fleet] == [(1, 1, 2, (0, 1)), (0, 0, 1, (0, 1))]
    with pytest.raises(InputError, match="starts or ends at site c, which is no depot; expected o, a"):
        wb.recharging_vrp(sites, TRAVEL, energy=9, homes=[3])


def test_every_term_has_a_name_of_its_own():
    assert {"total-duration", "latest-return", "penalties"} <= TERMS.keys()
