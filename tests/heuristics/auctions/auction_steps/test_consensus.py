"""Consensus on bundles: where gains diminish it is the sequential greedy answer, and at least half of the optimum."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from draws import draws

from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.auctions.auction_steps.consensus import consensus
from waybound.heuristics.auctions.consensus_bundle import GRAPHS, graph_of


class Coverage:
    """Each robot values a set of tasks by the weights of the items that they cover for it: monotone and submodular."""

    def __init__(self, rng: np.random.Generator, robots: int, tasks: int) -> None:
        self.covers = rng.random((robots, tasks, 6)) < 0.4
        self.weight = rng.integers(1, 10, (robots, 6)) + rng.random((robots, 6)) / 1000  # no ties

    def value(self, robot: int, tasks) -> float:
        return float(self.weight[robot][self.covers[robot][list(tasks)].any(axis=0)].sum())

    def gains(self, robot: int, path: tuple[int, ...]):
        here = self.value(robot, path)
        tasks = self.covers.shape[1]
        return np.array([self.value(robot, (*path, task)) - here for task in range(tasks)]), np.full(tasks, len(path))

    def greedy(self) -> tuple[tuple[int, ...], ...]:
        """Task after task to whom it is worth most, the lower robot, then the lower task, of equal worth."""
        robots, tasks, _ = self.covers.shape
        paths, left = [()] * robots, set(range(tasks))
        while left:
            _, robot, task = max((self.gains(r, paths[r])[0][t], -r, -t) for r in range(robots) for t in left)
            paths[-robot] = (*paths[-robot], -task)
            left.remove(-task)
        return tuple(paths)

    def optimum(self) -> float:
        robots, tasks, _ = self.covers.shape
        shares = itertools.product(range(robots), repeat=tasks)
        return max(sum(self.value(r, [t for t in range(tasks) if own[t] == r]) for r in range(robots)) for own in shares)


@pytest.mark.parametrize("communication", GRAPHS)
def test_where_gains_diminish_it_is_worth_what_sequential_greedy_is_and_half_of_the_optimum(communication):
    rng = np.random.default_rng(1)
    for _ in range(draws(50)):
        robots, tasks = int(rng.integers(1, 4)), int(rng.integers(1, 6))
        team = Coverage(rng, robots, tasks)
        found = consensus(team.gains, tasks, graph_of(communication, robots), NEVER)
        assert found.agreed
        assert sorted(task for path in found.paths for task in path) == list(range(tasks))
        worth, greedy = (sum(team.value(r, path) for r, path in enumerate(paths)) for paths in (found.paths, team.greedy()))
        assert worth == pytest.approx(greedy)
        assert worth >= 0.5 * team.optimum() - 1e-12


@pytest.mark.long
def test_half_of_the_optimum_on_thousands_of_teams():
    rng = np.random.default_rng(2)
    for _ in range(2000):
        team = Coverage(rng, int(rng.integers(2, 4)), int(rng.integers(2, 6)))
        robots, tasks, _ = team.covers.shape
        found = consensus(team.gains, tasks, graph_of("line", robots), NEVER)
        assert sum(team.value(r, path) for r, path in enumerate(found.paths)) >= 0.5 * team.optimum() - 1e-12


def test_rounds_grow_no_faster_than_tasks_times_the_diameter():
    rng = np.random.default_rng(3)
    for communication, diameter in (("complete", 1), ("star", 2), ("ring", 3), ("line", 5)):
        team = Coverage(rng, 6, 8)
        assert consensus(team.gains, 8, graph_of(communication, 6), NEVER).rounds <= 8 * diameter + 2


def test_nobody_who_is_not_heard_agrees():
    team = Coverage(np.random.default_rng(4), 2, 3)
    assert not consensus(team.gains, 3, np.zeros((2, 2), dtype=bool), NEVER).agreed


def test_bundles_have_room_for_so_many_and_a_wish_to_stop_is_kept():
    team = Coverage(np.random.default_rng(5), 2, 5)
    found = consensus(team.gains, 5, graph_of("complete", 2), NEVER, most=1)
    assert [len(path) for path in found.paths] == [1, 1]
    assert consensus(team.gains, 5, graph_of("complete", 2), Stop(0.0)).rounds == 0
