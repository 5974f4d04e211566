import csv
import math

import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.reports.ratios.figures import ratio_figure
from waybound.reports.studies.study import STUDIES, Fault, Report, StudySetting
from waybound.reports.studies.writing import check_folder, csv_text, markdown, png, write_report
from waybound.reports.tables.table import Column, Table


@pytest.fixture(scope="module")
def report() -> Report:
    return STUDIES["greedy-partition"](StudySetting(36))


def test_tables_observations_and_figures_are_written(report, tmp_path):
    folder = tmp_path / "deep" / "er"
    written = write_report(report, folder)
    assert sorted(path.name for path in written) == sorted(path.name for path in folder.iterdir())
    assert {path.name for path in written} == {
        "greedy-partition.csv", "greedy-partition-observations.csv", "greedy-partition.md", "greedy-partition.png",
    }  # fmt: skip


def test_the_csv_holds_the_rows_in_full(report, tmp_path):
    write_report(report, tmp_path)
    with (tmp_path / "greedy-partition.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["max_ratio"]) for row in rows] == [row["max_ratio"] for row in report.rows]
    with (tmp_path / "greedy-partition-observations.csv").open(newline="") as stream:
        assert len(list(csv.DictReader(stream))) == len(report.observations)


def test_the_markdown_has_one_row_a_line_of_the_table(report):
    lines = markdown(report).splitlines()
    assert sum(line.startswith("| greedy") for line in lines) == len(report.table.rows)
    assert "![greedy-partition](greedy-partition.png)" in lines


def test_markdown_tells_of_interrupts_and_faults():
    table = Table("t", (Column("a|b"),), (("x|y",),))
    told = markdown(Report("s", "title", table, faults=(Fault("ratio", "too bad"),), num_faults=3, done=1, asked=9, interrupted=True))
    for words in ("x\\|y", "interrupted: 1 of 9", "violation (ratio): too bad", "and 2 more"):
        assert words in told


def test_missing_values_are_empty_and_infinite_ones_are_named():
    assert csv_text([{"a": None, "b": math.inf}, {"b": 1, "c": "x,y"}]) == 'a,b,c\n,inf,\n,1,"x,y"\n'


def test_figures_are_the_same_for_the_same_report(report):
    (figure,) = report.figures
    first = png(figure)
    assert first.startswith(b"\x89PNG")
    assert first == png(figure)


def test_ratios_beyond_what_can_be_drawn_do_not_stop_the_figure(report):
    rows = [{**report.rows[0], "stated_min": None, "stated_max": None}]
    observations = [{**report.observations[0], "ratio": math.inf, "stated": None}]
    assert png(ratio_figure("name", "summary", rows, observations))


def test_a_folder_that_cannot_be_made_is_refused_before_anything_runs(tmp_path):
    (tmp_path / "file").write_text("")
    check_refused(UsageError, "is a file", check_folder, tmp_path / "file")
    check_refused(UsageError, "file is a file, not a folder", check_folder, tmp_path / "file" / "below")
    check_folder(tmp_path / "new" / "folder")
    assert not (tmp_path / "new").exists()
