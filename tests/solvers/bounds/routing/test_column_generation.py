"""The linear program of a node: its value is that of all routes, rays prove that there are none, and dropped routes are not missed."""

import math

import numpy as np
import pytest
from draws import draws
from oracles import set_partitioning_bound
from patience import HANG
from small_routing import plane, small
from truth.routing import best_values

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.routing.checking.relaxation import relax
from waybound.formulations.stop import Stop
from waybound.solvers.bounds.routing import column_generation
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration, Part
from waybound.solvers.bounds.routing.set_partition import set_partition


def prepared(problem: RoutingProblem) -> tuple[ColumnGeneration, Part]:
    partition = set_partition(problem)
    assert partition is not None
    columns = ColumnGeneration(problem, partition, Stop(HANG), lambda bound: False, 1)
    return columns, Part(columns.cost, partition.fewest, partition.most, partition.optional)


@pytest.mark.parametrize("seed", range(draws(20)))
def test_the_bound_is_the_linear_relaxation_over_all_routes(seed: int) -> None:
    problem = small("time-windows", seed, "exact")
    relaxed = relax(problem)
    assert relaxed is not None
    if best_values(problem) is None:
        return
    columns, part = prepared(problem)
    solved = columns.solve(part, None)
    truth = set_partitioning_bound(problem, relaxed.fewest)
    assert solved.status == "done" and solved.bound * columns.unit == pytest.approx(truth, rel=1e-7)
    assert columns.value(part) * columns.unit == pytest.approx(truth, rel=1e-7)


def test_too_few_vehicles_for_the_packing_end_in_a_ray_at_any_size_of_the_costs() -> None:
    for size in (1e-3, 1.0, 1e6):
        at = size * np.random.default_rng(1).integers(0, 50, (8, 2)).astype(float)
        sites = Sites.of(range(8), demand=[0, 7, 7, 7, 7, 7, 1, 0])  # 36 of 36, but no three sevens fit into 18
        columns, part = prepared(RoutingProblem(sites, Travel("euclidean", at), (VehicleType(2, 18.0),)))
        solved = columns.solve(part, None)
        assert (solved.status, solved.bound) == ("enough", math.inf) and solved.prices is not None


def test_moves_are_hopeless_only_where_every_route_over_them_costs_too_much() -> None:
    columns, part = prepared(plane(2, 8, 25.0))
    solved = columns.solve(part, None)
    all_of_them, none = columns.hopeless(part, solved, -2.0 * columns.dearest), columns.hopeless(part, solved, 1e3 * columns.dearest)
    assert all_of_them is not None and none is not None
    assert all_of_them[np.isfinite(part.cost[0])].all() and not none.any()


def test_routes_that_are_dropped_leave_the_value_and_what_was_solved_before_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    columns, part = prepared(plane(3, 14, 30.0))
    solved = columns.solve(part, None)
    before, many, flow = columns.value(part), len(columns.pool), solved.routes.flow(solved.values, part.cost.shape)
    monkeypatch.setattr(column_generation, "FEW", 0)
    columns.pool.add(columns.pool.new([(0, np.array([k, k + 1, k + 2])) for k in range(1, 9)]))  # later than the solution
    columns.purge(0.0)
    assert len(columns.pool) < many and columns.value(part) == pytest.approx(before)
    assert (solved.routes.flow(solved.values, part.cost.shape) == flow).all()


def test_with_room_for_few_routes_the_value_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = plane(3, 14, 30.0)
    columns, part = prepared(problem)
    usual = columns.solve(part, None)
    monkeypatch.setattr(column_generation, "CROWDED", 40)
    columns, part = prepared(problem)
    solved = columns.solve(part, None)
    assert solved.status == "done" and solved.bound == pytest.approx(usual.bound) and len(columns.pool) < 200
    assert columns.cut(solved, rows=True) and columns.solve(part, solved.prices).bound >= solved.bound - 1e-6


def test_where_labels_are_too_many_the_relaxation_is_made_weaker_step_by_step() -> None:
    columns, part = prepared(plane(3, 14, 30.0))
    solved = columns.solve(part, None)
    assert columns.cut(solved, rows=True)
    rows, memory = len(columns.cuts), columns.memory
    assert rows and columns.weaken() and not columns.cuts and columns.memory == memory
    while columns.weaken():
        memory //= 2
        assert columns.memory == memory
    assert memory == 1 and columns.near[1:, 1:].sum(axis=1).max() == 2
    again = columns.solve(part, None)
    assert again.status == "done" and again.bound <= solved.bound + 1e-6
    assert not columns.cut(again, rows=True) or not columns.cuts


def test_a_solution_tells_who_was_remembered_when_it_was_solved() -> None:
    columns, part = prepared(plane(3, 14, 30.0))
    columns.near = columns._nearest(1)
    heard = list[column_generation.Solved]()
    last = columns.solve(part, None, heard.append)
    numbers = [int(solved.near.sum()) for solved in heard]
    assert len(numbers) > 1 and numbers == sorted(set(numbers))
    assert (last.near == columns.near).all() and heard[0].bound <= last.bound
