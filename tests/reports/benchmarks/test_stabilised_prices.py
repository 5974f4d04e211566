"""A row for each file and way, and exit code 1 where bounds differ."""

from pathlib import Path

import pytest
from file_cases import tsplib
from small_routing import plane

from waybound.reports.benchmarks import stabilised_prices as benchmark
from waybound.reports.benchmarks.stabilised_prices import main

SMALL = tsplib(
    "NAME : a", "TYPE : CVRP", "DIMENSION : 3", "EDGE_WEIGHT_TYPE : EUC_2D", "CAPACITY : 5", NODE_COORD_SECTION="1 0 0|2 3 4|3 6 8",
    DEMAND_SECTION="1 0|2 2|3 3", DEPOT_SECTION="1|-1",
) + "EOF\n"  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(benchmark, "found", lambda folder, name: plane(int(name), 12, 25.0))
    return tmp_path


def test_all_ways_are_run_and_have_one_bound(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--folder", str(folder), "--file", "3", "4", "--seconds", "30"]) == 0
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[1] for row in rows] == 2 * ["trust-region", "smoothing", "none"]
    assert len({row[5] for row in rows[:3]}) == 1 and all(float(row[6].rstrip(" |")) > 0.0 for row in rows)


def test_another_bound_fails(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    root = benchmark.root
    monkeypatch.setattr(benchmark, "root", lambda problem, kind: (root(problem, kind)[0], 1.0 + (kind == "none")))
    assert main(["--folder", str(folder), "--file", "3", "--seconds", "0"]) == 1


def test_files_are_found_in_either_folder(tmp_path: Path) -> None:
    (tmp_path / "cvrp" / "A").mkdir(parents=True)
    (tmp_path / "cvrp" / "A" / "a.vrp").write_text(SMALL)
    assert len(benchmark.found(tmp_path, "a").customers) == 2
