"""The table of a comparison as text."""

from __future__ import annotations

import waybound as wb
from waybound.reports.comparison import Compared, Comparison
from waybound.reports.tables.comparing import comparison_html, comparison_lines, comparison_table, plain_text


def failed(*names: str) -> Comparison:
    return Comparison(wb.read("demo-tiny"), tuple(Compared(name, None, f"{name} <broke>") for name in names))


def test_columns_are_aligned_and_numbers_stand_to_the_right() -> None:
    lines = plain_text(comparison_table(failed("a", "much-longer"))).split("\n")
    assert lines[1].startswith("method ")
    assert lines[2].index("error") == lines[3].index("error")


def test_rows_without_answers_say_so_and_nothing_is_proved() -> None:
    lines = comparison_lines(failed("a"))
    assert [line.label for line in lines] == ["best bound"]
    assert "none was verified" in lines[0].text


def test_html_is_escaped() -> None:
    assert "<broke>" not in comparison_html(failed("a")) and "&lt;broke&gt;" in comparison_html(failed("a"))
