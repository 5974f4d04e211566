import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

import waybound as wb
from waybound.instances.routing.worlds.plume_exploration import PlumeWorld, grown
from waybound.reports.missions.routing.plume_exploration import PlumeExploration, covering, lawn_mower
from waybound.reports.studies.routing.plume_bounds import depth_first, longest_time, proved_ratio, shortest_time

ARMS = ((1, 0), (-1, 0), (0, 1), (0, -1))

PLUMES = {
    "line": [(x, 0) for x in range(5)],
    "L": [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)],
    "square of 4": [(0, 0), (1, 0), (0, 1), (1, 1)],
    "square of 9": [(x, y) for x in range(3) for y in range(3)],
    "plus": [(0, 0), *ARMS],
    "long plus": [(0, 0), *((k * x, k * y) for k in (1, 2, 3) for x, y in ARMS)],
    "U": [(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0)],
    "T": [(0, 0), (1, 0), (2, 0), (1, 1), (1, 2)],
}

KNOWN = [
    ("line", (1, 2, 3), (8, 8, 8), (4, 4, 4), (8, 8, 8)),
    ("L", (1, 2, 3), (8, 8, 8), (4, 4, 4), (6.8284, 5.6569, 5.6569)),
    ("square of 4", (1, 2, 3), (6, 4, 4), (2, 2, 2), (4, 3.4142, 2.8284)),
    ("square of 9", (1, 2, 3), (16, 10, 8), (6, 4, 4), (9.4142, 6.8284, 5.6569)),
    ("plus", (1, 2, 3), (8, 4, 4), (1, 1, 1), (6.2426, 3.4142, 3.4142)),
    ("long plus", (1, 2, 3, 4, 8), (24, 12, 12, 12, 6), (3, 3, 3, 3, 3), ()),
    ("U", (1, 2, 3), (12, 12, 12), (6, 6, 6), (8, 6.8284, 5.6569)),
    ("T", (1, 2, 3), (8, 6, 6), (3, 3, 3), (6.6503, 4.6503, 4.4721)),
]
"""Plume, robots, time and depth of the depth-first exploration, and the shortest exploration with straight flights."""


@pytest.mark.parametrize(("plume", "robots", "times", "depths", "_"), KNOWN)
def test_known_depth_first_explorations(plume, robots, times, depths, _):
    for team, time, depth in zip(robots, times, depths, strict=True):
        played = depth_first(PLUMES[plume], (0, 0), team)
        assert (played.played.clock, played.tree.depth) == (time, depth)


@pytest.mark.slow
@pytest.mark.parametrize(("plume", "robots", "_", "__", "shortest"), KNOWN)
def test_known_shortest_explorations(plume, robots, _, __, shortest):
    cells = [cell for cell in PLUMES[plume] if cell != (0, 0)]
    for team, length in zip(robots, shortest, strict=False):
        problem = covering((0, 0), [((0, 0), 0.0)] * team, cells, 1.0, (0.0, 0.0), plume)
        solution = wb.solve(problem, solver="branch-price-cut", time_limit=60)
        assert (solution.objective, solution.bound) == (pytest.approx(length, abs=1e-4), pytest.approx(length, abs=1e-4))


@pytest.mark.parametrize(("drift", "time"), [((1, 0), 8.571429), ((-1, 0), 8.571429), ((0, 1), 7.855844), ((0, 0), 7.2)])
def test_a_line_in_a_drift(drift, time):
    assert depth_first([(x, 0) for x in range(10)], (0, 0), 1, 2.5, drift).played.clock == pytest.approx(time, abs=1e-6)


@given(st.integers(0, 10**6), st.integers(1, 40), st.integers(1, 12), st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from(ARMS))
def test_explorations_end_visit_all_and_keep_their_bounds(seed, count, robots, wind, way):
    rng = np.random.default_rng(seed)
    cells = grown(rng, count)
    speed, drift = 2.0, (wind * way[0], wind * way[1])
    played = depth_first(cells, cells[int(rng.integers(count))], robots, speed, drift)
    world, tree = played.played, played.tree
    assert world.over and world.metrics()["visited"] == count
    assert set(tree.parent) == world.cells
    least, most = shortest_time(count, robots, speed, wind), longest_time(count, tree.depth, robots, speed, wind)
    assert least <= world.clock * (1 + 1e-9) and world.clock <= most * (1 + 1e-9) <= proved_ratio(robots, speed, wind) * least * (1 + 2e-9)
    if robots == 1:  # every edge of the tree to and fro
        across = sum(way[0] * (a[0] - b[0]) + way[1] * (a[1] - b[1]) == 0 for a, b in tree.parent.items() if b is not None)
        along = count - 1 - across
        exact = along * 2 * speed / (speed**2 - wind**2) + across * 2 / math.sqrt(speed**2 - wind**2)
        assert world.clock == pytest.approx(exact, rel=1e-9)


