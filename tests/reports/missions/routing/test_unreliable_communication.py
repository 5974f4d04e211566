import numpy as np
import pytest
from hypothesis import given, strategies as st

import waybound as wb
from waybound.instances.routing.worlds.unreliable_communication import CommunicationWorld
from waybound.reports.missions.routing.unreliable_communication import UnreliableCommunication, hindsight, sharing

NEAREST = {"policy": "nearest-frontier"}

SMALL = {"map": "rooms", "room": 2, "width": 13, "height": 9, "robots": 2, "battery": 20, "sight": 0, "reach": 3}


def farthest(robots, rule, battery=64, reach=0, **how):
    """The farthest cell of a corridor whose map comes to the base."""
    mission = UnreliableCommunication()
    settings = {"map": "corridor", "width": 80, "sight": 0, "period": 1000, "roles": "chain", **how}
    wb.run(mission, **NEAREST, robots=robots, rule=rule, battery=battery, reach=reach, **settings)
    return int(mission.played.returned.sum()) - 1


@pytest.mark.parametrize("robots", [1, 2, 3, 4, 5])
def test_a_chain_of_robots_in_a_corridor(robots):
    assert farthest(robots, "sacrifice") == 64 * (1 - 2.0**-robots)
    assert farthest(robots, "home") == 32


def test_two_robots_in_a_corridor_reach_three_quarters_of_a_battery_whatever_the_kind_of_roles():
    assert farthest(2, "sacrifice", roles="overwritten") == 48


@pytest.mark.parametrize("robots", [2, 3, 4])
def test_by_the_printed_rule_roles_gain_nothing(robots):
    assert farthest(robots, "printed") == farthest(robots, "home") == 32


@pytest.mark.parametrize("reach", [2, 4, 8])
def test_radios_lengthen_the_chain(reach):
    assert farthest(2, "sacrifice", reach=reach, near=True, close=0) == (64 + 32 + reach) // 2
    assert farthest(2, "sacrifice", reach=reach, close=0) == 48  # the text's robot flies to where it saw its relay


@given(
    st.integers(0, 10**6), st.integers(1, 5), st.integers(2, 60), st.sampled_from(["rooms", "blocks"]),
    st.sampled_from(["sacrifice", "printed", "home"]), st.sampled_from(["overwritten", "chain"]), st.sampled_from([0.0, 0.3]),
    st.integers(1, 40), st.integers(0, 30),
)  # fmt: skip
def test_runs_end_and_never_return_more_than_was_explored(seed, robots, battery, floor, rule, roles, loss, period, patience):
    log = wb.run(
        "unreliable-communication", **NEAREST, seed=seed, robots=robots, battery=battery, map=floor, width=20, height=15, room=5, sight=2,
        reach=4, rule=rule, roles=roles, loss=loss, period=period, patience=patience,
    )  # fmt: skip
    assert (log["returned"] <= log["explored"] * (1 + 1e-12)).all()
    assert log["returned"].is_monotonic_increasing and log["explored"].is_monotonic_increasing
    assert (log["energy"] >= 0).all() and log["energy"].is_monotonic_decreasing
    assert len(log) <= robots * (battery + patience + 2)
    if rule == "home" and not loss:
        assert log["returned"].iloc[-1] == log["explored"].iloc[-1]  # nobody is lost


@pytest.mark.slow
def test_exact_plans_are_optimal_at_every_step():
    log = wb.run("unreliable-communication", seed=3, solver="branch-price-cut", **SMALL)
    assert set(log["status"]) == {"optimal", "none"} and log["shared_out"].max() > 1
    assert (log["seconds"][log["problems"] > 0] > 0).all()


