"""Tsiligirides' text format of orienteering."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.formats.tsiligirides import read, recognises, write
from waybound.instances.routing.instance import VehicleType
from waybound.instances.routing.travel import Travel

GOOD = "15\t1\n10.5\t14.4\t0\n11.2\t14.1\t0\n18\t15.9\t10\n18.3\t13.3\t15\n"


def with_line(number: int, text: str) -> str:
    lines = GOOD.split("\n")
    lines[number - 1] = text
    return "\n".join(lines)


def test_paths_lead_from_the_first_point_to_the_second(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as(GOOD)
    assert (made.name, made.format, made.problem, made.problems) == (
        "file",
        "tsiligirides",
        "orienteering",
        ("orienteering", "team-orienteering"),
    )
    assert made.fleet == (VehicleType(1, start=0, end=1, max_duration=15.0),)
    assert made.sites.ids == ("0", "1", "2", "3")
    assert made.sites.depots.tolist() == [0, 1]
    assert made.sites.customers.tolist() == [2, 3]
    assert made.sites.reward.tolist() == [0, 0, 10, 15]
    assert not made.sites.required.any()
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")


def test_several_paths_make_a_team(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as(GOOD.replace("15\t1\n", "15 3\n", 1))
    assert (made.fleet[0].count, made.problem, made.problems) == (3, "team-orienteering", ("team-orienteering",))


@pytest.mark.parametrize(
    "change", [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.rstrip("\n"), lambda t: t.replace("\t", "  ")]
)
def test_line_ends_marks_and_blanks_do_not_matter(change: Callable[[str], str], read_text_as: Callable[..., Any]) -> None:
    assert read_text_as(change(GOOD)).sites.reward.tolist() == [0, 0, 10, 15]


@pytest.mark.parametrize(
    ("text", "line", "message", "expected", "found"),
    [
        (with_line(1, "-1 1"), 1, "Tmax is negative", "0 or more", "-1"),
        (with_line(1, "15 0"), 1, "number of paths must be a whole number", "1 or more", "'0'"),
        (with_line(1, "15 1.5"), 1, "number of paths must be a whole number", "1 or more", "'1.5'"),
        (with_line(4, "18 15.9 -10"), 4, "score is negative", "0 or more", "-10.0"),
        (with_line(4, "18 15.9"), 4, "point has a wrong length", "x, y, score", "2 values"),
        (with_line(4, "18 15.9 10 1"), 4, "point has a wrong length", "x, y, score", "4 values"),
        (with_line(4, "18 nan 10"), 4, "point holds something that is no finite number", "a number", "'nan'"),
        (with_line(4, "18 1_0 10"), 4, "point holds something that is no finite number", "a number", "'1_0'"),
        ("15 1\n0 0 0\n1 1 0\n", 3, "ends early", "a start, an end and a point between", "2 points"),
        (with_line(4, "1e200 0 3"), None, "coordinate of site 2 is too large", "at most 1e+150", "1e+200"),
    ],
)  # fmt: skip
def test_a_fault_is_refused_with_its_line(
    text: str, line: int | None, message: str, expected: str, found: str, refusal: Callable[..., InputError]
) -> None:
    error = refusal(text)
    assert message in str(error)
    assert (error.line, error.expected, error.found) == (line, expected, found)


def test_names_of_published_files_stand_for_a_number_of_points(refusal: Callable[..., InputError]) -> None:
    error = refusal(GOOD, "set_64_1_15.txt")
    assert "the name set_64_1_15 stands for another number of points; rename it if this is meant" in str(error)
    assert (error.line, error.expected, error.found) == (5, "64", "4")


def test_what_is_read_is_written_again(read_text_as: Callable[..., Any], differences: Callable[..., list[str]]) -> None:
    made = read_text_as(GOOD)
    assert write(made) == GOOD
    assert differences(made, read(write(made), Path("file.txt"))) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i: replace(i, fleet=(replace(i.fleet[0], max_distance=9.0),)), "no place for max-distance"),
        (lambda i: replace(i, fleet=(replace(i.fleet[0], count=None),)), "a number of paths and their limit"),
        (lambda i: replace(i, fleet=(replace(i.fleet[0], end=0),)), "from the first to the second"),
        (lambda i: replace(i, problem="min-cost-vrp", problems=("min-cost-vrp",)), "no orienteering problem but min-cost-vrp"),
        (lambda i: replace(i, sites=replace(i.sites, required=~i.sites.depot)), "sites that must be visited"),
        (lambda i: replace(i, travel=i.travel.with_convention("trunc1")), "euclidean trunc1, not Euclidean and exact"),
        (lambda i: replace(i, travel=Travel("EUC_2D", i.travel.coordinates)), "EUC_2D file, not Euclidean and exact"),
        (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abcd"))), "numbered 0, 1, 2"),
    ],
)  # fmt: skip
def test_what_the_format_cannot_express_is_refused(change: Callable[[Any], Any], message: str, read_text_as: Callable[..., Any]) -> None:
    with pytest.raises(UsageError, match=message):
        write(change(read_text_as(GOOD)))


@pytest.mark.parametrize("text", ["15 1\n1 2\n", "15 1 2\n1 2 3\n", "x y\n1 2 3\n", "15 1\n", "", "id,x,y\n1,2,3\n"])
def test_other_texts_are_not_recognised(text: str) -> None:
    assert not recognises(text)
