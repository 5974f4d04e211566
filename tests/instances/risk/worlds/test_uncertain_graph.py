import numpy as np
import pytest
from coded import coded
from file_cases import check_refused
from uncertain_graphs import WORKED, graph_of

from waybound.instances.bundled import bundled_path
from waybound.instances.errors import InputError, UsageError
from waybound.instances.risk.worlds.uncertain_graph import UncertainGraphWorld
from waybound.instances.worlds import make_world
from waybound.instances.writing import write_instance


def world(seed=1, **further):
    return UncertainGraphWorld(graph_of(WORKED, **further), np.random.default_rng(seed))


def test_costs_of_leaving_edges_are_seen_and_stay_known():
    w = world()
    o = w.observe()
    seen = ~np.isnan(o.known)
    assert (o.at, o.arrived, seen.sum()) == (w.graph.start, False, 2)
    assert (o.known[seen] == w.costs[seen]).all()
    w.step({0: w.graph.vertex_numbers["B"]})
    assert (~np.isnan(w.observe().known)).sum() == 4
    assert w.metrics()["cost"] == w.costs[w.graph.edges_of((w.graph.start, w.graph.vertex_numbers["B"]))[0]]


def test_at_the_goal_the_excess_is_that_over_the_cheapest_path():
    w = world()
    assert np.isnan(w.metrics()["excess"])
    for name in ("A", "G"):
        w.step({0: w.graph.vertex_numbers[name]})
    told = w.metrics()
    assert (told["arrived"], told["cost"]) == (1.0, w.cost)
    assert told["excess"] == pytest.approx(100 * (w.cost - w.hindsight) / w.hindsight)
    w.step({})
    assert w.metrics() == told
    assert w.time == 3


def test_the_draw_depends_on_the_seed_alone_and_costs_do_not_fall_below_their_least():
    assert (world(1).costs == world(1).costs).all()
    assert (world(1).costs != world(2).costs).all()
    assert (world(1, least=np.full(10, 1000.0)).costs == 1000.0).all()


def test_the_two_directions_of_an_edge_are_seen_together():
    edges = [("S", "a", 1, 1), ("a", "S", 1, 1), ("a", "G", 1, 1)]
    w = UncertainGraphWorld(graph_of(edges, variable=[0, 0, 1]), np.random.default_rng(1))
    assert (~np.isnan(w.observe().known)).tolist() == [True, True, False]
    assert w.costs[0] == w.costs[1]


def test_draws_have_the_moments_of_the_graph():
    rng = np.random.default_rng(3)
    g = graph_of(WORKED)
    drawn = np.array([UncertainGraphWorld(g, rng).costs for _ in range(2000)])
    assert np.abs(drawn.mean(axis=0) - g.mean).max() < 4 * 3 / np.sqrt(2000)
    assert np.allclose(drawn.var(axis=0), g.variance, rtol=0.2)


def test_moves_that_are_none_are_refused_and_change_nothing():
    w = world()
    check_refused(InputError, "no edge leads from S to vertex number 99", w.step, {0: 99})
    check_refused(InputError, "agent 1 does not exist", w.step, {1: 2})
    assert (w.time, w.path) == (0, [w.graph.start])


def test_a_graph_is_drawn_or_read(tmp_path):
    made = make_world("uncertain-graph", 5, vertices=20, graph=3)
    again = make_world("uncertain-graph", 6, vertices=20, graph=3)
    assert made.graph is again.graph  # runs on one graph share what is computed of it
    assert (made.costs != again.costs).any()
    assert make_world("uncertain-graph", 1, roadmap="raster-graph", vertices=40, scene="empty", pixels=32).graph.num_vertices == 40
    write_instance(graph_of(WORKED), tmp_path / "g.csv")
    assert make_world("uncertain-graph", 5, file=str(tmp_path / "g.csv")).graph.num_vertices == 7
    check_refused(InputError, "no such file", make_world, "uncertain-graph", 5, file="nowhere.csv")
    with pytest.raises(UsageError, check=coded("foreign")):
        make_world("uncertain-graph", 5, file=str(bundled_path("demo-tiny")))
