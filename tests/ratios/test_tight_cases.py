"""Adversarial instances: the ratios known for them are attained, and the optima by construction are the optima."""

import math

import numpy as np
import pytest

from waybound import Cardinality, SubmodularSelection
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.reports.ratios.judged_runs import judge, ratio_of, run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import max_min as graphs, selection_traps as traps
from waybound.reports.studies.sata.families.optima import MOST_ELEMENTS

EXACT = {"search": "secant", "eps": 1e-6, "ball": False}


def value(problem, name, **options):
    return problem.evaluate(run_heuristic(problem, name, options, 1).answer).values[0]


@pytest.mark.share(2)
@pytest.mark.parametrize(
    "family",
    [
        *(traps.geometric_covers(rule) for rule in ("cardinality", "partition", "knapsack")), traps.HALVES, traps.ORDER_MATTERS,
        traps.DENSITY_TRAPS, traps.HALF_TRAPS, traps.SHUT_OUTS, traps.FREE_ELEMENTS, graphs.REFERENCE_GRAPHS, graphs.TIGHT,
        graphs.PRIVATE, graphs.CYCLES, graphs.REGULAR_TREES,
    ],
    ids=lambda family: family.name,
)  # fmt: skip
def test_optima_by_construction_are_optima(family):
    for k in range(family.size):
        case = family.case(k, 1)
        if isinstance(case.problem, SubmodularSelection) and case.problem.num_elements > MOST_ELEMENTS:
            continue
        assert case.solved().value == pytest.approx(optimum(case.problem).value, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("k", [2, 3, 5, 10, 30])
@pytest.mark.parametrize("name", ["greedy", "lazy-greedy"])
def test_greedy_falls_to_its_bound_on_geometric_covers(name, k):
    bribe = 1e-9
    f, good, bad = traps.geometric_cover(k, bribe)
    problem = SubmodularSelection(f, Cardinality(k))
    assert problem.value(good.elements) == pytest.approx(1.0)
    found = value(problem, name)
    assert found == pytest.approx(bad)
    assert found == pytest.approx(1.0 - (1.0 - 1.0 / k) ** k, abs=2 * k * bribe)


@pytest.mark.parametrize("name", ["greedy", "sequential-greedy", "lazy-greedy", "continuous-greedy"])
def test_robots_that_know_what_others_took_meet_at_no_shared_target(name):
    for k in range(traps.SHARED_TARGETS.size):
        case = traps.SHARED_TARGETS.case(k, 1)
        assert value(case.problem, name) == pytest.approx(case.solved().value)


def test_cover_tight_is_the_geometric_cover_of_two():
    f, good, bad = traps.geometric_cover(2, 1 / 80)
    assert 80 * SubmodularSelection(f, Cardinality(2)).value(good.elements) == pytest.approx(80)
    assert 80 * bad == pytest.approx(62)


@pytest.mark.parametrize("e", [1.0, 0.1, 0.01, 0.001])
def test_sequential_greedy_takes_half_where_the_first_robot_takes_what_the_second_needs(e):
    problem = traps.robots([[[1 + e, 0], [0, 1]], [[1 + e, 0]]], "S2")
    assert value(problem, "sequential-greedy", order=[0, 1]) == pytest.approx(1 + e)
    assert value(problem, "sequential-greedy", order=[1, 0]) == pytest.approx(2 + e)
    assert optimum(problem).value == pytest.approx(2 + e)


@pytest.mark.parametrize("m", [10.0, 1e4, 1e8])
def test_the_best_element_mends_what_density_alone_gets_arbitrarily_wrong(m):
    case = traps._disjoint([2.0, m], [1.0, m], m, [1], "trap")
    assert case.solved().value == m
    assert value(case.problem, "knapsack-greedy", enumerate=0) == m  # density alone takes the first element: 2


def test_neither_greedy_nor_the_best_element_passes_the_bound_of_shut_outs():
    problem = traps._shut_out(3, 60).problem
    assert value(problem, "knapsack-greedy", enumerate=0) == pytest.approx(1 - math.exp(-2 / 3), abs=0.01)
    assert value(problem, "knapsack-greedy", enumerate=1) == pytest.approx(1.0, abs=1e-3)


# -- the local algorithm ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("h", "shares", "ratio"), [(1, [0.5, 0.5], 2.0), (2, [1.0, 2 / 3, 1 / 3], 1.5)])
def test_the_bound_of_the_local_algorithm_is_attained(h, shares, ratio):
    problem = graphs.tight_pair(h)
    outcome = run_heuristic(problem, "local", {"h": h, **EXACT}, 1)
    assert outcome.answer == pytest.approx(shares, abs=1e-5)
    run = judge(problem, optimum(problem), outcome, expected=ratio * (1 + 1e-6))
    assert not run.faults
    assert run.ratio == pytest.approx(ratio, rel=1e-5)
    assert run.stated == pytest.approx(ratio, rel=1e-5)


@pytest.mark.parametrize("h", [1, 2, 5])
@pytest.mark.parametrize("n", [2, 3, 8])
def test_private_targets_are_solved_exactly_and_have_the_integrality_gap(n, h):
    problem = graphs.private_targets(n)
    assert value(problem, "local", h=h, **EXACT) == pytest.approx(1 / n, abs=1e-6)
    assert optimum(problem).value == pytest.approx(1 / n)
    assert optimum(BottleneckSATA(problem.graph)).value == 0.0


def test_a_ratio_is_worse_over_better_in_both_senses():
    assert ratio_of("max", 2.0, 3.0) == 1.5
    assert ratio_of("min", 3.0, 2.0) == 1.5
    assert ratio_of("max", 0.0, 0.0) == 1.0
    assert ratio_of("max", 0.0, 1.0) == math.inf
    assert ratio_of("max", np.nextafter(1.0, 2.0), 1.0) == 1.0
