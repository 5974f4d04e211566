import itertools

import numpy as np
import pytest
from draws import draws
from task_problems import OBJECTIVES, drawn, line

from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.auctions.consensus_bundle import GRAPHS, consensus, graph_of
from waybound.reports.ratios.judged_runs import run_heuristic

CBBA = "consensus-bundle"


@pytest.mark.parametrize(("objective", "communication"), list(itertools.product(OBJECTIVES, GRAPHS)))
def test_robots_agree_over_every_graph(objective, communication):
    rng = np.random.default_rng(1)
    for k in range(8):
        problem = TaskAllocation(drawn(rng, robots=5, tasks=8, matrix=k % 2 == 1), objective)
        found = run_heuristic(problem, CBBA, {"communication": communication}, 1)
        assert problem.evaluate(found.answer).feasible
        assert not found.message and found.guarantee is None


def test_graphs_have_the_links_of_their_names():
    assert [int(graph_of(name, 5).sum()) for name in GRAPHS] == [20, 10, 8, 8]
    assert not graph_of("ring", 1).any() and int(graph_of("ring", 2).sum()) == 2


def test_a_longer_line_takes_more_rounds_and_each_of_them_a_message_a_link():
    rounds = []
    for robots in (2, 8):
        found = run_heuristic(line(range(robots), [robots - 0.9]), CBBA, {"communication": "line"}, 1)
        rounds.append(found.statistics["rounds"])
        assert found.statistics["messages"] == rounds[-1] * 2 * (robots - 1)
    assert rounds[1] > rounds[0]


def test_bundles_may_be_small_and_what_is_left_is_inserted():
    problem = line([0, 10], [1, 2, 3, 9])
    found = run_heuristic(problem, CBBA, {"most": 1}, 1)
    assert problem.evaluate(found.answer).feasible and "2 tasks that nobody had room for" in found.message


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
