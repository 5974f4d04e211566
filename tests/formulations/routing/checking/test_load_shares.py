"""Shares of round trips by load never exceed the optimum, whatever the metric, the rounding and the features."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, few, plane, small, varied
from truth.routing import best_values

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.evidence import Evidence
from waybound.formulations.routing.checking.load_shares import check_load_shares
from waybound.formulations.routing.checking.nearest_moves import check_nearest_moves
from waybound.formulations.routing.objective import (
    Composable,
    LatestReturn,
    Makespan,
    Objective,
    Penalties,
    Reward,
    TotalCost,
    TotalDuration,
    Vehicles,
)
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import InputError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import METRICS, Travel

GOALS: tuple[Composable, ...] = (
    TotalCost(), TotalCost() + 7.0 * Vehicles(), TotalDuration(), TotalCost() - Reward(), TotalCost() + 2.0 * Penalties(),
    Reward() - 0.5 * TotalCost(), TotalCost() + 0.5 * LatestReturn(),
)  # fmt: skip
CHECKED = {"load-shares": check_load_shares, "nearest-moves": check_nearest_moves}


def exceeds(problem: RoutingProblem, bound: float, best: float) -> bool:
    slack = 1e-9 * max(1.0, abs(best))
    return bound > best + slack if problem.sense == "min" else bound < best - slack


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, "prizes", "heterogeneous-fleet", "multiple-depots", "separate-durations"])
def test_no_bound_exceeds_the_optimum(feature: str) -> None:
    judged = 0
    for seed in range(4):
        problem = varied(feature, seed, few(feature)) if feature in WHOLE_FAMILY else small(feature, seed, "round")
        for k in (seed, seed + 3):
            asked = replace(problem, objective=Objective.of(GOALS[k % len(GOALS)]))
            best = best_values(asked)
            for name, check in CHECKED.items() if best is not None else ():
                judged += 1
                assert not exceeds(asked, check(asked, {}), float(best[0])), (name, seed, asked.objective)
    assert judged


ROUNDED = [
    (metric, convention) for metric in METRICS for convention in ("exact", "round", "trunc1", "trunc2", "ceil", "file")
    if convention != "file" or METRICS[metric].file_rounding is not None
]  # fmt: skip


@pytest.mark.parametrize(("metric", "convention"), ROUNDED)
def test_no_rounding_of_any_metric_makes_it_too_much(metric: str, convention: str) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        scale = (0.6, 3.0, 30.0)[seed % 3]  # where roundings weigh much, and little
        xy = rng.uniform(0, scale, (6, 2))
        xy[3] = xy[2]  # two in one place
        fleet = (VehicleType(None, 9.0), VehicleType(2, 14.0, fixed_cost=scale, unit_cost=1.2, unit_duration_cost=0.3, speed=2.0))
        sites = Sites.of(range(6), demand=[0, *rng.integers(1, 9, 5)], service=rng.integers(0, 2, 6))
        problem = RoutingProblem(sites, Travel(metric, xy, convention=convention), fleet[: 1 + seed % 2])
        best = best_values(problem)
        assert best is not None
        for name, check in CHECKED.items():
            assert check(problem, {}) <= float(best[0]) * (1 + 1e-9), (name, seed)


def test_what_it_proves_of_a_star_is_what_it_costs() -> None:
    # Four sites 10 away in one place, each with half a load: two routes out and back.
    xy = np.array([[0.0, 0.0]] + [[6.0, 8.0]] * 4)
    sites = Sites.of(range(5), demand=[0, 5, 5, 5, 5])
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=10.0, fixed_cost=3.0),))
    assert verified_bound(problem, Evidence("load-shares", "", 0.0, {})) == pytest.approx(46.0)
    assert verified_bound(problem, Evidence("nearest-moves", "", 0.0, {})) == pytest.approx(26.0), "half of two first and two last moves"


@pytest.mark.parametrize("power", [-300, -30, 30, 300])
def test_data_of_another_scale_give_the_same_bound(power: int) -> None:
    problem = plane(3, 8, 20.0)
    assert problem.travel.coordinates is not None
    plain = replace(problem, travel=Travel("euclidean", problem.travel.coordinates))
    scaled = replace(problem, travel=Travel("euclidean", problem.travel.coordinates * 2.0**power))
    for check in CHECKED.values():
        assert check(scaled, {}) == pytest.approx(check(plain, {}) * 2.0**power, rel=1e-12)


@pytest.mark.parametrize("vehicle", [{"unit_cost": 1e150}, {"fixed_cost": 1e150}, {"unit_duration_cost": 1e150, "speed": 1e-100}])
def test_numbers_beyond_all_doubles_prove_nothing_or_what_is_true(vehicle: dict[str, float]) -> None:
    level = Objective.of(1e150 * TotalCost())
    problem = replace(plane(1, 5, 20.0), fleet=(VehicleType(None, 20.0, **vehicle),), objective=level)  # type: ignore[arg-type]
    for check in CHECKED.values():
        bound = check(problem, {})
        assert not math.isnan(bound) and bound < math.inf


def test_other_families_and_objectives_prove_nothing() -> None:
    problem = plane(1, 5, 20.0)
    for kind, check in CHECKED.items():
        assert check(replace(problem, objective=Objective.of(Vehicles() - TotalCost())), {}) == -math.inf
        assert check(replace(problem, objective=Objective.of(Makespan())), {}) == 0.0
        with pytest.raises(InputError, match=kind):
            check(ArrayProblem(problem.compile().program), {})
