import numpy as np
import pytest
from sata_cases import CASES

from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.studies.sata.families import max_min as graphs
from waybound.reports.studies.sata.families.optima import best_shares


def test_unequal_graphs_hold_what_is_easily_forgotten():
    unequal = [graphs.unequal_graph(np.random.default_rng(k), "unit", "") for k in range(200)]
    assert all(not len(g.unseen_targets) for g in unequal)
    assert any((np.bincount(g.indices) == 1).any() for g in unequal), "targets of one action"
    assert any((np.diff(g.indptr) == 0).any() for g in unequal), "actions that see nothing"
    assert {int(np.bincount(g.robot_of_action).max()) for g in unequal} >= {1, 2, 3, 4, 5}


def test_near_regular_graphs_are_near_regular():
    g = graphs.near_regular_graph(np.random.default_rng(1), "uniform", "")
    assert g.num_actions == 2 * g.num_robots
    assert (np.diff(g.indptr) <= 2).all()
    assert (np.bincount(g.indices) <= 4).all()


@pytest.mark.parametrize("kind", ["unit", "whole", "uniform", "spread"])
def test_weights_are_positive_and_of_their_kind(kind):
    drawn = graphs.weights(np.random.default_rng(1), kind, 2000)
    assert (drawn > 0).all()
    assert {"unit": set(drawn) == {1.0}, "whole": set(drawn) == {1.0, 2.0, 3.0, 4.0}}.get(kind, len(set(drawn)) > 1900)
    assert (drawn.max() / drawn.min() > 1e3) == (kind == "spread")


def test_on_a_ring_robots_see_near_targets_alone_and_all_are_seen():
    for seed in range(40):
        g = graphs.ring_graph(np.random.default_rng(seed), "unit", "")
        assert not len(g.unseen_targets) and g.num_targets == g.num_robots
        away = np.abs(g.robot_of_action[g.action_of_edge] - g.indices)
        assert np.minimum(away, g.num_robots - away).max() <= 3


def test_packing_rows_stand_apart():
    problem = graphs.packing_rows(np.random.default_rng(2), "uniform", "rows")
    assert (np.bincount(problem.packing.indices, minlength=problem.num_variables) == 1).all()


@pytest.mark.parametrize("name", graphs.REFERENCES)
def test_the_optima_of_the_references_are_those_that_stand_there(name):
    rows, value = graphs.REFERENCES[name]
    problem = graphs.robots(rows, name)
    assert best_shares(problem).value == pytest.approx(value, rel=1e-9)
    if name in CASES:
        assert value == pytest.approx(CASES[name].lp, rel=1e-9)
        assert problem.graph.digest() == CASES[name].graph.digest()


def test_the_bound_of_the_local_algorithm_is_attained():
    for h, ratio in ((1, 2.0), (2, 1.5)):
        problem = graphs.tight_pair(h)
        found = run_heuristic(problem, "local", {"h": h, "search": "secant", "eps": 1e-6, "normalise": False}, 1)
        assert best_shares(problem).value / problem.evaluate(found.answer).values[0] == pytest.approx(ratio, rel=1e-3)
