from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import program

from waybound.reports.benchmarks.side_by_side import clocks, same_model

GIVEN = program([3, 2], [[2, 3], [1, 0]], [-np.inf, 1], [10.5, 4], 0, [4, 5], integer=[0])


def test_a_file_of_the_same_program_passes(tmp_path: Path) -> None:
    path = tmp_path / "model.mps"
    GIVEN.write(path)
    same_model(GIVEN, path)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (program([3, 2], [[2, 3]], -np.inf, 10.5, 0, [4, 5]), "rows, columns and entries"),
        (program([3, 9], [[2, 3], [1, 0]], [-np.inf, 1], [10.5, 4], 0, [4, 5]), "the costs differ"),
        (program([3, 2], [[2, 3], [1, 0]], [-np.inf, 1], [10.5, 4], -1, [4, 5]), "the lower bounds differ"),
        (program([3, 2], [[2, 3], [1, 0]], [-np.inf, 1], [10.5, 4], 0, [4, 6]), "the upper bounds differ"),
        (program([3, 2], [[2, 3], [1, 0]], [-np.inf, 2], [10.5, 4], 0, [4, 5]), "the left sides differ"),
        (program([3, 2], [[2, 3], [1, 0]], [-np.inf, 1], [11.5, 4], 0, [4, 5]), "the right sides differ"),
        (program([3, 2], [[2, 7], [1, 0]], [-np.inf, 1], [10.5, 4], 0, [4, 5]), "the coefficients differ"),
    ],
)
def test_another_program_is_told_by_what_differs(other: object, words: str, tmp_path: Path) -> None:
    path = tmp_path / "model.mps"
    GIVEN.write(path)
    with pytest.raises(AssertionError, match=words):
        same_model(other, path)  # type: ignore[arg-type]


def test_the_sense_may_stand_in_a_comment(tmp_path: Path) -> None:
    """PuLP negates the costs of a maximisation."""
    path = tmp_path / "model.mps"
    negated = tuple(replace(block, cost=-block.cost) for block in GIVEN.variables)
    replace(GIVEN, variables=negated).write(path)
    same_model(replace(GIVEN, sense="max"), path)


def test_a_part_is_timed_where_one_is_told() -> None:
    assert set(clocks(lambda: None)) == {"wall", "cpu"}
    assert clocks(lambda: ("result", 0.25))["part"] == 0.25
    assert clocks(lambda: sum(range(10**6)))["wall"] > 0
