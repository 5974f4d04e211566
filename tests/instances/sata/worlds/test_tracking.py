import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.sata.worlds.tracking import SCENARIOS, TrackingRules, TrackingWorld, linked
from waybound.instances.worlds import make_world

RULES = {
    "robots": 2, "targets": 3, "width": 100.0, "height": 60.0, "robot_step": 4.0, "target_step": 2.0, "sensing": 10.0,
    "communication": 20.0,
}  # fmt: skip


def world(seed=1, *, robots=None, targets=None, **changes):
    return TrackingWorld(TrackingRules(**{**RULES, **changes}), np.random.default_rng(seed), robots=robots, targets=targets)


def way(made, steps, drive=None):
    """Positions of the targets at the start and after each step."""
    seen = [made.targets]
    for _ in range(steps):
        made.step({} if drive is None else drive(made))
        seen.append(made.targets)
    return np.array(seen)


def test_the_same_seed_gives_the_same_world_and_another_seed_another():
    ways = [way(make_world("tracking", seed, turn_chance=0.3), 30) for seed in (5, 5, 6)]
    assert np.array_equal(ways[0], ways[1])
    assert not np.allclose(ways[0], ways[2])


def test_the_targets_go_their_way_whatever_the_robots_do_and_however_badly_they_measure():
    def to_the_middle(made):
        return {k: made.robots[k] + (np.array([50.0, 30.0]) - made.robots[k]) * 0.03 for k in range(2)}

    still, driven, noisy = (way(world(turn_chance=0.2, noise=n), 40, d) for n, d in ((0, None), (0, to_the_middle), (1.5, None)))
    assert np.array_equal(still, driven)
    assert np.array_equal(still, noisy)


@settings(max_examples=draws(40))
@given(
    seed=st.integers(0, 2**32), width=st.floats(2, 50), height=st.floats(2, 50), share=st.floats(0, 1),
    every=st.integers(0, 4), chance=st.floats(0, 1), length=st.floats(0.01, 0.5),
)  # fmt: skip
def test_targets_stay_inside_and_moving_ones_always_make_their_whole_step(seed, width, height, share, every, chance, length):
    step = length * min(width, height)
    made = world(seed, targets=None, width=width, height=height, moving=share, turn_every=every, turn_chance=chance, target_step=step)
    steps = way(made, 25)
    assert (steps >= 0).all()
    assert (steps <= [width, height]).all()
    lengths = np.linalg.norm(np.diff(steps, axis=0), axis=2)
    assert np.allclose(lengths[:, made.moving], step, rtol=1e-9)
    assert (lengths[:, ~made.moving] == 0).all()
    assert made.moving.sum() == round(share * 3)


def test_targets_go_straight_between_turns_and_all_turn_at_the_stated_steps():
    middle = [[50.0, 30.0]] * 3
    moves = np.diff(way(world(3, targets=middle, turn_every=5), 12), axis=0)
    turned = [not np.allclose(moves[k], moves[k - 1]) for k in range(1, 12)]
    assert [k for k, flag in enumerate(turned, start=1) if flag] == [5, 10]
    assert not any(np.allclose(moves[5][t], moves[4][t]) for t in range(3))
    never = np.diff(way(world(3, targets=middle), 10), axis=0)
    assert np.allclose(never, never[0])


def test_a_target_in_a_corner_turns_inside():
    for seed in range(20):
        after = way(world(seed, targets=[[0.0, 0.0], [100.0, 60.0], [100.0, 0.0]]), 1)[-1]
        assert ((after >= 0) & (after <= [100, 60])).all()


def test_a_robot_sees_what_is_within_its_range_and_measures_place_and_last_move():
    made = world(robots=[[10.0, 10.0], [50.0, 30.0]], targets=[[10.0, 20.0], [10.0, 20.001], [52.0, 30.0]])
    seen = made.observe()
    assert seen.seen.tolist() == [[True, False, False], [False, False, True]]
    assert np.array_equal(seen.measured[0, 0], [10.0, 20.0])
    assert np.isnan(seen.measured[0, 1]).all()
    assert np.isnan(seen.velocities[1, 0]).all()
    before = made.targets
    made.step({})
    after = made.observe()
    for robot, target in np.argwhere(after.seen):
        assert np.allclose(after.velocities[robot, target], (made.targets - before)[target])
        assert np.allclose(after.measured[robot, target], made.targets[target])


def test_before_the_first_step_the_announced_move_is_the_one_that_follows():
    made = world(robots=[[50.0, 30.0]] * 2, targets=[[50.0, 30.0]] * 3)
    told, before = made.observe().velocities, made.targets
    made.step({})
    assert np.allclose(told[0], made.targets - before)


def test_noise_blurs_what_is_measured_and_not_what_is_seen():
    exact, noisy = (make_world("tracking", 4, targets=200, noise=n).observe() for n in (0.0, 0.5))
    assert np.array_equal(exact.seen, noisy.seen)
    errors = (noisy.measured - exact.measured)[exact.seen]
    assert 0.4 < errors.std() < 0.6
    assert abs(errors.mean()) < 0.1


