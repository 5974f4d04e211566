"""A good answer soon, for proofs to begin with: it tells which moves and routes no better answer needs."""

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ....instances.errors import WayboundError

RUINS = 1000
"""Ruins for each customer."""

SPEED = 60_000
"""Ruins a second that the search can be relied on for."""


def first_answer(
    problem: RoutingProblem, seconds: float, seed: int, stop: Stop, *, compiled: bool = True, ruins: int = RUINS
) -> Routes | None:
    """An answer by ruin and recreate; None where it finds none, does not take the problem, or would first have to be compiled although it
    is asked to be ``compiled``."""
    from ...backend import Control, Options
    from ...engines.routing.ruin_recreate import RuinRecreate
    from ...engines.routing.ruin_recreate_steps import near_kernels, search_kernels

    engine, control = RuinRecreate(), Control()
    if engine.missing(problem) or (compiled and not (near_kernels.nearest.kept() and search_kernels.anneal.kept())):
        return None
    # It cools down by its ruins: cut short by the time it would still be hot.
    most = max(1, min(ruins * len(problem.customers), int(SPEED * seconds)))
    try:
        with stop.telling(control.stop):
            answer = engine.run(problem, Options(seconds, iterations=most, seed=seed), control).answer
    except WayboundError:  # numbers that it cannot scale: the proof begins without an answer
        return None
    return answer if answer is not None and problem.evaluate(answer).feasible else None
