"""Every reader on spoilt files: an instance that reads back the same, or one line of complaint. Nothing else may come out."""

import json
import re
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from draws import draws
from file_cases import tsplib
from file_texts import LI_LIM, MDVRP, OP, TOPTW, VROOM, VRPSPD
from hypothesis import HealthCheck, given, settings, strategies as st

from waybound import Cardinality, InputError, Knapsack, PartitionMatroid, SelectionInstance, SensingGraph, WayboundError
from waybound.instances import text as texts
from waybound.instances.bundled import bundled_path
from waybound.instances.formats import FORMATS, waybound_json
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.routing.formats import sites_csv
from waybound.instances.routing.solution_files import routes_from_text
from waybound.instances.sata.max_min_lp import MaxMinInstance, SparseMatrix
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation

TSP = (
    "NAME: t\nTYPE: TSP\nDIMENSION: 4\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: UPPER_ROW\nEDGE_WEIGHT_SECTION\n1 2 3\n4 5\n6\nEOF\n"
)
VRPTW = tsplib(
    "NAME: A-n3-k2", "TYPE: VRPTW", "DIMENSION: 3", "EDGE_WEIGHT_TYPE: GEO", "CAPACITY: 9", NODE_COORD_SECTION="1 1.5 2|2 1.3 2.1|3 1 1",
    DEMAND_SECTION="1 0|2 3|3 4", TIME_WINDOW_SECTION="1 0 9999|2 10 5000|3 0 9000", SERVICE_TIME_SECTION="1 0|2 5|3 5",
    DEPOT_SECTION="1|-1",
) + "EOF\n"  # fmt: skip
EDGES = """\
# name: e
# problem: winner-takes-all
# duplicates: sum
robot,action,target,weight
1,1.1,1,2.5
1,1.1,2,1
2,a,,
3,,,
2,b,1,0.5
2,b,1,3
,,9,
"""
TSILIGIRIDES = "15\t1\n10.5\t14.4\t0\n11.2\t14.1\t0\n18\t15.9\t10\n18.3\t13.3\t15\n"
CHAO = "n 4\nm 2\ntmax 22.5\n10.5\t14.4\t0\n18\t15.9\t10\n18.3\t13.3\t12\n11.2\t14.1\t0\n"
MTSP = "four EUC_2D 2\n1 0 0\n2 1 1\n3 3 4.5\n4 0 -2\n"
RICH = tsplib(
    "NAME : rich", "DIMENSION : 4", "EDGE_WEIGHT_TYPE : EUC_2D", "VEHICLES_UNIT_DISTANCE_COST : 2",
    NODE_COORD_SECTION="1 0 0|2 10 0|3 1 2|4 2 1", DEMAND_SECTION="1 0|2 0|3 4|4 4", PRIZE_SECTION="1 0|2 0|3 0|4 9",
    DEPOT_SECTION="1|2|-1", VEHICLES_DEPOT_SECTION="1 1|2 2", CAPACITY_SECTION="1 10|2 4",
) + "EOF"  # fmt: skip
GEOJSON = {
    "type": "FeatureCollection", "vehicles": 2, "capacity": 9.5, "time_unit": "min", "speed": 40, "shipments": [["1", "2", 3]],
    "features": [
        {"type": "Feature", "geometry": {"type": "Point", "coordinates": [9.0 + k, 45.0]},
         "properties": {"id": k, "demand": k, "due": 900, "service": 5, "phone": "1", "note": None, "depot": k == 0}}
        for k in range(3)
    ],
}  # fmt: skip
DOCUMENTS: dict[str, Any] = {
    "sensing": SensingGraph(
        np.array([0, 1, 0], np.int32), np.array([0, 2, 3, 3], np.int32), np.array([0, 2, 1], np.int32), np.array([0.5, 2, 3]), 3, 4,
        ("a", "b", "c"), target_names=tuple("wxyz"), action_positions=np.eye(3)[:, :2], notes=("seen",),
    ),
    "coverage": SelectionInstance(
        Coverage.from_sets([[0, 2], [1], []], [1, 2.5, 3]), PartitionMatroid.of([0, 1, 0], [1, 2]), tuple("abc")
    ),
    "facility-location": SelectionInstance(
        FacilityLocation(np.array([0, 1, 3], np.int32), np.array([1, 0, 2], np.int32), np.array([0.5, 1, 2]), 4), Knapsack([1, 2.5], 3.0)
    ),
    "dense": SelectionInstance(DenseFacilityLocation(np.array([[0.1, 2], [3, 0]], np.float32)), Cardinality(1)),
    "max-min": MaxMinInstance(SparseMatrix.of([[1, 0, 2], [0, 1, 0]]), SparseMatrix.of([[1, 1, 1.5]]), variable_names=tuple("abc")),
}  # fmt: skip
BASES = {
    "solomon": bundled_path("demo-c25").read_text().split("\n", 20)[:19],
    "vrplib-cvrp": bundled_path("demo-x40").read_text().split("\n"),
    "vrplib-tsp": TSP.split("\n"),
    "vrplib-vrptw": VRPTW.split("\n"),
    "csv": sites_csv.write(generate("random", 1, windows=True)).split("\n"),  # type: ignore[arg-type]
    "json": waybound_json.write(generate("random", 2, windows=True, metric="explicit", customers=3)).split("\n"),
    "edges": EDGES.split("\n"),
    "vrplib-op": OP.split("\n"),
    "tsiligirides": TSILIGIRIDES.split("\n"),
    "taillard": ["3", "0 40 40 0", "1 22 22 18", "2 36 26 26", "3 21 45 11", "2", "20 20 1.0 0 50", "30 35 1.1 0 2", ""],
    "chao": CHAO.split("\n"),
    "mtsp": MTSP.split("\n"),
    "cordeau": MDVRP.split("\n"),
    "toptw": TOPTW.split("\n"),
    "li-lim": LI_LIM.split("\n"),
    "vrplib-vrpspd": VRPSPD.replace("MVRPB", "VRPSPD").split("\n"),
    "vroom": json.dumps(VROOM, indent=1).split("\n"),
    "vrplib-rich": RICH.split("\n"),
    "geojson": json.dumps(GEOJSON, indent=1).split("\n"),
    **{kind: waybound_json.write(made).split("\n") for kind, made in DOCUMENTS.items()},
}
TOKENS = [
    "nan", "NaN", "inf", "-inf", "Infinity", "1e999", "-1", "0", "-0", "1e308", "9" * 30, "9" * 5000, "2000000000", "0x1F",
    "1_000", "1,5", "--5", "½", "٣", "é", "\u2028", "\x0b", "\x00", "\ud7ff", '"', "{", "[[[[", "null", "true", "EOF", ":", "#",
    "# vehicles: 0", "TYPE: TOUR", "DIMENSION : 3", "DEPOT_SECTION", "EDGE_WEIGHT_SECTION", "FIXED_EDGES_SECTION", "VEHICLE",
    "CUSTOMER", "EXPLICIT", "ATT", "FULL_MATRIX", "LOWER_DIAG_ROW", "VRPTW", "", " ", "\t",
    "n 4", "m 0", "tmax", "TYPE : OP", "NODE_SCORE_SECTION", "COST_LIMIT : -1", "NODE_SEQUENCE_SECTION", "2 4 3 2", "0 0", "GEO",
    "# order: rows", "# duplicates: error", "robot,action,target", "robot", "sum", "coverage", "99999999999", "[[0]]",
]  # fmt: skip


