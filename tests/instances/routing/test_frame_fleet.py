"""Vehicle types from frames and mappings."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from waybound.instances.clock import Times
from waybound.instances.errors import InputError
from waybound.instances.routing.frame_fleet import fleet_of, see_times
from waybound.instances.routing.sites import Sites
from waybound.instances.routing.vehicle_type import VehicleType

DAY = pd.Timestamp("2026-05-04")
SITES = Sites.of(["yard", "port", "a"], depot=[True, True, False], demand=[[0, 0], [0, 0], [1, 2]])


def fleet(given: Any, unit: str | None = None) -> tuple[VehicleType, ...]:
    times = Times(unit)
    see_times(given, times)
    return fleet_of(given, SITES, times)


def test_a_frame_without_count_has_one_vehicle_a_row() -> None:
    made = fleet(pd.DataFrame({"capacity": [5, 9], "capacity2": [1.0, np.nan], "start": ["yard", "port"]}, index=["van", "truck"]))
    assert [(v.name, v.count, v.capacities, v.start) for v in made] == [("van", 1, (5, 1), 0), ("truck", 1, (9,), 1)]
    assert fleet([{"capacity": 5}])[0].count is None
    assert [v.count for v in fleet(pd.DataFrame({"name": ["p", "q"], "count": pd.array([3, None], dtype="Int64")}))] == [3, None]


@pytest.mark.parametrize("missing", [None, float("nan"), pd.NA, pd.NaT])
@pytest.mark.parametrize("key", ["start", "end"])
def test_an_end_that_is_missing_is_neither_open_nor_a_depot(key: str, missing: Any) -> None:
    expected = f"fleet[0].{key} is missing; expected a depot, or no '{key}' at all for"
    for given in ([{key: missing}], pd.DataFrame({key: [missing, "port"]})):
        with pytest.raises(InputError) as error:
            fleet(given)
        assert expected in str(error.value) and "an open end is a depot of its own" in str(error.value)


def test_without_an_end_a_vehicle_returns_to_its_start() -> None:
    assert [(v.start, v.end) for v in fleet([{"name": "p", "start": "port"}, {"name": "q"}, {"name": "r", "end": "port"}])] == [
        (1, 1), (0, 0), (0, 1)
    ]  # fmt: skip


def test_times_of_vehicles_are_read_in_the_unit() -> None:
    frame = pd.DataFrame(
        {
            "shift_start": [DAY + pd.Timedelta("7h"), pd.NaT],
            "shift_end": [DAY + pd.Timedelta("15h")] * 2,
            "max_duration": pd.Timedelta("6h"),
        }
    )
    van, other = fleet(frame, "h")
    assert van.shift == (7, 15) and other.shift == (-math.inf, 15) and van.max_duration == 6
    assert fleet([{"shift": [DAY + pd.Timedelta("7h"), DAY + pd.Timedelta("8h")]}], "min")[0].shift == (420, 480)


def test_words_numbers_and_stores_are_what_the_json_has() -> None:
    made = fleet([{"skills": "cold, tall", "reloads": ["yard"], "energy": 40, "max_reloads": 2.0}])[0]
    assert made.skills == {"cold", "tall"} and made.reloads == (0,) and made.max_reloads == 2
    assert made.energy is not None and made.energy.capacity == 40
    assert fleet([VehicleType(2, name="own")])[0].name == "own"


@pytest.mark.parametrize(
    ("given", "unit", "message"),
    [
        (pd.DataFrame({"capcity": [5]}), None, "the fleet has an unknown column 'capcity'; did you mean 'capacity'?"),
        ([{"capcity": 5}], None, "fleet[0] has an unknown key 'capcity'; did you mean 'capacity'?"),
        (pd.DataFrame({"max_duration": [pd.Timedelta("6h")]}), None, "fleet[0].max_duration holds timedeltas"),
        ([{"shift": [0, 1], "shift_start": 0}], None, "fleet[0] tells its shift twice"),
        (pd.DataFrame({"start": ["a"]}), "min", ""),
        ([{"capacity": -math.inf}], None, "minus infinity"),
    ],
)
def test_what_is_wrong_is_named(given: Any, unit: str | None, message: str) -> None:
    if not message:
        assert fleet(given, unit)[0].start == 2  # whether that is a depot is for the instance to say
        return
    with pytest.raises(InputError) as error:
        fleet(given, unit)
    assert message in str(error.value) and "\n" not in str(error.value)
