import io
import zipfile
from pathlib import Path

import pandas as pd
import pytest
from file_cases import check_refused

import waybound as wb
from waybound.formulations import answer_tables
from waybound.formulations.answer_tables import first_sheet, frame_of, is_table, workbook
from waybound.instances.errors import InputError, MissingPackageError

VISITS = pd.DataFrame({"vehicle": ["v 1", "v 1", "v 2"], "position": [1, 2, 1], "site": ["a", "b", "c"]})


def test_a_table_of_visits_is_recognised_by_its_titles() -> None:
    assert is_table("vehicle,position,site\n") and is_table('"Site";"Vehicle"\n') and not is_table("Route #1: 1 2\n")


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_csv_keeps_ids_as_text_and_positions_as_numbers(delimiter: str) -> None:
    rows = [("v", "10", "007"), ("v", "2", "08")]
    made = frame_of("\n".join(delimiter.join(row) for row in [("vehicle", "position", "site"), *rows]) + "\n")
    assert made["site"].tolist() == ["007", "08"] and made["position"].tolist() == [10, 2]


def test_without_positions_the_rows_are_in_order() -> None:
    made = frame_of("vehicle,site,arrival\nv,b,10\nv,a,9\n")
    assert made["site"].tolist() == ["b", "a"] and made["position"].tolist() == [1, 2]


def test_a_workbook_comes_back_and_runs_no_formula() -> None:
    zoned = VISITS.assign(arrival=pd.Timestamp("2026-05-04 08:00", tz="Europe/Berlin"), note=["=1+1", "", ""])
    data = workbook({"visits": zoned, "routes": VISITS})
    assert first_sheet("a.xlsx", data)[["vehicle", "position", "site"]].astype({"position": int}).equals(VISITS)
    sheet = zipfile.ZipFile(io.BytesIO(data)).read("xl/worksheets/sheet1.xml").decode()
    assert "<f>" not in sheet


@pytest.mark.parametrize(("text", "message"), [("vehicle,site,position\nv,a,first\n", "column position must hold numbers")])
def test_broken_tables_are_refused(text: str, message: str) -> None:
    check_refused(InputError, message, frame_of, text)
    check_refused(InputError, r"a\.xlsx: is no workbook", first_sheet, "a.xlsx", b"PK\x03\x04 no more")


def test_without_openpyxl_the_cure_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answer_tables, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match="pip install openpyxl"):
        workbook({"visits": VISITS})


def test_every_file_that_save_writes_is_judged_the_same(tmp_path: Path) -> None:
    sites = pd.DataFrame({"id": ["yard", "a b", "c,d", "=e"], "lat": [45.0, 45.1, 45.2, 45.3], "lon": [9.0, 9.1, 9.0, 9.2]})
    mixed = wb.RoutingProblem.from_frame(sites, fleet=[{"name": "van", "count": 1}, {"name": "big truck", "fixed_cost": 1}])
    for problem in (wb.RoutingProblem.from_frame(sites), mixed):
        solution = wb.solve(problem, "highs", bound_time=0.0)
        for suffix in (".json", ".csv", ".xlsx", ".geojson", ".vroom", *([".sol"] if problem is not mixed else [])):
            path = tmp_path / f"answer{suffix}"
            solution.save(path)
            verdict = wb.judge(problem, path)
            assert verdict.feasible and verdict.objective == pytest.approx(solution.objective), suffix
