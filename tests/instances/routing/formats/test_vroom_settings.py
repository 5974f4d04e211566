import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import check_refused

from waybound import InputError, Travel
from waybound.instances.reading import read_instance
from waybound.instances.routing.formats.vroom import read

PLACES = {
    "vehicles": [
        {"id": 1, "start": [2.35, 48.7], "end": [2.35, 48.7], "capacity": [4],
         "breaks": [{"id": 1, "time_windows": [[0, 9]]}], "steps": [{"type": "start"}]},
        {"id": 2, "start": [2.35, 48.7], "profile": "bike", "breaks": [{"id": 2, "time_windows": [[0, 9]]}], "capacity": [4]},
    ],
    "jobs": [{"id": 1, "location": [2.0, 48.7], "delivery": [1]}, {"id": 2, "location": [2.0, 48.7], "setup": 60, "delivery": [1]}],
    "shipments": [{"pickup": {"id": 4, "location": [2.4, 49.2]}, "delivery": {"id": 3, "location": [2.35, 49.0]}, "amount": [1]}],
}  # fmt: skip


def read_places(tmp_path: Path, **settings: Any) -> Any:
    (tmp_path / "places.json").write_text(json.dumps(PLACES))
    return read_instance(tmp_path / "places.json", settings=dict(settings))


def test_great_circles_stand_for_matrices_at_a_speed(tmp_path: Path) -> None:
    made = read_places(tmp_path, speed="36", ignore="breaks,steps,setup")
    sites, travel = made.sites, made.travel
    assert sites.ids == ("location 0", "anywhere", "1", "2", "pickup 4", "delivery 3") and not sites.geographic
    home, first, second = (sites.ids.index(name) for name in ("location 0", "1", "2"))
    metres = Travel("haversine-m", coordinates=np.array([[2.35, 48.7], [2.0, 48.7]])).distance(0, 1)
    assert travel.duration(home, first) == pytest.approx(metres / 10) and travel.duration(first, second) == 0  # 36 km an hour
    assert made.notes == (
        "breaks left out, as was asked for: vehicles[0] and 1 more", "steps left out, as was asked for: vehicles[0]",
        "setup left out, as was asked for: jobs[1]", "distances are great circles, driven at 36 km an hour",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({}, "--set speed=50"),
        ({"speed": 50}, "vehicles[0].breaks is not supported; expected no breaks, or --set ignore=breaks to plan without"),
        ({"speed": 50, "ignore": ["steps", "breaks"]}, "jobs[1].setup is not supported"),
        ({"ignore": "skills"}, "ignore=skills names nothing that may be left out; expected setup, breaks"),
        ({"speed": "fast"}, "speed must be positive and finite"),
        ({"speed": 0}, "speed must be positive and finite"),
    ],
)
def test_a_setting_that_does_not_fit_is_refused(settings: dict[str, Any], message: str, tmp_path: Path) -> None:
    check_refused(InputError, re.escape(message), read_places, tmp_path, **settings)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("matrices",), {"car": {"durations": [[0]]}}, "speed stands beside matrices"),
        (("jobs", 0, "location"), [2.0, 148.7], "jobs[0].location is out of range"),
        (("jobs", 0, "location_index"), 1, "jobs[0].location_index is a row of matrices that are not there"),
        (("jobs", 0, "location"), None, "jobs[0] lacks the key 'location_index'"),
    ],
)
def test_places_that_are_none_are_refused(path: tuple[Any, ...], value: Any, message: str) -> None:
    data = json.loads(json.dumps(PLACES))
    held = data
    for key in path[:-1]:
        held = held[key]
    held[path[-1]] = value
    check_refused(InputError, re.escape(message), read, json.dumps(data), Path("p.json"), {"speed": 50, "ignore": "breaks,steps,setup"})
