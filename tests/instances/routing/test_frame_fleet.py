import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from file_cases import check_refused, refused

from waybound import InputError, Sites, VehicleType
from waybound.instances.clock import Times
from waybound.instances.routing.frame_fleet import fleet_of, see_times, shared_bans
from waybound.instances.routing.json_vehicles import decode_vehicle

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


@pytest.mark.parametrize("missing", [None, np.nan, pd.NA, pd.NaT])
def test_a_number_of_vehicles_that_is_missing_is_neither_one_nor_any(missing: Any) -> None:
    for frame in (pd.DataFrame({"name": ["p", "q"], "count": [3, missing]}), pd.DataFrame({"name": ["p", "q"], "count": [missing, 1]})):
        check_refused(InputError, r"fleet\[[01]\]\.count is missing; expected a number, unlimited or inf for any number", fleet, frame)
    assert fleet([{"count": missing}])[0].count is None  # as JSON's null


@pytest.mark.parametrize("many", [np.inf, "inf", "unlimited", "Unlimited"])
def test_any_number_of_vehicles_is_said_by_a_word_or_infinity(many: Any) -> None:
    assert [v.count for v in fleet(pd.DataFrame({"name": ["p", "q"], "count": ["3", many]}))] == [3, None]


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
    assert message in refused(fleet, given, unit)


def test_a_store_holds_numbers_of_any_kind() -> None:
    store = fleet([{"energy": {"capacity": np.int64(9), "rate": np.float32(2), "stations": ("yard",)}}])[0].energy
    assert store is not None and (store.capacity, store.rate, store.stations) == (9, 2, (0,))
    check_refused(InputError, r"energy must be an object; found set$", decode_vehicle, {"energy": {1, 2}}, "fleet[0]", SITES.index(), SITES)


@pytest.mark.parametrize("of", [np.array, pd.DataFrame, lambda m: {"metric": "EXPLICIT", "matrix": np.array(m)}, list])
def test_a_matrix_of_its_own_is_given_as_that_of_all(of: Any) -> None:
    inf = math.inf
    near, far = [[0, 1, inf], [2, 0, 3], [4, 5, 0]], [[0, 6, 7], [8, 0, 9], [1, 2, 0]]
    one, other = fleet([{"name": "van", "travel": of(near)}, {"name": "bike", "travel": of(far)}])
    assert one.travel is not None and one.travel.distance(1, 2) == 3 and other.travel is not None and other.travel.distance(0, 2) == 7
    assert one.travel.closing is not None and np.argwhere(np.isfinite(one.travel.closing)).tolist() == [[0, 2]]
    assert one.travel.closing[0, 2] < 0 and other.travel.closing is None  # closed before anybody can set out


def test_what_no_vehicle_can_do_is_forbidden_to_the_problem() -> None:
    near, far = np.ones((3, 3)), np.ones((3, 3))
    near[0, 1] = far[0, 1] = far[1, 2] = math.inf
    kinds, forbidden = shared_bans(fleet([{"name": "van", "travel": near}, {"name": "bike", "travel": far}]), None, SITES)
    assert forbidden is not None and np.argwhere(forbidden).tolist() == [[0, 1]]
    assert [v.travel is not None and v.travel.closing is not None for v in kinds] == [False, True]
    some = fleet([{"name": "van", "travel": near}, {"name": "bike"}])
    assert shared_bans(some, None, SITES) == (some, None)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (np.ones((2, 2)), r"fleet\[0\].travel: the distance matrix and the sites have different sizes; expected \(3, 3\)"),
        (-np.ones((3, 3)), r"fleet\[0\].travel: distance from site yard to site port must be a number and not negative"),
        ({"matrix": np.ones((3, 3))}, r"fleet\[0\].travel lacks the key 'metric'"),
        ("by air", r"fleet\[0\].travel.metric is unknown"),
    ],
)
def test_a_matrix_that_does_not_fit_is_refused(given: Any, message: str) -> None:
    check_refused(InputError, message, fleet, [{"travel": given}])


@pytest.mark.parametrize(
    ("title", "own"),
    [
        ("tw_early", "shift_start"), ("num_available", "count"), ("Shift Duration", "max_duration"), ("start_index", "start"),
        ("profile", "travel"),
    ],
)  # fmt: skip
def test_names_of_others_are_refused_with_ours(title: str, own: str) -> None:
    for given in (pd.DataFrame({title: [1]}), [{title: 1}]):
        check_refused(InputError, f"unknown (column|key) '{title}'; did you mean '{own}'", fleet, given)
