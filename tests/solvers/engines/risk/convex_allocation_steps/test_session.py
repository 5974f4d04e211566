import numpy as np
import pytest

from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import Program, Variables
from waybound.formulations.programs.rows import rows
from waybound.formulations.stop import Stop
from waybound.solvers.engines.risk.convex_allocation_steps.session import ClarabelSession, HighsSession, open_session


def program(sense: str = "max", integer: bool = False) -> Program:
    """max x + 2 y, x + y <= 4, x + 3 y <= 6, 0 <= x, y <= 3."""
    x = Variables("x", (), (), np.zeros(2), np.full(2, 3.0), np.array([1.0, 2.0]) * (1 if sense == "max" else -1), integer)
    limits = rows(
        "limit", 2, [(np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1]), np.array([1.0, 1.0, 1.0, 3.0]))], upper=np.array([4.0, 6.0])
    )
    return Program("it", sense, (x,), (limits,), offset=1.0)


@pytest.mark.parametrize("kind", [HighsSession, ClarabelSession])
@pytest.mark.parametrize("sense", ["max", "min"])
def test_value_and_duals_before_and_after_changes(kind, sense: str) -> None:
    session, sign = kind(program(sense)), 1.0 if sense == "max" else -1.0
    solution = session.solve(Stop())
    offset = 1.0
    assert (solution.status, solution.value) == ("optimal", pytest.approx(sign * 5.0 + offset))
    assert solution.x == pytest.approx([3.0, 1.0], abs=1e-6)
    assert solution.duals[0] * 4 + solution.duals[1] * 6 + sign * (1 - sign * (solution.duals[0] + solution.duals[1])) * 3 == pytest.approx(
        sign * 5.0, abs=1e-6
    )
    session.change_upper(0, np.array([4.0, 3.0]))
    assert session.solve(Stop()).value == pytest.approx(sign * 3.0 + offset)
    session.add(rows("more", 1, [(np.zeros(1, int), np.zeros(1, int), 1.0)], upper=1.0))
    last = session.solve(Stop())
    assert last.value == pytest.approx(sign * (1 + 4 / 3) + offset) and len(last.duals) == 3
    session.add(rows("none", 1, [(np.zeros(1, int), np.ones(1, int), 1.0)], lower=5.0))
    ended = session.solve(Stop())
    assert ended.status == "infeasible" and (ended.ray is None or len(ended.ray) == 4)


@pytest.mark.parametrize("kind", [HighsSession, ClarabelSession])
def test_columns_are_added_and_shortened(kind) -> None:
    session = kind(program())
    assert session.solve(Stop()).value == pytest.approx(6.0)
    # u takes from the first row and w from both: max x + 2 y, x + y - u - w <= 4, x + 3 y - 2 w <= 6, u <= 1, w <= 0.5.
    session.add_columns(np.array([1.0, 0.5]), np.array([0, 1, 1]), np.array([0, 0, 1]), np.array([-1.0, -1.0, -2.0]))
    solution = session.solve(Stop())
    assert solution.value == pytest.approx(1.0 + 3.0 + 2.0 * 4.0 / 3.0) and solution.x[[0, 1, 3]] == pytest.approx(
        [3.0, 4.0 / 3.0, 0.5], abs=1e-6
    )
    session.change_column_upper(np.array([3]), np.array([0.0]))
    assert session.solve(Stop()).value == pytest.approx(6.0)


def test_whole_numbers_come_with_a_bound() -> None:
    solution = open_session(program(integer=True)).solve(Stop())
    assert solution.value == pytest.approx(6.0) and solution.bound == pytest.approx(6.0) and not len(solution.duals)


def test_cones_are_clarabels() -> None:
    p = program("min")
    cone = Cones(
        "c", "second-order", 3, np.array([0, 0, 1, 2], np.int32), np.array([0, 1], np.int32), np.ones(2), np.array([1.0, 0.0, 0.0])
    )
    session = open_session(Program("it", "min", p.variables, p.rows, cones=(cone,)))
    assert isinstance(session, ClarabelSession)
    solution = session.solve(Stop())
    assert solution.value == pytest.approx(-np.sqrt(5.0), abs=1e-6)
    assert solution.cone_duals[0] == pytest.approx(np.hypot(*solution.cone_duals[1:]), abs=1e-6)


@pytest.mark.parametrize("kind", [HighsSession, ClarabelSession])
def test_nothing_is_known_without_time(kind) -> None:
    assert kind(program()).solve(Stop(0.0)).status == "unknown"
