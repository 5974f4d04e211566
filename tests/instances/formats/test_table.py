import pytest
from file_cases import check_fault, error_of

from waybound.instances.formats.table import delimiter_of, settings_of, table_of, titles_of, written

COLUMNS = ("id", "x", "y")


@pytest.mark.parametrize(("line", "mark"), [("a,b", ","), ("a;b,c;d", ";"), ("a\tb", "\t"), ("a|b|c", "|"), ("a", ",")])
def test_the_delimiter_is_the_mark_that_occurs_most(line: str, mark: str) -> None:
    assert delimiter_of(line) == mark


def test_titles_are_those_of_the_first_line_that_is_no_comment() -> None:
    assert titles_of('\n# name: x\n  # a remark\n "ID"; X ;y\n1;2;3') == {"id", "x", "y"}
    assert titles_of("# only\n\n") == titles_of("") == frozenset()


def test_settings_have_their_line_and_remarks_are_passed_over() -> None:
    text = "# a remark\n\n#Max_Load: 7 : 8\n# name:  two words \nid,x\n# later: 1"
    assert settings_of(text, ("max-load", "name"), COLUMNS) == ({"max-load": (3, "7 : 8"), "name": (4, "two words")}, 4)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("# colour: red\nid", 1, "setting 'colour' is unknown; expected name"),
        ("# name: a\n# NAME: b\nid", 2, "setting name stands twice, first in line 1"),
        ("\n# name:  \nid", 2, "setting name has no value"),
        ("# name: a\n\n", None, "holds no table; expected a line of titles out of id, x, y"),
    ],
)
def test_a_fault_in_the_settings_is_refused_with_its_line(text: str, line: int | None, words: str) -> None:
    check_fault(error_of(settings_of, text, ("name",), COLUMNS), words, line)


def test_cells_are_stripped_rows_keep_their_line_and_empty_ones_are_no_rows() -> None:
    table = table_of('# s: 1\nX, ID\n\n 1 ,"a, b"\n,\n"2\n3", c\n', 1, COLUMNS, "sites")
    assert table.titles == ["x", "id"]
    assert table.rows == [["1", "a, b"], ["2\n3", "c"]]
    assert table.at == [4, 7]
    assert table.column("id") == ["a, b", "c"] and table.column("y") is None


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("id,z\n1,2", 1, "column 'z' is unknown; expected id, x, y"),
        ("id,x,ID\n1,2,3", 1, "column id stands twice"),
        ("id,x\n1,2\n3", 3, "row has a wrong length; expected 2 values; found 1 values"),
        ("id,x\n1,2\n3,4,5", 3, "expected 2 values; found 3 values"),
        ('id,x\n1,"2', 2, "is no CSV"),
        ("id,x\n\n,\n", 1, "holds no sites"),
    ],
)
def test_a_fault_in_the_table_is_refused_with_its_line(text: str, line: int, words: str) -> None:
    check_fault(error_of(table_of, text, 0, COLUMNS, "sites"), words, line)


def test_what_is_written_reads_back() -> None:
    text = written([("name", "two words")], ["id", "x"], [["a, b", "1"], ['say "c"', "2"]])
    assert text == '# name: two words\nid,x\n"a, b",1\n"say ""c""",2\n'
    settings, start = settings_of(text, ("name",), COLUMNS)
    assert settings == {"name": (1, "two words")}
    assert table_of(text, start, COLUMNS, "sites").rows == [["a, b", "1"], ['say "c"', "2"]]
