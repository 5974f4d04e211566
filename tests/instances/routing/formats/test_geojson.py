import json
from pathlib import Path
from typing import Any

import pytest
from file_cases import refused

import waybound as wb
from waybound.instances.routing.formats.geojson import read, recognises


def feature(k: int, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "id": k, "geometry": {"type": "Point", "coordinates": [9 + k / 10, 45.0, 120]}, "properties": properties}


def collection(features: list[Any] | None = None, **members: Any) -> dict[str, Any]:
    made = [feature(k, demand=k, shop=f"S{k}") for k in range(4)] if features is None else features
    return {"type": "FeatureCollection", "features": made, **members}


def test_properties_are_columns_and_members_are_the_fleet(tmp_path: Path) -> None:
    path = tmp_path / "shops.geojson"
    path.write_text(json.dumps(collection(vehicles=2, capacity=5, generator="by hand")))
    problem = wb.read(path)
    assert isinstance(problem, wb.RoutingProblem)
    assert (problem.name, problem.sites.ids, problem.fleet[0].count, problem.fleet[0].capacity) == ("shops", ("0", "1", "2", "3"), 2, 5)
    assert problem.sites.geographic and problem.sites.attributes == {"shop": ("S0", "S1", "S2", "S3")}
    assert problem.travel.metric == "haversine" and problem.sites.demand.tolist() == [0, 1, 2, 3]
    problem.save(tmp_path / "shops.json")
    assert wb.read(tmp_path / "shops.json").digest() == problem.digest()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (collection(capcity=5), "member 'capcity' is unknown; did you mean 'capacity'?"),
        (collection([]), "holds no sites"),
        (
            collection([{"type": "Feature", "geometry": None}]),
            "features[0] is without a place; expected a geometry of type Point; found geometry null",
        ),
        (collection([{"type": "Feature", "geometry": [1]}]), "expected a geometry of type Point; found geometry a list"),
        (collection([{"type": "Feature"}]), "features[0] is without a place; expected a geometry of type Point; found no geometry"),
        (collection([[]]), "features[0] must be a feature; expected an object; found a list"),
        (collection([{**feature(0, demand=1), "demand": 4}]), "features[0] tells 'demand' twice"),
        (collection([{**feature(0), "lat": 4}]), "features[0] tells its place twice"),
        (collection([feature(0), {**feature(1), "prize": 4}]), "column 'prize' is unknown; did you mean 'reward'?"),
        (collection([{**feature(0), "geometry": {"type": "Polygon", "coordinates": []}}]), "features[0].geometry is no point"),
        (collection([{**feature(0), "geometry": {"type": "Point", "coordinates": ["9", 45]}}]), "must be longitude and latitude"),
        (collection([feature(0, lat=1)]), "features[0] tells its place twice"),
        (collection([{**feature(0), "properties": [1]}]), "features[0].properties must be an object"),
        (collection([{"geometry": {"type": "LineString", "coordinates": []}, "properties": {"kind": "route"}}]), "is a solution file"),
        ({"type": "Feature"}, "is no GeoJSON of sites"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(data: Any, message: str) -> None:
    assert message in refused(read, json.dumps(data), Path("x.geojson"))


def test_it_is_recognised_by_its_type_alone() -> None:
    assert recognises(json.dumps(collection())) and not recognises('{"waybound": 1}') and not recognises("[]")


def test_members_beside_the_properties_are_columns_too() -> None:
    features = [{**feature(0, shop="S0"), "bbox": [9, 45, 9, 45]}, {**feature(1), "demand": 4, "geometry_name": "geom", "layer": {"a": 1}}]
    made = read(json.dumps(collection(features)), Path("x.geojson"))
    assert made.sites.demand.tolist() == [0, 4] and made.sites.attributes["geometry_name"] == (None, "geom")
    assert "columns kept and not used: shop, geometry_name, layer" in made.notes
