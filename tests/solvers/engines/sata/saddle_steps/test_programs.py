import threading

import numpy as np
import pytest
from programs import Patient, program
from random_sensing import chain_graph, optimum, random_graph

from waybound.formulations.sata.balls import actions_of, coverage, even_shares, grown, robots_seeing, targets_seen
from waybound.formulations.stop import Stop
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import BACKENDS
from waybound.solvers.engines.sata.saddle_steps.programs import Programs, lift, lift_edges, parts
from waybound.solvers.linear_programs import LinearPrograms


@pytest.fixture
def programs() -> Programs:
    return Programs(Stop(60.0))


def test_with_all_robots_free_a_lift_is_the_optimum(programs):
    graph = random_graph(1)
    shares = even_shares(graph)
    found = lift(graph, shares, coverage(graph, shares), np.arange(graph.num_targets), 1e3, programs.solve)
    shares[found.actions] = found.shares
    assert coverage(graph, shares).min() == pytest.approx(optimum(graph), rel=1e-6)
    assert found.reached.min() == pytest.approx(optimum(graph), rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_a_lift_raises_its_ball_and_lowers_nothing_below_what_it_reached(seed, programs):
    graph = random_graph(seed, robots=80, targets=60)
    shares = even_shares(graph)
    cover, level = coverage(graph, shares), 1.2
    ball = np.sort(np.argsort(cover)[:3])
    found = lift(graph, shares, cover, ball, level, programs.solve)
    changed = np.unique(graph.robot_of_action[found.actions])
    assert changed.tolist() == robots_seeing(graph, ball).tolist()
    new = shares.copy()
    new[found.actions] = found.shares
    assert (new >= 0).all()
    assert np.bincount(graph.robot_of_action, new) == pytest.approx(np.ones(graph.num_robots))
    after = coverage(graph, new)
    touched = targets_seen(graph, actions_of(graph, changed))
    untouched = np.setdiff1d(np.arange(graph.num_targets), touched)
    assert np.array_equal(after[untouched], cover[untouched])
    # Parts reach levels of their own, each at least what stood; robots that no low target needs have none.
    assert after[touched].min() >= min(level, cover[touched].min()) - 1e-7
    known = found.reached[np.isfinite(found.reached)]
    assert after[touched].min() >= min(level, known.min(initial=level)) - 1e-7
    assert (known <= max(level, after.max()) + 1e-7).all()


def test_parts_of_a_lift_do_not_hold_each_other_down(programs):
    # Two robots apart: the first can give 1/2 to each of its targets, the second 2.
    graph = graph_of_edges([0, 0, 1, 1], [0, 1, 2, 3], [0, 1, 2, 3], [1.0, 1.0, 4.0, 4.0], robots=2)
    shares = np.array([1.0, 0.0, 1.0, 0.0])
    found = lift(graph, shares, coverage(graph, shares), np.arange(4), 10.0, programs.solve)
    assert found.reached == pytest.approx([0.5, 0.5, 2.0, 2.0])


def test_a_lift_stops_at_its_level(programs):
    graph = random_graph(2)
    shares, level = even_shares(graph), 0.5 * optimum(graph)
    found = lift(graph, shares, coverage(graph, shares), np.arange(graph.num_targets), level, programs.solve)
    assert found.reached.min() >= level - 1e-7


def test_there_is_nothing_to_lift_where_others_cover_enough(programs):
    graph = graph_of_edges([0, 0, 1], [0, 1, 2], [0, 0, 0], [1.0, 2.0, 5.0], robots=2)
    shares = np.array([1.0, 0.0, 1.0])
    assert lift(graph_of_edges([0], [0], [0], robots=1), np.ones(1), np.ones(1), np.arange(1), 0.0, programs.solve) is None
    found = lift(graph, shares, coverage(graph, shares), np.arange(1), 100.0, programs.solve)
    assert found.shares == pytest.approx([0.0, 1.0, 1.0])


def test_a_lift_that_is_not_solved_changes_nothing():
    graph = random_graph(3)
    shares = even_shares(graph)
    assert lift(graph, shares, coverage(graph, shares), np.arange(5), 9.0, Programs(Stop(0.0)).solve) is None


def test_lift_edges_are_all_that_the_robots_see():
    graph = chain_graph(0, 20)
    assert lift_edges(graph, np.array([5])) == 4
    assert lift_edges(graph, grown(graph, np.array([5]), 100)) == 8


def test_parts_are_the_connected_ones():
    rows, robots = np.array([0, 1, 1, 3]), np.array([0, 0, 1, 3])
    of_row, of_robot, count = parts(rows, robots, 4, 4)
    assert count == 2
    assert of_row.tolist() == [0, 0, -1, 1]
    assert of_robot.tolist() == [0, 0, -1, 1]


def test_programs_are_charged_and_make_room_for_no_more_than_their_share(programs):
    free = programs.most_edges(0.0)
    assert programs.most_edges(1e10) > free > 0
    graph = random_graph(4)
    shares = even_shares(graph)
    lift(graph, shares, coverage(graph, shares), np.arange(graph.num_targets), 9.0, programs.solve)
    assert programs.solved == 1
    assert programs.work > 0
    assert programs.most_edges(0.0) < free
    programs.work = 1e12
    assert programs.most_edges(1e10) == 0


def test_a_program_that_takes_too_many_iterations_is_given_up(monkeypatch):
    graph = chain_graph(1, 300)
    shares = even_shares(graph)
    monkeypatch.setattr("waybound.solvers.engines.sata.saddle_steps.programs.SPARE_ITERATIONS", 5 - 1500)  # five, for 1500 entries
    found = lift(graph, shares, coverage(graph, shares), np.arange(300), 9.0, Programs(Stop(60.0)).solve)
    assert found is None


def test_a_wish_to_stop_ends_the_program_that_runs(registered):
    registered(BACKENDS, "patient", Patient)
    stop = Stop(60.0)
    programs = Programs(stop, LinearPrograms("patient"))
    threading.Timer(0.1, stop.ask).start()
    assert programs.solve(program([1], [[1]], 1, 2)).limit == "interrupt"
