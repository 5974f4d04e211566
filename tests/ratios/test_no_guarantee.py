"""What no guarantee is claimed for: rounding, greedy on a bottleneck, random choice, more layers. Each with the case that refutes it."""

import pytest

from waybound import BottleneckSATA, Cardinality, SubmodularSelection, UserFunction
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.ratios.judged_runs import judge, run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import max_min as graphs, selection as random


def run(problem, name, **options):
    outcome = run_heuristic(problem, name, options, 1)
    found = judge(problem, optimum(problem), outcome)
    assert not found.faults
    assert outcome.guarantee is None, "nothing is known that could be guaranteed here"
    return found


@pytest.mark.parametrize("name", ["S6", "S7"])
@pytest.mark.parametrize("ties", ["first", "last"])
def test_rounding_the_linear_program_may_leave_a_target_without_anything(name, ties):
    problem = BottleneckSATA(graphs.robots(graphs.REFERENCES[name][0], name).graph)
    found = run(problem, "lp-rounding", ties=ties)
    assert found.optimum == 1.0
    assert found.value == 0.0


def test_rounding_the_local_algorithm_states_no_guarantee_and_has_none():
    found = run(BottleneckSATA(graphs.robots(graphs.REFERENCES["S6"][0], "S6").graph), "local", h=5)
    assert found.optimum == 1.0
    assert found.value == 0.0


@pytest.mark.parametrize("name", ["random", "lp-rounding"])
def test_baselines_state_no_guarantee(name):
    for k in range(20):
        run(random.RANDOM_ASSIGNMENTS.case(k, 3).problem, name)


def test_a_target_that_nobody_sees_ends_the_guarantee():
    graph = graph_of_edges([0, 0], [0, 1], [0, 1], robots=1, targets=3)
    found = run(BottleneckSATA(graph, fractional=True), "local")
    assert found.value == found.optimum == 0.0


@pytest.mark.parametrize("name", ["greedy", "lazy-greedy", "stochastic-greedy"])
def test_a_function_that_is_not_declared_submodular_gets_no_guarantee(name):
    run(SubmodularSelection(UserFunction(lambda masks: masks.sum(axis=1) ** 2.0, 5), Cardinality(2)), name)


@pytest.mark.parametrize("name", ["greedy", "lazy-greedy", "stochastic-greedy"])
def test_a_false_declaration_is_found_out(name):
    f = UserFunction(lambda masks: masks.sum(axis=1) ** 2.0, 5, monotone=True, submodular=True)
    outcome = run_heuristic(SubmodularSelection(f, Cardinality(2)), name, {}, 1)
    assert outcome.guarantee is None
    assert not outcome.evidence
