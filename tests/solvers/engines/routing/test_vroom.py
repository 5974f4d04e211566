import itertools
from dataclasses import replace

import numpy as np
import pytest
from coded import coded
from small_routing import small

from waybound import Route, Routes, RoutingProblem, Shipment, Sites, Travel, UsageError, VehicleType
from waybound.formulations.routing.objective import Objective, Penalties, Reward, TotalCost, Vehicles
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.engines.routing.routing_integers import integer_routing
from waybound.solvers.engines.routing.vroom import HIGHEST, LARGEST, Model, Priorities, priorities

needs_vroom = pytest.mark.skipif(not BACKENDS["vroom"].installed(), reason="VROOM is not installed")


def model(problem: RoutingProblem, most: int = 5) -> Model:
    asked = priorities(problem)
    assert isinstance(asked, Priorities)
    return Model(asked, integer_routing(asked.problem, largest=LARGEST, total=LARGEST), most)


@needs_vroom
def test_types_that_no_route_can_use_are_left_out() -> None:
    problem = small("multiple-depots", 0, "round")
    n = len(problem.sites)
    sites = replace(problem.sites, ready=np.array([50.0] + [0.0] * (n - 1)), due=np.array([np.inf, 20.0] + [np.inf] * (n - 2)))
    assert model(replace(problem, sites=sites, fleet=(VehicleType(2, start=0, end=1), VehicleType(3)))).types == [1, 1, 1]


@needs_vroom
def test_it_costs_what_the_problem_says() -> None:
    problem = small("capacity", 0, "round")
    cost, routes = model(problem).solved(5, 5.0)
    assert problem.evaluate(routes).values == pytest.approx([cost])


@needs_vroom
def test_it_begins_with_answers_that_keep_the_rules_alone() -> None:
    problem = small("capacity", 0, "round")
    alone = Routes.of(Route((site,)) for site in problem.customers.tolist())
    begun, all_in_one, too_many = model(problem), model(problem), model(problem, most=2)
    begun.begin(alone)
    all_in_one.begin(Routes.of([Route(tuple(problem.customers.tolist()))]))
    too_many.begin(alone)
    assert sorted(begun.routes.values()) == [(site,) for site in problem.customers.tolist()]
    assert all_in_one.routes == too_many.routes == {}


@needs_vroom
def test_a_required_site_that_is_left_out_is_no_answer() -> None:
    problem = small("capacity", 0, "round")
    alone = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=float(problem.sites.demand.max())),))
    assert model(alone).solved(0, 5.0) == (0, None)


def rewarded(reward, objective=None, required=(), **sites) -> RoutingProblem:
    n = len(reward) + 1
    at = np.arange(n, dtype=float)
    held = Sites.of(range(n), reward=[0.0, *reward], required=[False, *(k + 1 in required for k in range(n - 1))], **sites)
    travel = Travel(EXPLICIT, matrix=np.abs(at[:, None] - at))
    return RoutingProblem(held, travel, (VehicleType(1),), objective or Reward().then(TotalCost()))


def of(asked: RoutingProblem) -> dict[int, int]:
    found = priorities(asked)
    assert isinstance(found, Priorities)
    return dict(found.of)


@pytest.mark.parametrize("unit", [1.0, 0.3, 2.0**-30, 7e8])
def test_multiples_of_one_number_are_counted(unit) -> None:
    assert of(rewarded([3 * unit, 0.0, 5 * unit, 100 * unit])) == {1: 3, 3: 5, 4: 100}


def test_what_vrooms_own_json_stands_for_comes_back() -> None:
    for listed in ([0, 0, 0], [3, 0, 100], [7, 8, 9], [50, 50, 50]):
        found = of(rewarded([p * 4 + 1.0 for p in listed]))
        order = lambda values: [(sum(x), len(x)) for x in values]  # noqa: E731
        chosen = [c for k in (1, 2, 3) for c in itertools.combinations(range(3), k)]
        ours, theirs = (order([[v[k] for k in c] for c in chosen]) for v in ([found[k + 1] for k in range(3)], listed))
        assert (
            np.argsort([a * 4 + b for a, b in ours], kind="stable").tolist()
            == np.argsort([a * 4 + b for a, b in theirs], kind="stable").tolist()
        )


def test_too_many_steps_are_refused_by_name() -> None:
    assert priorities(rewarded([1.0, 2.0, 101.5])) == {f"objective:reward in more than {HIGHEST} steps"}
    assert priorities(rewarded([np.pi, 1.0])) == {f"objective:reward in more than {HIGHEST} steps"}


@pytest.mark.parametrize(
    ("objective", "named"),
    [(TotalCost() - Reward(), "reward"), (TotalCost().then(Reward()), "reward"), (Reward().then(Penalties()), "penalties")],
)
def test_rewards_come_alone_and_first(objective, named) -> None:
    found = priorities(rewarded([1.0, 2.0], objective))
    assert isinstance(found, frozenset)
    assert any(named in name for name in found)


def test_what_follows_is_minimised() -> None:
    found = priorities(rewarded([1.0], Reward().then(Vehicles()).then(TotalCost())))
    assert isinstance(found, Priorities)
    assert found.problem.objective == Objective.of(Vehicles().then(TotalCost()))
    alone = priorities(rewarded([1.0], Reward()))
    assert isinstance(alone, Priorities)
    assert alone.problem.objective.is_only(TotalCost)


