from pathlib import Path

import pytest
from coded import coded
from file_cases import check_fault, error_of

from waybound.instances.auctions.formats.assignment_matrix import read, recognises, write
from waybound.instances.errors import UsageError
from waybound.instances.generating import generate

TEXT = "# name: yard\nrobot/bin,a,b\nr1,2,-\nr2,,1.5\n"


def test_what_is_read_is_written_and_read_again() -> None:
    made = read(TEXT, Path("x.csv"))
    assert (made.name, made.robot_names, made.bin_names) == ("yard", ("r1", "r2"), ("a", "b"))
    assert made.matrix().tolist() == [[2.0, float("inf")], [float("inf"), 1.5]]
    assert recognises(write(made)) and read(write(made), Path("x.csv")).digest() == made.digest()


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("robot/bin,a,b\nr,1\n", 2, "wrong length; expected 3 values; found 2 values"),
        ("robot/bin,a\nr,nan\n", 2, "cost must be a finite number"),
        ("robot/bin,a\n", 1, "holds no robots"),
        ("robot/bin\nr\n", 1, "there are no bins"),
        ("robot/bin,a,a\nr,1,2\n", None, "two bins have the name 'a'"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text: str, line: int | None, message: str) -> None:
    check_fault(error_of(read, text, Path("x.csv")), message, line)


def test_what_the_format_has_no_place_for_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("unsupported")):
        write(generate("assignment", 1, costs="euclidean"))
