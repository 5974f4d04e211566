import math

import numpy as np
import pytest
from coded import coded

from waybound import BottleneckSATA, MaxMinLP, Selection, UsageError, WinnerTakesAllSATA
from waybound.instances.sata.worlds.tracking import TrackingRules, TrackingWorld
from waybound.reports.missions.mission import Decision
from waybound.reports.missions.sata.tracking import SPREAD, Tracking, assigned, chosen_actions


def begun(robots, targets, **settings):
    """A mission and a world with these places; targets stand still and primitives keep their order unless told otherwise."""
    sizes = {
        "robots": len(robots), "targets": len(targets), "width": 100.0, "height": 100.0, "robot_step": 2.0, "target_step": 1.0,
        "moving": 0.0, "sensing": 10.0, "communication": 20.0, **{k: settings.pop(k) for k in list(settings) if k in RULES},
    }  # fmt: skip
    mission = Tracking()
    mission.world(1, **sizes, **{"order": "fixed", **settings})
    return mission, TrackingWorld(TrackingRules(**sizes), np.random.default_rng(1), robots=robots, targets=targets)


RULES = set(TrackingRules.__dataclass_fields__)


def edges(problem):
    """{(robot name, target name): weights of the robot's actions that see it}."""
    g, found = problem.graph, {}
    for a in range(g.num_actions):
        for t, w in zip(g.indices[g.indptr[a] : g.indptr[a + 1]], g.weights[g.indptr[a] : g.indptr[a + 1]], strict=True):
            found.setdefault((g.robot_name(int(g.robot_of_action[a])), g.target_name(int(t))), []).append(float(w))
    return found


def test_a_target_is_a_candidate_only_for_robots_that_see_it_now():
    # Target 2 is out of sight of robot 1, and would be in its sight after a step of 2 m; robot 2 sees it.
    mission, world = begun([[50.0, 50.0], [65.0, 50.0]], [[55.0, 50.0], [61.0, 50.0]])
    (team,) = mission.teams(world.observe())
    problem = mission.problem(team)
    assert set(edges(problem)) == {("1", "1"), ("2", "1"), ("2", "2")}
    assert np.abs(problem.graph.action_positions - [61.0, 50.0]).sum(axis=1).min() < 10


def test_targets_are_predicted_to_go_on_as_they_last_moved():
    mission, world = begun([[50.0, 50.0]], [[50.0, 50.0]], moving=1.0, target_step=3.0)
    world.step({})
    last = world.observe().velocities[0, 0]
    problem = mission.problem(world.observe())
    assert np.linalg.norm(last) == pytest.approx(3.0)
    assert problem.graph.target_positions[0] == pytest.approx(world.targets[0] + last)


def test_primitives_lie_around_a_robot_and_staying_is_the_first():
    mission, world = begun([[50.0, 50.0]], [[55.0, 50.0]])
    places = mission.problem(world.observe()).graph.action_positions - [50.0, 50.0]
    assert places.shape == (21, 2)
    assert places[0] == pytest.approx([0.0, 0.0])
    assert np.linalg.norm(places[1:], axis=1) == pytest.approx(np.full(20, 2.0))
    angles = np.sort(np.arctan2(places[1:, 1], places[1:, 0]))
    assert np.diff(angles) == pytest.approx(np.full(19, math.pi / 10))


def test_primitives_come_in_any_order_so_that_equals_are_chosen_alike():
    mission, world = begun([[50.0, 50.0]] * 300, [[50.0, 50.0]], primitives=3, order="random")
    places = mission.problem(world.observe()).graph.action_positions.reshape(300, 3, 2) - 50.0
    stays = (places == 0).all(axis=2)
    assert (stays.sum(axis=1) == 1).all()
    assert (np.abs(stays.mean(axis=0) - 1 / 3) < 0.12).all()


def test_primitives_ahead_keep_to_the_heading_and_to_the_step():
    mission, world = begun([[50.0, 50.0]] * 40, [[55.0, 50.0]], primitives=3, motion="ahead")
    world.step({k: [51.0, 51.0] for k in range(40)})
    places = mission.problem(world.observe()).graph.action_positions.reshape(40, 3, 2) - [51.0, 51.0]
    assert (places[:, 0] == 0).all()
    turned = np.arctan2(places[:, 1:, 1], places[:, 1:, 0]) - math.pi / 4
    assert (np.abs(turned) <= SPREAD + 1e-9).all()
    assert turned.std() > 0.1
    lengths = np.linalg.norm(places[:, 1:], axis=2)
    assert (lengths <= 2.0 + 1e-9).all()
    assert lengths.std() > 0.1


