import time
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from programs import AnsweredBy
from random_sensing import chain_graph, optimum, random_graph
from ratio_strategies import graphs

from waybound import BottleneckSATA, InputError, MaxMinLP
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.backends.highs import Highs
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.sata.ball import ball_bound, ball_evidence
from waybound.solvers.linear_programs import LinearPrograms


class Solver(LinearPrograms):
    """Keeps the programs that it solves, and solves no more than ``most``."""

    def __init__(self, most=10**9):
        super().__init__()
        self.programs, self.most = [], most

    def solve(self, program, *args, **options):
        self.programs.append(program)
        return super().solve(program, *args, **options) if len(self.programs) <= self.most else RawResult("unknown", "time")


def size(program):
    """Targets and edges of the graph that a max-min program is of."""
    (targets,) = (b for b in program.rows if b.name == "target")
    return targets.size, len(targets.data) - targets.size


def problem(graph, **kind):
    return BottleneckSATA(graph, **{"fractional": True, **kind})


@settings(deadline=None, max_examples=draws(60))
@given(graphs(every_target_seen=True), st.integers(1, 5), st.integers(0, 10), st.randoms(use_true_random=False))
def test_a_ball_bounds_the_optimum_from_above_wherever_it_grows(graph, seeds, most_edges, random):
    covered = np.array([random.random() for _ in range(graph.num_targets)])
    evidence = ball_evidence(graph, covered, Stop(60.0), Solver(), seeds=seeds, most_edges=most_edges)
    if evidence is not None:
        proved = verified_bound(problem(graph), evidence)
        assert proved >= optimum(graph) * (1 - 1e-9)
        assert evidence.value == pytest.approx(proved, rel=1e-9)


@settings(deadline=None, max_examples=draws(40))
@given(graphs(every_target_seen=True))
def test_a_ball_that_is_everything_is_exact(graph):
    evidence = ball_evidence(graph, None, Stop(60.0), Solver(), seeds=graph.num_targets)
    assert verified_bound(problem(graph), evidence) == pytest.approx(optimum(graph), rel=1e-6)


@pytest.mark.share(2)
@pytest.mark.parametrize("seed", range(6))
def test_a_far_bottleneck_is_found_by_its_coverage_and_priced_exactly(seed):
    graph = random_graph(seed, robots=400, targets=250)
    best = optimum(graph)
    solver = Solver()
    evidence = ball_evidence(graph, None, Stop(60.0), solver)
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
    evidence = ball_evidence(graph, None, Stop(60.0), solver, seeds=1)
    assert verified_bound(problem(graph), evidence) == pytest.approx(optimum(graph), rel=1e-6)
    assert max(len(p.data) for p in solver.programs) < 200  # of 802 edges, 2407 entries


def test_targets_that_are_covered_as_well_as_the_bound_seed_no_ball():
    graph, solver = random_graph(3, robots=200, targets=120), Solver()
    assert ball_evidence(graph, np.full(graph.num_targets, 100.0), Stop(60.0), solver, seeds=2) is not None
    sizes = [size(p)[0] for p in solver.programs]
    assert sizes[0] == 2
    assert sizes == sorted(set(sizes))  # one ball that grew, and no second one


def test_no_program_is_larger_than_allowed():
    solver = Solver()
    ball_evidence(chain_graph(1, 300), None, Stop(60.0), solver, most_edges=50)
    assert solver.programs
    assert max(size(p)[1] for p in solver.programs) <= 50


def test_it_keeps_the_best_bound_when_a_program_is_not_solved_in_time():
    graph = chain_graph(2, 300)
    one = ball_evidence(graph, None, Stop(60.0), Solver(most=1))
    more = ball_evidence(graph, None, Stop(60.0), Solver(most=5))
    assert ball_evidence(graph, None, Stop(60.0), Solver(most=0)) is None
    assert ball_evidence(graph, None, Stop(0.0), Solver()) is None
    assert optimum(graph) * (1 - 1e-9) <= more.value <= one.value


def test_a_target_that_nobody_sees_proves_zero_without_a_program():
    graph = graph_of_edges([0], [0], [0], robots=1, targets=3)
    solver = Solver()
    evidence = ball_evidence(graph, None, Stop(60.0), solver)
    assert verified_bound(problem(graph), evidence) == 0.0
    assert not solver.programs


@pytest.mark.parametrize("size", [1e-200, 1e-12, 1e12, 1e200])
def test_weights_of_any_size_are_priced(size):
    graph = random_graph(5)
    other = replace(graph, weights=graph.weights * size)
    evidence = ball_evidence(other, None, Stop(60.0), Solver(), seeds=graph.num_targets)
    assert verified_bound(problem(other), evidence) / size == pytest.approx(optimum(graph), rel=1e-6)


def test_a_solver_that_refuses_the_numbers_proves_nothing():
    def refuses(program, seconds):
        raise InputError("too large")

    graph = graph_of_edges([0, 0], [0, 0, 1], [0, 1, 1], [1e-200, 1e200, 1.0], robots=1)
    assert ball_evidence(graph, None, Stop(60.0), AnsweredBy(refuses)) is None


def test_whole_actions_are_bounded_by_shares():
    graph = random_graph(6)
    evidence = ball_evidence(graph, None, Stop(60.0), Solver(), seeds=graph.num_targets)
    assert verified_bound(problem(graph, fractional=False), evidence) == pytest.approx(optimum(graph), rel=1e-6)


def test_only_nonzero_weights_become_evidence():
    data = ball_evidence(random_graph(7, robots=300, targets=200), None, Stop(60.0), Solver()).data
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
    evidence = BOUNDS["ball"].compute(asked, Stop(60.0), Solver())
    assert evidence.kind == "packing-covering-duals"
    program = asked.compile("max-min").program
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
    assert ball_bound(problem(chain_graph(0, 50)), Stop(2.0), AnsweredBy(slow)) is None
    assert max(given) <= 1.0
