from dataclasses import replace
from functools import partial
from typing import Any

import pytest
from file_cases import Differences, Read, Refusal, check_refused, with_line_of

from waybound import Travel, UsageError, VehicleType
from waybound.instances.routing.formats.taillard import read, recognises, write

GOOD = " 3\n 0 40 40 0\n 1 22 22 18 \n 2 36.5 26 26 \n 3 21 45 11\n2 \n20   20 1.0 0 50\n30   35 1.1 0 2\n"
with_line = partial(with_line_of, GOOD)


def test_everything_in_the_file_is_read(read_text_as: Read) -> None:
    made = read_text_as(GOOD, "c3.txt")
    assert (made.name, made.format, made.problem, made.problems) == ("c3", "taillard", "cvrp", ("cvrp", "min-cost-vrp"))
    assert made.fleet == (
        VehicleType(50, 20.0, fixed_cost=20.0, unit_cost=1.0, name="type 1"),
        VehicleType(2, 30.0, fixed_cost=35.0, unit_cost=1.1, name="type 2"),
    )
    assert made.sites.ids == ("0", "1", "2", "3") and made.sites.demand.tolist() == [0, 18, 26, 11]
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        (with_line(2, "0 40 40 5"), "the depot has a demand", 2),
        (with_line(4, "3 36 26 26"), "points are numbered from 0 on", 4),
        (with_line(4, "2 36 26 -6"), "demand is negative", 4),
        (with_line(4, "2 36 26"), "point has a wrong length", 4),
        (with_line(6, "3"), "wrong number of rows: vehicle type", 8),
        (with_line(7, "0 20 1.0 0 50"), "capacity must be positive", 7),
        (with_line(7, "20 20 -1.0 0 50"), "a cost is negative", 7),
        (with_line(7, "20 20 1.0 3 50"), "a least number of vehicles of one type is not supported", 7),
        (with_line(7, "20 20 1.0 0 0"), "largest number must be a whole number", 7),
        (with_line(1, "99999999"), "point has a wrong length", 6),
        ("3\n0 40 40 0\n1 22 22 18\n", "ends early", 3),
    ],
)
def test_a_fault_is_refused_with_its_line(text: str, message: str, line: int, refusal: Refusal) -> None:
    error = refusal(text)
    assert message in error.message and error.line == line


def test_recognition() -> None:
    assert recognises(GOOD) and not recognises("3\n1 40 40 0\n2 1 1 1\n") and not recognises("3 4\n0 1 1 0\n1 1 1 1\n")


def test_what_is_written_reads_back_the_same(read_text_as: Read, differences: Differences, tmp_path: Any) -> None:
    made = read_text_as(GOOD, "c3.txt")
    assert differences(made, read(write(made), tmp_path / "c3.txt")) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i: replace(i, fleet=(VehicleType(2, 40.0),)), "vehicle types must be called type 1"),
        (lambda i: replace(i, fleet=(VehicleType(None, 40.0, name="type 1"),)), "needs a capacity and a number"),
        (lambda i: replace(i, travel=Travel("manhattan", coordinates=i.sites.coordinates)), "Euclidean distances that are not rounded"),
        (lambda i: replace(i, team_risk=0.1), "no place for team-risk"),
        (lambda i: i.with_customers(2), None),
    ],
)
def test_what_the_format_cannot_express_is_refused(change: Any, message: str | None, read_text_as: Read) -> None:
    made = change(read_text_as(GOOD))
    if message is None:
        assert write(made).startswith("2\n")
        return
    check_refused(UsageError, message, write, made)
