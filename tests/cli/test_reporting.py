"""``waybound ratio`` and ``waybound report``."""

import itertools
import signal

import pytest

import waybound as wb
from waybound import Guarantee, Selection
from waybound.cli.output import table_fits
from waybound.heuristics.heuristic import HEURISTICS, Heuristic, Outcome
from waybound.reports.ratios import guarantees
from waybound.reports.ratios.guarantees import GuaranteePlan, run_plan
from waybound.reports.ratios.judged_runs import Configuration
from waybound.reports.studies.risk import reward_stages, worked_example
from waybound.reports.studies.sata import local
from waybound.reports.studies.sata.families.selection import random_families
from waybound.reports.studies.study import STUDIES, Study
from waybound.reports.tables.table import Column, Table


@pytest.fixture
def bad_study(registered):
    """A study whose heuristic chooses nothing and states 1/2."""
    nothing = Guarantee(2.0, "f(S) >= f(OPT) / 2", (), "nowhere")
    features = frozenset({"function:coverage", "function:facility-location", "constraint:cardinality"})
    registered(
        HEURISTICS, "idle", Heuristic("idle", ("selection",), features, lambda p, s: Outcome(Selection(), nothing), "for tests", "1/2")
    )
    plan = GuaranteePlan((Configuration("idle", "idle", lambda problem: 2.0),), random_families("cardinality", 5)[:2])
    registered(STUDIES, "idle", Study("idle", "for tests", 10, lambda setting: run_plan("idle", "for tests", plan, setting), plan=plan))
    return "idle"


def test_without_a_study_all_are_listed(json_of, run):
    told = run("ratio", code=0)
    names = set(STUDIES.names())
    assert all(name in told.stdout for name in names)
    assert {study["name"] for study in json_of("ratio")["studies"]} == names


def test_an_unknown_study_is_refused_with_the_names_of_the_others(refused):
    told = refused("ratio", "greed")
    assert "choose from auction, " in told and "worked-example" in told


@pytest.mark.parametrize(
    "arguments", [("--instances", 0), ("--instances", -3), ("--jobs", 0), ("--seed", -1)], ids=lambda a: f"{a[0]} {a[1]}"
)
def test_numbers_out_of_range_are_refused(refused, arguments):
    assert arguments[0] in refused("ratio", "greedy-cardinality", *arguments)


def test_a_folder_that_is_a_file_is_refused_before_anything_runs(refused, tmp_path):
    (tmp_path / "here").write_text("")
    assert "is a file" in refused("ratio", "local", "--instances", 10**9, "--out", tmp_path / "here")


def test_a_study_prints_its_table(run):
    told = run("ratio", "greedy-partition", "--instances", 12, "-q", code=0)
    for words in ("planted-assignment", "stated", "2.0000", "faults", "ALG/OPT", "0.5000"):
        assert words in told.stdout
    assert told.stderr == ""


def test_json_is_one_object(json_of):
    data = json_of("ratio", "lazy-greedy", "--instances", 12, "--seed", 5, "-q")
    assert (data["schema"], data["seed"]) == (1, 5)
    (study,) = data["studies"]
    assert study["study"] == "lazy-greedy"
    assert study["num_faults"] == 0 and study["faults"] == [] and not study["interrupted"]
    assert all(row["min_ratio"] <= row["mean_ratio"] <= row["max_ratio"] <= row["stated_max"] * (1 + 1e-6) for row in study["rows"])


def test_out_writes_tables_and_figures(run, tmp_path):
    told = run("ratio", "greedy-cardinality", "--instances", 12, "--out", tmp_path / "new", "-q", code=0)
    assert {path.suffix for path in (tmp_path / "new").iterdir()} == {".csv", ".md", ".png"}
    assert "written: " in told.stdout


@pytest.mark.long  # every entry is compared in tests/ratios
def test_table_3_1_ends_well(run):
    told = run("ratio", "table-3-1", "-q", code=0)
    assert told.stdout.count("0.7591") == 4  # two entries of the table, printed and reproduced


