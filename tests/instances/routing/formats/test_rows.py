import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.routing.formats._rows import Rows, head, widths


def test_the_head_of_a_text_is_its_first_lines_that_are_not_blank() -> None:
    assert head("\n 1  2\n\n3\tx\n4\n", 2) == [["1", "2"], ["3", "x"]]
    assert head("1 2", 3) == [["1", "2"]]
    assert head("\n\n", 3) == []
    assert widths(head(" 1 -2.5\nx 3\nnan", 3)) == [2, -1, -1]


def test_lines_are_read_one_after_the_other_with_their_numbers() -> None:
    rows = Rows.of("\nn 4\n1 2\n\n3 4\n5 6\n")
    assert rows.keyed("n") == (2, "4")
    assert rows.values("point", ("x", "y")) == (3, [1.0, 2.0])
    table, at = rows.table("point", ("x", "y"), 2)
    assert (table.tolist(), at) == ([[3.0, 4.0], [5.0, 6.0]], [5, 6])
    rows.end()
    with pytest.raises(InputError, check=coded("missing")) as caught:
        rows.next("a point")
    assert (caught.value.line, caught.value.expected) == (6, "a point")


def test_a_table_without_rows_keeps_its_width() -> None:
    rows = Rows.of("1 2")
    rows.next("head")
    assert rows.table("point", ("x", "y"))[0].shape == (0, 2)


def test_what_is_left_over_is_refused_with_its_line() -> None:
    with pytest.raises(InputError, check=coded("malformed")) as caught:
        Rows.of("1 2\n3\n").end()
    assert (caught.value.line, caught.value.found) == (1, "'1 2'")


@pytest.mark.parametrize(("count", "line"), [(1, 2), (3, 2)])
def test_a_claimed_number_of_rows_is_compared(count: int, line: int) -> None:
    with pytest.raises(InputError, match="wrong number of rows: point") as caught:
        Rows.of("1 2\n3 4\n").table("point", ("x", "y"), count)
    assert (caught.value.line, caught.value.expected, caught.value.found) == (line, str(count), "2")


def test_a_key_that_is_missing_is_named() -> None:
    with pytest.raises(InputError, check=coded("missing")) as caught:
        Rows.of("time 4\n").keyed("tmax")
    assert caught.value.expected == "tmax and its value"
