"""Routes of several trips in JSON and as a table."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.arange(4.0)[:, None] - np.arange(4.0)[None, :])


def problem(vehicle=None, **sites):
    return RoutingProblem(Sites.of("oabc", **sites), Travel(EXPLICIT, matrix=LINE), [vehicle or VehicleType()])


def test_depots_on_the_way_are_written_and_read_among_the_visits():
    made, answer = problem(VehicleType(reloads=(0,))), Routes.of([Route((1, 0, 2, 3))])
    data = made.answer_to_json(answer)
    assert data == {"kind": "routes", "routes": [{"visits": ["a", "o", "b", "c"]}]}
    assert made.answer_from_json(data) == answer


def test_the_table_tells_what_is_on_board_and_what_the_store_holds():
    frame = problem(VehicleType(reloads=(0,)), demand=[0, 1, 2, 0], pickup=[0, 5, 0, 0]).answer_to_frame(Routes.of([(1, 0, 2)]))
    assert frame["on_board"].tolist() == [5, 2, 0] and "energy" not in frame.columns
    frame = problem(VehicleType(energy=Energy(9, 2, stations=(0,)))).answer_to_frame(Routes.of([(1, 0, 2)]))
    assert frame["energy"].tolist() == [7, 9, 5] and "on_board" not in frame.columns


def test_a_plain_table_is_as_it_was():
    frame = problem().answer_to_frame(Routes.of([(1, 2)]))
    assert frame.columns.tolist() == ["vehicle", "position", "site", "arrival", "begin", "departure", "load", "distance"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"kind": "tour"}, "not an answer to a routing problem"),
        ({"kind": "routes", "routes": [{"visits": "abc"}]}, "route 1 has no list of visits"),
        ({"kind": "routes", "routes": [{"visits": ["z"]}]}, "route 1 visits an unknown site 'z'"),
        ({"kind": "routes", "routes": [{"visits": ["a"], "vehicle": "bus"}]}, "route 1 names an unknown vehicle 'bus'"),
    ],
)
def test_anything_else_is_refused(data, message):
    with pytest.raises(InputError, match=message):
        problem().answer_from_json(data)


def test_a_file_without_a_place_for_stops_at_depots_is_refused():
    with pytest.raises(UsageError, match="no place for stops at depots on the way"):
        problem(VehicleType(1, reloads=(0,))).check_answer_suffix(".sol")
