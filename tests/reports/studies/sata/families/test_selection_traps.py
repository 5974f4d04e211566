import math

import pytest

import waybound as wb
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import selection_traps as traps


def cases(family):
    return [family.case(k, 1) for k in range(family.size)]


def value(problem, name, **options):
    return problem.evaluate(run_heuristic(problem, name, options, 1).answer).values[0]


@pytest.mark.parametrize("k", [2, 3, 5, 10])
def test_greedy_takes_all_bad_sets_of_a_geometric_cover(k):
    f, good, bad = traps.geometric_cover(k)
    problem = wb.SubmodularSelection(f, wb.Cardinality(k))
    assert problem.value(good.elements) == pytest.approx(1.0)
    assert value(problem, "greedy") == pytest.approx(bad) == pytest.approx(1 - (1 - 1 / k) ** k + k * traps.BRIBE)
    if k < 6:
        assert optimum(problem).value == pytest.approx(1.0, abs=k * traps.BRIBE)


@pytest.mark.parametrize("family", [traps.geometric_covers("partition"), traps.HALVES, traps.DENSITY_TRAPS, traps.HALF_TRAPS,
                                    traps.SHUT_OUTS, traps.FREE_ELEMENTS], ids=lambda family: family.name)  # fmt: skip
def test_what_is_optimal_by_construction_is_optimal(family):
    small = [case for case in cases(family) if case.problem.num_elements <= 12]
    assert small
    for case in small:
        assert case.solved().value == pytest.approx(optimum(case.problem).value, rel=1e-9, abs=1e-9), case.problem.name


def test_copies_stand_side_by_side():
    one = traps.robots([[[2, 0], [0, 1]], [[2, 0]]], "one")
    three = traps.copies(one, 3)
    assert (three.graph.num_robots, three.graph.num_actions, three.graph.num_targets) == (6, 9, 6)
    assert optimum(three).value == 3 * optimum(one).value == 9.0


def test_a_half_is_reached_and_the_order_decides():
    for e in (0.1, 0.001):
        problem = traps.robots([[[1.0 + e + e * e, 0.0], [0.0, 1.0]], [[1.0 + e, 0.0]]], "half")
        assert any(case.problem.digest() == problem.digest() for case in cases(traps.HALVES))
        assert value(problem, "greedy") / optimum(problem).value == pytest.approx((1 + e) / (2 + e), abs=e * e)
    problem = traps.ORDER_MATTERS.case(0, 1).problem
    assert (value(problem, "sequential-greedy", order=[0, 1, 2]), value(problem, "sequential-greedy", order=[2, 1, 0])) == (9.0, 14.0)


def test_density_alone_is_arbitrarily_bad():
    case = max(cases(traps.DENSITY_TRAPS), key=lambda case: case.solved().value)
    assert case.solved().value == 1e4


def test_small_sets_shut_out_three_good_ones():
    case = next(c for c in cases(traps.SHUT_OUTS) if c.problem.name == "shut-out-3-15")
    assert case.solved().value == pytest.approx(1.0, abs=1e-3)
    assert value(case.problem, "knapsack-greedy", enumerate=0) == pytest.approx(1 - math.exp(-2 / 3), abs=0.02)