def test_no_primitive_leads_outside():
    mission, world = begun([[0.0, 0.0], [99.5, 100.0]], [[5.0, 5.0], [95.0, 95.0]])
    for team in mission.teams(world.observe()):
        places = mission.problem(team).graph.action_positions
        assert ((places >= 0) & (places <= 100)).all()


def test_weights_are_one_or_the_inverse_distance_with_its_cap():
    where = [[50.0, 50.0]], [[54.0, 50.0], [50.2, 50.0]]
    mission, world = begun(*where, primitives=1)
    assert edges(mission.problem(world.observe())) == {("1", "1"): [1.0], ("1", "2"): [1.0]}
    mission, world = begun(*where, primitives=1, weights="inverse-distance", closest=0.5)
    assert edges(mission.problem(world.observe())) == {("1", "1"): [0.25], ("1", "2"): [2.0]}


def test_a_target_that_no_primitive_will_see_is_left_out():
    mission, world = begun([[50.0, 50.0]], [[59.5, 50.0], [52.0, 50.0]], moving=1.0, target_step=3.0, robot_step=0.1, problem="bottleneck")
    while world._last_move[0, 0] < 1.5:  # until the first target runs away
        world = TrackingWorld(world.rules, world._draw._rng, robots=[[50.0, 50.0]], targets=[[59.5, 50.0], [52.0, 50.0]])
    problem = mission.problem(world.observe())
    assert [problem.graph.target_name(t) for t in range(problem.graph.num_targets)] == ["2"]
    assert len(problem.graph.unseen_targets) == 0


def test_there_is_no_problem_without_a_candidate():
    mission, world = begun([[50.0, 50.0]], [[90.0, 90.0]])
    assert mission.problem(world.observe()) is None


def test_teams_hear_each_other_and_share_targets():
    # 1 and 2 share target 1; 3 sees its own; 4 shares target 1 too but is out of hearing; 5 sees nothing.
    robots = [[50.0, 50.0], [58.0, 50.0], [66.0, 40.0], [54.0, 62.0], [90.0, 90.0]]
    mission, world = begun(robots, [[54.0, 54.0], [72.0, 36.0]], communication=12.7, sensing=9.0)
    o = world.observe()
    assert o.seen[:, 0].tolist() == [True, True, False, True, False]
    assert [team.ids.tolist() for team in mission.teams(o)] == [[0, 1, 3], [2], [4]]
    mission, world = begun(robots, [[54.0, 54.0], [72.0, 36.0]], communication=12.0, sensing=9.0)
    assert [team.ids.tolist() for team in mission.teams(world.observe())] == [[0, 1], [2], [3], [4]]


def test_the_problem_is_the_one_that_was_asked_for():
    for name, kind, fractional in (
        ("winner-takes-all", WinnerTakesAllSATA, None), ("bottleneck", BottleneckSATA, False), ("bottleneck-lp", BottleneckSATA, True),
    ):  # fmt: skip
        mission, world = begun([[50.0, 50.0]], [[52.0, 50.0]], problem=name)
        problem = mission.problem(world.observe())
        assert isinstance(problem, kind)
        assert problem.problem == name
        assert getattr(problem, "fractional", None) == fractional


def test_chosen_primitives_become_positions_and_robots_without_credit_are_idle():
    # Both robots see the one target; the first chosen action is credited, the other robot is free.
    mission, world = begun([[50.0, 50.0], [54.0, 50.0]], [[52.0, 50.0]], idle="stay")
    o = world.observe()
    problem = mission.problem(o)
    to = mission.actions(o, problem, Selection.of([21 + 5, 3]))
    assert set(to) == {1}
    assert to[1] == pytest.approx(problem.graph.action_positions[26])
    world.step(to)
    assert world.robots[1] == pytest.approx(problem.graph.action_positions[26])
    assert world.robots[0] == pytest.approx([50.0, 50.0])


def test_idle_robots_take_any_primitive_at_random():
    mission, world = begun([[50.0, 50.0]] * 30, [[90.0, 90.0]])
    to = mission.actions(world.observe(), None, None)
    places = {tuple(np.round(place - 50.0, 9)) for place in to.values()}
    assert set(to) == set(range(30))
    assert len(places) > 10
    assert all(math.hypot(*place) == pytest.approx(2.0) or place == (0.0, 0.0) for place in places)
    world.step(to)


