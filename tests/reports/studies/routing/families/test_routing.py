import numpy as np
import pytest
from truth.routing import best_values

from waybound.instances.routing.travel import Travel
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.routing.families import routing as families
from waybound.reports.studies.routing.tours import metric, partition_ratio

SMALL = 5


@pytest.mark.share(2)
@pytest.mark.parametrize("make", ["salesman", "loads", "shared", "rewarded", "risky"])
def test_the_optimum_of_a_random_problem_is_that_of_the_brute_force(make: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(families, "MOST", SMALL)
    for family in families.random_families(make):
        for k in range(4):
            case = family.case(k, 1)
            best = best_values(case.problem)
            assert best is not None and case.solved().value == pytest.approx(best[0], rel=1e-9, abs=1e-12)
            assert case.problem.evaluate(case.solved().answer).feasible


def test_all_but_rounded_distances_are_metric() -> None:
    rng = np.random.default_rng(1)
    for kind in families.KINDS:
        travels = [families.travel_of(rng, kind, 9) for _ in range(30)]
        assert all((t.distances == t.distances.T).all() for t in travels)
        kept = [bool((t.distances[:, :, None] + t.distances[None] >= t.distances[:, None] * (1 - 1e-12)).all()) for t in travels]
        assert all(kept) == (kind != "rounded")


def test_a_strip_leads_christofides_towards_half_as_much_again() -> None:
    ratios = []
    for k in range(families.strips().size or 0):
        case = families.strips().case(k, 1)
        assert metric(case.problem)
        found = run_heuristic(case.problem, "christofides", {"improve": False}, 1)
        ratios.append(case.problem.evaluate(found.answer).values[0] / case.solved().value)
        if len(case.problem.sites) <= 9:
            assert optimum(case.problem).value == pytest.approx(case.solved().value, rel=1e-6)
    assert ratios[-1] > 1.47 and max(ratios) <= 1.5


@pytest.mark.parametrize(
    "family",
    [*families.load_traps(), *families.share_traps(), *families.nearest_traps(), *families.reward_traps()],
    ids=lambda family: family.name,
)
def test_traps_are_metric_and_small_enough_to_enumerate(family: families.Family) -> None:
    for k in range(family.size or 0):
        case = family.case(k, 1)
        assert metric(case.problem) and case.problem.evaluate(case.solved().answer).feasible


def test_pairs_that_share_a_vehicle_are_cut_apart() -> None:
    case = families.big_and_small(6.0, 4.0, 4)
    found = run_heuristic(case.problem, "tour-partitioning", {}, 1)
    assert case.problem.evaluate(found.answer).values[0] > 1.5 * case.solved().value
    assert run_heuristic(case.problem, "split", {}, 1).guarantee is not None


@pytest.mark.parametrize(
    ("demand", "capacity", "ratio"), [([1, 1, 1], 2, 1.75), ([2, 4, 2], 4, 2 + 0), ([1, 2, 3], 5, 3.2), ([0, 2, 3], 4, 3.5)]
)
def test_ratios_of_the_literature(demand: list[float], capacity: float, ratio: float) -> None:
    from waybound.formulations.routing.problem import RoutingProblem
    from waybound.instances.routing.instance import Sites, VehicleType

    travel = Travel("euclidean", np.random.default_rng(1).uniform(0, 9, (4, 2)))
    problem = RoutingProblem(Sites.of(range(4), demand=[0, *demand]), travel, (VehicleType(capacity=capacity),))
    assert partition_ratio(1.5)(problem) == pytest.approx(ratio)


def test_both_rules_of_greedy_orienteering_are_led_astray() -> None:
    (family,) = families.reward_traps()
    for k, rule in ((1, "reward"), (3, "density")):
        case = family.case(k, 1)
        found = run_heuristic(case.problem, "greedy-orienteering", {"by": rule}, 1)
        assert case.solved().value >= 5 * case.problem.evaluate(found.answer).values[0]