def test_required_sites_have_the_highest_and_no_choice_leaves_them_alone() -> None:
    found = priorities(rewarded([1.0, 2.0, 0.0], required=(1, 3)))
    assert isinstance(found, Priorities)
    assert (found.of, found.required, found.choosing) == ({1: HIGHEST, 2: 1, 3: HIGHEST}, {1, 3}, True)
    assert found.without_choice().of.keys() == {1, 3}
    without = priorities(rewarded([1.0, 2.0], TotalCost(), required=(2,)))
    assert isinstance(without, Priorities)
    assert (without.of, without.choosing) == ({2: 0}, False)


def test_both_ends_of_a_shipment_count_alike() -> None:
    pair = Shipment(1, 2, (1.0,))
    assert of(rewarded([1.0, 4.0, 5.0], shipments=(pair,))) == {1: 1, 2: 1, 3: 2}


@needs_vroom
def test_vroom_earns_what_it_can_and_leaves_no_required_site_out_for_more() -> None:
    def visited(asked: RoutingProblem) -> set[int]:
        return {site for route in run(asked, time_limit=5.0).answer for site in route.visits}

    near = rewarded([3.0, 2.0, 2.0, 9.0])
    short = lambda p, most: RoutingProblem(p.sites, p.travel, (VehicleType(1, max_distance=most),), p.objective)  # noqa: E731
    assert visited(short(near, 6.0)) == {1, 2, 3}
    assert visited(short(near, 8.0)) == {1, 2, 3, 4}
    # Two of the highest priority outweigh one required site, which is on the other side.
    apart = np.array([0.0, 4.0, -4.0, -4.0])
    sides = RoutingProblem(
        Sites.of(range(4), reward=[0, 0, 100, 100], required=[False, True, False, False]),
        Travel(EXPLICIT, matrix=np.abs(apart[:, None] - apart)), (VehicleType(1, max_distance=8.0),), Reward().then(TotalCost()),
    )  # fmt: skip
    assert visited(sides) == {1}
    assert visited(rewarded([0.0, 0.0])) == set()


def run(problem: RoutingProblem, **options):
    return BACKENDS["vroom"]().run(problem, Options(**options), Control())


@needs_vroom
def test_it_goes_the_ways_of_the_bare_library() -> None:
    import vroom

    problem = small("capacity", 0, "round")
    bare = vroom.Input()
    bare.set_durations_matrix("car", problem.travel.distances)
    bare.add_job([vroom.Job(i, i, delivery=[int(problem.sites.demand[i])]) for i in problem.customers.tolist()])
    bare.add_vehicle([vroom.Vehicle(k, start=0, end=0, capacity=[int(problem.fleet[0].capacity)]) for k in range(len(problem.customers))])
    found = bare.solve(exploration_level=5, nb_threads=1)
    ours = run(problem)
    assert ours.objective == found.summary.cost
    jobs = found.routes[found.routes["type"] == "job"]
    assert {r.visits for r in ours.answer} == {tuple(map(int, v["location_index"])) for _, v in jobs.groupby("vehicle_id")}


@needs_vroom
def test_the_exploration_level_is_a_number_from_0_to_5() -> None:
    problem = small("capacity", 0, "round")
    assert run(problem, extra={"exploration_level": "0"}).statistics["exploration_level"] == 0
    for wrong in (-1, 6):
        with pytest.raises(UsageError, check=coded("out-of-range")):
            run(problem, extra={"exploration_level": wrong})


@needs_vroom
def test_types_of_vehicles_have_costs_of_their_own() -> None:
    problem = small("capacity", 0, "round")
    dear, cheap = (
        replace(problem.fleet[0], unit_cost=3.0, name="dear"),
        replace(problem.fleet[0], unit_cost=0.5, fixed_cost=2.0, name="cheap"),
    )
    assert {r.vehicle for r in run(replace(problem, fleet=(dear, cheap))).answer} == {1}


@needs_vroom
def test_a_feasible_start_is_used_and_another_is_not() -> None:
    problem = small("time-windows", 0, "round")
    best = run(problem)
    again = run(problem, start=best.answer, extra={"exploration_level": 0})
    assert (again.statistics["start"], again.objective) == ("used", best.objective)
    assert run(problem, start=Routes.of([problem.customers.tolist()] * 2)).statistics["start"] == "refused"


@needs_vroom
def test_numbers_that_32_bits_cannot_hold_are_rounded() -> None:
    xy = np.array([[0.0, 0.0], [1.0, 1.0], [2.0**31, 0.0]])
    problem = RoutingProblem(Sites.of(range(3), coordinates=xy), Travel("EUC_2D", xy), (VehicleType(),))
    found = run(problem)
    assert found.statistics["scale"]["exact"] is False
    assert problem.evaluate(found.answer).values == pytest.approx([2.0**32])


@needs_vroom
def test_what_fractions_cost_is_told_by_the_problem_itself() -> None:
    problem = small("capacity", 0, "exact")
    found = run(problem)
    assert found.objective == problem.evaluate(found.answer).values[0]
    assert found.statistics["scale"]["exact"] is False
