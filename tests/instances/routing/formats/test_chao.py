"""The text format of team orienteering."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.formats.chao import read, recognises, write
from waybound.instances.routing.instance import VehicleType

GOOD = "n 4\nm 2\ntmax 2.5\n10.5\t14.4\t0\n18\t15.9\t10\n18.3\t13.3\t12\n11.2\t14.1\t0\n"


def with_line(number: int, text: str) -> str:
    lines = GOOD.split("\n")
    lines[number - 1] = text
    return "\n".join(lines)


def test_paths_lead_from_the_first_point_to_the_last(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as(GOOD, "p9.txt")
    assert (made.name, made.format, made.problem, made.problems) == ("p9", "chao", "team-orienteering", ("team-orienteering",))
    assert made.fleet == (VehicleType(2, start=0, end=3, max_duration=2.5),)
    assert made.sites.depots.tolist() == [0, 3]
    assert made.sites.reward.tolist() == [0, 10, 12, 0]
    assert not made.sites.required.any()


def test_one_path_may_be_asked_as_orienteering(read_text_as: Callable[..., Any]) -> None:
    assert read_text_as(with_line(2, "m 1")).problems == ("team-orienteering", "orienteering")


def test_points_that_no_path_reaches_are_read(read_text_as: Callable[..., Any]) -> None:
    assert read_text_as(with_line(3, "tmax 0")).fleet[0].max_duration == 0


@pytest.mark.parametrize(
    ("text", "line", "message", "expected", "found"),
    [
        (with_line(1, "n 5"), 7, "wrong number of rows: point", "5", "4"),
        (with_line(1, "n 3"), 7, "wrong number of rows: point", "3", "4"),
        (with_line(1, "n 2000000000"), 7, "wrong number of rows: point", "2000000000", "4"),
        (with_line(1, "n 2"), 1, "number of points must be a whole number", "3 or more", "'2'"),
        (with_line(1, "N 4.5"), 1, "number of points must be a whole number", "3 or more", "'4.5'"),
        (with_line(2, "m 0"), 2, "number of paths must be a whole number", "1 or more", "'0'"),
        (with_line(2, "k 2"), 2, "m is missing", "m and its value", "'k 2'"),
        (with_line(3, "tmax -1"), 3, "tmax is negative", "0 or more", "-1"),
        (with_line(3, "tmax inf"), 3, "tmax must be a finite number", "a number", "'inf'"),
        (with_line(6, "18 15.9"), 6, "point has a wrong length", "x, y, score", "2 values"),
        (with_line(6, "18 15.9 -1"), 6, "score is negative", "0 or more", "-1.0"),
        ("n 4\nm 2\n", 2, "ends early", "tmax and its value", "the end of the file"),
    ],
)  # fmt: skip
def test_a_fault_is_refused_with_its_line(
    text: str, line: int, message: str, expected: str, found: str, refusal: Callable[..., InputError]
) -> None:
    error = refusal(text)
    assert message in str(error)
    assert (error.line, error.expected, error.found) == (line, expected, found)


def test_what_is_read_is_written_again(read_text_as: Callable[..., Any], differences: Callable[..., list[str]]) -> None:
    made = read_text_as(GOOD)
    assert write(made) == GOOD
    assert differences(made, read(write(made), Path("file.txt"))) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i: replace(i, fleet=(replace(i.fleet[0], start=3),)), "from the first to the last"),
        (lambda i: replace(i, fleet=(VehicleType(2, start=0, end=3),)), "a number of paths and their limit"),
        (lambda i: replace(i, objective=("reward", "vehicles")), "no place for objective"),
    ],
)
def test_what_the_format_cannot_express_is_refused(change: Callable[[Any], Any], message: str, read_text_as: Callable[..., Any]) -> None:
    with pytest.raises(UsageError, match=message):
        write(change(read_text_as(GOOD)))


@pytest.mark.parametrize("text", ["n 4\n", "a 4\nb 3\ntmax 5\n", "4 2\n0 0 0\n", ""])
def test_other_texts_are_not_recognised(text: str) -> None:
    assert not recognises(text)