def test_table_3_1_ends_with_5_when_an_entry_differs(run, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(local.PRINTED, 10, (0.5, 0.5, 0.7592, 0.2409, 0.2409, 0.7591))
    assert "p3" in run("ratio", "table-3-1", "-q", code=5).stderr


def test_a_broken_guarantee_ends_with_5_and_its_instance_is_in_a_file(run, bad_study, tmp_path, strict_json):
    told = run("ratio", bad_study, "--out", tmp_path, "--json", "-q", code=5)
    assert all(line.startswith("error: idle: ") for line in told.stderr.splitlines())
    (study,) = strict_json(told.stdout)["studies"]
    assert study["num_faults"] >= 5
    files = [fault["file"] for fault in study["faults"] if fault["kind"] == "ratio" and fault["file"]]
    assert files
    for file in files:
        problem = wb.read(file)
        assert problem.problem == "selection"
        assert any("stated 2" in note for note in problem.notes)
        assert wb.solve(problem, heuristic="greedy").objective > 0  # where the idle one has nothing


def test_without_a_folder_the_instances_are_written_where_one_stands(run, bad_study, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("ratio", bad_study, "-q", code=5)
    assert list(tmp_path.glob("violation-idle-*.json"))


@pytest.fixture
def interrupt(monkeypatch):
    """``interrupt(MODULE, name, number)``: Ctrl-C at the call of that number of a function."""

    def make(module, name, number):
        honest, calls = getattr(module, name), itertools.count(1)
        monkeypatch.setattr(module, name, lambda *given: honest(*given) if next(calls) < number else signal.default_int_handler(2, None))

    return make


def test_an_interrupt_shows_what_was_done_and_says_so(run, interrupt):
    interrupt(guarantees, "measure", 4)
    told = run("ratio", "greedy-partition", "--instances", 600, "-q", code=0)
    assert "interrupted: 3 of" in told.stderr and "coverage" in told.stdout


def test_an_interrupt_before_anything_was_done_ends_with_130(run, interrupt):
    interrupt(guarantees, "measure", 1)
    assert run("ratio", "greedy-partition", "-q").exit_code == 130


@pytest.mark.long
def test_all_runs_every_study_of_guarantees(run, strict_json):
    told = run("ratio", "all", "--instances", 40, "--jobs", 2, "--json", "-q", code=0)
    names = [study["study"] for study in strict_json(told.stdout)["studies"]]
    assert names == [study.name for study in STUDIES.values() if study.guarantees]


# -- waybound report -------------------------------------------------------------------------------------------------------


def test_without_a_study_reports_are_listed_with_their_sources(json_of, run):
    told = run("report", code=0)
    assert "Zhang (2015)" in told.stdout and "uncertain-roadmaps" in told.stdout
    listed = {study["name"]: study for study in json_of("report")["studies"]}
    assert set(listed) == set(STUDIES.names())
    assert listed["table-3-1"]["source"].startswith("Sung (2019)")


def test_an_unknown_report_is_answered_with_the_nearest(refused):
    assert "did you mean 'orchard'" in refused("report", "oarchard")


def test_a_report_shows_what_was_published_beside_ours(run):
    told = run("report", "worked-example", "-q", code=0)
    for words in ("Published and ours", "41.85 %", "41.8525 %", "reproduced", "47.16 %", "not reproduced"):
        assert words in told.stdout


def test_a_report_becomes_a_page(run, tmp_path):
    told = run("report", "risk-tables", "--out", tmp_path / "page.html", "-q", code=0)
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    assert "written: " in told.stdout
    html = (tmp_path / "page.html").read_text()
    assert "Xiao (2019)" in html and "<svg" in html and "http://" not in html.replace("http://www.w3.org", "")


def test_a_folder_gets_page_tables_and_figures(run, tmp_path):
    run("report", "orchard", "--out", tmp_path / "new", "--json", "-q", code=0)
    assert {path.name for path in (tmp_path / "new").iterdir()} == {
        "orchard.html", "orchard.csv", "orchard-observations.csv", "orchard.md", "orchard.png",
    }  # fmt: skip


def test_json_has_findings(json_of):
    (study,) = json_of("report", "cheapest-of-several", "-q")["studies"]
    assert {finding["verdict"] for finding in study["findings"]} <= {"sign reproduced", "cannot be compared"}
    assert len(study["rows"]) == 7


def test_pages_that_cannot_be_written_are_refused_before_anything_runs(refused, tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.html").mkdir()
    assert "is a file" in refused("report", "local", "--full", "--out", tmp_path / "file")
    assert "is a folder" in refused("report", "local", "--full", "--out", tmp_path / "folder.html")
    assert "is a file" in refused("report", "local", "--full", "--out", tmp_path / "file" / "page.html")
    assert "name a folder" in refused("report", "all", "--out", tmp_path / "page.html")


def test_a_value_that_is_not_the_published_one_ends_with_5(run, monkeypatch):
    monkeypatch.setattr(worked_example, "PRINTED", ("41.86 %", *worked_example.PRINTED[1:]))
    assert "risk of choice 1" in run("report", "worked-example", "-q", code=5).stderr


def test_an_interrupted_report_shows_and_writes_what_was_done(run, interrupt, tmp_path):
    interrupt(reward_stages, "stages", 4)
    told = run("report", "reward-stages", "--out", tmp_path / "page.html", "-q", code=0)
    assert "interrupted: 3 of 16 parts" in told.stderr and "share" in told.stdout
    assert "interrupted: 3 of 16 parts" in (tmp_path / "page.html").read_text()


def test_tables_too_wide_for_the_terminal_are_named(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    wide = Table("t", tuple(Column(f"column {k}", right=True) for k in range(5)), (("1",) * 5,))
    assert not table_fits(wide) and table_fits(Table("t", wide.columns[:3], (("1",) * 3,)))
    monkeypatch.setattr("waybound.cli.reporting.table_fits", lambda table: len(table.columns) > 4)
    assert "Risk of each choice: the chance that the cheapest path lies elsewhere: 4 columns, too wide" in run(
        "report", "worked-example", "-q", code=0
    ).stdout.replace("\n", " ")
