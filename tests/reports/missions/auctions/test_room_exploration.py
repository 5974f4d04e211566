import numpy as np
import pytest

import waybound as wb
from waybound.formulations.auctions.room_exploration import RoomExploration
from waybound.instances.auctions.beliefs import after_type
from waybound.reports.missions.auctions.room_exploration import RoomsExplored
from waybound.reports.ratios.judged_runs import run_heuristic

SMALL = {"rooms": 9, "round": 4}


@pytest.mark.parametrize("policy", ["alone", "relays"])
def test_policies_decide_step_by_step_and_are_heard_in_time(policy):
    for silence in (0, 2):
        log = wb.run("room-exploration", policy=policy, steps=30, seed=2, silence=silence, robots=3, rooms=9)
        assert log["silent"].max() <= silence
        assert log["readings"].iloc[-1] > 5


def test_relays_lead_further_than_a_robot_goes_alone():
    entered = {policy: wb.run("room-exploration", policy=policy, steps=60, seed=1, silence=0, robots=3, explore=0.9, map=0.05, search=0.05)
               for policy in ("alone", "relays")}  # fmt: skip
    assert entered["relays"]["entered"].iloc[-1] > entered["alone"]["entered"].iloc[-1]


def test_a_round_is_planned_where_all_have_contact_and_what_was_read_changes_the_next():
    mission = RoomsExplored()
    world = mission.world(3, **SMALL, silence=2)
    gains = []
    for _ in range(5):
        problem = mission.problem(world.observe())
        assert isinstance(problem, RoomExploration) and not world.silent.any()
        gains.append(problem.instance.mapping)
        answer = run_heuristic(problem, "heard-greedy", {}, 1).answer
        for k in range(4):
            assert k == 0 or mission.problem(world.observe()) is None
            world.step(mission.actions(world.observe(), problem if k == 0 else None, answer))
            assert world.silent.max() <= 2
    read = {r.room for r in world.readings[:-1] if r.action == 1}
    assert read and not np.array_equal(gains[0], gains[-1])
    mission.measures([], world)
    assert np.array(mission._beliefs).sum(axis=(1, 2)).tolist() == pytest.approx([1.0] * 9)


def test_beliefs_are_those_of_bayes_rule():
    mission = RoomsExplored()
    world = mission.world(1, **SMALL, robots=1)
    start = mission._beliefs[0]
    world.step({0: (0, 1)})
    mission.measures([], world)
    assert mission._beliefs[0].tolist() == after_type(start, mission._sensors, world.readings[0].value).tolist()


def test_two_robots_pass_on_what_they_hear_where_a_solver_plans():
    """Without silence nobody alone leaves the rooms beside the base; a relay leads another one room further."""
    rules = {"rooms": 5, "round": 4, "silence": 0, "explore": 1, "map": 0, "search": 0}
    logs = [wb.run("room-exploration", solver="highs", steps=4, seed=1, robots=robots, **rules) for robots in (1, 2)]
    assert (logs[0]["silent"] == 0).all() and (logs[1]["silent"] == 0).all()
    assert logs[1]["entered"].iloc[-1] > logs[0]["entered"].iloc[-1]
    assert logs[1].attrs["faults"] == []


def test_readings_make_truth_likelier():
    log = wb.run("room-exploration", heuristic="heard-greedy", steps=80, seed=4, **SMALL, silence=8)
    assert log["types_known"].iloc[-1] > log["types_known"].iloc[0] and log["targets_known"].iloc[-1] > log["targets_known"].iloc[0]
    again = wb.run("room-exploration", heuristic="heard-greedy", steps=80, seed=4, **SMALL, silence=8)
    assert again.drop(columns="seconds").equals(log.drop(columns="seconds"))


def test_a_round_without_an_answer_is_spent_in_contact():
    mission = RoomsExplored()
    world = mission.world(1, **SMALL)
    told = mission.actions(world.observe(), mission.problem(world.observe()), None)
    assert told == {0: (0, 0), 1: (0, 0)}


def test_it_can_be_filmed(filmed):
    film = filmed("room-exploration", heuristic="heard-greedy", steps=8, seed=5, **SMALL)
    scene = film.shots[8][0]
    assert all(np.linalg.norm(scene.points - robot, axis=1).min() < 0.3 for robot in scene.agents)  # each at its own room
    assert len(np.unique(scene.agents, axis=0)) == len(scene.agents)
    assert len(scene.ways) >= 8 and scene.marked.sum() == film.values[8]


def test_weights_sum_to_one():
    with pytest.raises(wb.UsageError, match=r"must sum to 1, not to 1\.6"):
        wb.run("room-exploration", heuristic="heard-greedy", steps=1, map=0.9)
