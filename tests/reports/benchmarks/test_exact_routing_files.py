"""Benchmark files and their provers: each run, its result in a file, and the tables that are printed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import waybound as wb
from waybound.formulations.evidence import Evidence
from waybound.instances.writing import write_instance
from waybound.reports.benchmarks import exact_routing_files as benchmark
from waybound.reports.benchmarks.exact_routing_files import (
    SETS,
    Results,
    Task,
    apart,
    excluded,
    files,
    first_level,
    gap,
    main,
    run_all,
    seconds_for_bounds,
    summary,
    table,
    told,
)

SMALL = """NAME : a
TYPE : CVRP
DIMENSION : 5
EDGE_WEIGHT_TYPE : EUC_2D
CAPACITY : 5
NODE_COORD_SECTION
1 0 0
2 3 4
3 6 8
4 0 7
5 9 0
DEMAND_SECTION
1 0
2 2
3 3
4 2
5 3
DEPOT_SECTION
1
-1
EOF
"""

HEADS = "family,instance,convention,objective,vehicles,value\n"


def task(file: str = "a", solver: str = "auto", path: Path = Path("a.json"), seconds: float = 1.0, bound: float = 0.5) -> Task:
    return Task("cvrp", file, str(path), {}, solver, seconds, bound)


def result(value: float | None = 10.0, bound: float | None = 10.0, status: str = "proved", **more: Any) -> dict[str, Any]:
    return {"cpu": 2.0, "value": value, "bound": bound, "status": status, "kind": "verified", "verified": bound, **more}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Files of three sets, and rows of their best values."""
    for name in ("vrptw-solomon/R101.txt", "vrptw-solomon/R101.dimacs.sol", "vrptw-solomon/RC208.txt", "cvrp/A/a.vrp", "cvrp/F/f.vrp",
                 *(f"top/set{k}/p{k}.{m}.txt" for k in (1, 2) for m in range(30))):  # fmt: skip
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    rows = ["vrptw-solomon,R101,dimacs-trunc1,distance,,1637.7", "vrptw-solomon,R101,euclidean-double,distance,,1642.88"]
    rows += ["cvrp/A,a,tsplib-nint,distance (fleet unlimited),,9", "cvrp/A,a,tsplib-nint,distance (at most k=3 routes),3,10"]
    rows += [f"top/set{k},p{k}.{m},euclidean-double,score(max),2,{m}" for k in (1, 2) for m in range(30)]
    (tmp_path / "bks.csv").write_text(HEADS + "\n".join(rows) + "\n")
    return tmp_path


# -- what is run -------------------------------------------------------------------------------------------------------------


def test_files_are_those_that_are_there_with_the_values_of_their_convention_and_fleet(folder: Path) -> None:
    def held(name: str) -> dict[str, float | None]:
        return {path.stem: value for path, value in files(folder, name).items()}

    assert held("solomon-100-first") == {"R101": 1637.7}
    assert held("solomon-100-second") == {"RC208": None}
    assert held("solomon-25") == {"R101": None, "RC208": None}  # of a part of a file nobody published a value
    assert held("cvrp") == {"a": 10.0}
    assert held("homberger-200") == {}


def test_what_is_drawn_has_a_value_and_is_drawn_alike(folder: Path) -> None:
    drawn = files(folder, "team-orienteering")
    assert len(drawn) == 40 and all(drawn.values())
    assert list(drawn) == list(files(folder, "team-orienteering"))


@pytest.mark.parametrize("name", SETS)
def test_real_files_of_each_set_are_found(name: str, benchmarks: Path) -> None:
    found = files(benchmarks, name)
    assert len(found) >= 10
    assert all(value is None for value in found.values()) == (not SETS[name].row)


def test_who_proves_nothing_leaves_time_for_bounds() -> None:
    assert seconds_for_bounds("auto", 100.0, 0.1) == seconds_for_bounds("pyvrp", 100.0, 0.1) == 90.0
    assert seconds_for_bounds("highs", 100.0, 0.1) == seconds_for_bounds("vrpsolver", 100.0, 0.1) == 0.0


