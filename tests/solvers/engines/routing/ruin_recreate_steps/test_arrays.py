from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_routing import small

import waybound as wb
from waybound import Route, Routes, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.objective import LongestRoute, Reward, TotalCost, Vehicles
from waybound.instances.routing.sites import Group
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.engines.routing.routing_integers import integer_routing, searched_integers, with_slope
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import MOST, Arrays, arrays


def made(problem: RoutingProblem, neighbours: int = 60) -> Arrays:
    return arrays(problem, with_slope(problem, integer_routing(problem)), neighbours, 1)


def test_an_answer_comes_back_as_it_went_in() -> None:
    problem = small("heterogeneous-fleet", 1, "round")
    answer = Routes.of([Route((3, 4, 5), 1), Route((1,), 0), Route((2,), 2)])
    held = made(problem)
    assert held.begin(answer)
    assert sorted(held.routes(held.node[:, k.FOLLOWING]), key=lambda r: r.visits) == sorted(answer, key=lambda r: r.visits)
    assert held.sums[k.ABSENT] == 0


@pytest.mark.parametrize("routes", [[Route((99,))], [Route((0,))], [Route((1, 2), 7)], [Route((1,)), Route((1, 2))], [Route((1,), 1)] * 2])
def test_an_answer_of_other_sites_or_vehicles_changes_nothing(routes: list[Route]) -> None:
    held = made(small("heterogeneous-fleet", 1, "round"))
    before = held.node.copy()
    assert not held.begin(Routes.of(routes))
    assert np.array_equal(held.node, before)


def test_a_route_that_breaks_a_limit_is_dissolved_and_the_others_stay() -> None:
    problem = small("capacity", 0, "round")
    heavy = problem.customers[np.argsort(-problem.sites.demand[problem.customers])].tolist()
    held = made(problem)
    assert held.begin(Routes.of([heavy[:4], heavy[4:]]))
    assert [route.visits for route in held.routes(held.node[:, k.FOLLOWING])] == [tuple(heavy[4:])]
    assert held.sums[k.ABSENT] == 4


def test_moves_of_one_kind_are_kept_once() -> None:
    rng = np.random.default_rng(1)
    one_way, hours = rng.integers(1, 9, (2, 4, 4)).astype(float)
    both = np.minimum(one_way, one_way.T)
    sites = Sites.of(range(4), coordinates=np.zeros((4, 2)))

    def kinds(lengths: np.ndarray, times: np.ndarray) -> tuple[int, list[int]]:
        held = made(RoutingProblem(sites, Travel(EXPLICIT, None, lengths, times, convention="exact"), (VehicleType(max_duration=99.0),)))
        return held.ways.shape[-1], held.at_way[:4].tolist()

    assert kinds(both, both) == (1, [0, 0, 0, 0])
    assert kinds(one_way, one_way) == (2, [1, 0, 1, 0])
    assert kinds(both, hours) == (3, [0, 0, 2, 1])
    assert kinds(one_way, hours) == (4, [1, 0, 3, 2])


def test_neighbours_are_the_nearest_of_those_that_can_be_on_one_route() -> None:
    xy = np.array([[0, 0], [1, 0], [2, 0], [3, 0]], dtype=float)
    sites = Sites.of(range(4), ready=[0, 0, 0, 50], due=[99, 5, 5, 99], service=[0, 9, 9, 9], coordinates=xy)
    held = made(RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(),)))
    assert held.near[1].tolist() == [3, -1]  # nobody is at 1 and at 2 in time
    assert held.near[3].tolist() == [2, 1]
    assert made(RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(),)), 1).near.shape == (4, 1)


