import numpy as np
import pandas as pd
import pytest

import waybound as wb
from waybound.reports.tables.answers import answer_tables


def test_an_answer_is_told_row_by_row():
    (table,) = answer_tables(wb.read("figure-3-3"), wb.Selection.of([0, 2, 5]))
    assert [c.name for c in table.columns] == ["robot", "action", "share", "targets"]
    assert [c.right for c in table.columns] == [False, False, True, True]
    assert table.rows[1] == ("r2", "p3", "1", "2")


def test_what_a_row_has_not_is_left_blank():
    problem = wb.read("figure-3-3")
    told = lambda answer: pd.DataFrame({"trip": [1, 2], "bring": pd.array([3, None], dtype="Int64"), "to": ["a", None]})  # noqa: E731
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(problem), "answer_to_frame", lambda self, answer: told(answer))
        (table,) = answer_tables(problem, wb.Selection.of([0]))
    assert table.rows == (("1", "3", "a"), ("2", "", ""))


def test_a_long_answer_is_cut_and_says_so():
    (table,) = answer_tables(wb.MaxMinLP(np.ones((1, 50)), np.ones((1, 50))), np.full(50, 0.01))
    assert len(table.rows) == 21
    assert table.rows[-1] == ("and 30 more", "")


def test_without_an_answer_there_is_no_table():
    assert answer_tables(wb.read("figure-3-3"), None) == []
