import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st
from programs import program

from waybound import Program, UnsupportedError, UsageError
from waybound.formulations.programs.cones import Cones
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.backends.outer_approximation import OuterApproximation

VARIANTS = ["", "highs", "mathopt:highs", *(["scip"] if BACKENDS["scip"].installed() else [])]


def cone(rows, offset) -> Cones:
    """One second-order cone."""
    a = np.asarray(rows, dtype=float)
    row, column = np.nonzero(a)
    starts = np.cumsum([0, *np.bincount(row, minlength=len(a))]).astype(np.int32)
    return Cones("ball", "second-order", len(a), starts, column.astype(np.int32), a[row, column], np.asarray(offset, dtype=float))


def ball(cost, radius: float, centre=(0.0, 0.0), sense: str = "max") -> Program:
    """Whole points of a disc."""
    plain = program(cost, [[1.0, 1.0]], -50, 50, -20, 20, integer=(0, 1), sense=sense)
    return replace(plain, cones=(cone([[0, 0], [1, 0], [0, 1]], [radius, -centre[0], -centre[1]]),))


@pytest.mark.parametrize("variant", VARIANTS)
def test_whole_points_of_a_disc(variant: str) -> None:
    result = OuterApproximation(variant).run(ball([3.0, 2.0], 5.0), Options(time_limit=20.0), Control())
    assert (result.status, result.objective, result.bound) == ("optimal", pytest.approx(18.0), pytest.approx(18.0))
    assert result.answer == pytest.approx([4.0, 3.0]) and result.statistics["rows_added"] > 0


@settings(max_examples=draws(30), deadline=None)
@given(cost=st.tuples(*[st.integers(-9, 9)] * 2), radius=st.integers(1, 60), centre=st.tuples(*[st.integers(-20, 20)] * 2))
def test_the_best_point_of_all(cost, radius, centre) -> None:
    """Radii between those of whole points, for what lies on the rim is a matter of tolerances."""
    size, middle = math.sqrt(radius + 0.37), (centre[0] / 4.0, centre[1] / 4.0)
    points = [p for p in itertools.product(range(-20, 21), repeat=2) if (p[0] - middle[0]) ** 2 + (p[1] - middle[1]) ** 2 <= size**2]
    result = OuterApproximation().run(ball([float(c) for c in cost], size, middle), Options(time_limit=20.0), Control())
    if not points:
        assert result.status == "infeasible"
        return
    assert (result.status, result.objective) == ("optimal", pytest.approx(max(cost[0] * x + cost[1] * y for x, y in points), abs=1e-6))


def test_a_cone_with_a_tip_that_is_a_variable_is_met_at_its_tip() -> None:
    """The least t that is no less than the norm of (x + 1, y), x + y being 3 at least."""
    plain = program([0.0, 0.0, 1.0], [[1.0, 1.0, 0.0]], 3.0, math.inf, 0, [9, 9, 99], integer=(0, 1))
    asked = replace(plain, cones=(cone([[0, 0, 1], [1, 0, 0], [0, 1, 0]], [0, 1, 0]),))
    result = OuterApproximation().run(asked, Options(time_limit=20.0), Control())
    assert (result.status, result.objective) == ("optimal", pytest.approx(math.sqrt(8.0), abs=1e-5))


def test_bounds_are_published_on_the_way_and_nodes_are_counted_over_all_programs() -> None:
    class Listening(Control):
        bounds: list[float]

        def publish(self, answer=None, objective=None, bound=None, evidence=()) -> None:
            super().publish(answer, objective, bound, evidence)
            self.bounds = [*getattr(self, "bounds", []), *([] if bound is None else [bound])]

    control = Listening()
    result = OuterApproximation().run(ball([7.0, 5.0], 9.31), Options(time_limit=20.0), control)
    assert result.status == "optimal" and control.bounds[-1] == pytest.approx(result.objective)
    assert all(bound >= result.objective - 1e-6 for bound in control.bounds)
    few = OuterApproximation().run(ball([7.0, 5.0], 9.31), Options(time_limit=20.0, iterations=1), Control())
    assert few.status in ("unknown", "feasible", "optimal") and (few.bound is None or few.bound >= result.objective - 1e-6)


def test_no_point_is_infeasible_and_a_wish_to_stop_ends_it() -> None:
    assert OuterApproximation().run(ball([1.0, 1.0], 0.3, (0.5, 0.5)), Options(time_limit=20.0), Control()).status == "infeasible"
    control = Control()
    control.stop()
    result = OuterApproximation().run(ball([1.0, 1.0], 5.0), Options(time_limit=20.0), control)
    assert result.status in ("unknown", "optimal", "feasible")


def test_what_it_refuses() -> None:
    whole = ball([1.0, 1.0], 5.0)
    backend = OuterApproximation()
    assert not backend.lacking(whole)
    assert backend.lacking(replace(whole, cones=())) and backend.lacking(program([1.0], [[1.0]], 0, 1))
    continuous = replace(whole, variables=tuple(replace(v, integer=False) for v in whole.variables))
    check_refused(UnsupportedError, "cone LP", backend.run, continuous, Options(), Control())
    check_refused(UsageError, "nobody", OuterApproximation, "nobody")
    check_refused(UsageError, "no_such_option", backend.run, whole, Options(extra={"no_such_option": 1}), Control())
