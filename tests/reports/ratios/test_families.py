"""Families of instances: seeded, and made as they say."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.instances.selection.constraints import Knapsack
from waybound.reports.ratios import max_min_families as graphs
from waybound.reports.ratios import planted_families as planted
from waybound.reports.ratios import selection_families as random
from waybound.reports.ratios.judging import run_heuristic

RANDOM = [
    *(family for rule in random.CONSTRAINTS for family in random.random_families(rule)), random.random_assignments(),
    planted.planted_covers("cardinality"), planted.planted_covers("knapsack"), planted.planted_assignments(), *graphs.random_families(),
    graphs.random_programs(),
]  # fmt: skip


@pytest.mark.parametrize("family", RANDOM, ids=lambda family: family.name)
def test_a_case_depends_on_its_number_and_the_seed_alone(family):
    digests = {(k, seed): family.case(k, seed).problem.digest() for k in range(6) for seed in (1, 2)}
    assert len(set(digests.values())) > 6
    if family.name != "user-function":  # the digest of a program of the user's is that of its label
        assert all(family.case(k, seed).problem.digest() == digest for (k, seed), digest in digests.items())


@pytest.mark.parametrize("family", RANDOM, ids=lambda family: family.name)
def test_every_case_can_be_solved(family):
    for k in range(30):
        case = family.case(k, 7)
        assert case.problem.evaluate(case.solved().answer).feasible


def test_planted_answers_beat_greedy():
    for family, name in ((planted.planted_covers("cardinality"), "greedy"), (planted.planted_assignments(), "sequential-greedy")):
        ratios = []
        for k in range(60):
            case = family.case(k, 1)
            found = case.problem.evaluate(run_heuristic(case.problem, name, {}, 1).answer).values[0]
            ratios.append(case.solved().value / found)
        assert np.mean(ratios) > 1.03
        assert max(ratios) > 1.15


def test_random_instances_hold_what_is_easily_forgotten():
    graphs_ = [random.random_graph(np.random.default_rng(k), k) for k in range(200)]
    assert any(len(g.idle_robots) for g in graphs_), "robots that see nothing"
    assert any(len(g.unseen_targets) for g in graphs_), "targets that nobody sees"
    knapsacks = [random.knapsack(np.random.default_rng(k), 8) for k in range(200)]
    assert all(isinstance(c, Knapsack) for c in knapsacks)
    assert any((c.costs == 0).any() for c in knapsacks)
    assert any((c.costs > c.budget).any() for c in knapsacks)
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
