from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from file_cases import Differences, Read, Refusal, check_fault, unwritable, with_line_of

from waybound.instances.generating import generate
from waybound.instances.routing.formats.solomon import read, recognises, write
from waybound.instances.routing.instance import VehicleType

GOOD = """\
T1

VEHICLE
NUMBER     CAPACITY
  3         50

CUSTOMER
CUST NO.  XCOORD.   YCOORD.    DEMAND   READY TIME  DUE DATE   SERVICE   TIME

    0      40         50          0          0        300          0
    1      45         68         10         20        100         10
    2      42.5       66         30         30        120         10
"""
with_line = partial(with_line_of, GOOD)


def test_everything_in_the_file_is_read(read_text_as: Read) -> None:
    made = read_text_as(GOOD)
    assert (made.name, made.format, made.problem, made.problems) == ("T1", "solomon", "vrptw", ("vrptw", "min-cost-vrp"))
    assert made.fleet == (VehicleType(3, 50.0),)
    assert made.sites.ids == ("0", "1", "2")
    assert made.sites.depots.tolist() == [0]
    assert made.sites.coordinates.tolist() == [[40, 50], [45, 68], [42.5, 66]]
    assert made.sites.demand.tolist() == [0, 10, 30]
    assert made.sites.ready.tolist() == [0, 20, 30]
    assert made.sites.due.tolist() == [300, 100, 120]
    assert made.sites.service.tolist() == [0, 10, 10]
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")
    assert made.travel.distance(0, 1) == np.hypot(5, 18)
    assert made.notes == ()


@pytest.mark.parametrize(
    "change", [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.rstrip("\n"), lambda t: t.replace("  ", "\t")]
)
def test_line_ends_marks_and_blanks_do_not_matter(change: Callable[[str], str], read_text_as: Read) -> None:
    assert read_text_as(change(GOOD)).sites.demand.tolist() == [0, 10, 30]


def test_without_a_name_the_file_gives_it(read_text_as: Read) -> None:
    assert read_text_as(GOOD.replace("T1\n", ""), "R9.txt").name == "R9"


@pytest.mark.parametrize(
    ("line", "text", "message", "expected", "found"),
    [
        (5, "  0         50", "number of vehicles must be a whole number", "1 or more", "'0'"),
        (5, "  -3        50", "number of vehicles", "1 or more", "'-3'"),
        (5, "  3         0", "capacity must be positive", "more than 0", "0"),
        (5, "  3         nan", "capacity must be a finite number", "a number", "'nan'"),
        (5, "  3", "vehicle line has a wrong length", "number and capacity", "1 values"),
        (7, "CLIENTS", "heading is missing", "CUSTOMER", "'CLIENTS'"),
        (8, "0 40 50 0 0 300 0", "titles of the columns are missing", None, None),
        (10, "    0 40 50 5 0 300 0", "the depot has a demand or a service time", "0", None),
        (11, "    1 45 68 -10 20 100 10", "demand is negative", "0 or more", "-10.0"),
        (11, "    1 45 68 10 20 100 -10", "service time is negative", "0 or more", "-10.0"),
        (11, "    1 45 68 10 120 100 10", "time window closes before it opens", "ready time <= due date", "[120. 100.]"),
        (11, "    1 45 68 10 20 100", "row of the customer table has a wrong length", "7 values", "6 values"),
        (11, "    1 45 68 10 20 100 10 9", "wrong length", "7 values", "8 values"),
        (11, "    1 45 inf 10 20 100 10", "no finite number", "a number", "'inf'"),
        (11, "    1 45 NaN 10 20 100 10", "no finite number", "a number", "'NaN'"),
        (11, "    7 45 68 10 20 100 10", "customer numbers must run 0, 1, 2", "1", "7"),
        (12, "    1 45 68 10 20 100 10", "number 1 stands already in line 11", "2", "1"),
        (11, "    1 45 68 10 0 5 10", "no vehicle can reach customer 1: earliest arrival", "at most 5", "at least 18"),
        (11, "    1 45 68 10 20 290 10", "", None, None),
        (11, "    1 45 68 10 280 290 10", "no vehicle can reach customer 1: earliest return to the depot", "at most 300", "at least 308"),
    ],
)
def test_a_fault_is_refused_with_its_line(
    line: int, text: str, message: str, expected: str | None, found: str | None, refusal: Refusal, read_text_as: Read
) -> None:
    if not message:  # the counterpart of the fault: this one is fine
        read_text_as(with_line(line, text))
        return
    check_fault(refusal(with_line(line, text)), message, line, expected, found)


