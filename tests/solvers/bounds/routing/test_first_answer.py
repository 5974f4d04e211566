"""First answers: judged, and none where a search cannot give one."""

from dataclasses import replace

import pytest
from patience import HANG
from small_routing import plane, small

from waybound.formulations.stop import Stop
from waybound.instances.errors import InputError
from waybound.solvers.bounds.routing.first_answer import first_answer
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate


def test_an_answer_is_one_of_the_problem_and_the_same_for_the_same_seed() -> None:
    problem = plane(1, 12, 25.0)
    one, two = (first_answer(problem, HANG, 3, Stop(HANG), compiled=False) for _ in range(2))
    assert one is not None and problem.evaluate(one).feasible and one == two


def test_there_is_none_without_a_feasible_one() -> None:
    problem = small("capacity", 1, "round")
    tight = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=10.0),))
    assert first_answer(tight, 1.0, 1, Stop(HANG), compiled=False) is None


def test_a_search_that_cannot_scale_the_numbers_costs_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*arguments: object) -> None:
        raise InputError("too large to be scaled")

    monkeypatch.setattr(RuinRecreate, "run", refuse)
    assert first_answer(plane(1, 6, 25.0), 1.0, 1, Stop(HANG), compiled=False) is None
