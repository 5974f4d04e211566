from pathlib import Path

import numpy as np
import pytest
from coded import coded
from file_cases import check_fault, error_of

from waybound import AssignmentInstance, UsageError
from waybound.instances.auctions.formats.assignment_pairs import read, recognises, write
from waybound.instances.generating import generate

TEXT = "# name: yard\nrobot;bin;cost\nr1;a;2\nr2;a;1.5\nr1;b;-3\n"


def test_what_is_read_is_written_and_read_again() -> None:
    made = read(TEXT, Path("x.csv"))
    assert (made.name, made.robot_names, made.bin_names) == ("yard", ("r1", "r2"), ("a", "b"))
    assert made.matrix().tolist() == [[2.0, -3.0], [1.5, float("inf")]]
    assert recognises(write(made)) and read(write(made), Path("x.csv")).digest() == made.digest()


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("robot,bin,cost\na,b,x\n", 2, "cost must be a finite number"),
        ("robot,bin,cost\na,b,nan\n", 2, "cost must be a finite number"),
        ("robot,bin,cost\na,b\n", 2, "wrong length"),
        ("robot,bin,cost\na,b,1\na,b,2\n", 3, "stands twice, first in line 2"),
        ("robot,bin,cost\n,b,1\n", 2, "robot must have a name"),
        ("robot,bin,cost\na,,1\n", 2, "bin must have a name"),
        ("robot,bin,cost,filled\n,,,2\n", 2, "robot must have a name"),
        ("robot,bin,cost\na,b,\n", 2, "cost must be a finite number"),
        ("robot,bin,cost,filled\na,b,1,2\na,,,2\n", 3, "filled stands in a row without a bin"),
        ("robot,bin,cost\n", 1, "holds no pairs"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text: str, line: int, message: str) -> None:
    check_fault(error_of(read, text, Path("x.csv")), message, line)


@pytest.mark.parametrize("costs", ["uniform", "whole", "euclidean", "orchard"])
def test_all_that_is_generated_is_written_with_places_and_times_and_read_again(costs: str) -> None:
    made = generate("assignment", 1, costs=costs)
    again = read(write(made), Path("x.csv"))
    assert again.digest() == made.digest() and recognises(write(made))
    for key in ("robot_positions", "bin_positions", "filled"):
        assert (getattr(made, key) is None) == (getattr(again, key) is None)
        assert getattr(made, key) is None or (getattr(made, key) == getattr(again, key)).all()


def test_a_bin_that_nobody_fills_stays_one() -> None:
    again = read("robot,bin,cost,filled\na,x,1,inf\na,y,2,0\n", Path("x.csv"))
    assert again.filled.tolist() == [float("inf"), 0.0] and "inf" in write(again)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("robot,bin,cost,filled\na,x,1,3\nb,x,2,4\n", 3, "filled of bin 'x' is another one than in line 2; expected 3; found '4'"),
        ("robot,bin,cost,robot-x\na,x,1,3\n", None, "places of robots need both"),
        ("robot,bin,filled\na,x,3\n", 1, "column cost is missing"),
    ],
)
def test_what_does_not_belong_together_is_refused(text: str, line: int | None, message: str) -> None:
    check_fault(error_of(read, text, Path("x.csv")), message, line)


@pytest.mark.parametrize("seed", range(6))
def test_robots_and_bins_without_a_pair_have_a_row_of_their_own_and_all_keep_their_numbers(seed: int) -> None:
    inf, rng = float("inf"), np.random.default_rng(seed)
    costs = np.where(rng.random((5, 6)) < 0.3, rng.random((5, 6)), inf)
    places = {"robot_positions": rng.random((5, 2)), "bin_positions": rng.random((6, 2)), "filled": rng.integers(0, 3, 6).astype(float)}
    for made in (
        AssignmentInstance.from_matrix(costs, **places),
        AssignmentInstance.from_matrix(costs),
        AssignmentInstance.from_matrix(np.full((2, 3), inf)),
        AssignmentInstance.from_matrix([[inf, 1.0], [2.0, inf]]),
        generate("assignment", seed, robots=4, bins=5, arcs=2),
    ):
        again = read(write(made), Path("x.csv"))
        assert again.digest() == made.digest() and recognises(write(made))
        assert again.bin_names == tuple(map(made.bin_name, range(made.num_bins)))
        for key in ("robot_positions", "bin_positions"):
            np.testing.assert_array_equal(getattr(again, key), getattr(made, key))


def test_only_what_has_no_pair_has_a_row_of_its_own() -> None:
    made = read("robot,bin,cost\nr1,,\n,a,\nr2,b,3\n", Path("x.csv"))
    assert made.matrix().tolist() == [[float("inf")] * 2, [float("inf"), 3.0]]
    assert write(made).splitlines()[1:] == ["robot,bin,cost", "r1,,", ",a,", "r2,b,3"]


def test_what_the_format_has_no_place_for_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("unsupported")):
        write(generate("generalised-assignment", 1))
