import waybound as wb
from waybound.reports.comparison import Compared, Comparison
from waybound.reports.tables.comparison import comparison_lines


def failed(*names: str) -> Comparison:
    return Comparison(wb.read("demo-tiny"), tuple(Compared(name, None, f"{name} <broke>") for name in names))


def test_columns_are_aligned_and_numbers_stand_to_the_right() -> None:
    shown = [line.strip() for line in str(failed("a", "much-longer")).split("\n")]
    assert [line for line in shown if line.startswith("method ")]
    a, longer = (next(line for line in shown if line.startswith(name)) for name in ("a ", "much-longer "))
    assert a.index("error") == longer.index("error")


def test_rows_without_answers_say_so_and_nothing_is_proved() -> None:
    lines = comparison_lines(failed("a"))
    assert [line.label for line in lines] == ["best bound"]
    assert "none was verified" in lines[0].text


def test_html_is_escaped() -> None:
    page = failed("a")._repr_html_()
    assert "<broke>" not in page and "&lt;broke&gt;" in page
