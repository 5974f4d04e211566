from typing import Any

import pytest

import waybound as wb
from waybound.instances.errors import UnsupportedError


@pytest.fixture(autouse=True)
def module(own_modules: Any) -> Any:
    return own_modules("waybound.reports.benchmarks.pyvrp_alone")


def test_it_is_judged_as_any_solver_and_never_chosen_unasked(module: Any) -> None:
    found = wb.solve(wb.generate("random", customers=8, capacity=40), "bare-pyvrp", iterations=50, bound_time=0)
    assert found.status == "feasible" and found.limit == "iterations" and found.certificate.feasible
    assert not module.BarePyVRP.by_default


def test_what_its_script_models_not_is_refused() -> None:
    problem = wb.read("demo-tiny")
    several = wb.RoutingProblem(
        problem.sites, problem.travel, (wb.VehicleType(2, reloads=(0,), capacity=50),), wb.TotalCost(), name="reloads"
    )
    with pytest.raises(UnsupportedError, match="reloads"):
        wb.solve(several, "bare-pyvrp", iterations=1)