@pytest.mark.slow
def test_a_run_goes_on_in_a_process_of_its_own_and_a_fault_in_it_is_a_line(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_instance(wb.generate("random", customers=6, capacity=40).to_instance(), path)
    ran = apart(task(path=path, seconds=2.0, bound=1.8))
    assert ran["status"] in ("proved", "gap") and ran["kind"] == "verified" and ran["cpu"] > 0.0
    assert "no such file" in apart(task(path=tmp_path / "b.json"))["fault"].lower()


def test_what_is_told_of_a_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = wb.generate("random", customers=5, capacity=40)
    solution = wb.solve(problem, "highs", bound_time=0)
    assert told(problem, solution) == {
        "value": solution.objective, "bound": solution.bound, "status": "proved", "kind": "claimed", "verified": None, "leaves": None,
        "check": None, "limit": "none", "message": solution.message,
    }  # fmt: skip
    tree = Evidence("branching-tree", "made up", 1.0, {"nodes": [{"branch": []}, {"kind": "x", "data": {}}, {}]})
    monkeypatch.setitem(solution.certificate.__dict__, "evidence", (tree,))
    monkeypatch.setattr(benchmark, "proved_bound", lambda problem, evidence: 1.0)
    assert (told(problem, solution)["leaves"], told(problem, solution)["check"]) == (2, 0.0)
    assert first_level([3.0, 4.0]) == 3.0 and first_level(None) is first_level(float("inf")) is None


# -- what is kept ------------------------------------------------------------------------------------------------------------


def test_runs_that_are_there_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []
    monkeypatch.setattr(benchmark, "apart", lambda task: ran.append(task.file) or result())
    out = tmp_path / "out.jsonl"
    run_all([task("a"), task("b")], Results(out), 1)
    with out.open("a") as stream:
        stream.write('{"set": "cvrp", "file": "c", "sol')  # what a killed command may leave
    again = Results(out)
    run_all([task("a"), task("b"), task("c"), task("a", seconds=2.0)], again, 2)
    assert sorted(ran) == ["a", "a", "b", "c"]
    assert len(Results(out).of) == 4 and again.of.keys() == Results(out).of.keys()
    assert json.loads(out.read_text().splitlines()[0]) == {"set": "cvrp", "file": "a", "solver": "auto", "seconds": 1.0, **result()}


def test_an_interrupt_keeps_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(task: Task) -> dict[str, Any]:
        if task.file == "b":
            raise KeyboardInterrupt
        return result()

    monkeypatch.setattr(benchmark, "apart", run)
    out = tmp_path / "out.jsonl"
    with pytest.raises(SystemExit, match="the same command goes on"):
        run_all([task("a"), task("b"), task("c")], Results(out), 1)
    assert [key[1] for key in Results(out).of] == ["a"]


# -- what is told ------------------------------------------------------------------------------------------------------------

RUNS = {
    "a": {"one": result(), "other": result(kind="claimed", cpu=8.0, verified=None)},
    "b": {"one": result(bound=9.0, status="gap", cpu=9.0), "other": result(None, None, "none")},
    "c": {"one": {"fault": "ended with code -11: "}, "other": result(11.0)},
}


def test_each_file_has_a_row() -> None:
    assert gap(result(bound=9.0)) == pytest.approx(10.0) and gap(result(None)) is None
    assert table(("one", "other"), {file: (None if file == "b" else 10.0, of) for file, of in RUNS.items()}) == [
        "| file | best known | `one` value | `one` bound | `one` gap | `one` CPU s | `one` proved | `other` value | `other` bound "
        "| `other` gap | `other` CPU s | `other` proved |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
        "| a | 10 | 10 | 10 | 0.00 % | 2.0 | verified | 10 | 10 | 0.00 % | 8.0 | claimed |",
        "| b |  | 10 | 9 | 10.00 % | 9.0 |  |  |  |  | 2.0 |  |",
        "| c | 10 |  |  |  |  | ended with code -11:  | 11 | 10 | 9.09 % | 2.0 | verified |",
    ]


def test_a_set_is_summed_up() -> None:
    assert summary(("one", "other"), {"few": list(RUNS.values()), "none": [RUNS["b"]]})[2:] == [
        "| few | one | 3 | 1 | 1 | 10.00 % | 2.0 (1) |", "| few | other | 3 | 2 | 1 | 9.09 % | 8.0 (1) |",
        "| none | one | 1 | 0 | 0 | 10.00 % |  |", "| none | other | 1 | 0 | 0 | none |  |",
    ]  # fmt: skip


def test_a_verified_bound_may_not_exclude_the_value_known() -> None:
    assert excluded(10.0, result(bound=10.1), most=False) and not excluded(10.0, result(bound=9.9), most=False)
    assert excluded(10.0, result(bound=9.9), most=True) and not excluded(10.0, result(bound=10.1), most=True)
    assert not excluded(None, result(), most=False) and not excluded(10.0, {"fault": "it fails"}, most=False)


def test_wrong_words_end_in_a_line(folder: Path) -> None:
    with pytest.raises(SystemExit, match=r"error: .*'nobody'"):
        main(["--folder", str(folder), "--set", "cvrp", "--solver", "nobody"])
    with pytest.raises(SystemExit, match="error: there are no such files"):
        main(["--folder", str(folder), "--set", "homberger-200"])


@pytest.mark.slow
def test_the_whole_command_proves_a_file_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "cvrp" / "A"
    place.mkdir(parents=True)
    (place / "a.vrp").write_text(SMALL)
    (tmp_path / "bks.csv").write_text(HEADS + "cvrp/A,a,tsplib-nint,distance,,1\n")
    words = ["--folder", str(tmp_path), "--set", "cvrp", "--solver", "highs", "--seconds", "5", "--out", str(tmp_path / "out.jsonl")]
    assert main(words) == 0
    first = capsys.readouterr()
    assert "1 of 1: cvrp, a, highs: proved" in first.err and "### cvrp, 5 s" in first.out and "| cvrp | highs | 1 | 1 | 0 |" in first.out
    assert main(words) == 0
    assert capsys.readouterr() == (first.out, "")


@pytest.mark.long
def test_a_file_of_25_customers_is_proved_with_evidence(benchmarks: Path) -> None:
    path = benchmarks / "vrptw-solomon" / "R101.txt"
    ran = apart(Task("solomon-25", "R101", str(path), SETS["solomon-25"].settings, "auto", 20.0, 18.0))
    assert (ran["status"], ran["kind"], ran["value"]) == ("proved", "verified", pytest.approx(617.1))
