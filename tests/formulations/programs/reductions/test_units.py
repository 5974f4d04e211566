import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hostile_instances import FAMILIES, UNCERTAIN, Units
from hypothesis import given, strategies as st

import waybound as wb
from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.programs.reductions.units import LARGEST, SMALLEST, scaled
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.highs import Highs

INF = math.inf


def knapsack(unit: float = 1.0, worth: float = 1.0) -> Program:
    """Two whole variables and a continuous one, of which 4 units may be used: the best is x = (1, 0, 2), 5.5 + 4 worth."""
    return Program(
        "toy", "max",
        (
            Variables("x", lower=np.zeros(2), upper=np.ones(2), cost=np.array([5.5, 2.0]) * worth, integer=True),
            Variables("f", lower=np.zeros(1), upper=np.array([3.0]) * unit, cost=np.array([2.0]) * worth / unit),
        ),
        (
            Rows("load", indptr=np.array([0, 3], np.int32), indices=np.array([0, 1, 2], np.int32), data=np.array([2.0, 3.0, 1.0 / unit]),
                 lower=np.array([-INF]), upper=np.array([4.0])),
        ),
        offset=1.0 * worth,
    )  # fmt: skip


@pytest.mark.parametrize("parts", [1.0, 10.0, 100.0])
def test_whole_numbers_and_short_decimals_are_handed_over_as_they_are(parts):
    program = knapsack(worth=2.0 / parts)
    assert scaled(program).program is program