@pytest.mark.parametrize("lines", [4, 5, 6, 7, 8, 9, 10])
def test_a_file_that_is_cut_off_is_refused(lines: int, refusal: Refusal) -> None:
    error = refusal("\n".join(GOOD.split("\n")[:lines]))
    assert error.code == "missing"
    assert error.line is not None and error.line <= lines


def test_a_last_row_cut_inside_a_number_is_refused(refusal: Refusal, read_text_as: Read) -> None:
    text = write(generate("solomon", 1, customers=9))  # type: ignore[arg-type]
    assert len(read_text_as(text.rstrip()).sites) == 10
    error = refusal(text.rstrip()[:-1])
    assert (error.message, error.line) == ("last row is cut off", 19)


@pytest.mark.parametrize(
    ("name", "customers", "good"),
    [
        ("C101", 100, True), ("rc208", 25, True), ("R201", 50, True), ("C101", 99, False), ("R1_2_1", 100, False), ("demo", 7, True),
        ("C101.7", 7, True),
    ],
)  # fmt: skip
def test_a_published_name_stands_for_a_number_of_customers(
    name: str, customers: int, good: bool, refusal: Refusal, read_text_as: Read
) -> None:
    text = write(generate("solomon", 1, customers=customers, name=name))  # type: ignore[arg-type]
    if good:
        assert read_text_as(text).name == name
    else:
        error = refusal(text)
        assert "stands for another number of customers" in error.message
        assert error.found == str(customers)


def test_a_table_without_a_row_holds_no_customers_not_minus_one(refusal: Refusal) -> None:
    text = write(generate("solomon", 1, customers=25, name="C101"))  # type: ignore[arg-type]
    assert refusal(text[: text.index("SERVICE TIME") + len("SERVICE TIME")] + "\n").found == "0"


def test_only_the_two_headings_on_lines_of_their_own_are_recognised() -> None:
    assert recognises(GOOD)
    assert not recognises("a VEHICLE NUMBER CAPACITY in prose")
    assert not recognises("VEHICLE\n3 50\n")


@pytest.mark.parametrize("kind", ["C1", "R2", "RC1"])
def test_what_is_written_reads_back_the_same(kind: str, differences: Differences) -> None:
    made = generate("solomon", 4, **{"class": kind, "customers": 30})
    assert differences(made, read(write(made), Path("x.txt"))) == []  # type: ignore[arg-type]


def test_numbers_wider_than_a_column_stay_apart(read_text_as: Read, differences: Differences) -> None:
    made = read_text_as(with_line(11, "1 45.12345678901234 68.00000000000001 10 20 100 10"))
    assert differences(made, read(write(made), Path("x.txt"))) == []


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    GOOD,
    (lambda i: replace(i, fleet=(VehicleType(None, 50.0),)), "needs a number of vehicles"),
    (lambda i: replace(i, fleet=(VehicleType(3, 50.0, max_duration=9.0),)), "no place for max-duration"),
    (lambda i: replace(i, fleet=(VehicleType(3, 50.0, name="a"), VehicleType(3, 60.0, name="b"))), "no place for heterogeneous-fleet"),
    (lambda i: replace(i, travel=i.travel.with_convention("trunc1")), "its convention is trunc1"),
    (lambda i: replace(i, min_vehicles=2), "min-vehicles"),
    (lambda i: replace(i, name="VEHICLE"), "cannot be the name"),
)
