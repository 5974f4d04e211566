import numpy as np
import pytest
from coded import coded
from file_cases import check_refused
from orchard_cases import LANE, ONE_ROUTE, lane, played

from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules, OrchardStart, Trip
from waybound.instances.auctions.worlds.orchard import DELIVERING, HAULING, OrchardWorld
from waybound.instances.errors import InputError, UsageError
from waybound.instances.worlds import make_world
from waybound.reports.missions.auctions.orchard_days.policies import CHOOSING, DELIVERIES, trips


def world(rules=None, start=ONE_ROUTE):
    return OrchardWorld(rules or lane(start, 2), np.random.default_rng(1), start=start)


def test_sizes_of_the_source():
    assert make_world("orchard", 1).rules.bins == 160
    small = make_world("orchard", 1, rows=5)
    assert small.rules.bins == 80
    assert (small.rules.groups * small.rules.pickers, small.rules.fill) == (20, 2)
    assert (small.rules.grid.empty_speed, small.rules.grid.full_speed) == (2, 1)


def test_the_first_trips_by_hand():
    w = world()
    o = w.observe()
    assert (o.bins.tolist(), o.remaining.tolist(), o.requests.tolist()) == ([0], [2], [])
    assert np.nonzero(o.wanting)[0].tolist() == [1]
    w.step({0: Trip(1, 0)})
    assert w.stood.tolist()[:2] == [0, 1]  # a new bin in reserve beside the one that is filled
    o = w.observe()
    assert (o.bins.tolist(), o.remaining.tolist(), o.robots.tolist()) == ([1], [3], [1])
    w.step({1: Trip(-1, 1)})
    assert w.full[0] == 2
    w.step({})
    assert (w.returned[0], w.metrics()["returned"]) == (3, 1.0)
    w.step({})
    w.step({})
    assert (w.full[1], w.returned[1]) == (4, 5)
    assert w.observe().requests.tolist() == [2]  # the cell is empty: the group is in the next one


def test_a_new_bin_is_home_at_the_step_that_the_reference_counts():
    day = played(lane(ONE_ROUTE, 1), 1, "greedy", "baseline", start=ONE_ROUTE)
    assert day.returned.tolist() == [3, 7, 12, 17, 24, 31, 39, 47]  # deliver ceil(c / 2), fill 2, back c


@pytest.mark.parametrize("delivery", DELIVERIES)
@pytest.mark.parametrize("choice", CHOOSING)
def test_bins_are_kept_and_never_fetched_early(choice, delivery):
    rules = OrchardRules(OrchardGrid(4, 6, 1), 5, 3, relocation="random")
    w = OrchardWorld(rules, np.random.default_rng(3))
    while (w.returned < 0).any():
        o = w.observe()
        w.step(trips(o, CHOOSING[choice](o, "later") if len(o.bins) else {}, delivery))
        standing = (w.stood >= 0) & (w.returned < 0)
        carried_full = int((w.states == HAULING).sum())
        carried_new = int((w.states == DELIVERING).sum())
        assert int(standing.sum()) - carried_full == w.metrics()["standing"]
        assert int((w.returned >= 0).sum()) + int(standing.sum()) + carried_new == w.made
        assert (w.carried >= 0).sum() == carried_new
        hauled = w.fetched[w.states == HAULING]
        assert (w.full[hauled] >= 0).all()
        assert len(set(hauled.tolist())) == len(hauled)
        assert w.fruit.sum() == rules.bins - (w.full >= 0).sum()
        assert len(set(w.group_cells[w.group_cells >= 0].tolist())) == (w.group_cells >= 0).sum()
    assert w.fruit.sum() == 0
    assert (w.stood <= w.full - rules.fill).all()
    assert (w.full + rules.grid.full_times[w.bin_cells, rules.grid.home] <= w.returned).all()
    assert w.metrics()["finished"] == w.returned.max()
    per_cell = np.bincount(w.bin_cells, minlength=rules.grid.size)
    assert (per_cell[rules.grid.harvested] == rules.bins_per_cell).all()


def test_a_group_that_exhausts_its_cell_goes_to_the_nearest_with_fruit():
    start = OrchardStart(np.array([1, 2]), np.empty((2, 0), int))
    w = world(OrchardRules(LANE, 2, 2, bins_per_cell=1), start)
    for _ in range(2):
        w.step({})
    assert w.group_cells.tolist() == [3, 4]  # both at once: the first group chooses first
    assert w.observe().requests.tolist() == [3, 4]
    assert w.metrics()["waiting_groups"] == 2.0


def test_a_group_waits_without_a_bin():
    w = world()
    for _ in range(5):
        w.step({})
    assert w.metrics()["idle_worker_steps"] == 3 * 5


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ({2: Trip()}, "no robot number 2"),
        ({0: Trip(3, -1)}, "no new bin may be brought to cell number 3"),
        ({0: Trip(1, -1), 1: Trip(1, -1)}, "no new bin may be brought to cell number 1 by robot number 1"),
        ({0: Trip(-1, 4)}, "cannot fetch bin number 4"),
        ({0: Trip(-1, 0), 1: Trip(-1, 0)}, "robot number 1 cannot fetch bin number 0"),
        ({0: "home"}, "must be told a trip"),
    ],
)
def test_what_cannot_be_done_changes_nothing(actions, message):
    w = world()
    check_refused(InputError, message, w.step, actions)
    assert (w.time, w.made, w.on_way.any(), (w.taker >= 0).any()) == (0, 1, False, False)


def test_busy_robots_and_robots_in_the_field_are_refused_what_they_cannot_do():
    w = world()
    w.step({0: Trip(1, -1)})
    with pytest.raises(InputError, check=coded("contradiction")):
        w.step({0: Trip(1, 0)})
    w.step({1: Trip(-1, 0)})
    check_refused(InputError, "robot number 1 has not finished its trip", w.step, {1: Trip()})


def test_starts_depend_on_the_seed_alone():
    first, again, other = (make_world("orchard", seed, robots=robots) for seed, robots in ((1, 2), (1, 20), (2, 2)))
    assert first.start.cells.tolist() == again.start.cells.tolist() != other.start.cells.tolist()
    assert len(set(first.start.cells.tolist())) == 4
    nearest, random = (make_world("orchard", 5, relocation=how).start for how in ("nearest", "random"))
    assert nearest.cells.tolist() == random.cells.tolist()


def test_more_groups_than_cells_and_false_routes_are_refused():
    check_refused(UsageError, "5 groups do not fit into 4 harvest cells", make_world, "orchard", 1, rows=1, columns=6, groups=5)
    for start in (OrchardStart(np.array([0]), np.array([[1]])), OrchardStart(np.array([1]), np.array([[5]]))):
        with pytest.raises(InputError, check=coded("contradiction")):
            world(start=start, rules=OrchardRules(LANE, 1, 1))
