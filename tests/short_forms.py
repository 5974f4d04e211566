"""A study in its short form, run twice: findings, rows that the seed decides, and its page."""

from waybound.reports.studies.findings import LOST, NOT, REPRODUCED, SIGN, UNDECIDED
from waybound.reports.studies.page import page_of
from waybound.reports.studies.study import Report, Study


def short_form(study: Study) -> tuple[Report, str]:
    """What it brings back, and the page in HTML, after all that holds of every study was asserted."""
    setting = study.setting(full=False)
    report, again = study(setting), study(setting)
    assert report.rows and report.table.rows and report.num_faults == 0
    assert report.done == report.asked > 0 and not report.interrupted
    same = (report.rows, report.observations) == (again.rows, again.observations)
    assert same or repr(report.rows) == repr(again.rows)  # NaN equals nothing
    assert report.findings or study.claim.startswith("none")
    for finding in report.findings:
        assert finding.verdict in (REPRODUCED, SIGN, NOT, UNDECIDED, LOST)
        assert finding.what and finding.published and finding.ours
        assert (finding.why == "") == (finding.verdict in (REPRODUCED, SIGN)), finding
    assert all("second" not in key for row in (*report.rows, *report.observations) for key in row), "a row is what the seed gives"
    html = page_of(study, setting, report).html()  # with all figures
    assert study.source in html
    return report, html
