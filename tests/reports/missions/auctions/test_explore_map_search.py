import numpy as np
import pytest

import waybound as wb
from waybound.heuristics.auctions._exploration import steps_to_contact
from waybound.reports.missions.auctions.explore_map_search import ExploreMapSearch, most_gain

NAME = "explore-map-search"

SMALL = {"rooms": 5, "budget": 3, "range": 1}


def test_beliefs_are_those_of_what_a_robot_was_told():
    mission = ExploreMapSearch()
    world = mission.world(2, silence=3, robots=3, range=1)
    rule = mission.policies()["alone"]
    apart = 0
    while not world.over:
        o = world.observe()
        told = [mission.known(o, robot) for robot in (0, 1, 2, -1)]
        for (beliefs, visits), group in zip(told, o.groups, strict=True):
            if (o.groups == o.groups[0]).all():
                assert beliefs == pytest.approx(world.beliefs) and visits.tolist() == world.visits.tolist()
            same = told[int(np.nonzero(o.groups == group)[0][0]) - 4 * (group == 3)]
            assert beliefs.tolist() == same[0].tolist() and (visits <= world.visits).all()
        apart += int((o.groups != o.groups[-1]).any())
        world.step(rule(o))
    assert apart > 5  # some step in which not all have contact


@pytest.mark.parametrize("policy", ["alone", "relays"])
@pytest.mark.parametrize("silence", [0, 1, 3])
def test_nobody_is_silent_for_too_long_and_all_could_come_back(policy, silence):
    for seed in (1, 2):
        mission = ExploreMapSearch()
        log = wb.run(mission, policy=policy, seed=seed, silence=silence, robots=4, budget=60)
        assert len(log) == 60 and log["silent"].max() <= silence
        w = mission.played
        back = steps_to_contact(w.building.adjacent, w.building.linked[w.building.base])[w.robots]
        assert (back[w.silent > 0] + w.silent[w.silent > 0] - 1 <= silence).all()


def test_two_robots_that_are_always_heard_come_one_room_further_with_a_relay(tmp_path):
    """Rooms in a row: without relays all stay beside the base."""
    doors, none = [[k, k + 1] for k in range(5)], np.zeros((6, 1))
    wb.RoomExploration(wb.ExplorationMap(doors, none, none, none, [0, 0], 0, doors, 0, 1)).save(tmp_path / "row.json")
    for policy, depth in (("alone", 1), ("relays", 2)):
        mission = ExploreMapSearch()
        wb.run(mission, policy=policy, file=str(tmp_path / "row.json"), explore=0.8, map=0.1, search=0.1, budget=30)
        assert int(np.nonzero(mission.played.visits)[0].max()) == depth
        assert mission.scene(mission.played) is None  # rooms without places


def test_the_gain_changes_the_first_decision():
    """With entropies mapping comes first, with mutual information exploring: 0.3 lies between."""
    for gain, action in (("entropy", 1), ("mutual-information", 0)):
        mission = ExploreMapSearch()
        world = mission.world(1, gain=gain, robots=1)
        deed = mission.policies()["alone"](world.observe())[0]
        assert deed[1] == action and (action == 1 or deed[0] != 0)


def test_marginals_in_turn_come_to_other_beliefs():
    mission = ExploreMapSearch()
    world = mission.world(3, update="marginal", robots=1)
    for _ in range(4):
        world.step({0: (0, 1)})
    marginal = mission.known(world.observe(), 0)[0][0]
    mission.values["update"] = "joint"
    joint = mission.known(world.observe(), 0)[0][0]
    assert marginal.sum(axis=1) == pytest.approx(joint.sum(axis=1))  # only types were read
    assert abs(float(marginal.sum(axis=0)[0] - joint.sum(axis=0)[0])) > 1e-3 and joint.sum(axis=0)[0] <= 0.8


@pytest.mark.parametrize("how", [{"heuristic": "heard-greedy"}, {"solver": "highs"}], ids=["heard-greedy", "highs"])
def test_plans_go_from_contact_to_contact(how):
    mission = ExploreMapSearch()
    log = wb.run(mission, seed=3, silence=2, horizon=4, replan=2, rooms=6, budget=9, range=1, **how)
    assert len(log) == 9 and log["silent"].max() <= 2 and log.attrs["faults"] == []
    planned = log["planned"].tolist()
    assert planned[0] == 4 and max(planned) == 4 and 0 in planned
    assert all(value <= 9 - k for k, value in enumerate(planned))


def test_a_plan_that_was_not_found_is_waited_out_in_contact():
    mission = ExploreMapSearch()
    world = mission.world(1, **SMALL)
    assert mission.actions(world.observe(), mission.problem(world.observe()), None) == {}
    world.step({})
    assert not world.silent.any() and mission.problem(world.observe()) is None


@pytest.mark.slow
@pytest.mark.parametrize("silence", [0, 1])
@pytest.mark.parametrize("gain", ["mutual-information", "entropy"])
def test_nobody_gains_more_than_the_bound(silence, gain):
    for seed in (1, 2):
        settings = {**SMALL, "silence": silence, "gain": gain}
        bound = wb.solve(most_gain(ExploreMapSearch().world(seed, **settings)), "highs").bound
        for how in ({"policy": "alone"}, {"policy": "relays"}, {"solver": "highs", "horizon": 3}, {"heuristic": "heard-greedy"}):
            assert wb.run(NAME, seed=seed, **settings, **how)["utility"].iloc[-1] <= bound * (1 + 1e-6)


def test_where_only_visits_count_the_whole_plan_is_the_optimum_and_the_bound():
    settings = {**SMALL, "silence": 0, "explore": 1, "map": 0, "search": 0}
    bound = wb.solve(most_gain(ExploreMapSearch().world(2, **settings)), "highs").bound
    assert wb.run(NAME, seed=2, solver="highs", horizon=3, **settings)["utility"].iloc[-1] == pytest.approx(bound)


def test_it_can_be_filmed(filmed):
    assert len(filmed(NAME, policy="relays", steps=4, seed=5).shots) == 5
