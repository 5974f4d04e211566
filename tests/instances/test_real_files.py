"""Real benchmark files: all of them are read, and their published values come out of our distances.

Two sources: the folder of WAYBOUND_BENCHMARKS, and the package VRPSolverEasy of the dev extra, which carries files of Solomon,
Gehring and Homberger and CVRPLIB, so that real files are read on any machine.
"""

import csv
import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from draws import ALL

from waybound.instances.errors import InputError
from waybound.instances.formats import FORMATS, waybound_json
from waybound.instances.reading import read_instance
from waybound.instances.routing.solution_files import routes_from_text
from waybound.instances.text import read_text

FAMILIES_READ = {
    "vrptw-solomon": (".txt", "vrptw"), "vrptw-homberger": (".txt", "vrptw"), "cvrp": (".vrp", "cvrp"), "tsplib": (".tsp", "tsp"),
    "op/tsiligirides1": (".txt", "orienteering"), "op/tsiligirides2": (".txt", "orienteering"),
    "op/tsiligirides3": (".txt", "orienteering"),
    "op/chao64": (".txt", "orienteering"), "op/chao66": (".txt", "orienteering"), "op": (".oplib", "orienteering"),
    "top": (".txt", "team-orienteering"), "toptw": (".txt", "team-orienteering"), "mdvrp-cordeau": (".txt", "mdvrp"),
    "minmax-mtsp": (".txt", "min-makespan-vrp"), "pdptw-lilim": (".txt", "pdptw"), "vrpspd-salhi": (".vrpspd", "cvrp"),
}  # fmt: skip
"""Below a folder: suffix of the instances, and the problem that is meant."""

FAMILIES = {"vrptw-solomon": ".txt", "vrptw-homberger": ".txt", "cvrp": ".vrp", "tsplib": ".tsp"}
CONVENTIONS = {"tsplib": "file", "tsplib-nint": "file", "euclidean-double": "exact", "dimacs-trunc1": "trunc1"}


@pytest.fixture(scope="session")
def wheel() -> Path:
    """Data of the package VRPSolverEasy, found without importing it."""
    spec = importlib.util.find_spec("VRPSolverEasy")
    if spec is None or not spec.submodule_search_locations:
        pytest.skip("VRPSolverEasy is not installed (dev extra): its real files are not tested here")
    folder = Path(spec.submodule_search_locations[0]) / "demos" / "data"
    assert folder.is_dir()
    return folder


def files_of(folder: Path, suffix: str) -> list[Path]:
    found = sorted(p for p in folder.rglob(f"*{suffix}") if p.is_file())
    assert found, f"no {suffix} file below {folder}"
    return found


@pytest.mark.share(2)
@pytest.mark.parametrize("family", FAMILIES_READ)
def test_every_benchmark_file_is_read_and_survives_json_and_its_own_format(
    family: str, benchmarks: Path, differences: Callable[..., list[str]]
) -> None:
    suffix, problem = FAMILIES_READ[family]
    for path in files_of(benchmarks / family, suffix)[:: 1 if ALL else 2]:
        if path.stem.endswith("_format"):
            continue
        if path.stem == "linhp318":
            with pytest.raises(InputError, match="FIXED_EDGES_SECTION is not supported; fixed edges make it another problem"):
                read_instance(path)
            continue
        made: Any = read_instance(path, problem=problem if family == "toptw" else None)
        assert made.problem == problem
        assert differences(made, waybound_json.read(waybound_json.write(made), path)) == [], path
        own = FORMATS[made.format]
        assert own.write is not None
        if family not in ("cvrp", "tsplib"):  # a .vrp file names its fleet otherwise, and a .tsp file its matrix
            assert differences(made, own.read(own.write(made), path)) == [], path


