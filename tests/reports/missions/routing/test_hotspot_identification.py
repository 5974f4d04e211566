import itertools
import math

import numpy as np
import pytest

import waybound as wb
from waybound.instances.errors import UsageError
from waybound.instances.routing.aerial_pictures import Arms
from waybound.instances.worlds import make_world
from waybound.reports.missions.routing.hotspot_identification import (
    HotspotIdentification,
    block_start,
    bonus_weight,
    mean_variances,
    picture_route,
    sweep,
)

SMALL = {"size": 8, "altitudes": "10,20", "budget": 40, "sensing_time": 4, "candidates": 8}

POLICIES = (
    "current-variance", "future-variance", "current-variance-window", "future-variance-window", "block-ucl", "boustrophedon",
)  # fmt: skip


def test_weights_of_the_bonus():
    assert bonus_weight(10.0, -0.05, 0, "decreasing") == 10.0 and bonus_weight(10.0, -0.05, 0, "increasing") == 0.0
    assert bonus_weight(1.5, -0.05, 20, "decreasing") == pytest.approx(1.5 * math.exp(-1))
    assert bonus_weight(0.5, -0.05, 20, "increasing") == pytest.approx(0.5 - 0.5 * math.exp(-1))


def test_variances_before_any_picture():
    o = make_world("hotspot-identification", 1, size=4, altitudes="10,20", deviation=3.0, length_scale=0.01, noise=0.5).observe()
    arms = np.ones(len(o.arms), dtype=bool)
    arms[0] = False
    now, later = (mean_variances(o, which, arms) for which in ("current", "future"))
    assert np.isinf(now[0]) and np.isinf(later[0])
    assert now[1:16] == pytest.approx([9.0] * 15) and now[16:] == pytest.approx([9.0 / 4] * 9)
    assert later[1:16] == pytest.approx([9 * 5 / (9 + 5)] * 15) and later[16:] == pytest.approx([9 * 10 / (9 + 10) / 4] * 9)
    dependent = mean_variances(o, "future", arms, "dependent")
    assert dependent[1:16] == pytest.approx(later[1:16]) and dependent[16:] == pytest.approx(4 * later[16:])


@pytest.mark.parametrize("cells", ["independent", "dependent"])
@pytest.mark.parametrize("schedule", ["increasing", "decreasing"])
def test_current_variance_never_climbs(cells, schedule):
    """The bound of a footprint is at most the mean of the bounds of its cells, which are arms of the lowest altitude."""
    mission = HotspotIdentification()
    wb.run(mission, seed=1, policy="current-variance", cells=cells, schedule=schedule, budget=60)
    w = mission.played
    if cells == "independent":  # else bounds are equal far from all pictures, and rounding decides
        assert set(w.arms.places[list(w.taken), 2]) == {10.0}
    bounds = mission.indices(w.observe(), "current", np.ones(len(w.arms), dtype=bool))
    for layer in w.arms.layers:
        assert (bounds[layer.arms] <= bounds[layer.cells].mean(axis=1) + 1e-9).all()


def test_blocks_of_frames():
    starts = [k for k in range(31) if block_start(k)]
    assert [k + 1 for k in starts] == [1, 2, 4, 7, 8, 12, 16, 21, 26, 31]  # frames 1, 2-3, 4-7, 8-15, 16-31 in blocks of 1, 2, 3, 4, 5