def test_rewards_that_outweigh_all_distance_count_as_much_as_is_asked_for() -> None:
    problem = small("reward", 0, "round")
    held = made(problem)
    assert held.begin(Routes.of([problem.customers.tolist()[:1]]))
    held.reward(2.0)
    visited = problem.customers.tolist()[0]
    cost = int(held.route[:, k.COST].sum())
    assert held.site[visited, k.MISSED] == pytest.approx(2.0 * cost, rel=1e-6)
    ratio = held.site[problem.customers, k.MISSED] / problem.sites.reward[problem.customers]
    assert ratio == pytest.approx(np.full(len(ratio), ratio[0]), rel=0.05)
    assert held.sums[k.SEARCHED] == cost + held.site[held.absent[: held.sums[k.ABSENT]], k.MISSED].sum()


def test_forbidden_moves_are_longer_than_any_route() -> None:
    problem = small("capacity", 0, "round")
    shut = np.zeros((len(problem.sites),) * 2, dtype=bool)
    shut[1, 2] = True
    held = made(replace(problem, forbidden=shut))
    assert held.ways[0, 1, 2, held.at_way[1]] == MOST > held.types[0, k.MAX_DISTANCE]
    assert held.ways[0, 2, 1, held.at_way[0]] == MOST


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("committed", [False, True])
@pytest.mark.parametrize(
    "objective", [LongestRoute() + 0.5 * Vehicles(), 9.0 * Vehicles() + TotalCost(), Vehicles() + 2.0 * LongestRoute()]
)
def test_the_objective_in_integers_is_that_of_the_problem(objective: Any, committed: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 10, (7, 2))
    sites = Sites.of(range(7), depot=np.arange(7) == 0, coordinates=xy)
    travel = Travel(EXPLICIT, xy, np.hypot(*(xy[:, None] - xy[None]).transpose(2, 0, 1)))
    fleet = [VehicleType(count=2, fixed_cost=3.0), VehicleType(count=2, fixed_cost=1.5, unit_cost=0.5, committed=committed)]
    problem = RoutingProblem(sites, travel, fleet, objective)
    data, _sloped = searched_integers(problem)
    held = arrays(problem, data, 60, 1)
    for _ in range(10):
        visits = np.array_split(rng.permutation(np.arange(1, 7)), rng.integers(1, 4))
        answer = Routes.of(Route(tuple(map(int, one)), kind) for one, kind in zip(visits, rng.permutation([0, 0, 1, 1]), strict=False))
        assert held.put(answer)
        assert held.sums[k.OBJECTIVE] / data.cost_factor == pytest.approx(problem.evaluate(answer).values[0], rel=1e-4)


@pytest.mark.parametrize(("rewards", "told"), [(0.0, True), (np.arange(13.0), False)])
def test_steps_may_end_early_where_all_of_a_group_are_worth_the_same(rewards: Any, told: bool) -> None:
    problem = wb.generate("random", customers=12, capacity=40)
    groups = tuple(Group(tuple(members), True) for members in problem.customers.reshape(4, 3).tolist())
    none = np.zeros(13, dtype=bool)
    sites = replace(problem.sites, groups=groups, required=none, reward=np.broadcast_to(rewards, 13))
    held = made(replace(problem, sites=sites, objective=TotalCost() - Reward()))
    assert held.most_visits == 4 and bool(held.flags & k.LENGTHENED) is told


@pytest.mark.parametrize(("shortcut", "told"), [(0.0, True), (60.0, False)])
def test_steps_may_end_early_where_no_visit_more_is_a_shortcut(shortcut: float, told: bool) -> None:
    xy = np.random.default_rng(1).uniform(0, 100, (12, 2))
    lengths = np.rint(np.hypot(*(xy[:, None] - xy[None]).transpose(2, 0, 1)))
    far = np.unravel_index(lengths.argmax(), lengths.shape)
    lengths[far] += shortcut
    sites = Sites.of(range(12), depot=np.arange(12) == 0, demand=np.where(np.arange(12) == 0, 0.0, 1.0))
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=lengths), [VehicleType(capacity=5.0)])
    assert bool(made(problem).flags & k.LENGTHENED) is told