@pytest.mark.parametrize(("family", "size"), [("CVRPTW", 116), ("CVRP", 114)])
def test_every_file_of_the_wheel_is_read(family: str, size: int, wheel: Path) -> None:
    files = [p for p in files_of(wheel / family, "") if p.suffix in (".txt", ".vrp")]
    made: list[Any] = [read_instance(path) for path in files]
    assert len(made) >= size
    assert {m.problem for m in made} == {"vrptw" if family == "CVRPTW" else "cvrp"}
    if family == "CVRPTW":
        assert {len(m.sites) for m in made} == {101, 201}
        assert {m.fleet[0].count for m in made} == {25, 50}
    else:
        for m in made:
            assert len(m.sites) == int(m.name.split("-n")[1].split("-")[0])
            k = int(m.name.split("-k")[1])
            assert m.fleet[0].count == (None if m.name.startswith("X") else k)
            assert len(m.notes) == 1


def test_mixed_fleets_of_the_wheel_are_read(wheel: Path, differences: Callable[..., list[str]]) -> None:
    """Golden's files with Taillard's costs, and those of Pessoa, Sadykov and Uchoa; the names tell the customers."""
    files = [p for p in files_of(wheel / "HFVRP", "") if p.suffix in (".txt", ".vrp")]
    made: list[Any] = [read_instance(path) for path in files]
    assert {m.format: sum(m.format == o.format for o in made) for m in made} == {"taillard": 40, "vrplib": 22}
    for path, m in zip(files, made, strict=True):
        assert len(m.sites) == (int(m.name[1:].split("-")[0]) if m.format == "vrplib" else int(m.name[1:].split("_")[0]) + 1)
        assert m.problem == "cvrp" and len(m.fleet) >= 3
        if m.format == "taillard":
            assert differences(m, FORMATS["taillard"].read(FORMATS["taillard"].write(m), path)) == []  # type: ignore[misc]


def test_both_sources_hold_the_same_files(wheel: Path, benchmarks: Path, differences: Callable[..., list[str]]) -> None:
    ours = {p.stem: p for suffix in (".txt", ".vrp") for f in ("vrptw-solomon", "cvrp") for p in (benchmarks / f).rglob(f"*{suffix}")}
    shared = [p for f in ("CVRPTW", "CVRP") for p in (wheel / f).rglob("*") if p.is_file() and p.stem in ours]
    assert len(shared) > 100
    for path in shared:
        assert differences(read_instance(path), read_instance(ours[path.stem])) == [], path.stem


def rows(benchmarks: Path) -> Iterator[dict[str, str]]:
    with (benchmarks / "bks.csv").open(newline="") as stream:
        for row in csv.DictReader(stream):
            if row["solution_file"] and row["family"].split("/")[0] in FAMILIES:
                yield row


@pytest.mark.slow
def test_every_published_solution_costs_what_its_row_says(benchmarks: Path) -> None:
    """Distances alone, summed here: loads, windows and fleets belong to the judge and its tests."""
    count = {"tsplib": 0, "cvrp": 0, "vrptw-solomon": 0, "vrptw-homberger": 0}
    for row in rows(benchmarks):
        family = row["family"].split("/")[0]
        folder = benchmarks / row["family"]
        instance: Any = read_instance(next(folder.rglob(row["instance"] + FAMILIES[family])))
        solution = routes_from_text(read_text(next(folder.rglob(row["solution_file"]))), instance.sites)
        visited = sorted(site for route in solution.routes for site in route)
        assert visited == instance.sites.customers.tolist(), row["solution_file"]
        travel = instance.travel.with_convention(CONVENTIONS[row["convention"]])
        depot = instance.sites.depots[0]
        paths = [np.array([depot, *route, depot]) for route in solution.routes]
        length = sum(float(travel.distance(p[:-1], p[1:]).sum()) for p in paths)
        digits = len(row["value"].partition(".")[2])
        assert abs(length - float(row["value"])) <= 0.5 * 10.0**-digits + 1e-6, (row["solution_file"], length, row["value"])
        if solution.cost is not None:
            assert abs(length - solution.cost) < 0.01
        count[family] += 1
    assert all(count.values()), count


