import html.parser
import io
import pickle
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st
from rich.console import Console

import waybound as wb
from waybound.reports.tables.table import PLAIN_WIDTH, SHOWN_ROWS, Column, Listing, Table, short, table_html, table_plain


def test_every_entry_is_printable_and_only_wide_columns_are_long():
    table = Table("a\x1b[2Jb", (Column("site"), Column("reason", wide=True)), (("x\ny" + "z" * 900, "\u202ew" * 900),), ("\x07", ""))
    shown = [table.title, *table.rows[0], *table.total]
    assert all(text.isprintable() for text in shown)
    assert len(table.rows[0][0]) == 200 and len(table.rows[0][1]) == 1800


def test_quantities_have_at_most_three_decimals():
    assert [short(v) for v in (2.0, 1.23456, 1e12)] == ["2", "1.235", "1e+12"]


EVIL = "<script>alert('x')</script> & \x1b[31m"


class Cells(html.parser.HTMLParser):
    """Tags of a page, and the texts between them."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@given(st.lists(st.tuples(st.text(max_size=20), st.text(max_size=20)), min_size=1, max_size=5), st.text(max_size=10))
@settings(max_examples=50, deadline=None)
def test_no_text_of_a_table_becomes_html(rows: list[tuple[str, str]], title: str) -> None:
    table = Table(title, (Column("a <b>"), Column("b", wide=True)), tuple(rows), total=("<i>", ""))
    seen = Cells(table_html(table))
    assert set(seen.tags) <= {"table", "caption", "thead", "tbody", "tfoot", "tr", "th", "td"}
    assert [t for t in seen.texts if t] == [t for t in (table.title, "a <b>", "b", *(c for row in table.rows for c in row), "<i>") if t]


def test_long_tables_say_how_much_they_leave_out() -> None:
    table = Table("T", (Column("n", right=True),), tuple((str(k),) for k in range(SHOWN_ROWS + 7)))
    assert "and 7 more rows" in table_html(table)
    assert table_plain(table).endswith("and 7 more rows")
    assert Cells(table_html(table)).tags.count("td") == SHOWN_ROWS


def test_rows_after_the_first_ones_are_folded() -> None:
    table = Table("T", (Column("n"),), tuple((str(k),) for k in range(5)), most=2, rest="<b>ad rows")
    first, folded = table_html(table).split("<details><summary>and 3 &lt;b&gt;ad rows</summary>")
    assert (Cells(first).tags.count("td"), Cells(folded).tags.count("td")) == (2, 3)
    assert table_plain(table).count("\n") >= 5


def evil_problem() -> wb.RoutingProblem:
    import pandas as pd

    frame = pd.DataFrame({"id": ["depot", EVIL], "x": [0, 1], "y": [0, 1], "demand": [0, 3]})
    return wb.RoutingProblem.from_frame(frame, capacity=2, name=EVIL)


def shown() -> dict[str, Any]:
    """One of each kind of thing that a cell ends with, with names that are HTML where they can be."""
    problem = wb.read("demo-tiny")
    solution = wb.solve(problem, heuristic="savings", bound_time=0.5)
    return {
        "problem": evil_problem(), "solution": solution, "certificate": solution.certificate, "explanation": wb.explain(evil_problem()),
        "solvers": wb.solvers(), "solvers of a problem": wb.solvers(problem), "heuristics": wb.heuristics(problem),
    }  # fmt: skip


@pytest.fixture(scope="module")
def ends() -> dict[str, Any]:
    return shown()


@pytest.mark.parametrize("what", ["problem", "solution", "certificate", "explanation", "solvers", "solvers of a problem", "heuristics"])
def test_everything_that_a_cell_ends_with_shows_itself(ends: dict[str, Any], what: str) -> None:
    page = ends[what]._repr_html_()
    seen = Cells(page)
    assert set(seen.tags) <= {"table", "caption", "thead", "tbody", "tr", "th", "td", "details", "summary"}
    assert page.count("<table") == 1 + page.count("<details>")
    assert "\x1b" not in page
    screen = io.StringIO()
    Console(file=screen, width=100).print(ends[what])
    assert len(screen.getvalue().splitlines()) > 1
    text = repr(ends[what])
    assert "object at 0x" not in text and "\x1b" not in text
    assert all(len(line) <= PLAIN_WIDTH for line in text.splitlines()) or what in ("solution", "problem", "certificate", "explanation")


def test_a_problem_with_html_in_its_names_is_told_as_text(ends: dict[str, Any]) -> None:
    assert "<script>" not in ends["problem"]._repr_html_() + ends["explanation"]._repr_html_()
    assert "&lt;script&gt;" in ends["problem"]._repr_html_()


@pytest.mark.parametrize(
    "kind", ["sata", "coverage", "risk-allocation", "risky-grid", "prm-graph", "assignment", "robot-tasks", "orchard-day"]
)
def test_problems_of_every_family_show_what_they_hold(kind: str) -> None:
    problem = wb.generate(kind)
    seen = Cells(problem._repr_html_())
    assert problem.name in seen.texts and problem.digest() in seen.texts
    assert seen.tags.count("tr") >= 4


def test_explanations_read_as_text(ends: dict[str, Any]) -> None:
    assert repr(wb.explain(wb.read("demo-tiny", capacity=9))).splitlines()[1:] == [
        "verdict  there is no solution, according to the data",
        "site 3   its demand is 10, the capacity 9",
    ]


def test_lists_of_solvers_are_lists(ends: dict[str, Any]) -> None:
    able = [info.name for info in ends["solvers of a problem"] if not info.missing]
    assert "highs" in able
    assert isinstance(ends["solvers"], list) and len(ends["solvers"]) > 10
    assert pickle.loads(pickle.dumps(ends["solvers"])) == list(ends["solvers"])
    assert Listing([1, 2], lambda rows: Table("N", (Column("n"),), tuple((str(r),) for r in rows)))._repr_html_().count("<td") == 2


def test_as_text_a_table_is_not_shown_by_the_notebook_besides(monkeypatch: pytest.MonkeyPatch) -> None:
    """There ``rich`` would show it instead of writing it."""
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    assert "n" in table_plain(Table("N", (Column("n"),), (("1",),))).split()
