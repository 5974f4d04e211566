import numpy as np
import pytest

import waybound as wb
from waybound.instances.sata.phd_filter import Mixture
from waybound.reports.missions.sata.search_and_track import SearchAndTrack, lawn_mower

PLACES = np.array([[20.0, 20.0], [60.0, 20.0], [60.0, 30.0], [140.0, 140.0]])
VARIANCES = np.array([30.0, 20.0, 10.0, 80.0])


def begun(**settings):
    """A mission and its world, whose filter holds four components."""
    mission = SearchAndTrack()
    world = mission.world(1, **settings)
    world.mixture = Mixture(np.ones(4), PLACES.copy(), VARIANCES[:, None, None] * np.eye(2))
    world._observed()
    return mission, world


def test_a_sweep_takes_2400_steps_as_three_of_the_source_take_7278():
    lanes = lawn_mower(0.0, 150.0, 150.0, 25.0)
    first = lanes[:14]
    assert (first[0].tolist(), first[-1].tolist()) == ([0, 0], [150, 150])
    assert np.abs(np.diff(first, axis=0)).sum() / 0.5 == 2400
    assert np.abs(np.diff(np.vstack([lanes, lanes[:1]]), axis=0)).sum() / 0.5 == 4800
    assert np.unique(lawn_mower(50.0, 30.0, 10.0, 20.0)[:, 0]).tolist() == [50, 65, 80]


def test_the_lawn_mower_sees_everything():
    mission = SearchAndTrack()
    world = mission.world(1, robots=2, robot_step=5, initial=0)
    points = np.array([(x, y) for x in range(0, 151, 10) for y in range(0, 151, 10)], dtype=float)
    seen = np.zeros(len(points), dtype=bool)
    for _ in range(160):
        world.step(mission.policies()["lawn-mower"](world.observe()))
        seen |= (np.linalg.norm(points[:, None] - world.robots, axis=2) <= 25.0).any(axis=1)
    assert seen.all()


@pytest.mark.parametrize(("policy", "objective", "goal"), [("nearest-gaussian", "nearest", 0), ("largest-gaussian", "largest", 3)])
def test_with_one_robot_the_solver_does_what_the_source_does(policy, objective, goal):
    mission, world = begun(objective=objective)
    o = world.observe()
    by_rule = mission.policies()[policy](o)[0]
    problem = mission.problem(o)
    by_solver = mission.actions(o, problem, wb.solve(problem, solver="highs").answer)[0]
    assert by_rule == pytest.approx(by_solver)
    assert by_rule == pytest.approx(0.5 * PLACES[goal] / np.linalg.norm(PLACES[goal]))


def test_the_size_of_a_covariance_is_its_trace_or_its_largest_eigenvalue():
    skewed = Mixture(np.ones(2), PLACES[:2], np.array([np.diag([10.0, 10.0]), np.diag([15.0, 1.0])]))
    sizes = []
    for size in ("trace", "eigenvalue"):
        mission = SearchAndTrack()
        mission.world(1, size=size)
        sizes.append(mission.sizes(skewed).tolist())
    assert sizes == [[20, 16], [10, 15]]


def test_a_team_takes_goals_that_are_nearest_together():
    mission, world = begun(robots=2, objective="nearest", start="50,20 64,20")
    problem = mission.problem(world.observe())
    exact, greedy = (wb.solve(problem, **how) for how in ({"solver": "highs"}, {"heuristic": "sequential-greedy"}))
    apart = np.linalg.norm(world.robots[:, None] - PLACES, axis=2)
    best = min(apart[0, i] + apart[1, j] for i in range(4) for j in range(4) if i != j)
    assert exact.objective == pytest.approx(2 * np.hypot(150, 150) - best)
    assert greedy.objective <= exact.objective


def test_a_goal_counts_all_that_is_in_sight_from_it():
    mission, world = begun()
    worth = mission.worth(world.observe())[0]
    f, far = world.filter, np.linalg.norm(PLACES[1])
    seen = f.detected(world.mixture, PLACES[1])
    less = 2 * VARIANCES * VARIANCES / (VARIANCES + f.noise**2)
    assert worth[1, :3] == pytest.approx((seen * less / (1 + far / 0.5))[:3])
    assert worth[1, 3] == 0 and (worth[1, 1:3] > 100 * worth[1, 0]).all()


def test_robots_fly_to_their_goals_between_plans_and_mow_without_any():
    mission, world = begun(plan_every=3, objective="largest")
    o = world.observe()
    problem = mission.problem(o)
    world.step(mission.actions(o, problem, wb.solve(problem, solver="highs").answer))
    assert world.robots[0] == pytest.approx(0.5 * PLACES[3] / np.linalg.norm(PLACES[3]))
    assert mission.problem(world.observe()) is None
    world.step(mission.actions(world.observe(), None, None))
    assert world.robots[0] == pytest.approx(PLACES[3] / np.linalg.norm(PLACES[3]))
    mission = SearchAndTrack()
    world = mission.world(1, initial=0, targets=1)
    assert mission.problem(world.observe()) is None
    assert mission.actions(world.observe(), None, None)[0].tolist() == [0, 0.5]


def test_what_cannot_be_is_refused_before_the_first_step():
    for settings, kind in (({"start": "-1,0"}, wb.InputError), ({"detection": 2}, wb.UsageError), ({"lane": 0}, wb.UsageError)):
        with pytest.raises(kind):
            wb.run("search-and-track", policy="stay", steps=1, **settings)


def test_it_can_be_filmed(filmed):
    assert filmed("search-and-track", heuristic="sequential-greedy", seed=1, steps=6, robots=2).shots[-1][0].links
