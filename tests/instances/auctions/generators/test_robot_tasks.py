import numpy as np
import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate


@pytest.mark.parametrize("layout", ["plane", "clusters", "grid", "line"])
def test_a_seed_gives_the_same_instance_of_the_size_that_was_asked_for(layout):
    one, same, other = (generate("robot-tasks", seed, layout=layout, robots=6, tasks=9, weight=3) for seed in (1, 1, 2))
    assert one.digest() == same.digest() != other.digest()
    assert (one.num_robots, one.num_tasks, one.name) == (6, 9, f"{layout}-r6-t9-s1")
    assert (one.weights >= 0).all() and (one.weights <= 3).all()


def test_on_a_grid_the_first_bases_are_corners_and_moves_go_in_eight_directions():
    team = generate("robot-tasks", 3, layout="grid", size=10, robots=5)
    assert team.positions[:5].tolist() == [[0, 0], [9, 9], [9, 0], [0, 9], [4, 4]]
    assert team.metric == "chebyshev" and (team.positions == np.round(team.positions)).all()


def test_settings_out_of_range_are_refused():
    check_refused(UsageError, "robots must lie between 1 and", generate, "robot-tasks", 1, robots=0)
