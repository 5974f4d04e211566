from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_sensing import chain_graph, optimum, random_graph
from ratio_strategies import graphs

from waybound.formulations.certificate import verified_bound
from waybound.formulations.max_min.bottleneck_sata import BottleneckSATA
from waybound.formulations.max_min.max_min_lp import MaxMinLP
from waybound.instances.errors import InputError
from waybound.instances.sensing.graph import graph_of_edges
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.highs import Highs
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.max_min.ball import ball_bound, ball_evidence


class Solver:
    """Solves with HiGHS, and counts the programs and their largest size."""

    def __init__(self, most=10**9):
        self.programs, self.most = [], most

    def __call__(self, program, seconds):
        self.programs.append(program)
        if len(self.programs) > self.most:
            return None
        return Highs().run(program, Options(time_limit=seconds), Control()).row_duals


def problem(graph, **kind):
    return BottleneckSATA(graph, **{"fractional": True, **kind})


@settings(deadline=None, max_examples=60)
@given(graphs(every_target_seen=True), st.integers(1, 5), st.integers(0, 10), st.randoms(use_true_random=False))
def test_a_ball_bounds_the_optimum_from_above_wherever_it_grows(graph, seeds, most_edges, random):
    covered = np.array([random.random() for _ in range(graph.num_targets)])
    evidence = ball_evidence(problem(graph), covered, Solver(), 60.0, seeds=seeds, most_edges=most_edges)
    if evidence is not None:
        proved = verified_bound(problem(graph), evidence)
        assert proved >= optimum(graph) * (1 - 1e-9)
        assert evidence.value == pytest.approx(proved, rel=1e-9)