def test_half_to_even_rounding_would_give_the_lower_values_that_the_sources_warn_of(benchmarks: Path) -> None:
    """F-n45-k4 has distances of exactly x.5: 724 with floor(d + 0.5), 721 with Python's own rounding."""
    instance: Any = read_instance(benchmarks / "cvrp" / "F" / "F-n45-k4.vrp")
    solution = routes_from_text(read_text(benchmarks / "cvrp" / "F" / "F-n45-k4.sol"), instance.sites)
    exact = instance.travel.with_convention("exact")
    costs = {"floor": 0.0, "even": 0.0}
    for route in solution.routes:
        p = np.array([0, *route, 0])
        costs["floor"] += float(instance.travel.distance(p[:-1], p[1:]).sum())
        costs["even"] += float(np.round(exact.distance(p[:-1], p[1:])).sum())
    assert costs["floor"] == 724
    assert costs["even"] < 724


@pytest.mark.slow
def test_the_package_vrplib_reads_the_same_numbers_where_it_can(benchmarks: Path) -> None:
    vrplib = pytest.importorskip("vrplib", reason="vrplib is not installed: the readers are not compared")
    for path in files_of(benchmarks / "cvrp", ".vrp"):
        theirs = vrplib.read_instance(path)
        ours: Any = read_instance(path)
        assert theirs["capacity"] == ours.fleet[0].capacity
        assert theirs["demand"].tolist() == ours.sites.demand.tolist()
        assert theirs["depot"].tolist() == ours.sites.depots.tolist()
        exact = ours.travel.distances if ours.travel.metric == "EXPLICIT" else ours.travel.with_convention("exact").distances
        assert np.allclose(theirs["edge_weight"], exact, rtol=0, atol=1e-4)
    for path in files_of(benchmarks / "vrptw-solomon", ".txt"):
        theirs = vrplib.read_instance(path, instance_format="solomon")
        ours = read_instance(path)
        assert (theirs["vehicles"], theirs["capacity"]) == (ours.fleet[0].count, ours.fleet[0].capacity)
        assert theirs["time_window"].tolist() == np.column_stack([ours.sites.ready, ours.sites.due]).tolist()
        assert theirs["service_time"].tolist() == ours.sites.service.tolist()


@pytest.mark.parametrize("name", ["X-n101-k25", "A-n32-k5"])
def test_every_cut_of_a_real_file_is_refused(name: str, benchmarks: Path, tmp_path: Path) -> None:
    text = next(benchmarks.rglob(f"{name}.vrp")).read_text()
    end = text.index("-1", text.index("DEPOT_SECTION")) + 2
    path = tmp_path / f"{name}.vrp"
    for length in [*range(60, end, 97), end - 1, end]:
        path.write_text(text[:length])
        with pytest.raises(InputError):
            read_instance(path)


@pytest.mark.parametrize(
    ("path", "format_name"),
    [("top/set1/p1.2.c.txt", None), ("mdvrp-cordeau/p01.txt", None), ("toptw/c101.txt", "toptw"), ("toptw/pr01.txt", None),
     ("op/chao64/set_64_1_15.txt", None), ("op/oplib-gen1/att48-gen1-50.oplib", None)],
)  # fmt: skip
def test_every_cut_between_two_numbers_of_a_file_is_refused(path: str, format_name: str | None, benchmarks: Path, tmp_path: Path) -> None:
    text = (benchmarks / path).read_text().replace("\r", "")
    end = text.index("-1", text.index("DEPOT_SECTION")) if "DEPOT_SECTION" in text else len(text.rstrip()) - len(text.rstrip().split()[-1])
    cut = tmp_path / Path(path).name
    for length in [*range(1, end, 97), end]:
        cut.write_text(text[:length])
        with pytest.raises(InputError):
            read_instance(cut, format_name)


def test_every_cut_of_a_solomon_file_is_refused(benchmarks: Path, tmp_path: Path) -> None:
    text = (benchmarks / "vrptw-solomon" / "C101.txt").read_text()
    path = tmp_path / "C101.txt"
    complete = len(text.rstrip())
    short = [text.index("\n", text.index(f"\n  {k:3d} ") + 1) for k in (25, 50)]
    for length in [*range(60, complete, 53), complete - 1, *(k + 1 + 30 for k in short)]:
        path.write_text(text[:length])
        if any(k - 4 <= length <= k + 1 for k in short):
            continue  # the first 25 and 50 customers are instances of their own
        with pytest.raises(InputError):
            read_instance(path)
    path.write_text(text[:complete])
    assert len(read_instance(path).sites) == 101  # type: ignore[attr-defined]
