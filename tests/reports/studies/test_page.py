import pytest

from waybound.instances.errors import InputError
from waybound.reports.studies.findings import NOT, Finding
from waybound.reports.studies.page import SHOWN_OBSERVATIONS, page_of, write_page
from waybound.reports.studies.study import Fault, Report, Study, StudySetting
from waybound.reports.tables.table import Column, Table

FOUND = (Finding("a < number", "0.714", "0.8", NOT, "it is & was wrong"),)

REPORT = Report(
    "mine", "title", Table("values", (Column("x", right=True),), (("1.5",),)), ({"x": 1.5},),
    tuple({"seed": k} for k in range(SHOWN_OBSERVATIONS + 7)), (Fault("values", "off by one"),), 3, notes=("a note",), findings=FOUND,
    done=2, asked=5, interrupted=True,
)  # fmt: skip

STUDY = Study("mine", "plays something", 10, lambda setting: REPORT, source="Somebody (2001), Fig. 1", claim="all is well")


@pytest.fixture
def html():
    return page_of(STUDY, StudySetting(2, seed=3, full=False), REPORT).html()


def test_it_says_what_was_claimed_and_what_came_of_it(html):
    for words in ("Plays something.", "Somebody (2001), Fig. 1", "all is well", "a &lt; number", "0.714", "not reproduced",
                  "it is &amp; was wrong", "a note", "off by one", "and 2 violations more"):  # fmt: skip
        assert words in html


def test_it_says_how_much_of_it_was_done_and_how_to_do_it_again(html):
    assert "interrupted: 2 of 5 parts" in html and "waybound report mine --seed 3" in html
    assert "and 7 more; --out FOLDER writes all" in html


def test_it_is_written_whole_or_not_at_all(tmp_path):
    setting = StudySetting(2)
    assert write_page(STUDY, setting, REPORT, tmp_path / "new" / "page.html").read_text().startswith("<!doctype html>")
    (tmp_path / "folder.html").mkdir()
    with pytest.raises(InputError):
        write_page(STUDY, setting, REPORT, tmp_path / "folder.html")
