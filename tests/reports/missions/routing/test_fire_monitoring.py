import numpy as np
import pytest
from file_cases import check_refused
from hypothesis import given, strategies as st

import waybound as wb
from waybound.instances.errors import UsageError
from waybound.instances.routing.worlds.fire_monitoring import Hotspots
from waybound.reports.missions.routing.fire_monitoring import (
    FireMonitoring,
    advanced,
    cheapest_paths,
    circling_heading,
    corners,
    least_possible,
    weighted_scores,
)

STILL = {"size": 32, "begin": 30, "still": True, "hotspots": 4, "radius": 0.0}

EVERY_WAY = [
    {"policy": "weighted-greedy"}, {"policy": "circling"}, {"policy": "exact"}, {"heuristic": "pure-greedy"},
    {"heuristic": "greedy-assignment"}, {"solver": "highs", "decide": "on-arrival"},
    {"solver": "highs", "decide": "on-arrival", "alpha": 0.0},
]  # fmt: skip


def test_scores_of_three_hotspots():
    waits, costs = np.array([100.0, 60.0, 80.0]), np.array([150.0, 20.0, 100.0])
    scores = weighted_scores(waits, costs, 0.5)
    assert scores.tolist() == [25, 50, 30]
    assert (scores.argmax(), scores.argmin()) == (1, 0)  # the printed argmin would fly to the farthest
    assert weighted_scores(waits, costs, 0.0).argmax() == 0


@pytest.mark.parametrize(
    ("least", "most", "heading"), [(2, 8, (-0.8, 0.6)), (2, 4, (0.6, 0.8)), (6, 6, (-0.6, -0.8)), (6, 9, (-0.6, -0.8))]
)
def test_headings_of_circling(least, most, heading):
    front = np.array([[30.0, 40.0], [3.0, 4.0]])
    assert circling_heading(np.zeros(2), front, least, most, np.array([1.0, 0.0])) == pytest.approx(np.array(heading))


def test_circling_keeps_its_heading_where_it_stands_on_the_front():
    last = np.array([0.6, -0.8])
    assert circling_heading(np.ones(2), np.ones((1, 2)), 1.0, 3.0, last) is last


def test_steps_along_a_way():
    place, rest = advanced(np.zeros(2), [np.array([3.0, 0.0]), np.array([3.0, 2.0])], 4.0)
    assert place == pytest.approx(np.array([3.0, 1.0]), abs=1e-8)
    assert np.array(rest).tolist() == [[3.0, 2.0]]
    assert advanced(place, rest, 4.0)[0].tolist() == [3.0, 2.0] and advanced(place, rest, 4.0)[1] == []


@pytest.mark.parametrize("how", EVERY_WAY)
def test_every_way_to_decide_keeps_the_rules(how):
    log = wb.run("fire-monitoring", seed=3, size=40, begin=30, steps=25, **how)
    assert len(log) == 25
    assert log["flown"].diff().dropna().max() <= 2.0 + 1e-6
    assert (log["worst_waits"] >= log["mean_wait"] * log["hotspots"] * (1 - 1e-12)).all()
    assert (log["seconds"] > 0).sum() >= 5


@given(st.integers(0, 10**6))
def test_the_exact_patrol_is_as_planned_and_nobody_beats_the_bound(seed):
    mission = FireMonitoring()
    world = mission.world(seed, **STILL)
    o = world.observe()
    bound = least_possible(o.hotspots, o.place, o.speed, 0.0, 20)
    planned, _, steps = mission.patrol(o, 20)
    assert steps == 20
    assert bound <= planned
    ends = {}
    for policy in ("exact", "weighted-greedy", "circling"):
        log = wb.run("fire-monitoring", seed=seed, steps=20, look_ahead=20, policy=policy, **STILL)
        ends[policy] = log["worst_waits"].iloc[-1]
    assert ends["exact"] == planned
    assert min(ends.values()) >= bound


@given(st.integers(0, 10**6), st.sampled_from([0.5, 2.0, 6.0]))
def test_the_bound_holds_for_aircraft_that_see_far(seed, radius):
    """Whatever flies at random stays above it, hotspots that are seen at once included."""
    rng = np.random.default_rng(seed)
    world = FireMonitoring().world(seed, **{**STILL, "radius": radius})
    o = world.observe()
    bound = least_possible(o.hotspots, o.place, o.speed, radius, 25)
    for _ in range(25):
        to = o.hotspots.places[int(rng.integers(len(o.hotspots)))] - world.place
        far = float(np.hypot(*to))
        world.step({0: world.place + to * min(1.0, world.speed / far if far else 1.0)})
    assert world.worst_waits >= bound


def test_five_hotspots_on_an_arc_are_patrolled_no_worse_than_by_shuttling():
    """The bound of shuttling within 20 of a front of 100 at speed 1 is 200; circling ends with 500."""
    five = Hotspots(np.arange(5), np.array([[5.0 * k, 0.0] for k in range(5)]), np.zeros(5), np.zeros(5))
    assert 0 < least_possible(five, np.zeros(2), 1.0, 0.0, 120) <= 200 < 5 * 100


def test_a_tour_takes_what_is_worth_its_way():
    """An exact tour is no worse than a greedy one, and the aircraft flies along it."""
    mission = FireMonitoring()
    world = mission.world(2, size=40, begin=30)
    for _ in range(12):
        world.step({})
    problem = mission.problem(world.observe())
    assert problem is not None and problem.sites.reward[1:-1].tolist() == world.hotspots.waits.tolist()
    solution = wb.solve(problem, solver="highs")
    greedy = wb.solve(problem, heuristic="pure-greedy")
    assert solution.status == "optimal" and greedy.objective <= solution.objective + 1e-6
    to = mission.actions(world.observe(), problem, solution.answer)[0]
    assert 0 < np.hypot(*(to - world.place)) <= world.speed * (1 + 1e-6)
    mission.values["decide"] = "on-arrival"
    assert mission.problem(world.observe()) is None


def test_paths_lead_round_the_fire():
    burnt = np.zeros((21, 21), bool)
    burnt[4:17, 8:13] = True
    ends = np.array([[2.0, 10.0], [18.0, 10.0]])
    costs, before = cheapest_paths(burnt, ends, 2.0, 1.0, 10.0)
    way = corners(burnt, before[0], *ends)
    assert way[-1].tolist() == [18, 10] and not any(burnt[int(y), int(x)] for x, y in way)
    assert costs[0].reshape(21, 21)[10, 18] == pytest.approx(costs[1].reshape(21, 21)[10, 2])
    assert cheapest_paths(burnt, ends, 2.0, 0.0, 0.0)[0][0].reshape(21, 21)[10, 18] == pytest.approx(16.0)
    assert corners(burnt, before[0], ends[0], ends[0] + 0.25) == [pytest.approx(ends[0] + 0.25)]


def test_a_distance_that_cannot_be_kept_is_refused():
    check_refused(UsageError, "closest must be at most farthest", wb.run, "fire-monitoring", policy="circling", closest=4.0)
    check_refused(UsageError, "alpha", wb.run, "fire-monitoring", policy="weighted-greedy", alpha=-1)


def test_it_can_be_filmed(filmed):
    shots = filmed("fire-monitoring", policy="weighted-greedy", seed=1, size=40, begin=30, steps=4).shots
    assert shots[-1][0].links and shots[0][0].marked.sum() == shots[0][0].marked.argmin()
