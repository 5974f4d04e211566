import numpy as np
import pytest
from file_cases import check_refused

from waybound.instances.auctions.worlds.information_gathering import GatheringRules, GatheringWorld, Move
from waybound.instances.errors import InputError, UsageError
from waybound.instances.worlds import make_world


def world(rules, places, rates, seed=1):
    return GatheringWorld(rules, np.random.default_rng(seed), places=places, rates=rates)


def test_one_sensor_emptied_once():
    w = world(GatheringRules(1, 3, 1, 1, cell=1000.0), [[0, 1]], [4.0])
    for step in range(1, 101):
        w.step({0: Move((0, 1), 100.0 if step == 50 else 0.0)})
        if step == 25:
            assert (w.stores[0], w.lost[0]) == (100.0, 0.0)
    told = w.metrics()
    assert (told["idle"], told["loss"], told["carried"], told["stored"]) == (50.0, 200.0, 100.0, 100.0)
    assert w.due == 400.0


def test_constants_of_the_source():
    w = make_world("information-gathering", 1)
    r = w.rules
    assert (r.sensors, r.robots, r.store, r.load, r.cell) == (10, 2, 100.0, 100.0, 200.0)
    assert r.bases.tolist() == [[0, 0], [19, 19]]
    assert (w.rates >= 1).all() and (w.rates <= 5).all()


@pytest.mark.parametrize("size", [6, 20])
def test_nothing_is_lost_track_of(size):
    rng = np.random.default_rng(size)
    rules = GatheringRules(size, size, 10, 3, cell=60.0)
    w = GatheringWorld(rules, np.random.default_rng(2))
    gain = 0.0
    for _ in range(600):
        cells = np.clip(w.robots + rng.integers(-1, 2, (3, 2)), 0, size - 1)
        amounts = rng.uniform(0.0, 80.0, 3)
        w.step({r: Move(tuple(cells[r].tolist()), amounts[r]) for r in range(3)})
        told = w.metrics()
        assert told["gain"] + told["carried"] + told["stored"] + told["loss"] + w.cut == pytest.approx(w.due, rel=1e-12)
        assert (w.stores >= 0).all() and (w.stores <= rules.store + 1e-9).all()
        assert (w.loads >= 0).all() and (w.loads <= rules.load + 1e-9).all()
        assert told["gain"] >= gain
        gain = told["gain"]
        assert len(np.unique(w.places[w.gathering], axis=0)) == w.gathering.sum()
    assert gain <= rules.cell * size * size
    assert w.left.min() >= 0.0
    if size == 6:
        assert 0 < w.gathering.sum() < 10  # some found no cell any more
        assert w.metrics()["working"] <= w.gathering.sum()


def test_sensors_go_where_the_seed_says_whatever_robots_do():
    rules = GatheringRules(8, 8, 4, 1, cell=20.0)
    still, busy = (GatheringWorld(rules, np.random.default_rng(4)) for _ in range(2))
    assert still.rates.tolist() == busy.rates.tolist()
    still.step({})
    busy.step({0: Move((1, 1), 50.0)})
    assert [order.tolist() for order in still._orders] == [order.tolist() for order in busy._orders]


def test_a_robot_unloads_at_its_own_base_alone():
    w = world(GatheringRules(1, 4, 1, 2), [[0, 1]], [5.0])  # bases at both ends
    for _ in range(4):
        w.step({})
    w.step({0: Move((0, 1), 10.0)})
    assert w.loads.tolist() == [10.0, 0.0]
    w.step({0: Move((0, 2))})
    w.step({0: Move((0, 3))})
    assert (w.gain, w.loads[0]) == (0.0, 10.0)
    for column in (2, 1, 0):
        w.step({0: Move((0, column))})
    assert (w.gain, w.loads[0]) == (10.0, 0.0)


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ({5: Move((0, 0))}, "no robot number 5"), ({0: Move((2, 0))}, "eight cells around it"), ({0: Move((-1, 0))}, "must stay inside"),
        ({0: Move((0, 0), -1.0)}, "finite amount"), ({0: Move((0, 0), np.inf)}, "finite amount"), ({0: "home"}, "must be told a move"),
    ],
)  # fmt: skip
def test_what_cannot_be_done_changes_nothing(actions, message):
    w = GatheringWorld(GatheringRules(5, 5, 2, 1), np.random.default_rng(1))
    check_refused(InputError, message, w.step, actions)
    assert (w.time, w.stores.sum()) == (0, 0.0)


def test_sizes_and_starts_that_do_not_fit_are_refused():
    check_refused(UsageError, "5 sensors do not fit into 4 cells", make_world, "information-gathering", 1, rows=2, columns=2, sensors=5)
    rules = GatheringRules(3, 3, 2, 1)
    for places, rates, message in (
        ([[0, 0], [0, 0]], [1, 1], "two sensors"), ([[0, 0], [3, 0]], [1, 1], "2 cells"), ([[0, 0], [1, 0]], [1, 0], "one rate"),
    ):  # fmt: skip
        check_refused(InputError, message, world, rules, places, rates)