@st.composite
def spoilt(draw: st.DrawFn) -> bytes:
    """A valid file after a few accidents."""
    lines = list(BASES[draw(st.sampled_from(sorted(BASES)))])
    for _ in range(draw(st.integers(1, 4))):
        accident = draw(st.sampled_from(["token", "delete", "double", "swap", "insert", "header"]))
        k = draw(st.integers(0, max(0, len(lines) - 1)))
        if not lines:
            break
        if accident == "token":
            parts = re.split(r"(\s+|[,:])", lines[k])
            parts[draw(st.integers(0, len(parts) - 1))] = draw(st.sampled_from(TOKENS) | st.text(max_size=6))
            lines[k] = "".join(parts)
        elif accident == "delete":
            del lines[k : k + draw(st.integers(1, 5))]
        elif accident == "double":
            lines.insert(k, lines[k])
        elif accident == "swap":
            other = draw(st.integers(0, len(lines) - 1))
            lines[k], lines[other] = lines[other], lines[k]
        elif accident == "insert":
            lines.insert(k, draw(st.sampled_from(TOKENS) | st.text(max_size=20)))
        else:
            head, colon, _ = lines[k].partition(":")
            lines[k] = head + colon + " " + draw(st.sampled_from(TOKENS))
    data = draw(st.sampled_from(["\n", "\r\n"])).join(lines).encode("utf-8", "surrogatepass")
    if draw(st.integers(0, 3)) == 0:
        data = data[: draw(st.integers(0, len(data)))]
    if draw(st.integers(0, 5)) == 0 and data:
        at = draw(st.integers(0, len(data) - 1))
        data = data[:at] + draw(st.binary(min_size=1, max_size=4)) + data[at + 1 :]
    return data


def attempt(data: bytes, path: Path, format_name: str | None, differences: Callable[..., list[str]]) -> None:
    path.write_bytes(data)
    try:
        made: Any = read_instance(path, format_name)
    except WayboundError as error:
        assert error.exit_code == 2
        assert "\n" not in str(error)
        assert str(error).startswith(str(path)) or format_name is None
        return
    assert differences(made, waybound_json.read(waybound_json.write(made), path)) == []


FUZZ = settings(max_examples=draws(300), deadline=2000, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])


@FUZZ
@given(spoilt())
def test_a_spoilt_file_is_read_or_refused_in_one_line(differences: Callable[..., list[str]], tmp_path: Path, data: bytes) -> None:
    attempt(data, tmp_path / "spoilt.txt", None, differences)


@FUZZ
@given(spoilt(), st.sampled_from(sorted(FORMATS)))
def test_a_spoilt_file_is_read_or_refused_by_every_reader(
    differences: Callable[..., list[str]], tmp_path: Path, data: bytes, format_name: str
) -> None:
    attempt(data, tmp_path / "spoilt.txt", format_name, differences)


