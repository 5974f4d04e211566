import inspect
from dataclasses import fields
from typing import Any

import numpy as np
import pandas as pd
import pytest
from file_cases import check_refused, refused

import waybound as wb
from waybound.instances.errors import InputError, WayboundError
from waybound.instances.routing.frame_arguments import FrameArguments, loads_of, number_of, text_of, titles_of, whole_of

SITES = pd.DataFrame({"id": ["hub", "a", "b"], "x": [0, 10, 20], "y": [0, 3, 4]})
NUMBERS = ("vehicles", "capacity", "max_distance", "fixed_cost", "unit_cost", "min_vehicles", "team_risk", "speed")
TEXTS = ("name", "distance_unit", "weight", "convention", "time_unit")
OTHERS = ("max_duration", "extra", "closing", "windows", "shipments", "groups", "fleet", "travel", "durations", "variances", "columns")


def test_they_are_those_of_from_frame_with_the_same_defaults() -> None:
    documented = inspect.signature(wb.RoutingProblem.from_frame).parameters
    own = {field.name: field.default for field in fields(FrameArguments)}
    assert own == {name: p.default for name, p in documented.items() if name not in ("sites", "objective", "problem")}


def said(value: object) -> str:
    """Its text without an address in memory, which would make names of tests differ from process to process."""
    return repr(value).partition(" at 0x")[0]


@pytest.mark.parametrize("value", ["x", [], {}, True, -1, float("nan"), None, b"x", object(), {"a": 1}, [object()]], ids=said)
@pytest.mark.parametrize("key", [*NUMBERS, *TEXTS, *OTHERS])
def test_no_argument_ends_in_a_raw_exception(key: str, value: Any) -> None:
    try:
        wb.RoutingProblem.from_frame(SITES, **{key: value})
    except WayboundError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize("value", ["x", [], {}, b"x", object()], ids=said)
@pytest.mark.parametrize("key", [key for key in NUMBERS if key != "speed"])
def test_what_is_no_number_is_refused_by_the_name_of_the_argument(key: str, value: Any) -> None:
    with pytest.raises(InputError, match=key.replace("vehicles", ".*vehicles") + " (must be|is empty)"):
        wb.RoutingProblem.from_frame(SITES, **{key: value})


@pytest.mark.parametrize("value", [5, None, ["x"], b"x", 3.5, True])
def test_a_name_is_a_text(value: Any) -> None:
    check_refused(InputError, "name must be a text; found", wb.RoutingProblem.from_frame, SITES, name=value)


def test_numbers_of_any_library_are_numbers() -> None:
    assert number_of(np.float32(2), "n") == 2 and whole_of(np.int64(3), "n") == 3 and whole_of(4.0, "n") == 4
    assert loads_of(np.array([1, 2]), "n") == [1, 2] and loads_of((5,), "n") == [5] and loads_of(7, "n") == [7]
    assert titles_of("a", "n") == ["a"] and titles_of((), "n") == [] and titles_of(True, "n") is True
    assert text_of("a", "n") == "a"
    made = wb.RoutingProblem.from_frame(SITES.assign(demand2=1), capacity=np.array([5, 6]), vehicles=np.int64(2))
    assert (made.fleet[0].capacities, made.fleet[0].count) == ((5, 6), 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"fleet": {"count": 1}}, "fleet must be a frame or a list; expected [{'capacity': 5}], one entry a type"),
        ({"fleet": {}}, "found one mapping: {}"),
        ({"fleet": "f.csv"}, "pandas.read_csv(file); found one str: 'f.csv'"),
        ({"fleet": wb.VehicleType()}, "fleet must be a frame or a list"),
        (
            {"travel": {}},
            "is no table of a routing service; expected distances or durations (OSRM), or sources_to_targets (Valhalla); found an",
        ),
        ({"durations": "f.csv"}, "the duration matrix must be an array or a frame; found str 'f.csv'"),
        ({"variances": {}}, "the variance matrix must be an array or a frame"),
        ({"capacity": []}, "capacity is empty"),
    ],
)
def test_what_is_of_the_wrong_kind_is_named(given: dict[str, Any], message: str) -> None:
    assert message in refused(wb.RoutingProblem.from_frame, SITES, **given)


def test_a_fleet_may_be_read_once_alone() -> None:
    places = pd.DataFrame({"lat": [45, 45.1], "lon": [15, 15.0], "service": [0, 5]})
    rows = ({"name": name, "count": 1, "speed": 50} for name in "ab")
    assert len(wb.RoutingProblem.from_frame(places, fleet=rows, time_unit="min").fleet) == 2


@pytest.mark.parametrize("frame", [SITES[:1], SITES.assign(depot=True)])
def test_sites_without_a_customer_are_refused(frame: pd.DataFrame) -> None:
    check_refused(InputError, "there is no customer; expected a row that is no depot", wb.RoutingProblem.from_frame, frame)
