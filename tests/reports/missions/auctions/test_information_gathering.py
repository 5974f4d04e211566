import numpy as np
import pytest

import waybound as wb
from waybound import BalancedPartition, TaskAllocation
from waybound.instances.auctions.worlds.information_gathering import GatheringRules, GatheringWorld
from waybound.reports.missions.animation import Film
from waybound.reports.missions.auctions import information_gathering as tours
from waybound.reports.missions.auctions.information_gathering import PLANS, InformationGathering

SMALL = {"rows": 10, "columns": 10, "sensors": 6}


@pytest.mark.parametrize("plan", PLANS)
def test_policies_are_the_heuristics_of_their_plans(plan):
    rule = wb.run("information-gathering", policy=plan, steps=120, seed=3, **SMALL)
    played = wb.run("information-gathering", heuristic=PLANS[plan], plan=plan, steps=120, seed=3, **SMALL)
    for name in ("gain", "loss", "carried"):
        assert rule[name].tolist() == played[name].tolist()
    assert played.attrs["faults"] == []


def test_a_partition_is_asked_for_once_and_an_allocation_whenever_a_robot_is_back():
    mission = InformationGathering()
    world = mission.world(1, **SMALL)
    first = mission.problem(world.observe())
    assert isinstance(first, BalancedPartition)
    mission.actions(world.observe(), first, ((0, 1, 2), (3, 4, 5)))
    assert mission.problem(world.observe()) is None
    log = wb.run("information-gathering", heuristic="sequential-single-item", plan="auction", steps=150, seed=1, **SMALL)
    assert 2 < log["problems"].sum() < 150
    world = mission.world(1, plan="auction", **SMALL)
    assert isinstance(mission.problem(world.observe()), TaskAllocation)


@pytest.mark.parametrize("plan", PLANS)
def test_units_are_kept_and_robots_bring_them_home(plan):
    mission = InformationGathering()
    world = mission.world(7, robots=3, **SMALL)
    rule = mission.policies()[plan]
    for _ in range(400):
        world.step(rule(world.observe()))
        told = world.metrics()
        assert told["gain"] + told["carried"] + told["stored"] + told["loss"] + world.cut == pytest.approx(world.due, rel=1e-9)
    assert told["gain"] > 1000


@pytest.mark.parametrize("plan", PLANS)
def test_they_go_on_when_nothing_is_left_to_gather(plan):
    mission = InformationGathering()
    world = mission.world(2, rows=4, columns=4, sensors=5, robots=2, cell=30.0)
    rule = mission.policies()[plan]
    for _ in range(500):
        world.step(rule(world.observe()))
    assert not world.gathering.any()
    assert world.gain == pytest.approx(16 * 30.0)  # all of it is home


def test_one_robot_gathers_more_than_nobody():
    lost = [
        wb.run("information-gathering", steps=200, seed=1, policy="partition", robots=robots, **SMALL)["loss"].iloc[-1] for robots in (1, 3)
    ]
    assert lost[1] < lost[0]


@pytest.mark.parametrize(
    "settings", [{"look_ahead": 1}, {"urgency": "literal", "edges": "clique"}, {"urgency": "rate"}, {"objective": "min-difference"}]
)
def test_settings_are_taken(settings):
    assert wb.run("information-gathering", policy="partition", steps=60, seed=1, **SMALL, **settings)["gain"].iloc[-1] > 0


def test_the_exact_partition_can_be_asked_for():
    log = wb.run("information-gathering", solver="highs", steps=3, seed=1, edges="none", **{**SMALL, "sensors": 4})
    assert log["status"].iloc[0] == "optimal"


def test_it_can_be_filmed(filmed):
    scene = filmed("information-gathering", policy="auction", steps=30, seed=1, **SMALL).shots[0][0]
    assert scene.marked.all()
    assert scene.points.shape == (6, 2)
    assert np.isfinite(scene.points).all()


def test_a_film_tells_who_gathered_what_and_how_much_it_could_be_at_most():
    film = Film(InformationGathering())
    log = wb.run(film.mission, policy="auction", steps=90, seed=1, robots=3, watch=film, **SMALL)
    for (scene, gain), row in zip(film.shots[1:], log.to_dict("records"), strict=True):
        assert scene.shares.sum() == pytest.approx(gain) and gain == row["gain"]
        assert gain + row["carried"] + row["stored"] + row["loss"] <= scene.limit + 1e-9
        assert (scene.levels * 100.0).sum() == pytest.approx(row["stored"])
        assert sum(map(float, scene.notes)) == pytest.approx(row["carried"], abs=1.5)
    assert (film.shots[-1][0].shares > 0).all() and any(scene.links for scene, _ in film.shots)


def observation(places, rates, stores, robots=1, size=20):
    world = GatheringWorld(GatheringRules(size, size, len(places), robots), np.random.default_rng(1), places=places, rates=rates)
    world.stores[:] = stores
    return world._look()


def test_shares_of_the_reference():
    o = observation([[0, 4], [0, 7], [0, 10]], [2.0, 1.0, 5.0], [80.0, 40.0, 10.0])
    made = tours.tour(o, 0, [0, 1, 2])  # 20 steps out and back; what each will hold is capped at its store
    assert list(made.shares.values()) == pytest.approx([38.462, 23.077, 38.462], abs=1e-3)
    assert tours.times_to_full(o) == pytest.approx([10, 60, 18])


def test_lengths_and_orders_on_a_line():
    o = observation([[0, 2], [0, 5]], [1.0, 1.0], [50.0, 50.0])
    reached, back = tours.length(o, 0, [1, 0])
    assert (reached.tolist(), back) == ([5.0, 8.0], 10.0)
    assert tours.by_urgency(o, 0, [0, 1], 1, "shifted") == [0, 1]  # equally full: the nearer is the more urgent
    assert tours.by_urgency(o, 0, [], 3, "shifted") == []


def test_a_robot_changes_for_a_smaller_loss_alone():
    o = observation([[0, 3], [0, 4]], [5.0, 1.0], [100.0, 0.0])
    assert tours.switched(o, 0, [1], [0])
    assert not tours.switched(o, 0, [0], [1])
    assert not tours.switched(o, 0, [0], [0])


def test_tasks_go_to_the_end_of_the_shortest_path():
    o = observation([[0, 4], [0, 6], [0, 1], [0, 9]], [1.0] * 4, [0.0] * 4, robots=2, size=11)
    o.robots[:] = [[0, 0], [0, 10]]
    assert tours.appended(o, [0, 1], [0, 1, 2, 3]) == {0: [0, 2], 1: [1, 3]}
    assert tours.appended(o, [], [0]) == {}


def test_a_full_robot_goes_home():
    o = observation([[3, 3]], [1.0], [50.0])
    o.robots[:], o.loads[:] = [[2, 5]], 100.0
    own = tours.Tour([0], {0: 10.0})
    move = tours.drive(o, 0, own)
    assert (move.cell, move.amount, own.stops) == ((1, 4), 0.0, [])