def test_a_part_of_the_robots_moves_by_its_own_numbers():
    mission, world = begun([[10.0, 10.0], [50.0, 50.0]], [[52.0, 50.0]])
    (team,) = [t for t in mission.teams(world.observe()) if t.ids.tolist() == [1]]
    assert set(mission.actions(team, mission.problem(team), Selection.of([4]))) == {1}


def test_shares_are_rounded_to_the_largest_the_last_of_equals_and_no_share_is_no_action():
    mission, world = begun([[50.0, 50.0]] * 3, [[52.0, 50.0]], primitives=3, problem="bottleneck-lp")
    problem = mission.problem(world.observe())
    assert chosen_actions(problem, np.array([0.2, 0.5, 0.3, 0.4, 0.2, 0.4, 0.0, 0.0, 0.0])) == [1, 5]
    assert chosen_actions(problem, np.full(9, 1 / 3)) == [2, 5, 8]


def test_measures_put_what_was_predicted_beside_what_came_true():
    mission, world = begun([[50.0, 50.0], [50.0, 60.0]], [[50.0, 55.0], [59.5, 50.0]], primitives=1, weights="inverse-distance")
    (team,) = mission.teams(world.observe())
    problem = mission.problem(team)
    solution = type("Answered", (), {"answer": Selection.of([0, 1])})()
    world.robots = np.array([[50.0, 50.0], [50.0, 57.0]])
    world.targets = np.array([[50.0, 55.0], [62.0, 50.0]])
    world._observation = world._look()
    told = mission.measures([Decision(team, problem, solution)], world)
    assert told == {
        "candidates": 2.0, "estimated_targets": 2.0, "actual_targets": 1.0,
        "estimated_value": pytest.approx(1 / 5 + 1 / 9.5), "actual_value": pytest.approx(1 / 2),
    }  # fmt: skip


def test_measures_of_a_bottleneck_are_the_worst_target_of_the_worst_team():
    mission, world = begun([[20.0, 20.0], [22.0, 20.0], [80.0, 80.0]], [[21.0, 20.0], [80.0, 81.0]], primitives=1, problem="bottleneck")
    teams = mission.teams(world.observe())
    problems = [mission.problem(team) for team in teams]
    answers = [Selection.of([0, 1]), Selection.of([0])]
    decisions = [Decision(t, p, type("Answered", (), {"answer": a})()) for t, p, a in zip(teams, problems, answers, strict=True)]
    told = mission.measures(decisions, world)
    assert (told["estimated_value"], told["actual_value"]) == (1.0, 1.0)
    assert mission.total([2.0, 1.0]) == 1.0
    only = mission.measures(decisions[:1], world)
    assert (only["estimated_value"], only["candidates"]) == (2.0, 1.0)


def test_measures_without_an_answer_have_no_values():
    mission, world = begun([[50.0, 50.0]], [[90.0, 90.0]])
    told = mission.measures([Decision(world.observe(), None, None)], world)
    assert told["candidates"] == told["estimated_targets"] == 0.0
    assert math.isnan(told["estimated_value"])
    assert math.isnan(told["actual_value"])


@pytest.mark.parametrize(
    ("key", "value"), [("problem", "cvrp"), ("primitives", 0), ("motion", "back"), ("idle", "dance"), ("weights", 3), ("colour", 1)]
)
def test_settings_that_do_not_exist_are_refused_by_name(key, value):
    with pytest.raises(UsageError, match=key):
        Tracking().world(1, **{key: value})


def test_problems_without_robots_and_targets_are_refused():
    with pytest.raises(UsageError, check=coded("unsupported")):
        assigned(MaxMinLP(np.eye(1), np.eye(1)), None)


def test_scenarios_choose_problem_and_primitives_unless_told_otherwise():
    mission = Tracking()
    mission.world(1, scenario="gazebo-local")
    assert (mission.values["problem"], mission.values["primitives"], mission.values["motion"]) == ("bottleneck", 2, "ahead")
    mission.world(1, scenario="gazebo-local", problem="winner-takes-all")
    assert (mission.values["problem"], mission.values["primitives"]) == ("winner-takes-all", 2)
    mission.world(1)
    assert (mission.values["problem"], mission.values["primitives"]) == ("winner-takes-all", 21)
