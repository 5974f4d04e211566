from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import coded

from waybound.instances.errors import Code, InputError
from waybound.instances.frames import columns_of, name_of, numbers_of

FRAME = pd.DataFrame({"x": [1, 2], "name": ["a", "b"]})


def test_columns_come_by_their_titles_and_cells_as_numbers_and_names() -> None:
    columns = columns_of("places", FRAME, ("name", "x"), ("x",))
    assert list(columns) == ["x", "name"] and numbers_of("places", "x", columns["x"]).tolist() == [1.0, 2.0]
    assert [name_of(cell) for cell in (3, 3.0, np.float64(3), " a ", 0.5)] == ["3", "3", "3", "a", "0.5"]


@pytest.mark.parametrize(
    ("frame", "code", "message"),
    [
        ([1], "malformed", "places must be a pandas frame; found list"),
        (FRAME.assign(y=1), "unknown-name", "column 'y' of places is unknown; expected name, x"),
        (FRAME[["x", "x"]], "duplicate", "column 'x' of places stands twice"),
        (FRAME[["name"]], "missing", "places lacks the column 'x'; expected name, x; found name"),
    ],
)
def test_other_titles_are_refused(frame: Any, code: Code, message: str) -> None:
    with pytest.raises(InputError, match=message, check=coded(code)):
        columns_of("places", frame, ("name", "x"), ("x",))


@pytest.mark.parametrize("column", [FRAME["name"], pd.to_datetime(pd.Series(["2026-05-04"])), [None, [1]]])
def test_cells_without_a_number_are_refused(column: Any) -> None:
    with pytest.raises(InputError, match="column 'at' of places must hold numbers"):
        numbers_of("places", "at", column)
