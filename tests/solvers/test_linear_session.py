import math

import numpy as np
import pytest
from programs import program
from scipy.optimize import linprog

from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.linear_session import LinearSession


def afresh(p, lower, upper) -> tuple[int, float]:
    dense, sign = p.matrix.toarray(), 1.0 if p.sense == "min" else -1.0
    found = linprog(
        sign * p.cost, A_ub=np.vstack([dense, -dense]), b_ub=np.concatenate([p.row_upper, -p.row_lower]),
        bounds=np.column_stack([lower, upper]),
    )  # fmt: skip
    return found.status, sign * found.fun + p.offset if found.status == 0 else math.nan


@pytest.mark.parametrize("seed", range(20))
def test_changed_bounds_give_what_a_fresh_run_gives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, n = 4, 6
    matrix = rng.integers(-4, 5, (m, n)).astype(float)
    middle = matrix @ rng.integers(-2, 3, n)
    p = program(rng.integers(-5, 6, n), matrix, middle - 3.0, middle + 3.0, -5.0, 5.0, sense=str(rng.choice(["min", "max"])), offset=2.0)
    session = LinearSession(p)
    basis = None
    for turn in range(12):
        lower = rng.integers(-5, 2, n).astype(float)
        upper = lower + rng.integers(0, 6, n)
        session.bound(lower, upper)
        if basis is not None and turn % 3 == 0:
            session.start(basis)
        found = session.solve(NEVER)
        status, value = afresh(p, lower, upper)
        assert found.status == {0: "optimal", 2: "infeasible"}[status]
        if status == 0:
            assert found.value == pytest.approx(value, abs=1e-7)
            assert (found.x >= lower - 1e-7).all() and (found.x <= upper + 1e-7).all()
            basis = session.basis()
        else:
            assert found.ray is not None


def test_a_ray_is_known_even_where_the_first_look_tells_that_there_is_no_point() -> None:
    found = LinearSession(program([1.0], [[0.0]], 0.5, 1.0, 0.0, 1.0)).solve(NEVER)
    assert found.status == "infeasible" and found.ray is not None and found.ray.tolist() == [1.0]
    found = LinearSession(program([1.0, 1.0], [[1.0, 1.0], [1.0, 2.0]], [0.0, -math.inf], [9.0, -1.0], 0.0, 1.0)).solve(NEVER)
    assert found.status == "infeasible" and found.ray is not None and found.ray[1] < 0


def test_bounds_that_cross_and_a_stop_that_is_reached_need_no_run() -> None:
    session = LinearSession(program([1.0], [[1.0]], 0.0, 1.0, 0.0, 1.0))
    session.bound(np.array([2.0]), np.array([1.0]))
    assert session.solve(NEVER).status == "infeasible"
    session.bound(np.array([0.0]), np.array([1.0]))
    assert session.solve(Stop(0.0)).status == "unknown"
    assert session.solve(NEVER).status == "optimal"


def test_a_limit_of_iterations_is_kept_and_the_next_run_goes_on() -> None:
    rng = np.random.default_rng(2)
    session = LinearSession(program(-rng.random(40), rng.random((30, 40)), -math.inf, 10.0, 0.0, 1.0))
    assert session.solve(NEVER, 1).status == "iterations"
    assert session.solve(NEVER).status == "optimal"


@pytest.mark.parametrize("seed", range(10))
def test_columns_that_are_added_count_as_if_they_had_always_been_there(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, n = 4, 9
    matrix = rng.integers(-2, 5, (m, n)).astype(float)
    right, cost = matrix @ rng.integers(0, 3, n), rng.integers(1, 9, n).astype(float)
    session = LinearSession(program(cost[:3], matrix[:, :3], right, right, 0.0, math.inf))
    session.solve(NEVER)
    for first, last in ((3, 4), (4, 9)):
        rows, columns = np.nonzero(matrix[:, first:last])
        order = np.lexsort((rows, columns))
        starts = np.searchsorted(columns[order], np.arange(last - first))
        session.add(cost[first:last], starts, rows[order], matrix[:, first:last].T[matrix[:, first:last].T != 0])
        found = session.solve(NEVER)
        p = program(cost[:last], matrix[:, :last], right, right, 0.0, math.inf)
        status, value = afresh(p, np.zeros(last), np.full(last, math.inf))
        assert found.status == {0: "optimal", 2: "infeasible"}[status]
        if status == 0:
            assert found.value == pytest.approx(value, abs=1e-7) and len(found.x) == last
    assert found.status == "optimal"
    upper = session.upper.copy()
    upper[n - 1] = 0.0
    session.bound(session.lower, upper)
    status, value = afresh(p, np.zeros(n), upper)
    found = session.solve(NEVER)
    assert found.status == {0: "optimal", 2: "infeasible"}[status]
    if status == 0:
        assert found.value == pytest.approx(value, abs=1e-7)


def test_changed_costs_count_from_then_on() -> None:
    p = program(np.ones(3), np.ones((1, 3)), np.array([2.0]), np.array([9.0]), 0.0, 5.0)
    session = LinearSession(p)
    assert session.solve(NEVER).value == pytest.approx(2.0)
    session.price(np.array([1]), np.array([0.25]))
    assert session.solve(NEVER).value == pytest.approx(0.5)
