import numpy as np
from draws import draws
from explorations import enumerated, path, random_map

import waybound as wb
from waybound import ExplorationMap, RoomExploration


def test_answers_keep_contact_and_gain_no_more_than_the_best() -> None:
    rng = np.random.default_rng(7)
    for _ in range(draws(12)):
        problem = random_map(rng)
        found = wb.solve(problem, heuristic="heard-greedy", bound_time=0)
        assert found.certificate.feasible and found.objective <= enumerated(problem)


def test_a_robot_walks_towards_what_is_far_and_comes_back() -> None:
    assert wb.solve(path(5, 5, 6, 1, 3), heuristic="heard-greedy", bound_time=0).objective == 1.0
    assert wb.solve(path(5, 4, 6, 1, 3), heuristic="heard-greedy", bound_time=0).objective == 0.0
    large = wb.generate("exploration-map", rooms=40, robots=4, steps=30, silence=5, seed=2)
    assert wb.solve(large, heuristic="heard-greedy", bound_time=0).objective > 5.0


def test_who_starts_too_far_out_has_no_answer() -> None:
    none = np.zeros((3, 0))
    lost = RoomExploration(ExplorationMap([(0, 1), (1, 2)], none, none, none, [2], 0, [], 0, 3))
    found = wb.solve(lost, heuristic="heard-greedy", bound_time=0)
    assert found.answer is None and "cannot be heard in time" in found.message
