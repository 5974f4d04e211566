import math
from typing import Any

import pandas as pd
import pytest

from waybound import Group, InputError, Shipment
from waybound.instances.clock import Times
from waybound.instances.routing.frame_lists import groups_of, see_windows, shipments_of, windows_of

INDEX = {"o": 0, "a": 1, "b": 2, "7": 3}
DAY = pd.Timestamp("2026-05-04")


def windows(given: Any, unit: str | None = None) -> dict[int, list[tuple[float, float]]]:
    times = Times(unit)
    see_windows(given, times)
    return windows_of(given, INDEX, times)


def test_a_frame_and_a_mapping_tell_the_same_windows() -> None:
    frame = pd.DataFrame({"site": ["a", 7, "a"], "ready": [1, 2, None], "due": [3, math.inf, 0.5]})
    assert windows(frame) == windows({"a": [(1, 3), (None, 0.5)], 7: [(2, math.inf)]}) == {1: [(1, 3), (0, 0.5)], 3: [(2, math.inf)]}
    assert windows(None) == {}
    moments = pd.DataFrame({"site": ["a"], "ready": [DAY + pd.Timedelta("8h")], "due": [pd.NaT]})
    assert windows(moments, "h") == {1: [(8, math.inf)]}


def test_a_frame_and_a_list_tell_the_same_shipments() -> None:
    frame = pd.DataFrame({"pickup": ["a", "b"], "delivery": ["b", 7.0], "load": [2.5, None], "load2": [1, 4]})
    assert shipments_of(frame, INDEX) == shipments_of([("a", "b", (2.5, 1)), ("b", 7, [0, 4])], INDEX)
    assert (
        shipments_of(frame[["pickup", "delivery"]], INDEX)
        == [Shipment(1, 2), Shipment(2, 3)]
        == shipments_of([("a", "b"), ("b", 7)], INDEX)
    )


def test_a_load_is_told_by_its_title_alone() -> None:
    frame = pd.DataFrame({"pickup": ["a"], "delivery": ["b"], "load": [2], "load3": [5]})
    assert shipments_of(frame, INDEX) == [Shipment(1, 2, (2, 0, 5))]
    assert shipments_of(frame.drop(columns="load"), INDEX) == [Shipment(1, 2, (0, 0, 5))]


def test_a_frame_and_a_list_tell_the_same_groups() -> None:
    frame = pd.DataFrame({"group": ["x", "y", "x"], "site": ["a", 7, "b"], "required": [None, False, None]})
    assert (
        groups_of(frame, INDEX) == groups_of([["a", "b"], {"sites": [7], "required": False}], INDEX) == [Group((1, 2)), Group((3,), False)]
    )
    assert groups_of(frame[["group", "site"]], INDEX) == [Group((1, 2)), Group((3,))]


@pytest.mark.parametrize(
    ("read", "given", "message"),
    [
        (windows, pd.DataFrame({"sites": ["a"]}), "windows have an unknown column 'sites'; did you mean 'site'?"),
        (windows, pd.DataFrame({"ready": [1]}), "windows have no column 'site'"),
        (windows, pd.DataFrame({"site": ["a", None], "due": 1}), "row 2 of windows has no site"),
        (windows, {"a": [(1, 2, 3)]}, "a window of a has an opening and a close"),
        (windows, {"z": [(1, 2)]}, "windows name the unknown site 'z'"),
        (shipments_of, pd.DataFrame({"pickup": ["a"]}), "shipments have no column 'delivery'"),
        (shipments_of, [("a", "b", "much")], "load of the shipment from a to b must be a number"),
        (shipments_of, [("a",)], "a shipment has a pickup, a delivery and perhaps a load"),
        (groups_of, pd.DataFrame({"group": [1, 1], "site": ["a", "b"], "required": [True, False]}), "group 1 is required in one row and"),
        (groups_of, pd.DataFrame({"group": [1], "site": ["a"], "required": ["si"]}), "column required of groups must hold true and false"),
        (groups_of, [["a", "c"]], "groups name the unknown site 'c'"),
        (windows, True, "windows must be a mapping or a frame"),
        (windows, [("a", 0, 4)], "windows must be a mapping or a frame"),
        (windows, {"a": (0, 4)}, "a window of a has an opening and a close"),
        (windows, {"a": 4}, "windows of a must be a list"),
        (windows, pd.DataFrame({"site": ["a"]}), "windows have neither a column 'ready' nor 'due'"),
        (windows, pd.DataFrame({"site": ["a", "a"], "ready": [0, 3], "due": [4, 9]}), "windows of a are not apart from each other"),
        (windows, pd.DataFrame({"site": ["a"], "ready": [5], "due": [4]}), "a window of a closes before it opens"),
        (shipments_of, True, "shipments must be a list"),
        (shipments_of, [5], "a shipment has a pickup, a delivery and perhaps a load"),
        (groups_of, True, "groups must be a list"),
        (groups_of, {"far": ["7", "a"]}, "groups must be a list"),
        (groups_of, ["7a"], "sites of a group must be a list"),
        (groups_of, [{"sites": "7a"}], "sites of a group must be a list"),
        (groups_of, [{"members": ["7"]}], "a group has sites and perhaps required"),
        (groups_of, [{"sites": ["7"], "require": False}], "a group has sites and perhaps required"),
        (groups_of, [{"sites": ["7"], "required": "false"}], "required of a group must be True or False; found 'false'"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(read: Any, given: Any, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(given) if read is windows else read(given, INDEX)
    assert str(caught.value).startswith(message)