@pytest.mark.parametrize(("shape", "height"), [((5, 7), 10), ((20, 20), 40), ((20, 20), 70), ((4, 4), 40)])
def test_a_sweep_covers_the_field_in_rows_there_and_back(shape, height):
    arms = Arms(shape, [height], 0.1, 1.0)
    order = sweep(arms)
    assert set(np.concatenate([arms.cells(arm) for arm in order]).tolist()) == set(range(shape[0] * shape[1]))
    assert len(order) == math.ceil(shape[0] / (height // 10)) * math.ceil(shape[1] / (height // 10))
    legs = [np.abs(arms.places[a] - arms.places[b]) for a, b in itertools.pairwise(order)]
    assert all(np.count_nonzero(leg) == 1 and leg.max() <= height // 10 for leg in legs)


@pytest.mark.parametrize("seed", range(4))
def test_routes_are_orienteering_without_a_return(seed):
    rng = np.random.default_rng(seed)
    places, rewards, left = rng.uniform(0, 9, (5, 3)), rng.uniform(1, 9, 5), 24.0
    problem = picture_route(np.zeros(3), places, rewards, 2.0, left, "test")
    best = 0.0
    for count in range(1, 6):
        for order in itertools.permutations(range(5), count):
            way = [np.zeros(3), *places[list(order)]]
            if sum(math.dist(a, b) + 2.0 for a, b in itertools.pairwise(way)) <= left:
                best = max(best, float(rewards[list(order)].sum()))
    solution = wb.solve(problem, solver="highs")
    assert (solution.status, solution.objective) == ("optimal", pytest.approx(best))
    assert 0.0 < best < rewards.sum()


@pytest.mark.parametrize("how", [*({"policy": name} for name in POLICIES), {"heuristic": "greedy-orienteering"}])
def test_every_way_to_decide_keeps_to_its_time(how):
    mission = HotspotIdentification()
    log = wb.run(mission, seed=3, **SMALL, **how)
    assert (log["left"] >= 0).all() and log["pictures"].iloc[-1] >= 4
    assert log["collected"].is_monotonic_increasing and (log[["point", "arm"]] <= 100 + 1e-9).all(axis=None)
    w = mission.played
    stops = [np.array([0, 0, 10.0]), *w.arms.places[list(w.taken)]]
    spent = sum(math.dist(a, b) + 4 for a, b in itertools.pairwise(stops))
    assert w.left == pytest.approx(40 - spent)
    assert w.taken[0] == 0  # the nearest
    again = wb.run("hotspot-identification", seed=3, **SMALL, **how)
    assert log.drop(columns="seconds").equals(again.drop(columns="seconds"))


def test_windows_bound_every_flight():
    mission = HotspotIdentification()
    wb.run(mission, seed=2, policy="current-variance-window", window=2, climb=0, schedule="decreasing")
    places = mission.played.arms.places[list(mission.played.taken)]
    assert np.abs(np.diff(places[:, :2], axis=0)).max() <= 2 and set(places[:, 2]) == {10.0}


def test_the_best_arm_that_fits_is_taken_at_the_end_if_asked_for():
    how = {"policy": "current-variance", "schedule": "decreasing", "budget": 60}
    logs = [wb.run("hotspot-identification", seed=1, **how, last=last) for last in ("stop", "reach")]
    assert logs[0]["left"].iloc[-1] >= 3.0 > logs[1]["left"].iloc[-1]
    assert logs[1]["pictures"].iloc[-1] > logs[0]["pictures"].iloc[-1]


def test_candidates_are_the_best_arms_with_disjoint_footprints():
    mission = HotspotIdentification()
    world = mission.world(4, **SMALL)
    assert mission.problem(world.observe()) is None
    assert mission.actions(world.observe(), None, None) == {0: 0}
    world.step({0: 0})
    chosen = mission.best_apart(world.observe())
    cells = np.concatenate([world.arms.cells(arm) for arm in chosen])
    assert len(chosen) == 8 and len(set(cells.tolist())) == len(cells) and 0 not in chosen
    assert mission._indices[chosen[0]] == mission._indices.max() and (np.diff(mission._indices[chosen]) <= 0).all()
    problem = mission.problem(world.observe())
    assert problem.sites.reward[2:].tolist() == mission._indices[chosen].tolist()
    assert problem.fleet[0].max_distance == world.left


def test_with_one_candidate_routes_are_the_policy():
    """As long as the arm of the largest bound is a new one and in reach."""
    one = HotspotIdentification()
    wb.run(one, seed=5, heuristic="greedy-orienteering", candidates=1, steps=6)
    other = HotspotIdentification()
    wb.run(other, seed=5, policy="future-variance", steps=6)
    first = next((k for k in range(1, 6) if other.played.taken[k] in other.played.taken[:k]), 6)
    assert one.played.taken[:first] == other.played.taken[:first] and first >= 2


@pytest.mark.slow
def test_exact_routes_are_optimal_and_no_flight_beats_hindsight():
    mission = HotspotIdentification()
    log = wb.run(mission, seed=4, solver="branch-price-cut", **SMALL)
    assert set(log["status"]) <= {"optimal", "none"} and log["planned"].max() > 1
    o = mission.world(4, **SMALL).observe()
    rewards = o.arms.means(mission.played.values)
    best = wb.solve(picture_route(o.place, o.arms.places, rewards, 4.0, 40.0, "hindsight"), solver="branch-price-cut")
    assert best.status == "optimal" and log["collected"].iloc[-1] <= best.bound * (1 + 1e-9)


def test_settings_out_of_range_are_refused():
    for settings, message in (
        ({"rate": 0.1}, "rate must lie between"),
        ({"scale": -1}, "scale must lie"),
        ({"last": "go"}, "last must be"),
    ):
        with pytest.raises(UsageError, match=message):
            wb.run("hotspot-identification", policy="block-ucl", **settings)


def test_it_can_be_filmed(filmed):
    shots = filmed("hotspot-identification", policy="future-variance-window", seed=1, **SMALL).shots
    assert shots[-1][0].marked.sum() > shots[1][0].marked.sum() > shots[0][0].marked.sum() == 0
