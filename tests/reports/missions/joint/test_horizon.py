"""Planning within a horizon: what is bound, what is reachable, selection, and extension of plans."""

import itertools
import math

import numpy as np
import pytest
from coded import coded

import waybound as wb
from waybound.instances.errors import InputError
from waybound.instances.routing.occupancy import way
from waybound.reports.missions.joint._horizon import Horizon
from waybound.reports.missions.joint.persistent_exploration import PersistentExploration


def begun(steps=0, **settings):
    """A mission after some steps, and its planning from there on."""
    mission = PersistentExploration()
    found = {}

    def watch(world, row):
        found["world"] = world

    if steps:
        wb.run(mission, seed=1, steps=steps, heuristic="greedy-assignment", watch=watch, rows=17, columns=17, **settings)
    else:
        mission.world(1, rows=17, columns=17, **settings)
    return mission, Horizon(mission.played.observe(), mission.played, mission.values, mission._stops)


def test_robots_at_the_base_are_free_and_those_in_the_air_are_bound_to_their_next_waypoint():
    _, h = begun()
    assert [(plan.fresh, plan.end, plan.cell) for plan in h.plans] == [(True, 0.0, h.o.base)] * 3
    _, h = begun(steps=3, waypoints=2, advance=10.0)
    assert any(plan.stops for plan in h.plans)
    for plan in h.plans:
        if plan.stops:
            ((cell, moment),) = plan.stops
            assert plan.cell == cell and moment == pytest.approx(h.o.clock + plan.end)
            assert plan.end == pytest.approx(h.o.robots[plan.robot].after + len(plan.cells) * h.step)
            assert plan.cells == list(h.o.robots[plan.robot].ahead[: len(plan.cells)])


def test_an_extension_keeps_the_battery_and_a_way_home():
    _, h = begun(endurance=40.0)
    plan, targets = h.plans[0], [tuple(map(int, cell)) for cell in h.pool]
    before = (plan.end, plan.used, list(plan.stops))
    taken = [target for target in targets if h.extend(plan, target)]
    assert taken and len(taken) < len(targets)
    assert [stop for stop, _ in plan.stops] == taken == h.places
    assert plan.used + len(plan.home) * h.step <= 40.0 and plan.end == len(plan.cells) * h.step
    assert all(abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1 for a, b in itertools.pairwise([h.o.base, *plan.cells, *plan.home]))
    assert before[:2] == (0.0, 0.0) and plan.home[-1] == h.o.base


def test_what_is_out_of_reach_or_closed_is_no_candidate_and_extends_nothing():
    _, h = begun(endurance=20.0, lanes=4)
    plan = h.plans[0]
    open_, out = h.reachable(plan)
    back = h.tree[h.pool[:, 0], h.pool[:, 1]] * h.step
    assert (out[open_] + back[open_] <= 20.0).all() and open_.all()  # the pool is within reach of the base
    assert h.extend(plan, tuple(map(int, h.pool[int(out.argmax())])))
    assert not h.reachable(plan)[0].all()
    blocked = tuple(map(int, np.argwhere(h.closes == -math.inf)[0]))
    assert not h.extend(h.plans[1], blocked) and not h.plans[1].stops


def test_selection_is_greedy_beside_all_waypoints_and_within_its_bound():
    _, h = begun()
    h.extend(h.plans[0], tuple(map(int, h.pool[0])))
    chosen, added, at_most = h.selected(h.plans, 4, 0.0)
    best, values = h.weights(h.places).max(axis=0), []
    for k in chosen:
        gains = np.maximum(h.offered - best, 0.0).sum(axis=1)
        gains[chosen[: len(values)]] = -1.0
        assert gains[k] == pytest.approx(gains.max())
        values.append(gains[k])
        best = np.maximum(best, h.offered[k])
    assert added == pytest.approx(sum(values)) and added <= at_most * (1 + 1e-12)
    singles = np.sort(np.maximum(h.offered - h.weights(h.places).max(axis=0), 0.0).sum(axis=1))[::-1]
    assert at_most <= singles[:4].sum() * (1 + 1e-12) and added >= (1 - (1 - 1 / 4) ** 4) * at_most * (1 - 1e-9)


@pytest.mark.slow
def test_no_pair_of_views_exceeds_the_bound():
    _, h = begun()
    _, _, at_most = h.selected(h.plans, 2, 0.0)
    pairs = itertools.combinations(range(len(h.pool)), 2)
    assert max(np.maximum(h.offered[a], h.offered[b]).sum() for a, b in pairs) <= at_most * (1 + 1e-12)


def test_free_cells_close_later_where_confidence_decays():
    mission, h = begun(steps=6, model="decay")
    finite = np.isfinite(h.closes)
    assert finite.any() and (h.closes[finite] > 0).any()
    assert np.isinf(h.closes[mission.played.terrain.known]).all()
    far = tuple(map(int, h.pool[-1]))
    assert len(way(h.ways_from(h.o.base, 0.0), far)) == h.tree[far]


def test_batteries_that_reach_no_view_are_refused():
    with pytest.raises(InputError, match="no view is within reach", check=coded("contradiction")):
        begun(endurance=2.0, spacing=3)
