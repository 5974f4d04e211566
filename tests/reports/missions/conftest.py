from collections.abc import Callable
from typing import Any

import pytest

import waybound as wb
from waybound.reports.missions.animation import Film
from waybound.reports.missions.mission import MISSIONS


@pytest.fixture
def filmed() -> Callable[..., Film]:
    """``filmed(NAME, ...)``: a mission that was played with these settings, as a film whose last picture could be drawn."""

    def play(name: str, **settings: Any) -> Film:
        film = Film(MISSIONS[name]())
        wb.run(film.mission, watch=film, **settings)
        assert film.pictures(2)[-1].startswith(b"\x89PNG")
        return film

    return play
