from collections.abc import Callable

import pytest

from waybound.formulations.stop import Stop
from waybound.solvers.engines.sata.saddle_steps.game import Game, Limits, Record
from waybound.solvers.engines.sata.saddle_steps.programs import Programs


@pytest.fixture
def make_game() -> Callable[..., Game]:
    """``make_game(graph, gap, most_work=)``: a game with a minute to play."""

    def make(graph, gap=1e-3, most_work=float("inf")) -> Game:
        limits = Limits(Stop(60.0), most_work)
        return Game(graph, Record(graph, gap), limits, Programs(limits.stop))

    return make
