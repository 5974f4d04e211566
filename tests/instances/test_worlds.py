import math
import pickle

import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.worlds import WORLDS, Setting, World, make_world, setting_values


def test_every_world_is_made_with_its_defaults_and_does_the_three_things():
    assert "tracking" in WORLDS
    for name in WORLDS:
        world = make_world(name, 1)
        assert isinstance(world, World)
        assert world.time == 0
        world.observe()
        before = set(world.metrics())
        world.step({})
        assert world.time == 1
        assert set(world.metrics()) == before


@pytest.mark.parametrize("name", sorted(set(WORLDS) - {"plume-exploration"}))  # which holds what cannot be pickled
def test_the_same_seed_gives_the_same_world_and_another_one_another(name):
    one, same, other = (pickle.dumps(make_world(name, seed)) for seed in (5, 5, 6))
    assert one == same != other


@pytest.mark.parametrize("name", list(WORLDS))
def test_every_setting_out_of_its_range_is_refused(name):
    for key, setting in WORLDS[name].settings.items():
        for value in (setting.least - 1, setting.most + 1):
            if math.isfinite(value):
                with pytest.raises(UsageError, match=f"{key} must lie between {setting.least:g}"):
                    make_world(name, 1, **{key: value})


def test_an_unknown_world_lists_the_known_ones():
    with pytest.raises(UsageError, match="tracking"):
        make_world("nothing", 1)


@pytest.mark.parametrize("seed", [-1, True, 1.5, "1"])
def test_a_seed_is_a_whole_number_that_is_not_negative(seed):
    with pytest.raises(UsageError, match="seed"):
        make_world("tracking", seed)


def test_settings_take_text_and_dashes_and_fill_in_defaults():
    settings = {"turn-every": Setting(3, "steps", least=0), "kind": Setting("a", "kind", choices=("a", "b"))}
    assert setting_values("x", settings, {"turn_every": "5"}) == {"turn-every": 5, "kind": "a"}
    check_refused(UsageError, "x has no setting 'colour'; it takes turn-every, kind", setting_values, "x", settings, {"colour": "red"})
    check_refused(UsageError, "turn-every must lie between", setting_values, "x", settings, {"turn-every": -1})