@pytest.mark.parametrize("worth", [1.0, 0.1, math.pi])
@pytest.mark.parametrize("power", [-300, -30, -3, 1, 30, 300])
def test_the_same_program_comes_out_whatever_its_units(power, worth):
    one, other = (scaled(knapsack(k, worth * k)).program for k in (1.0, 2.0**power))
    for name in ("cost", "lower", "upper", "row_lower", "row_upper", "data", "offset"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert 2.0**SMALLEST <= np.abs(one.cost).max() < 2.0**LARGEST


@pytest.mark.parametrize("family", sorted(FAMILIES | UNCERTAIN))
def test_forms_of_every_family_are_the_same_programs_whatever_the_units_of_their_data(family):
    """Ten decades in one problem, limits met by a hair, decimals, and sizes on either side of every threshold."""
    for case in range(draws(6)):
        common, rng = Units.common(2.0 ** (10 * (case % 7 - 3))), np.random.default_rng
        first, second = ((FAMILIES | UNCERTAIN)[family](rng([7, case]), units) for units in (Units(), common))
        for form in first.forms():
            one, other = (scaled(problem.compile(form).program).program for problem in (first, second))
            for name in ("cost", "lower", "upper", "row_lower", "row_upper", "data"):
                assert np.array_equal(getattr(one, name), getattr(other, name)), (case, form, name)


@pytest.mark.parametrize(("unit", "worth"), [(1.0, 1.0), (2.0**-40, 1.0), (2.0**60, 2.0**-60), (2.0**-300, 2.0**300)])
def test_answers_values_and_duals_come_back_in_the_units_of_the_data(unit, worth):
    program = knapsack(unit, worth)
    heard = []
    control = Control(heard.append)
    result = Highs().run(program, Options(start=np.array([0.0, 1.0, unit])), control)
    assert result.answer / np.array([1.0, 1.0, unit]) == pytest.approx([1.0, 0.0, 2.0])
    assert result.objective / worth == pytest.approx(10.5)
    assert result.bound / worth == pytest.approx(10.5)
    assert all(event["objective"] is None or event["objective"] / worth <= 10.5 + 1e-6 for event in heard)
    relaxed = replace(program, variables=tuple(replace(b, integer=False) for b in program.variables))
    assert Highs().run(relaxed, Options(), Control()).row_duals / worth == pytest.approx([2.0])


@given(st.integers(-200, 200), st.integers(-200, 200))
def test_vectors_survive_the_way_there_and_back(unit, worth):
    scaling = scaled(knapsack(2.0**unit, 2.0**worth))
    x = np.array([1.0, 0.0, 2.0**unit])
    assert np.array_equal(scaling.vector(scaling.encoded(x)), x)
    assert scaling.residual(x) == 0.0


def test_cones_stay_cones():
    starts, columns, entries = np.array([0, 1, 2], np.int32), np.array([2, 0], np.int32), np.array([1.0, 1e-30])
    program = replace(knapsack(2.0**-40), cones=(Cones("norm", "second-order", 2, starts, columns, entries, np.zeros(2)),))
    scaling = scaled(program)
    for x in (np.array([1.0, 0.0, 2.0**-40]), np.array([0.0, 0.0, -(2.0**-40)])):
        assert (scaling.program.cones[0].excess(scaling.encoded(x)) <= 0) == (program.cones[0].excess(x) <= 0)


@pytest.mark.parametrize("power", [-60, -30, 30, 60])
def test_a_problem_is_solved_alike_in_every_unit(power):
    graph = wb.generate("sata", robots=3, actions=2, targets=5, phi=40, seed=3).graph
    other = wb.SensingGraph(graph.robot_of_action, graph.indptr, graph.indices, np.ldexp(graph.weights, power), graph.num_robots,
                            graph.num_targets, name="other")  # fmt: skip
    for kind in (wb.BottleneckSATA, wb.WinnerTakesAllSATA):
        a, b = (wb.solve(kind(g), "highs", bound_time=60.0) for g in (graph, other))
        assert (a.status, a.bound_kind) == (b.status, b.bound_kind)
        assert b.objective == pytest.approx(math.ldexp(a.objective, power), rel=1e-12)
        assert b.bound == pytest.approx(math.ldexp(a.bound, power), rel=1e-9)


def test_variables_of_a_block_that_lie_far_apart_are_counted_each_in_its_own_unit():
    """With one unit for both, the second would be below every tolerance."""
    x = Variables("x", lower=np.zeros(2), upper=np.array([1e7, 1e-4]), cost=np.array([-1e-7, -1e4]))
    row = Rows("row", indptr=np.array([0, 2], np.int32), indices=np.array([0, 1], np.int32), data=np.array([1e-7, 1e4]),
               lower=np.array([-INF]), upper=np.array([0.5]))  # fmt: skip
    result = Highs().run(Program("apart", "min", (x,), (row,)), Options(), Control())
    assert result.objective == pytest.approx(-0.5)


def test_numbers_too_far_apart_for_any_unit_are_left_alone():
    x = Variables("x", lower=np.zeros(1), upper=np.array([1e200]), cost=np.array([1e200]))
    row = Rows("row", indptr=np.array([0, 1], np.int32), indices=np.array([0], np.int32), data=np.array([1e-300]),
               lower=np.array([1e100]), upper=np.array([INF]))  # fmt: skip
    program = Program("far", "min", (x,), (row,))
    result = scaled(program).program
    assert result is program or all(np.isfinite(part).all() for part in (result.cost, result.row_lower, result.data))


@pytest.mark.parametrize("bound", [100.0, 9e5, 1e9])
def test_a_bound_far_beyond_what_rows_allow_is_no_size(bound):
    """Ten parts are divided in two halves as even as they can be; brought to 4, such a bound left the halves to the tolerance."""
    rng = np.random.default_rng(2)
    parts = 10.0 + 10.0 * rng.random(10)
    x = Variables("x", lower=np.zeros(10), upper=np.ones(10), cost=np.zeros(10), integer=True)
    largest = Variables("largest", lower=np.zeros(1), upper=np.array([bound * math.pi / 3]), cost=np.ones(1))
    rows = Rows("rows", indptr=np.array([0, 11, 22], np.int32), indices=np.tile(np.arange(11), 2).astype(np.int32),
                data=np.concatenate([-parts, [1.0], parts, [1.0]]), lower=np.array([0.0, parts.sum()]), upper=np.full(2, INF))  # fmt: skip
    sums = [float(parts[[k >> i & 1 == 1 for i in range(10)]].sum()) for k in range(1 << 10)]
    result = Highs().run(Program("halves", "min", (x, largest), (rows,)), Options(), Control())
    assert result.objective == pytest.approx(min(max(s, parts.sum() - s) for s in sums), rel=1e-9)


def test_one_number_far_above_the_others_leaves_them_their_digits():
    rng = np.random.default_rng(1)
    costs = np.append(50.0 + 0.05 * rng.random(6), 1e6 / 3)
    x = Variables("x", lower=np.zeros(7), upper=np.ones(7), cost=costs, integer=True)
    scaled_program = scaled(Program("costs", "min", (x,), ())).program
    assert scaled_program.cost.min() >= 1.0 and scaled_program.cost.max() < 2.0**LARGEST
