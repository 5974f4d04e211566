"""What a method cannot take is refused before it runs, with the names of those that can."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import UnsupportedError, UsageError
from waybound.solvers.backend import RawResult
from waybound.solving import runs
from waybound.solving.solve import solve


def test_a_missing_feature_names_solvers_that_have_it(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("unknown"))
    windows = replace(square, sites=replace(square.sites, due=np.array([100.0, 50.0, 50.0, 50.0, 50.0])))
    with pytest.raises(UnsupportedError, match=r"time-windows.*can take it: .*pyvrp"):
        solve(windows, engine)


def test_an_unknown_solver_is_named_with_the_choices(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match=r"unknown solver .cplex.; choose from .*highs"):
        solve(square, "cplex")


def test_a_heuristic_checks_its_parameters(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="savings has no option 'shap'; it takes shape"):
        solve(square, heuristic="savings", shap=2)


def test_a_variant_without_a_name_is_refused(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="names no solver within pulp"):
        solve(square, "pulp:")


def test_a_large_program_is_searched_where_its_solver_can_be_ended(square: RoutingProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    apart: list[Any] = []
    inside = runs.run_in_process
    monkeypatch.setattr(runs, "run_in_process", lambda work, *rest: apart.append(work.solver) or inside(work, *rest))
    before = solve(square, "highs", bound_time=0)
    assert not apart
    monkeypatch.setattr(runs, "LARGE", 0)
    assert solve(square, "highs", bound_time=0).objective == before.objective
    assert apart == ["highs"]