@FUZZ
@given(
    st.binary(max_size=200) | st.text(max_size=200).map(lambda s: s.encode("utf-8", "surrogatepass")),
    st.sampled_from([None, *sorted(FORMATS)]),
)
def test_noise_is_refused(differences: Callable[..., list[str]], tmp_path: Path, data: bytes, format_name: str | None) -> None:
    attempt(data, tmp_path / "noise.txt", format_name, differences)


@pytest.mark.long
@settings(FUZZ, max_examples=10_000)
@given(spoilt(), st.sampled_from([None, *sorted(FORMATS)]))
def test_many_spoilt_files_are_read_or_refused(
    differences: Callable[..., list[str]], tmp_path: Path, data: bytes, format_name: str | None
) -> None:
    attempt(data, tmp_path / "spoilt.txt", format_name, differences)


leaves = st.none() | st.booleans() | st.integers(-3, 10**20) | st.floats() | st.text(max_size=5) | st.lists(st.integers(-1, 3), max_size=4)


def _paths(data: Any, above: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [above, *(path for key, value in items for path in _paths(value, (*above, key)))]


PARSED = {base: json.loads("\n".join(BASES[base])) for base in ("json", "vroom", *DOCUMENTS)}
PLACES = [(base, path) for base, document in PARSED.items() for path in _paths(document)[1:]]


@FUZZ
@given(st.sampled_from(PLACES), leaves | st.dictionaries(st.text(max_size=4), leaves, max_size=2))
def test_any_value_anywhere_in_json_is_read_or_refused(
    differences: Callable[..., list[str]], tmp_path: Path, place: tuple[str, tuple[Any, ...]], value: Any
) -> None:
    base, path = place
    data = json.loads(json.dumps(PARSED[base]))
    part = data
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    attempt(json.dumps(data).encode("utf-8", "surrogatepass"), tmp_path / "spoilt.json", None, differences)


SOLUTIONS = [
    "Route #1: 1 2 3\nRoute #2: 4 5 6\nCost 12\nComment x\n",
    "NAME : t\nTYPE : TOUR\nTOUR_SECTION\n1\n2\n3\n4\n5\n6\n7\n-1\nEOF\n",
    "NAME : t\nTYPE : OP\nDIMENSION : 7\nROUTE_NODES : 3\nROUTE_SCORE : 4\nNODE_SEQUENCE_SECTION\n1\n2\n3\n-1\nDEPOT_SECTION\n1\n-1\nEOF\n",
]


@FUZZ
@given(st.sampled_from(SOLUTIONS), st.integers(0, 60), st.integers(0, 8), st.sampled_from(TOKENS) | st.text(max_size=8))
def test_spoilt_routes_are_read_or_refused(base: str, at: int, length: int, token: str) -> None:
    instance: Any = generate("random", 1)
    try:
        made = routes_from_text(base[:at] + token + base[at + length :], instance.sites)
    except InputError as error:
        assert "\n" not in str(error)
        return
    assert all(1 <= site <= 6 for route in made.routes for site in route)


@pytest.mark.parametrize(
    "text",
    [
        "TYPE: CVRP\nDIMENSION: 2000000000\nCAPACITY: 5\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\nEOF\n",
        TSP.replace("DIMENSION: 4", "DIMENSION: 2000000000").replace("UPPER_ROW", "FULL_MATRIX"),
        TSP.replace("DIMENSION: 4", "DIMENSION: 99999999999999999"),
    ],
)
def test_a_claim_is_compared_and_never_allocated(text: str, tmp_path: Path) -> None:
    path = tmp_path / "huge.vrp"
    path.write_text(text)
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match="wrong number of"):
            read_instance(path)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("kind", "path", "value"),
    [
        ("sensing", "robots.count", 2_000_000_000), ("sensing", "targets.count", 10**17), ("sensing", "edges.target", [10**9, 1, 2]),
        ("facility-location", "function.items", 2_000_000_000), ("max-min", "variables", 2_000_000_000),
        ("max-min", "packing.rows", 2_000_000_000), ("coverage", "constraint.groups", [0, 10**9, 1]),
    ],
)  # fmt: skip
def test_a_claim_in_json_is_compared_and_never_allocated(kind: str, path: str, value: Any, tmp_path: Path) -> None:
    data = json.loads(json.dumps(PARSED[kind]))
    *above, last = path.split(".")
    part = data
    for key in above:
        part = part[key]
    part[last] = value
    if kind == "sensing":
        for names in ("robots", "targets"):
            data[names].pop("name", None)
    (tmp_path / "huge.json").write_text(json.dumps(data))
    tracemalloc.start()
    try:
        with pytest.raises(InputError):
            read_instance(tmp_path / "huge.json")
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


def test_a_file_beyond_the_limit_is_refused_without_being_parsed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(texts, "LARGEST_FILE", 100)
    path = tmp_path / "large.txt"
    path.write_text("x" * 101)
    with pytest.raises(InputError, match="is too large; expected at most 100 bytes"):
        read_instance(path)