def test_halvings_are_rounded_down():
    """With the logarithm rounded up, as the introduction prints it, five robots on a plus would be faster than they are."""
    assert depth_first(PLUMES["plus"], (0, 0), 5).played.clock == 4.0
    assert longest_time(5, 1, 5, 1.0, 0.0) == 4.0 > 2 * (4 + 1 * 3) / (1 + 3)


def test_a_robot_that_is_alone_goes_where_fewer_are():
    """Third arm of the long plus: of four robots two share the first arm, and the fourth arm waits for whoever is back first."""
    mission = PlumeExploration()
    world = mission.begin(PlumeWorld(PLUMES["long plus"], (0, 0), 4))
    went = mission.policies()["depth-first"](world.observe())
    assert [went[robot] for robot in range(4)] == [(0, 1), (1, 0), (0, 1), (0, -1)]


def test_lawn_mowers_sweep_the_rectangle_once():
    sweeps, longest = lawn_mower((-1, 2, 4, 5), 3, 1.0, (0.0, 0.0))
    cells = [cell for sweep in sweeps for cell in sweep]
    assert sorted(cells) == [(x, y) for x in range(-1, 5) for y in range(2, 6)]
    assert longest == 7.0  # two columns of four cells; in rows it would be two of six
    assert lawn_mower((0, 0, 0, 6), 2, 1.0, (0.0, 0.0))[1] == 3.0


@pytest.mark.parametrize("how", [{"policy": "lawn-mower"}, {"policy": "depth-first"}, {"heuristic": "greedy-assignment"}])
@pytest.mark.parametrize("shape", ["grown", "square", "serpentine"])
def test_every_way_to_decide_explores_all_and_returns(how, shape):
    log = wb.run("plume-exploration", seed=2, shape=shape, cells=20, robots=3, **how)
    assert log.iloc[-1]["finished"] == 1.0
    assert log["clock"].is_monotonic_increasing and log["visited"].is_monotonic_increasing
    assert (log["seconds"] > 0).any()


@pytest.mark.slow
def test_exact_plans_are_optimal_at_every_step_and_no_exploration_beats_hindsight():
    mission = PlumeExploration()
    log = wb.run(mission, seed=4, solver="branch-price-cut", cells=10, robots=2)
    assert set(log["status"]) <= {"optimal", "none"} and log["finished"].iloc[-1] == 1.0
    w = mission.played
    whole = covering(w.start, [(w.start, 0.0)] * 2, sorted(w.cells - {w.start}), w.speed, w.drift, "hindsight")
    best = wb.solve(whole, solver="branch-price-cut")
    assert best.status == "optimal" and best.bound <= log["clock"].iloc[-1] * (1 + 1e-9)


def test_robots_under_way_count_with_the_time_that_they_still_need():
    mission = PlumeExploration()
    world = mission.begin(PlumeWorld([(x, 0) for x in range(-3, 4)], (0, 0), 2))
    world.step({0: (1, 0), 1: (-3, 0)})
    problem = mission.problem(world.observe())
    assert [problem.sites.ids[k] for k in problem.customers] == ["-1,0", "2,0"]
    assert [vehicle.count for vehicle in problem.fleet] == [1, 1]
    assert problem.travel.distances[1, 0] == 1.0 and problem.travel.distances[2, 0] == 2.0 + 3.0
    answer = wb.solve(problem, solver="highs").answer
    assert mission.actions(world.observe(), problem, answer) == {0: (2, 0)}


def test_it_can_be_filmed(filmed):
    film = filmed("plume-exploration", policy="depth-first", seed=1, cells=8, robots=2)
    assert len(film.pictures(4)) == 4
    assert film.shots[-1][0].marked.all() and not film.shots[0][0].marked.all()
