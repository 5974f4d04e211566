import json

import pytest

from waybound.reports.studies.findings import Finding
from waybound.reports.studies.study import STUDIES, Fault, Report, Study, StudySetting, broken, thinned
from waybound.reports.studies.violations import summary_lines
from waybound.reports.tables.table import Table


def test_common_faults_do_not_hide_rare_ones():
    faults = [Fault("ratio", f"r{k}", None, "a") for k in range(50)] + [Fault("bound", "b", None, "a")]
    kept = thinned(faults)
    assert [fault.message for fault in kept] == ["r0", "r1", "r2", "b"]
    lines = summary_lines(kept, [None, "file.json", None, None], 51)
    assert lines[1] == "ratio: r1; instance in file.json"
    assert lines[-1] == "and 47 more"


def test_faults_of_another_place_are_kept_apart():
    faults = [Fault("ratio", f"{where}{k}", None, where) for k in range(3) for where in "ab"]
    assert [fault.message for fault in thinned(faults, most=1)] == ["a0", "b0"]
    assert thinned([]) == ()


def test_a_study_runs_as_its_summary_says_unless_told_otherwise():
    asked = []

    def run(setting: StudySetting) -> Report:
        asked.append((setting.instances, setting.seed, setting.jobs))
        return Report("mine", "title", Table("title", (), ()))

    study = Study("mine", "one line", 40, run)
    study()
    study(seed=3)
    study(StudySetting(7, jobs=2), seed=5)
    assert asked == [(40, 1, 1), (40, 3, 1), (7, 5, 2)]


def test_a_report_is_plain_json_with_the_files_of_its_faults():
    made = Report(
        "mine", "title", Table("title", (), ()), ({"a": 1.5},), (), (Fault("ratio", "r"), Fault("bound", "b")), 9, done=3, asked=4
    )
    data = json.loads(json.dumps(made.to_json(("r.json", None))))
    assert data["faults"] == [{"kind": "ratio", "message": "r", "file": "r.json"}, {"kind": "bound", "message": "b", "file": None}]
    assert (data["num_faults"], data["rows"], data["done"], data["asked"], data["interrupted"]) == (9, [{"a": 1.5}], 3, 4, False)
    assert [f["file"] for f in made.to_json()["faults"]] == [None, None]
    with pytest.raises(ValueError):
        made.to_json(("only-one.json",))


def test_every_study_has_a_summary_of_one_line_and_something_to_do():
    for study in STUDIES.values():
        assert study.summary and "\n" not in study.summary and study.instances >= 1


def test_findings_that_must_hold_are_faults_if_they_do_not():
    good, bad = Finding.of_number("a", "1.0", 1.0), Finding.of_number("b", "1.0", 2.0)
    assert broken([good, bad])["num_faults"] == 1 and broken([good, bad])["faults"][0].message == "b: 2.000, published 1.0"
    assert broken([good]) == {"faults": (), "num_faults": 0}


def test_the_short_form_is_never_more_than_the_full_one():
    made = Study("mine", "one line", 3, lambda setting: Report("mine", "", Table("", (), ())), short=12)
    assert made.setting(full=False).instances == made.setting().instances == 3
    assert list(made.setting(seed=5).seeds) == [5, 6, 7]
