from dataclasses import replace

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import UsageError
from waybound.instances.sata.worlds.tracking import TrackingRules, TrackingWorld
from waybound.reports.missions.sata.force_vectors import ForceRules, attraction, forces, moves, repulsion

HALF = np.sqrt(0.5)


def observed(robots, targets, *, communication=1000.0, sensing=10.0, step=2.0):
    rules = TrackingRules(
        robots=len(robots), targets=len(targets), width=100.0, height=100.0, robot_step=step, target_step=0.0, sensing=sensing,
        communication=communication,
    )  # fmt: skip
    return TrackingWorld(rules, np.random.default_rng(1), robots=robots, targets=targets).observe()


@pytest.mark.parametrize(
    ("distance", "force"),
    [(0, -1), (1, -0.5), (2, 0), (3, 0.5), (4, 1), (7, 1), (10, 1), (11, 0.5), (12, 0), (50, 0)],
)
def test_a_target_pushes_off_when_near_draws_in_the_middle_and_is_forgotten_when_far(distance, force):
    assert attraction(distance, 2.0, 4.0, 10.0, 12.0) == pytest.approx(force)


@pytest.mark.parametrize(("distance", "force"), [(0, -1), (5, -1), (6, -0.5), (7, 0), (50, 0)])
def test_a_robot_pushes_off_until_it_is_far(distance, force):
    assert repulsion(distance, 5.0, 7.0) == pytest.approx(force)


def test_a_lone_robot_goes_its_whole_step_towards_its_target():
    o = observed([[50.0, 50.0]], [[55.0, 50.0]])
    assert forces(o) == pytest.approx(np.array([[1.0, 0.0]]))
    assert moves(o)[0] == pytest.approx([52.0, 50.0])


def test_forces_of_several_targets_add_up():
    o = observed([[50.0, 50.0]], [[55.0, 50.0], [50.0, 44.0], [50.0, 50.75]])  # 0.75 of sensing 10 with do1 = 1.5: force -0.5
    assert forces(o) == pytest.approx(np.array([[1.0, -1.0 - 0.5]]))


def test_robots_push_each_other_off_and_share_a_target_at_half_its_weight():
    o = observed([[50.0, 50.0], [54.0, 50.0]], [[50.0, 55.0]])  # the robots are 4 apart: full push (dr1 = 5)
    to_first, to_second = np.array([0.0, 1.0]), np.array([-4.0, 5.0]) / np.sqrt(41.0)
    assert forces(o) == pytest.approx(np.array([0.5 * to_first + [-1.0, 0.0], 0.5 * to_second + [1.0, 0.0]]))


def test_a_push_fades_between_its_breakpoints():
    o = observed([[50.0, 50.0], [56.0, 50.0]], [[90.0, 90.0]])  # 6 of 5 to 7.5
    assert forces(o) == pytest.approx(np.array([[-0.6, 0.0], [0.6, 0.0]]))


def test_what_another_robot_sees_draws_only_those_who_hear_it():
    where, target = [[50.0, 50.0], [69.0, 50.0]], [[61.0, 50.0]]  # 11 from the first, beyond its range, 8 from the second
    hears, deaf = observed(where, target, communication=20.0), observed(where, target, communication=18.0)
    assert forces(hears)[0] == pytest.approx([0.5 * 0.5, 0.0])
    assert forces(deaf)[0] == pytest.approx([0.0, 0.0])
    assert forces(hears)[1] == pytest.approx([-1.0, 0.0])


def test_messages_are_relayed():
    where = [[50.0, 50.0], [50.0, 65.0], [61.0, 61.0]]
    o = observed(where, [[61.0, 54.0]], communication=16.0)  # the third hears both, and the first and the third are 15.6 apart
    assert len(set(o.components.tolist())) == 1


def test_nothing_near_and_things_at_one_place_exert_no_force():
    o = observed([[50.0, 50.0], [50.0, 50.0]], [[50.0, 50.0], [90.0, 90.0]])
    assert (forces(o) == 0).all()
    assert moves(o)[0] == pytest.approx([50.0, 50.0])


def test_a_robot_goes_no_farther_than_the_wall():
    o = observed([[99.0, 50.0]], [[100.0, 51.0]], step=2.0, sensing=4.0)  # 1.41 away, beyond do2 = 1.2
    assert forces(o) == pytest.approx(np.array([[HALF, HALF]]))
    assert moves(o)[0] == pytest.approx([100.0, 50.0 + 2 * HALF])


def test_a_target_is_where_those_who_see_it_measure_it_on_average():
    o = observed([[50.0, 50.0], [58.0, 50.0]], [[54.0, 53.0]])
    shifted = o.measured.copy()
    shifted[0, 0], shifted[1, 0] = [54.0, 53.0], [56.0, 53.0]
    seen = forces(replace(o, measured=shifted))
    way = np.array([5.0, 3.0]) / np.sqrt(34.0)
    assert seen[0] == pytest.approx(0.5 * way)


@pytest.mark.parametrize("wrong", [{"do1": 0.5}, {"predictive": 1.0}, {"dr1": 0.0}, {"dr2": 0.5}, {"shared": 2.0}])
def test_breakpoints_out_of_order_are_refused(wrong):
    with pytest.raises(UsageError, check=coded("contradiction")):
        ForceRules(**wrong)
