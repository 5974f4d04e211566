"""Further levels of a program are the later levels of the objective, over the columns of the first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_routing import varied
from truth.routing import RoutingTruth

from waybound.formulations.routing.objective import (
    Composable,
    LatestReturn,
    LongestRoute,
    Makespan,
    Objective,
    Penalties,
    Reward,
    TotalCost,
    TotalDuration,
    Vehicles,
)

LEVELS: tuple[Composable, ...] = (
    TotalCost() - Reward(),
    Makespan(),
    LongestRoute(),
    LatestReturn(),
    TotalDuration(),
    Vehicles(),
    Penalties(),
)


@pytest.mark.share(3)
@pytest.mark.parametrize("first", [0, 2, 4])
@pytest.mark.parametrize("feature", ["overtime", "penalties", "committed-vehicles", "duration-cost", "shifts"])
def test_an_answer_has_the_judges_value_at_every_level(feature: str, first: int) -> None:
    ordered = (*LEVELS[first:], *LEVELS[:first])
    seed = 3 if feature == "overtime" else 1
    problem = replace(varied(feature, seed, 3), objective=Objective(tuple(level for goal in ordered for level in goal.levels())))
    truth = RoutingTruth(problem)
    assert truth.samples
    for form in problem.forms():
        made = problem.compile(form)
        assert (made.program.sense, *(level.sense for level in made.program.further)) == problem.senses
        assert made.encode is not None
        for answer in truth.samples[:3]:
            x = made.encode(answer)
            found = [made.program.first_level().value(x), *(level.value(x) for level in made.program.further)]
            # Set partitioning holds the best of several orders of stops.
            assert found == pytest.approx(problem.evaluate(made.decode(x)).values), form


def test_only_the_levels_after_the_first_are_further() -> None:
    problem = replace(varied("shifts", 1, 3), objective=Objective.of(Makespan().then(Vehicles())))
    alone = replace(problem, objective=Objective.of(Makespan()))
    for form in problem.forms():
        program, single = problem.compile(form).program, alone.compile(form).program
        assert len(program.further) == 1
        assert single.further == ()
        if form == "three-index":
            assert np.array_equal(program.cost, single.cost)
            assert [rows.name for rows in program.rows] == [rows.name for rows in single.rows]
