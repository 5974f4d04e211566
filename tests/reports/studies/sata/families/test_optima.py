"""Optima of small selection and max-min problems, against plain Python and known cases."""

import itertools
import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from ratio_strategies import assignments, graphs, selections
from sata_cases import CASES

from waybound import BottleneckSATA, Cardinality, CheckFailedError, MaxMinLP, Selection, SubmodularSelection, UsageError, WinnerTakesAllSATA
from waybound.instances.sata.set_functions import Coverage, UserFunction
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import max_min, optima
from waybound.reports.studies.sata.families.optima import MOST_ELEMENTS, allowed_sets, set_values


@pytest.mark.parametrize("name", CASES)
def test_reference_cases(name):
    case = CASES[name]
    assert optimum(BottleneckSATA(case.graph)).value == pytest.approx(case.bottleneck)
    assert optimum(BottleneckSATA(case.graph, fractional=True)).value == pytest.approx(case.lp, rel=1e-6)
    assert optimum(WinnerTakesAllSATA(case.graph)).value == pytest.approx(case.winner)


@settings(max_examples=draws(60))
@given(selections("cardinality", "partition", "knapsack"))
def test_every_subset_is_valued_and_allowed_as_the_problem_does(problem):
    values, allowed = set_values(problem), allowed_sets(problem)
    for mask in range(2**problem.num_elements):
        chosen = Selection(tuple(e for e in range(problem.num_elements) if mask >> e & 1))
        judged = problem.evaluate(chosen)
        assert values[mask] == pytest.approx(judged.values[0], rel=1e-12, abs=1e-12)
        if allowed[mask]:
            assert judged.feasible
    best = max(v for v, a in zip(values, allowed, strict=True) if a)
    assert optimum(problem).value == pytest.approx(best, rel=1e-12, abs=1e-12)


@settings(max_examples=draws(40))
@given(assignments())
def test_the_best_assignment_is_that_of_plain_enumeration(problem):
    g = problem.graph
    starts, actions = g.by_robot
    own = [actions[starts[i] : starts[i + 1]].tolist() for i in range(g.num_robots)]
    best = max(problem.value(list(choice)) for choice in itertools.product(*(o for o in own if o)))
    assert optimum(problem).value == pytest.approx(best)


@settings(max_examples=draws(40))
@given(graphs())
def test_whole_actions_are_worth_no_more_than_shares(graph):
    whole, shares = optimum(BottleneckSATA(graph)), optimum(BottleneckSATA(graph, fractional=True))
    assert whole.value <= shares.value * (1 + 1e-9) + 1e-12
    assert BottleneckSATA(graph).evaluate(whole.answer).values[0] == whole.value


def test_a_general_program_is_that_of_its_robots():
    case = CASES["S7"].graph
    packing, covering = np.zeros((2, 4)), np.zeros((3, 4))
    packing[case.robot_of_action, np.arange(4)] = 2.0
    covering[case.indices, case.action_of_edge] = case.weights
    assert optimum(MaxMinLP(packing, covering)).value == pytest.approx(6 / 7)


def test_a_users_function_is_enumerated():
    f = UserFunction(lambda masks: np.sqrt(masks.sum(axis=1)), 6, monotone=True, submodular=True)
    assert optimum(SubmodularSelection(f, Cardinality(4))).value == 2.0


def test_what_is_too_large_is_refused():
    f = Coverage.from_sets([[0]] * (MOST_ELEMENTS + 1), [1.0])
    with pytest.raises(UsageError, match="too many"):
        optimum(SubmodularSelection(f, Cardinality(2)))


def test_only_programs_that_maximise_have_one():
    with pytest.raises(UsageError, match="no optimum is known for max-min-lp problems"):
        optimum(MaxMinLP(np.eye(2), np.eye(2), sense="min"))


def test_an_optimum_whose_two_sides_differ_is_refused(monkeypatch):
    monkeypatch.setattr(optima, "verified_bound", lambda problem, evidence: math.pi)
    with pytest.raises(CheckFailedError, match="bound of"):
        optimum(BottleneckSATA(CASES["S1"].graph, fractional=True))


@pytest.mark.parametrize(("largest", "value"), [((), 2 / 3), ((0, 3), 2 / 3), ((0, 2), 1 / 2), ((1, 3), 1 / 2), ((1, 2), 1 / 2)])
def test_the_linear_program_of_shares_in_a_given_order(largest, value):
    """Robot 1 is at target 0 or 1, robot 2 at target 1 or 2: at most half is left for an outer target
    that is not the larger share."""
    graph = max_min.robots(max_min.REFERENCES["D"][0], "D").graph
    assert optima.least_coverage(graph, largest) == pytest.approx(value)
