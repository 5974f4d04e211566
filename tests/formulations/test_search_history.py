import math

import pytest

from waybound.formulations.search_history import COLUMNS, Event, history_frame


def test_a_row_an_event_with_the_gap_of_what_was_known() -> None:
    events = (
        Event(0.1, "bound", None, (8.0,), "evidence", "a bound"),
        Event(0.5, "solve", (10.0,), (8.0,), "evidence", "pyvrp"),
        Event(0.9, "check", (10.0,), (8.0,), "verified", "pyvrp"),
    )
    frame = history_frame(events)
    assert list(frame.columns) == list(COLUMNS)
    assert math.isnan(frame["gap"][0]) and math.isnan(frame["objective"][0])
    assert frame["gap"][1] == pytest.approx(0.2)
    assert frame["bound_kind"].tolist() == ["evidence", "evidence", "verified"]


def test_levels_after_the_first_have_columns_of_their_own() -> None:
    frame = history_frame(
        (Event(0.1, "solve", (3.0,), (3.0,), "claimed", "a"), Event(1.0, "check", (3.0, 24.5), (3.0, None), "verified", "a")), 2
    )
    assert frame["objective_2"].tolist()[1] == 24.5
    assert math.isnan(frame["objective_2"][0]) and math.isnan(frame["bound_2"][1])
    assert frame.dtypes["objective_2"].kind == "f"


def test_no_events_are_an_empty_frame_of_the_same_columns() -> None:
    assert list(history_frame((), 2).columns) == [*COLUMNS, "objective_2", "bound_2"]
    assert not len(history_frame(()))
