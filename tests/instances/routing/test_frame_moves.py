"""Lists of moves: titles in any case, names of others refused, what counts for nothing told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

import waybound as wb
from waybound.instances.clock import Times
from waybound.instances.errors import InputError
from waybound.instances.routing.foreign_names import ELSEWHERE, OURS
from waybound.instances.routing.frame_moves import MOVES, is_list, listed_moves

IDS = ("o", "a", "b")
MOVE = pd.DataFrame({"from": ["o", "a", "b"], "to": ["a", "b", "o"], "distance": [1.0, 4.0, 5.0]})
SITES = pd.DataFrame({"id": IDS, "due": [900, 60, 900]})


def refused(frame: Any, unit: str | None = None) -> str:
    with pytest.raises(InputError) as error:
        listed_moves(frame, IDS, Times(unit))
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("title", ["duration", "Duration", "DURATION"])
def test_titles_are_read_in_any_case(title: str) -> None:
    frame = MOVE.rename(columns=str.upper).assign(**{title: [50, 60, 70]})
    distances, durations, notes = listed_moves(frame, IDS, Times(None))
    assert is_list(frame, IDS) and distances[0, 1] == 1 and durations is not None and durations[0, 1] == 50 and notes == ()


@pytest.mark.parametrize("title", OURS["moves"]["duration"].split())
def test_durations_under_another_name_are_never_taken_from_the_distances(title: str) -> None:
    assert f"{title!r}; did you mean 'duration'?" in refused(MOVE.assign(**{title: [50, 60, 70]}))
    with pytest.raises(InputError, match="did you mean 'duration'"):
        wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(**{title: [50, 60, 70]}), vehicles=1)


@pytest.mark.parametrize("own", ["from", "to", "distance"])
def test_other_names_of_what_has_to_be_there(own: str) -> None:
    for title in OURS["moves"][own].split():
        frame = MOVE.rename(columns={own: title})
        assert is_list(frame, IDS) and f"{title!r}; did you mean {own!r}?" in refused(frame)


@pytest.mark.parametrize("title", [name for names in ELSEWHERE["moves"].values() for name in names.split()])
def test_what_is_told_otherwise_is_refused(title: str) -> None:
    assert f"unknown column {title!r}; " in refused(MOVE.assign(**{title: 1}))


def test_ends_under_other_names_make_a_list() -> None:
    both = MOVE.rename(columns={"from": "origin", "to": "destination"})
    assert is_list(both, IDS) and "'origin'; did you mean 'from'?" in refused(both)
    assert not is_list(pd.DataFrame(np.zeros((3, 3)), index=IDS, columns=IDS), IDS)
    assert not is_list(pd.DataFrame(np.zeros((2, 2)), columns=["from", "to"]), ("from", "to")) and not is_list(np.zeros((3, 3)), IDS)


def test_columns_that_mean_nothing_are_told() -> None:
    told = "columns of moves that are not used: street, note"
    assert listed_moves(MOVE.assign(street="x", note=1), IDS, Times(None))[2] == (told,)
    made = wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(street="x", note=1), vehicles=1)
    assert told in made.notes and told in made.remarks()


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (MOVE.drop(columns="distance"), "the moves have no column 'distance'; expected from, to, distance, duration; found from, to"),
        (MOVE.assign(Distance=1), "columns 'distance' and 'Distance' of the moves both tell distance"),
        (MOVE.assign(km=1), "columns 'distance' and 'km' of the moves both tell distance"),
        (MOVE.assign(distance=[1, np.nan, 2]), "distance of the move from a to b must be a number and not negative"),
        (MOVE.assign(duration=[1, 2, -2]), "duration of the move from b to o must be a number and not negative"),
        (MOVE.assign(distance="far"), "column distance of the moves must hold numbers"),
        (MOVE.assign(to=["a", None, "o"]), "row 2 of the moves has no to"),
        (MOVE.assign(duratoin=1), "unknown column 'duratoin'; did you mean 'duration'?"),
    ],
)
def test_what_is_wrong_is_named(frame: Any, message: str) -> None:
    assert message in refused(frame)


def test_numbers_of_sites_that_a_missing_value_made_floats_are_whole() -> None:
    frame = pd.DataFrame({"from": [0.0, 1.0], "to": [1.0, 0.0], "distance": [3, 4]})
    assert listed_moves(frame, ("0", "1"), Times(None))[0].tolist() == [[0, 3], [4, 0]]


def test_durations_are_told_once() -> None:
    with pytest.raises(InputError, match="durations are told twice"):
        wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(duration=1), durations=np.zeros((3, 3)), vehicles=1)
    assert MOVES == ("from", "to", "distance", "duration")
