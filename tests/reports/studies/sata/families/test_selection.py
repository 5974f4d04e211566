"""Random selection problems: every kind of function and constraint, with what is easily forgotten among them."""

import numpy as np
import pytest
from selection_problems import feasible_sets

from waybound import Knapsack, check_submodular
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import selection as random


def test_random_instances_hold_what_is_easily_forgotten():
    graphs_ = [random.random_graph(np.random.default_rng(k), k) for k in range(200)]
    assert any(len(g.idle_robots) for g in graphs_), "robots that see nothing"
    assert any(len(g.unseen_targets) for g in graphs_), "targets that nobody sees"
    knapsacks = [random.knapsack(np.random.default_rng(k), 8) for k in range(200)]
    assert all(isinstance(c, Knapsack) for c in knapsacks)
    assert any((c.costs == 0).any() for c in knapsacks)
    assert any((c.costs > c.budget).any() for c in knapsacks)


@pytest.mark.parametrize("constraint", random.CONSTRAINTS)
def test_a_family_for_each_function_has_ground_sets_up_to_the_size_asked_for(constraint):
    families = random.random_families(constraint, largest=7)
    assert [family.name for family in families] == list(random.FUNCTIONS)
    for family in families:
        problems = [family.case(k, 3).problem for k in range(12)]
        assert {p.constraint.name for p in problems} == {constraint}
        assert all(4 <= p.num_elements <= 7 for p in problems) and len({p.num_elements for p in problems}) > 1
        assert all(any(len(s) for s in feasible_sets(p)) or constraint == "knapsack" for p in problems)


@pytest.mark.parametrize("kind", random.FUNCTIONS)
def test_every_function_is_monotone_and_submodular(kind):
    for seed in range(8):
        assert check_submodular(random.FUNCTIONS[kind](np.random.default_rng(seed), 6)), (kind, seed)


def test_groups_are_numbered_without_gaps_and_mostly_of_one_choice():
    drawn = [random.partition(np.random.default_rng(k), 9) for k in range(60)]
    assert all(sorted(set(c.groups.tolist())) == list(range(len(c.limits))) for c in drawn)
    limits = np.concatenate([c.limits for c in drawn])
    assert limits.min() == 1 and 0.5 < (limits == 1).mean() < 1.0


def test_planted_answers_beat_greedy():
    for family, name in ((random.planted_covers("cardinality"), "greedy"), (random.PLANTED_ASSIGNMENTS, "sequential-greedy")):
        ratios = []
        for k in range(60):
            case = family.case(k, 1)
            found = case.problem.evaluate(run_heuristic(case.problem, name, {}, 1).answer).values[0]
            ratios.append(case.solved().value / found)
        assert np.mean(ratios) > 1.03
        assert max(ratios) > 1.15


@pytest.mark.parametrize("constraint", ["cardinality", "partition", "knapsack"])
def test_the_planted_sets_cover_everything_and_are_allowed(constraint):
    for seed in range(20):
        problem = random.planted_cover(np.random.default_rng(seed), 4, "planted", constraint)
        everything = problem.value(range(problem.num_elements))
        assert problem.num_elements == 8
        assert optimum(problem).value == pytest.approx(everything)


def test_each_robot_alone_can_keep_what_is_its_own():
    for seed in range(20):
        problem = random.planted_assignment(np.random.default_rng(seed), 3, "planted")
        g = problem.graph
        own = problem.value(range(0, g.num_actions, 2))
        assert g.num_robots == 3 and not len(g.unseen_targets)
        assert optimum(problem).value >= own - 1e-9
