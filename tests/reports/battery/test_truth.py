from fractions import Fraction

import numpy as np
import pytest
from programs import INF, program
from truth.families import truth as other_truth

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import Truth, program_truth, truth


@pytest.mark.share(3)
@pytest.mark.parametrize("kind", [k for k in KINDS if k not in ("products", "squares", "unbounded")])
def test_two_accounts_of_the_truth_agree(kind):
    # They share no code; that of the tests takes no quadratic objectives, and enumerates no variable without bounds.
    for turn in range(12):
        problem = KINDS[kind](np.random.default_rng([5, turn]))
        ours, theirs = truth(problem), other_truth(problem)
        if theirs.unbounded:
            assert ours.status == "unbounded"
        else:
            assert ours == (Truth("infeasible") if theirs.best is None else Truth("optimal", theirs.best[0]))


def test_a_fraction_is_found_to_the_last_digit():
    lp = program([1, 1], [[1, 2], [3, 1]], [4, 6], [INF, INF], [0, 0], [INF, INF])
    assert program_truth(lp) == Truth("optimal", Fraction(14, 5))


@pytest.mark.parametrize(
    ("cost", "status"), [([-1, -1], "unbounded"), ([-1, 1], "optimal"), ([1, -1], "optimal")], ids=["both", "first", "second"]
)
def test_a_direction_that_no_side_limits_makes_a_program_unbounded(cost, status):
    # x - y within [-1, 1]: both may grow together, neither alone.
    assert program_truth(program(cost, [[1, -1]], [-1], [1], [0, 0], [INF, INF])).status == status


def test_an_endless_direction_without_a_point_is_infeasible():
    made = program([-1, 0], [[0, 2]], [1], [1], [0, 0], [INF, 5], integer=(0, 1))
    assert program_truth(made) == Truth("infeasible")


def test_whole_variables_that_have_no_bound_are_not_guessed_at():
    with pytest.raises(NotImplementedError):
        program_truth(program([1], [[2]], [-7], [INF], [0], [INF], integer=(0,)))


def test_free_variables_go_below_zero():
    assert program_truth(program([1, 1], [[1, 1], [1, -1]], [-3, -1], [INF, INF], [-INF, -INF], [INF, INF])).value == -3


def test_squares_are_least_on_an_edge_or_within():
    # (x - 1)^2 + (y - 2.5)^2 less its constant: within the box first, then on the edge x + y = 2.
    q = [[2, 0], [0, 2]]
    assert program_truth(program([-2, -5], np.zeros((0, 2)), [], [], [-9, -9], [9, 9], quadratic=q)).value == Fraction(-29, 4)
    assert program_truth(program([-2, -5], [[1, 1]], [-INF], [2], [-9, -9], [9, 9], quadratic=q)).value == Fraction(-49, 8)


def test_a_concave_objective_is_maximised():
    made = program([2], np.zeros((0, 1)), [], [], [-9], [9], sense="max", quadratic=[[-2]])
    assert program_truth(made) == Truth("optimal", Fraction(1))


def test_products_of_whole_and_other_variables_are_linear_in_the_others():
    # 2 b y - y over b in {0, 1}, y in [0, 3]: b = 0 and y = 3.
    made = program([0, -1], [[1, 0]], [0], [1], [0, 0], [1, 3], integer=(0,), quadratic=[[0, 2], [2, 0]])
    assert program_truth(made) == Truth("optimal", Fraction(-3))


@pytest.mark.parametrize("kind", ["products", "squares", "unbounded"])
def test_no_point_of_a_grid_beats_the_truth(kind):
    for turn in range(10):
        problem = KINDS[kind](np.random.default_rng([6, turn]))
        assert isinstance(problem, ArrayProblem)
        p, known = problem.program, truth(problem)
        axes = [np.linspace(max(a, -4.0), min(b, 4.0), 2 if k else 9) for a, b, k in zip(p.lower, p.upper, p.integer, strict=True)]
        points = [np.array(x) for x in np.array(np.meshgrid(*axes)).reshape(len(axes), -1).T]
        inside = [x for x in points if p.residual(x) == 0.0]
        if known.status == "infeasible":
            assert not inside
        elif known.status == "optimal":
            sign = 1 if p.sense == "min" else -1
            assert all(sign * (Fraction(p.value(x)) - known.value) >= -1e-9 for x in inside)