def test_of_two_close_frontiers_the_robot_of_the_lower_number_has_the_first_choice():
    mission = UnreliableCommunication()
    floor = np.zeros((3, 9), dtype=bool)
    floor[1], floor[0, 4] = True, True
    world = mission.begin(CommunicationWorld(floor, (1, 4), 3, 20, sight=0), close=1.5)
    base, rule = world.base, mission.policies()["nearest-frontier"]
    north = base - world.width
    assert rule(world.observe()) == {0: north, 1: north, 2: north}  # all are close to it, so that nothing else is left
    mission.begin(CommunicationWorld(floor, (1, 4), 3, 20, sight=0), close=1.2)
    assert rule(mission.played.observe()) == {0: north, 1: base - 1, 2: base + 1}


def test_frontiers_are_shared_out_among_robots_in_contact_that_have_none():
    mission = UnreliableCommunication()
    world = mission.begin(CommunicationWorld(np.ones((1, 9), dtype=bool), (0, 4), 2, 20, sight=0, reach=20))
    (team,) = mission.teams(world.observe())
    problem = mission.problem(team)
    assert problem is not None and [problem.sites.ids[k] for k in problem.customers] == [str(world.base - 1), str(world.base + 1)]
    assert [vehicle.max_distance for vehicle in problem.fleet] == [19, 19]
    answer = wb.solve(problem, solver="highs").answer
    assert set(mission.actions(team, problem, answer).values()) <= {world.base - 1, world.base + 1}
    (again,) = mission.teams(world.observe())
    both = len(mission.goals) == 2
    assert (mission.problem(again) is None) == both  # one robot may as well fly to both


def test_routes_keep_to_walls_and_batteries():
    floor = np.pad(np.ones((3, 3), dtype=bool), 1)
    floor[2, 2] = False
    corner, across = 6, 18
    problem = sharing(floor.ravel(), 5, [across], [2.0], [(corner, corner, 8)], 0.1, "ring")
    assert wb.solve(problem, solver="highs").objective == pytest.approx(2.0 - 0.8)
    short = sharing(floor.ravel(), 5, [across], [2.0], [(corner, corner, 7)], 0.1, "ring")
    assert wb.solve(short, solver="highs").objective == pytest.approx(0.0)


def test_it_can_be_filmed(filmed):
    assert filmed("unreliable-communication", **NEAREST, seed=1, robots=2, battery=20, width=30, height=20).shots[-1][0].marked.all()


@pytest.mark.parametrize(("reach", "farthest"), [(0, 12), (2, 13), (4, 14)])
def test_hindsight_in_a_corridor_is_the_formula(reach, farthest):
    """(battery + half a battery + reach) / 2 for two robots."""
    world = CommunicationWorld(np.ones((1, 30), dtype=bool), (0, 0), 2, 16, sight=0, reach=reach)
    best = wb.solve(hindsight(world, 16), solver="highs")
    assert (best.objective, best.bound) == (pytest.approx(farthest), pytest.approx(farthest))


@pytest.mark.parametrize("floor", ["111/010/111", "111/101/111", "1111/0100/1111", "10101/11111/00100"])
def test_hindsight_is_not_less_than_what_any_plan_of_two_robots_returns(floor):
    """All pairs of walks on a small floor, the first closed, the second from where the first is to where it is met."""
    free = np.array([[sign == "1" for sign in row] for row in floor.split("/")])
    world, battery = CommunicationWorld(free, (0, 0), 2, 6, sight=0, reach=0), 6
    walks, ended = [[world.base]], []
    while walks:
        walk = walks.pop()
        ended.append(walk)
        if len(walk) <= battery:
            walks += [[*walk, walk[-1] + step] for step in (1, -1, world.width, -world.width) if world.free[walk[-1] + step]]
    home = {frozenset(walk) for walk in ended if walk[-1] == world.base}
    others = {(frozenset(walk), walk[-1]) for walk in ended}
    best = max(len(first | cells) for first in home for cells, end in others if end in first)
    bound = wb.solve(hindsight(world, battery), solver="highs").bound + 1.0  # the base has no reward
    assert best <= bound * (1 + 1e-9) and bound <= best + 1.0 + 1e-6  # the first robot need not come to where the second ends