@settings(deadline=None, max_examples=40)
@given(graphs(every_target_seen=True))
def test_a_ball_that_is_everything_is_exact(graph):
    evidence = ball_evidence(problem(graph), None, Solver(), 60.0, seeds=graph.num_targets)
    assert verified_bound(problem(graph), evidence) == pytest.approx(optimum(graph), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_far_bottleneck_is_found_by_its_coverage_and_priced_exactly(seed):
    graph = random_graph(seed, robots=400, targets=250)
    best = optimum(graph)
    solver = Solver()
    evidence = ball_evidence(problem(graph), None, solver, 60.0)
    assert verified_bound(problem(graph), evidence) == pytest.approx(best, rel=1e-6)


def test_growth_ends_where_the_bound_stands_still():
    # Robot 0 has targets 0 and 1 for itself: 1/2 is all they can have. A long chain is joined to it by a strong robot.
    chain = 400
    owner, action, target, weight = [0, 0], [0, 1], [0, 1], [1.0, 1.0]
    for k in range(chain):
        for side in (0, 1):
            action.append(len(owner))
            target.append(1 + k + side)
            weight.append(3.0 if k else 1e-3)
            owner.append(1 + k)
    graph = graph_of_edges(owner, action, target, weight, robots=chain + 1, targets=chain + 2)
    solver = Solver()
    evidence = ball_evidence(problem(graph), None, solver, 60.0, seeds=1)
    assert verified_bound(problem(graph), evidence) == pytest.approx(optimum(graph), rel=1e-6)
    assert max(len(p.data) for p in solver.programs) < 200  # of 802 edges, 2407 entries


def test_targets_that_are_covered_as_well_as_the_bound_seed_no_ball():
    graph, solver = random_graph(3, robots=200, targets=120), Solver()
    assert ball_evidence(problem(graph), np.full(graph.num_targets, 100.0), solver, 60.0, seeds=2) is not None
    sizes = [p.problem.graph.num_targets for p in solver.programs]
    assert sizes[0] == 2
    assert sizes == sorted(set(sizes))  # one ball that grew, and no second one


def test_no_program_is_larger_than_allowed():
    solver = Solver()
    ball_evidence(problem(chain_graph(1, 300)), None, solver, 60.0, most_edges=50)
    assert solver.programs
    assert max(p.problem.graph.num_edges for p in solver.programs) <= 50


def test_it_keeps_the_best_bound_when_a_program_is_not_solved_in_time():
    graph = chain_graph(2, 300)
    one = ball_evidence(problem(graph), None, Solver(most=1), 60.0)
    more = ball_evidence(problem(graph), None, Solver(most=5), 60.0)
    assert ball_evidence(problem(graph), None, Solver(most=0), 60.0) is None
    assert ball_evidence(problem(graph), None, Solver(), 0.0) is None
    assert optimum(graph) * (1 - 1e-9) <= more.value <= one.value


def test_a_target_that_nobody_sees_proves_zero_without_a_program():
    graph = graph_of_edges([0], [0], [0], robots=1, targets=3)
    solver = Solver()
    evidence = ball_evidence(problem(graph), None, solver, 60.0)
    assert verified_bound(problem(graph), evidence) == 0.0
    assert not solver.programs


@pytest.mark.parametrize("size", [1e-200, 1e-12, 1e12, 1e200])
def test_weights_of_any_size_are_priced(size):
    graph = random_graph(5)
    other = graph_of_edges(
        graph.robot_of_action, graph.action_of_edge, graph.indices, graph.weights * size, robots=graph.num_robots, targets=graph.num_targets
    )
    evidence = ball_evidence(problem(other), None, Solver(), 60.0, seeds=graph.num_targets)
    assert verified_bound(problem(other), evidence) / size == pytest.approx(optimum(graph), rel=1e-6)


def test_a_solver_that_refuses_the_numbers_proves_nothing():
    def refuses(program, seconds):
        raise InputError("too large")

    graph = graph_of_edges([0, 0], [0, 0, 1], [0, 1, 1], [1e-200, 1e200, 1.0], robots=1)
    assert ball_evidence(problem(graph), None, refuses, 60.0) is None


def test_whole_actions_are_bounded_by_shares():
    graph = random_graph(6)
    evidence = ball_evidence(problem(graph, fractional=False), None, Solver(), 60.0, seeds=graph.num_targets)
    assert verified_bound(problem(graph, fractional=False), evidence) == pytest.approx(optimum(graph), rel=1e-6)


def test_only_nonzero_weights_become_evidence():
    graph = random_graph(7, robots=300, targets=200)
    data = ball_evidence(problem(graph), None, Solver(), 60.0).data
    assert all(w > 0 for w in data["weights"])
    assert data["targets"] == sorted(set(data["targets"]))


def test_as_a_method_it_bounds_max_min_programs_with_one_packing_row_a_variable():
    rng = np.random.default_rng(8)
    rows = np.arange(60) // 3
    packing = np.zeros((20, 60))
    packing[rows, np.arange(60)] = rng.uniform(0.5, 2.0, 60)
    covering = rng.uniform(0.5, 1.5, (15, 60)) * (rng.random((15, 60)) < 0.2)
    covering[:, 0] += 0.1
    asked = MaxMinLP(packing, covering)
    evidence = BOUNDS["ball"].compute(asked, 60.0, Solver())
    assert evidence.kind == "packing-covering-duals"
    program = asked.compile("max-min")
    best = Highs().run(program, Options(), Control()).objective
    assert best * (1 - 1e-9) <= verified_bound(asked, evidence) <= best * (1 + 1e-6)


def test_as_a_method_it_names_what_it_cannot_bound():
    two_rows = MaxMinLP(np.ones((2, 2)), np.ones((1, 2)))
    assert BOUNDS["ball"].missing(two_rows) == {"several-packing-rows"}
    assert BOUNDS["ball"].missing(MaxMinLP(np.eye(2), np.ones((1, 2)), sense="min")) == {"min-max"}
    assert not BOUNDS["ball"].missing(problem(random_graph(9)))
    assert not BOUNDS["ball"].missing(problem(random_graph(9), fractional=False))
    assert BOUNDS["ball"].order < BOUNDS["linear-relaxation"].order


def test_as_a_method_it_leaves_time_for_the_whole_program():
    def slow(program, seconds):
        given.append(seconds)
        time.sleep(min(seconds, 0.3))

    given: list[float] = []
    assert ball_bound(problem(chain_graph(0, 50)), 2.0, slow) is None
    assert max(given) <= 1.0
