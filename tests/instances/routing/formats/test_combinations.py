"""Rows with a list of combinations of visits."""

from __future__ import annotations

import math

import pytest

from waybound.instances.errors import InputError
from waybound.instances.routing.formats._combinations import Table
from waybound.instances.routing.formats._rows import Rows


def test_windows_stand_behind_a_list_of_any_length() -> None:
    table = Table()
    table.read(Rows.of("1 5 6 7 8 2 3 1 2 4 9 10\n2 5 6 7 8 1 0 9 10\n"), "site", 1, 2, windows=True)
    assert table.columns.tolist() == [[1, 5, 6, 7, 8, 9, 10], [2, 5, 6, 7, 8, 9, 10]]
    assert (table.frequency, table.combinations, table.at) == ([2, 1], [[1, 2, 4], []], [1, 2])


def test_without_windows_a_site_is_always_open() -> None:
    table = Table()
    table.read(Rows.of("4 5 6 7 8 1 1 1"), "site", 4, 1, windows=False)
    assert table.columns.tolist() == [[4, 5, 6, 7, 8, 0, math.inf]]
    table.check("demand")


@pytest.mark.parametrize(
    "row", ["1 5 6 7 8 1", "1 5 6 7 8 1 2 1", "1 5 6 7 8 1 -1", "1 5 6 7 8 1 0.5", "1 5 6 7 8 1 1 1 9", "1 5 6 7 8 1 1e300 1"]
)
def test_a_row_that_is_as_long_as_it_says_alone_is_read(row: str) -> None:
    with pytest.raises(InputError, match="row of a site has a wrong length"):
        Table().read(Rows.of(row), "site", 1, 1, windows=False)


def test_a_table_without_rows_keeps_its_columns() -> None:
    assert Table().columns.shape == (0, 7)
