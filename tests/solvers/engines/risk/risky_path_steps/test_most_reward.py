import numpy as np
import pytest
import risky_cases as cases

from waybound import InputError, RiskyPath
from waybound.formulations.stop import NEVER
from waybound.instances.risk.elements import LocaleRisk
from waybound.instances.risk.traverse_elements import CollectedRisk
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.risk.risky_path_steps.most_reward import most_reward


@pytest.mark.parametrize("discount", [1.0, 0.7, 0.0])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("goals", [(), (8,)])
def test_the_best_of_all_paths_is_found(seed, discount, goals):
    rng = np.random.default_rng(seed)
    given = {"rewards": rng.integers(0, 4, 9) + np.eye(9)[8], "discount": discount, "objective": "reward-per-risk"}
    problem = cases.random_map(rng, muddy=True, **given)
    if goals:
        from dataclasses import replace

        problem = RiskyPath(replace(problem.graph, goals=goals))
    result = most_reward(problem, NEVER, Options(), Control())
    assert result.status == "optimal" and result.limit == "none"
    assert problem.evaluate(result.answer).values[0] == pytest.approx(cases.best(problem)) == pytest.approx(result.bound)


@pytest.mark.parametrize("discount", [0.0, 1.0])
def test_a_ratio_of_zero_is_an_answer(discount):
    given = {"goals": (1,), "rewards": [0.0, 0.0, 1.0], "discount": discount, "objective": "reward-per-risk"}
    near = RiskyPath(cases.graph([(0, 1)], [LocaleRisk([0.0, 0.5, 0.0])], states=3, **given))
    result = most_reward(near, NEVER, Options(), Control())
    assert (result.status, result.answer, result.objective, result.bound) == ("optimal", (0, 1), 0.0, 0.0)


@pytest.mark.parametrize("discount", [0.0, 1.0])
def test_a_ratio_of_zero_is_found_where_the_least_risky_walk_comes_to_a_state_twice(discount):
    before = cases.loop()
    rewards = np.eye(len(before.rewards) + 1)[-1]
    graph = cases.graph(
        list(zip(before.graph.tail.tolist(), before.graph.head.tolist(), strict=True)), before.graph.elements,
        states=len(rewards), goals=before.graph.goals, rewards=rewards, discount=discount, objective="reward-per-risk",
    )  # fmt: skip
    result = most_reward(RiskyPath(graph), NEVER, Options(), Control())
    assert (result.status, result.answer, result.bound) == ("optimal", (0, 1, 2), 0.0)


def test_a_ratio_of_zero_is_found_where_the_least_risky_path_has_none():
    risk = CollectedRisk([False, True, False, False], [[0.0] * 4, [0.0, 0.0, 0.0, 0.2]])  # at the end, for those who came by 1
    arcs, given = [(0, 3), (0, 1), (1, 3)], {"states": 4, "goals": (3,), "discount": 0.0, "objective": "reward-per-risk"}
    result = most_reward(RiskyPath(cases.graph(arcs, [risk], rewards=[0.0, 0.0, 1.0, 0.0], **given)), NEVER, Options(), Control())
    assert (result.status, result.answer, result.bound) == ("optimal", (0, 1, 3), 0.0)
    with pytest.raises(InputError, match="a reward is reached without risk, by 1 4"):
        RiskyPath(cases.graph(arcs, [risk], rewards=[0.0, 0.0, 1.0, 1.0], **given))


def test_a_limit_leaves_the_best_so_far_and_a_bound():
    problem = cases.random_map(np.random.default_rng(1), rewards=1.0 - np.eye(9)[0])
    result = most_reward(problem, NEVER, Options(iterations=3), Control())
    assert (result.status, result.limit) == ("feasible", "iterations")
    assert result.objective <= cases.best(problem) <= result.bound * (1 + 1e-9)


def test_a_start_is_never_made_worse():
    problem = cases.two_ways()
    assert most_reward(problem, NEVER, Options(iterations=1, start=(0, 2, 3)), Control()).answer == (0, 2, 3)
