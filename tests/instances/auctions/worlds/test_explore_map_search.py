import json

import numpy as np
import pytest

import waybound as wb
from waybound.instances.auctions.beliefs import after_type, mutual_information
from waybound.instances.auctions.worlds.explore_map_search import within
from waybound.instances.worlds import make_world

GO, MAP, SEARCH = range(3)


def path(tmp_path, rooms, *, robots=(0, 0)):
    """A file with rooms in a row, which hear those beside them."""
    doors = [[k, k + 1] for k in range(rooms - 1)]
    none = np.zeros((rooms, 1))
    instance = wb.ExplorationMap(doors, none, none, none, list(robots), 0, doors, 9, 1)
    file = tmp_path / "path.json"
    wb.RoomExploration(instance).save(file)
    return file


def test_the_sources_numbers():
    world = make_world("explore-map-search", 1)
    assert (world.building.num_rooms, world.steps) == (22, 100)
    assert world.prior.sum(axis=0).tolist() == pytest.approx([0.5, 0.5])
    assert (world.prior[:, 0] / world.prior.sum(axis=1)).tolist() == pytest.approx([0.1, 0.8, 0.6])


def test_visits_gain_less_each_time_and_staying_nothing(tmp_path):
    world = make_world("explore-map-search", 1, file=str(path(tmp_path, 3, robots=(0,))), explore=1, map=0, search=0)
    for room in (1, 0, 1, 1, 2):
        world.step({0: (room, GO)})
    assert world.gains.tolist() == pytest.approx([1 + 0.5 + 0.5 + 1, 0, 0])  # the base is visited at the start
    assert world.metrics()["utility"] == pytest.approx(3.0)


def test_readings_gain_by_all_that_was_read_before():
    world = make_world("explore-map-search", 5, robots=2)
    uniform, table = np.full(3, 1 / 3), world.sensing.types
    world.step({0: (0, MAP), 1: (0, MAP)})
    between = after_type(world.prior, world.sensing, world.readings[0].value).sum(axis=1)
    assert world.gains[MAP] == pytest.approx(float(mutual_information(uniform, table) + mutual_information(between, table)))
    old = make_world("explore-map-search", 5, robots=2, gain="entropy")
    old.step({0: (0, MAP), 1: (0, SEARCH)})
    assert old.gains.tolist()[1] == pytest.approx(1.098612, abs=1e-6)
    assert world.beliefs.sum(axis=(1, 2)) == pytest.approx(1.0)


def test_who_hears_whom_is_told_what_they_know(tmp_path):
    world = make_world("explore-map-search", 1, file=str(path(tmp_path, 6, robots=(0, 0))))
    world.step({0: (0, MAP), 1: (1, GO)})
    assert world.knows.tolist() == [[1, 1]] * 3
    world.step({0: (0, MAP), 1: (2, GO)})  # out of contact
    assert world.observe().groups.tolist() == [0, 1, 0] and world.silent.tolist() == [0, 1]
    assert world.knows.tolist() == [[2, 1], [1, 2], [2, 1]]
    world.step({0: (1, GO), 1: (2, SEARCH)})  # robot 1 is heard over robot 0
    assert world.knows.tolist() == [[3, 3]] * 3 and world.silent.tolist() == [0, 0]
    world.step({0: (0, GO), 1: (3, GO)})
    world.step({0: (0, SEARCH), 1: (3, MAP)})
    seen = world.observe()
    assert seen.knows.tolist() == [[5, 3], [3, 5], [5, 3]] and seen.history.shape == (5, 2, 3)
    assert seen.history[3].tolist() == [[0, GO, 1], [3, GO, 1]] and seen.history[2, 1, :2].tolist() == [2, SEARCH]


def test_links_up_to_the_range_and_below_it():
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0], [0.3, 0.0]])
    assert within(places, 1.0, False).tolist() == [[0, 1], [0, 3], [1, 3]]
    assert within(places, 1.0, True).tolist() == [[0, 3], [1, 3]]
    assert within(np.array([[0.0, 0.0], [0.1 + 0.2, 0.0]]), 0.3, False).tolist() == [[0, 1]]


def test_the_budget_ends_the_world():
    world = make_world("explore-map-search", 1, budget=3, cost=1.5)
    assert world.steps == 2 and make_world("explore-map-search", 1, budget=0.3, cost=0.1).steps == 3
    world.step({})
    world.step({0: (0, MAP)})
    assert world.over
    with pytest.raises(wb.InputError, match="the budget of 2 actions is spent"):
        world.step({})


def test_the_same_seed_is_the_same_world_whatever_is_done_in_it():
    one, two = make_world("explore-map-search", 7), make_world("explore-map-search", 7)
    one.step({0: (0, MAP)})
    two.step({0: (0, GO), 1: (0, MAP)})
    one.step({0: (0, SEARCH), 1: (0, MAP)})
    two.step({0: (0, SEARCH), 1: (0, MAP)})
    assert one.types.tolist() == two.types.tolist() and one.readings[-2:] == two.readings[-2:]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"type-sensor": "0.5 0.05 0.1; 0.3 0.9 0.1; 0.2 0.05 0.8"}, "type-sensor: each row, a true state, must be probabilities"),
        ({"target-sensor": "0.5 0.3; 0.05 0.9"}, "target-sensor: each row, .* of sum 0.8"),
        ({"decay": -0.5}, "decay between 0 and 1"),
        ({"map": 0.9}, "weights of exploring, mapping and searching must not be negative, and sum to 1"),
        ({"explore": -0.3, "map": 0.9}, "weights of exploring, mapping and searching must not be negative"),
        ({"budget": 0.5}, "a budget of 0.5 reaches no action, each costs 1"),
        ({"file": "solomon-c101"}, "solomon-c101"),
    ],
)
def test_bad_settings_are_refused_in_one_line(settings, message):
    with pytest.raises((wb.InputError, wb.UsageError), match=message) as refused:
        make_world("explore-map-search", 1, **settings)
    assert "\n" not in str(refused.value)


def test_maps_that_cannot_be_played_are_refused(tmp_path):
    with pytest.raises(wb.InputError, match="robot 2 does not hear the base at the start"):
        make_world("explore-map-search", 1, file=str(path(tmp_path, 4, robots=(0, 3))))
    data = json.loads(path(tmp_path, 4).read_text())
    for key, value in (("robots", [9]), ("doors", [])):
        (tmp_path / "bad.json").write_text(json.dumps({**data, key: value}))
        with pytest.raises(wb.InputError):
            make_world("explore-map-search", 1, file=str(tmp_path / "bad.json"))
    wb.generate("assignment", seed=1).save(tmp_path / "other.json")
    with pytest.raises(wb.UsageError, match="holds no map of rooms to explore"):
        make_world("explore-map-search", 1, file=str(tmp_path / "other.json"))
