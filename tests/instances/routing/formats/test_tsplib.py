"""Scanning of TSPLIB-like text: headers, sections, tables of nodes, lists and matrices, each fault with its line."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.routing.formats._tsplib import FLEET_IN_NAME, SET_X, Specification, edge_weights, node_list, node_table, scan


def fault(call: Callable[..., Any], *given: Any) -> tuple[int | None, str]:
    with pytest.raises(InputError) as caught:
        call(*given)
    return caught.value.line, str(caught.value)


def section(name: str, *rows: str) -> Specification:
    return scan("\n".join([name, *rows, "EOF"]))


# -- headers and sections ----------------------------------------------------------------------------------------------


def test_headers_and_sections_keep_their_lines_and_nothing_is_read_after_the_end() -> None:
    spec = scan("Name : a b : c\n\nCOMMENT : one\nCOMMENT : two\nDEMAND_SECTION :\n1 0\n 2  5 \nDEPOT_SECTION\n1 -1\neof :\nrubbish !\n")
    assert spec.headers == {"NAME": (1, "a b : c"), "COMMENT": (4, "two")}
    assert spec.value("NAME") == "a b : c" and spec.line("NAME") == 1 and spec.value("TYPE", "TSP") == "TSP"
    assert [(s.line, s.rows) for s in spec.sections.values()] == [(5, [(6, "1 0"), (7, "2  5")]), (8, [(9, "1 -1")])]
    assert spec.end == 10


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("NAME : a\nNAME : b\nEOF\n", 2, "header NAME stands twice, first in line 1"),
        ("DEMAND_SECTION\n1 0\nDEMAND_SECTION\nEOF\n", 3, "DEMAND_SECTION stands twice, first in line 1"),
        ("1 2\nEOF\n", 1, "neither a header nor a section"),
        ("NAME : a\n1 2\nEOF\n", 2, "neither a header nor a section"),
        ("NAME a\nEOF\n", 1, "line is not understood; expected a header or a section"),
        ("DEMAND_SECTION\none 2\nEOF\n", 2, "expected numbers of DEMAND_SECTION"),
        ("NAME : a\nDEMAND_SECTION\n1 0", 3, "ends early: the last line is not ended, and EOF is missing"),
    ],
)
def test_a_line_that_is_not_understood_is_refused(text: str, line: int, words: str) -> None:
    found, message = fault(scan, text)
    assert found == line and words in message


def test_what_is_missing_is_told_with_the_last_line() -> None:
    spec = scan("NAME :\nDIMENSION : 3\n\n")
    assert spec.whole("DIMENSION") == 3
    assert fault(spec.value, "TYPE") == (2, "line 2: header TYPE is missing; expected TYPE : ...; found the end of the file")
    assert fault(spec.value, "NAME") == (1, "line 1: NAME has no value")
    assert fault(spec.section, "DEMAND_SECTION")[0] == 2
    assert "DIMENSION" in fault(scan("DIMENSION : 2.5\n").whole, "DIMENSION")[1]
    assert "DIMENSION" in fault(scan("DIMENSION : 0\n").whole, "DIMENSION")[1]


def test_what_would_be_dropped_is_refused_and_fixed_edges_say_why() -> None:
    spec = scan("NAME : a\nCOLOUR : red\nFIXED_EDGES_SECTION\n1 2\n-1\nEOF\n")
    spec.refuse_unknown({"NAME", "COLOUR"}, {"FIXED_EDGES_SECTION"})
    assert fault(spec.refuse_unknown, {"NAME"}, {"FIXED_EDGES_SECTION"}, " in a TSP") == (
        2, "line 2: header 'COLOUR' is not supported in a TSP; expected NAME",
    )  # fmt: skip
    line, words = fault(spec.refuse_unknown, {"NAME", "COLOUR"}, {"DEMAND_SECTION"})
    assert line == 3 and "another problem, with another optimum" in words


# -- tables of nodes ---------------------------------------------------------------------------------------------------


def test_nodes_come_in_any_order_and_the_section_may_end_as_a_list_does() -> None:
    values, lines = node_table(section("NODE_COORD_SECTION", "3 5 6", "1 1 2", "2 3 4", "-1"), "NODE_COORD_SECTION", 3, ("x", "y"))
    assert values.tolist() == [[1, 2], [3, 4], [5, 6]] and lines.tolist() == [3, 4, 2]


@pytest.mark.parametrize(
    ("rows", "line", "words"),
    [
        (["1 0"], 2, "wrong number of rows; expected 2 (DIMENSION); found 1"),
        ([], 1, "expected 2 (DIMENSION); found 0"),
        (["1 0", "2 0", "3 0"], 4, "found 3"),
        (["1 0", "2"], 3, "row of DEMAND_SECTION has a wrong length; expected node, demand; found 1 values"),
        (["1 0", "3 0"], 3, "names a node that does not exist"),
        (["0 0", "1 0"], 2, "names a node that does not exist"),
        (["1 0", "1.5 0"], 3, "names a node that does not exist"),
        (["2 0", "2 0"], 3, "names node 2 twice, first in line 2"),
    ],
)
def test_a_fault_in_a_table_is_refused_with_its_line(rows: list[str], line: int, words: str) -> None:
    found, message = fault(node_table, section("DEMAND_SECTION", *rows), "DEMAND_SECTION", 2, ("demand",))
    assert found == line and words in message


def test_lists_end_with_minus_1_wherever_that_stands() -> None:
    assert node_list(section("DEPOT_SECTION", "2 3", "1 -1"), "DEPOT_SECTION", 3) == ([2, 3, 1], [2, 2, 3])
    assert node_list(section("DEPOT_SECTION", "-1"), "DEPOT_SECTION", 3) == ([], [])


def test_a_list_ends_with_its_section_too_unless_the_file_may_have_been_cut_off() -> None:
    whole = section("DEPOT_SECTION", "1", "2")
    assert node_list(whole, "DEPOT_SECTION", 3) == ([1, 2], [2, 3])
    line, message = fault(node_list, replace(whole, complete=False), "DEPOT_SECTION", 3)
    assert line == 3 and "ends early; expected -1 or EOF" in message


@pytest.mark.parametrize(
    ("rows", "line", "words"),
    [
        ([], 1, "ends early"), (["1 -1", "2"], 3, "goes on after its end"), (["4 -1"], 2, "does not exist; expected 1 to 3; found 4"),
        (["2", "2 -1"], 3, "names node 2 twice"), (["1.5 -1"], 2, "node in DEPOT_SECTION"), (["0 -1"], 2, "node in DEPOT_SECTION"),
    ],
)  # fmt: skip
def test_a_fault_in_a_list_is_refused_with_its_line(rows: list[str], line: int, words: str) -> None:
    found, message = fault(node_list, section("DEPOT_SECTION", *rows), "DEPOT_SECTION", 3)
    assert found == line and words in message


# -- matrices ----------------------------------------------------------------------------------------------------------


def matrix_of(layout: str, *rows: str, n: int = 3) -> Any:
    return edge_weights(scan("\n".join([f"EDGE_WEIGHT_FORMAT : {layout}", "EDGE_WEIGHT_SECTION", *rows, "EOF"])), n)


@pytest.mark.parametrize(
    ("layout", "numbers"),
    [
        ("FULL_MATRIX", "0 1 2 1 0 3 2 3 0"), ("UPPER_ROW", "1 2 3"), ("LOWER_COL", "1 2 3"), ("LOWER_ROW", "1 2 3"),
        ("UPPER_COL", "1 2 3"), ("UPPER_DIAG_ROW", "9 1 2 9 3 9"), ("LOWER_DIAG_COL", "9 1 2 9 3 9"),
        ("LOWER_DIAG_ROW", "9 1 9 2 3 9"), ("UPPER_DIAG_COL", "9 1 9 2 3 9"),
    ],
)  # fmt: skip
def test_every_layout_is_the_same_matrix(layout: str, numbers: str) -> None:
    """1-2: 1, 1-3: 2, 2-3: 3; the triangle is read row by row, so that its second entry is 1-3 above and below the diagonal."""
    made, lines = matrix_of(layout.lower(), *numbers.split())
    assert made.tolist() == [[0, 1, 2], [1, 0, 3], [2, 3, 0]]
    assert np.array_equal(lines, lines.T) or layout == "FULL_MATRIX"


def test_a_full_matrix_may_differ_by_direction_and_its_diagonal_is_not_looked_at() -> None:
    made, lines = matrix_of("FULL_MATRIX", "-1 1 2", "4 -1 3 5", "6 7")
    assert made.tolist() == [[0, 1, 2], [4, 0, 3], [5, 6, 0]]
    assert lines.tolist() == [[3, 3, 3], [4, 4, 4], [4, 5, 5]]


def test_a_negative_distance_and_a_wrong_number_of_them_are_refused_with_their_line() -> None:
    assert fault(matrix_of, "UPPER_ROW", "1", "-2 3")[0] == 4
    for rows, line in ((["1 2"], 3), (["1 2", "3", "4"], 5), (["1 2 3 4"], 3)):
        found, message = fault(matrix_of, "UPPER_ROW", *rows)
        assert found == line and "wrong number of values for UPPER_ROW; expected 3 (DIMENSION 3)" in message
    assert "EDGE_WEIGHT_FORMAT 'FUNCTION' is not supported" in fault(matrix_of, "FUNCTION", "1")[1]


# -- names -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "fleet", "set_x"), [("A-n32-k5", "5", False), ("X-n101-k25", "25", True), ("a-k5b", None, False)])
def test_names_that_tell_of_a_fleet(name: str, fleet: str | None, set_x: bool) -> None:
    found = FLEET_IN_NAME.search(name)
    assert (None if found is None else found[1]) == fleet
    assert bool(SET_X.match(name)) == set_x