def test_asking_twice_gives_the_same_and_a_part_is_what_its_robots_know():
    made = world(noise=1.0)
    assert made.observe() is made.observe()
    part = made.observe().part([1])
    assert part.ids.tolist() == [1]
    assert np.array_equal(part.measured, made.observe().measured[[1]], equal_nan=True)


def test_metrics_count_targets_that_anyone_sees_that_stay_seen_and_groups_that_hear_each_other():
    made = world(robots=[[10.0, 10.0], [50.0, 30.0]], targets=[[10.0, 12.0], [10.0, 12.0], [90.0, 50.0]], moving=0.0)
    assert made.metrics() == {"observed": 2.0, "kept": 0.0, "components": 2.0}
    made.step({0: [12.0, 10.0]})
    assert made.metrics()["kept"] == 2.0
    for x in range(14, 46, 4):
        made.step({0: [float(x), 10.0]})
    assert made.metrics() == {"observed": 0.0, "kept": 0.0, "components": 2.0}
    made.step({1: [47.0, 28.0]})
    assert made.metrics()["components"] == 1.0


def test_headings_follow_the_last_move_and_stay_with_a_robot_that_stays():
    made = world(robots=[[10.0, 10.0], [50.0, 30.0]])
    kept = made.observe().headings[1]
    made.step({0: [10.0, 7.0]})
    assert made.observe().headings.tolist() == [pytest.approx(-math.pi / 2), kept]


@pytest.mark.parametrize(
    ("actions", "says"),
    [
        ({0: [11.0, 10.0], 1: [55.0, 30.0]}, "cannot move 5 m"),
        ({0: [11.0, 10.0], 2: [0.0, 0.0]}, "no robot number 2"),
        ({0: [11.0, 10.0], -1: [50.0, 30.0]}, "no robot number -1"),
        ({0: [11.0, 10.0], 1: [math.nan, 30.0]}, "two finite numbers"),
        ({0: [11.0, 10.0], 1: [30.0]}, "two finite numbers"),
        ({0: [11.0, 10.0], 1: "north"}, "two finite numbers"),
        ({1: [50.0, 30.0], 0: [10.0, -1.0]}, "must stay inside"),
    ],
)
def test_what_a_robot_cannot_do_is_refused_and_changes_nothing(actions, says):
    made = world(robots=[[10.0, 2.0], [50.0, 30.0]], robot_step=4.0) if "inside" in says else world(robots=[[10.0, 10.0], [50.0, 30.0]])
    before = made.robots.copy(), made.targets.copy(), made.time
    check_refused(InputError, says, made.step, actions)
    assert np.array_equal(made.robots, before[0])
    assert np.array_equal(made.targets, before[1])
    assert made.time == before[2]


def test_a_start_outside_or_of_the_wrong_number_is_refused():
    check_refused(InputError, "target 2 starts outside", world, targets=[[1, 1], [101, 1], [1, 1]])
    with pytest.raises(InputError, check=coded("wrong-shape")):
        world(robots=[[1, 1]])


def test_a_target_step_longer_than_half_the_area_is_refused():
    check_refused(UsageError, "too long", make_world, "tracking", 1, target_step=101)


@pytest.mark.parametrize(("key", "value"), [("width", "wide"), ("sensing", math.nan), ("scenario", "x")])
def test_settings_that_are_none_are_refused_by_name(key, value):
    check_refused(UsageError, key, make_world, "tracking", 1, **{key: value})


def test_scenarios_hold_the_numbers_of_the_source_and_settings_override_them():
    r = make_world("tracking", 1, targets=30).rules
    assert (r.robots, r.targets, r.width, r.height, r.robot_step, r.target_step) == (10, 30, 200, 200, 10, 5)
    assert (r.turn_every, r.sensing, r.communication) == (25, 40, 80)
    r = make_world("tracking", 1, scenario="gazebo-greedy").rules
    assert (r.robots, r.targets, r.width, r.height, r.sensing, r.communication) == (10, 30, 30, 30, 5, 10)
    r = make_world("tracking", 1, scenario="gazebo-local").rules
    assert (r.robots, r.targets, r.sensing, r.communication, r.robot_step) == (5, 30, 3, 6, 1)
    assert 0 < r.moving < 1
    assert len({tuple(values) for values in SCENARIOS.values()}) == 1


@settings(max_examples=draws(50))
@given(st.integers(1, 12), st.integers(0, 2**32), st.floats(0, 0.5))
def test_linked_finds_the_connected_components(size, seed, density):
    import networkx as nx

    draw = np.random.default_rng(seed).random((size, size)) < density
    adjacent = draw | draw.T | np.eye(size, dtype=bool)
    labels = linked(adjacent)
    groups = {frozenset(np.nonzero(labels == k)[0].tolist()) for k in range(labels.max() + 1)}
    assert groups == {frozenset(c) for c in nx.connected_components(nx.from_numpy_array(adjacent))}
    assert [int(k) for k in dict.fromkeys(labels.tolist())] == list(range(labels.max() + 1))
