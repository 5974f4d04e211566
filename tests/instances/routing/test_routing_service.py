import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import check_refused, refused

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.routing_service import is_table, table_from_file, table_of, unit_of_distance

OSRM = {"code": "Ok", "distances": [[0, 5000], [4000, 0]], "durations": [[0, 600], [None, 0]]}
VALHALLA = {
    "units": "miles",
    "sources_to_targets": [
        [{"distance": 0.0, "time": 0}, {"distance": 2.0, "time": 240, "to_index": 1}],
        [{"distance": 3.0, "time": 300}, {"distance": 0.0, "time": 0}],
    ],
}


def test_osrm_tells_metres_seconds_and_where_there_is_no_way() -> None:
    distances, durations, notes = table_of(OSRM).in_units("km", "min")
    assert distances.tolist() == [[0, 5], [4, 0]] and durations is not None and durations.tolist() == [[0, 10], [math.inf, 0]]
    assert notes == ("distances by OSRM in km, durations in min",)


def test_valhalla_tells_its_unit_and_has_a_terse_form() -> None:
    distances, durations, _ = table_of(VALHALLA).in_units("m", "s")
    assert distances[0, 1] == pytest.approx(3218.688) and durations is not None and durations[1, 0] == 300
    terse = {"units": "kilometers", "sources_to_targets": {"distances": [[0, 1.5], [2, 0]], "durations": [[0, 60], [90, 0]]}}
    assert table_of(terse).in_units("km", "min")[0].tolist() == [[0, 1.5], [2, 0]]


def test_without_distances_what_routes_cost_is_time() -> None:
    costs, durations, notes = table_of({"code": "Ok", "durations": [[0, 60], [120, 0]]}).in_units("km", "min")
    assert costs.tolist() == [[0, 1], [2, 0]] and durations is None and "told no distances" in notes[0]


def test_miles_are_miles() -> None:
    assert table_of({"distances": [[0, 1609.344], [1, 0]]}).in_units("mi", None)[0][0, 1] == pytest.approx(1.0)
    check_refused(UsageError, "unknown unit of distance 'kms'; choose from km, m, mi; did you mean 'km'", unit_of_distance, "kms")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ([], "is no table of a routing service"),
        ({"routes": []}, "is no table of a routing service"),
        ({"code": "NoTable", "message": "no way"}, "the routing service found no table; found no way"),
        ({"distances": [[0, 1], [1]]}, r"distances[1] of the table has a wrong length: sources and destinations must be the same sites"),
        ({"distances": [[0, -1], [1, 0]]}, "distances[0][1] of the table must be a number that is not negative, or null; found -1"),
        ({"distances": [[0, True], [1, 0]]}, "distances[0][1]"),
        ({"distances": "x"}, "distances of the table must be a list of lists"),
        ({"units": "furlongs", "sources_to_targets": []}, "units of the table are unknown"),
        ({"sources_to_targets": [1]}, "sources_to_targets must be lists of objects"),
        ({"sources_to_targets": {}}, "holds neither distances nor times"),
    ],
)
def test_what_is_no_table_is_refused(data: Any, message: str, tmp_path: Path) -> None:
    assert message in refused(table_of, data)
    path = tmp_path / "table.json"
    path.write_text(json.dumps(data))
    check_refused(InputError, r"table\.json", table_from_file, path)


def test_a_table_is_told_from_other_objects() -> None:
    assert is_table(OSRM) and is_table(VALHALLA) and not is_table({"x": 1}) and not is_table(np.zeros((2, 2)))
