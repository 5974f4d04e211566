import math

import numpy as np
import pytest
from small_routing import FEATURES, WHOLE_FAMILY, drawn, enumerated, excludes

from waybound import InputError, Reward, RoutingProblem, Sites, TotalCost, VehicleType
from waybound.formulations.routing.checking.cut_multipliers import check_cut_multipliers
from waybound.formulations.routing.checking.known_features import RESOURCES
from waybound.instances.routing.travel import EXPLICIT, Travel


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, *FEATURES])
def test_no_prices_however_wrong_exclude_the_optimum(feature):
    judged = 0
    for seed in range(3):
        problem, rng = drawn(feature, seed), np.random.default_rng(seed)
        for scale in (0.0, 1.0, 4.0, 20.0):
            customers = problem.customers
            cuts = []
            for _ in range(4):
                members = rng.permutation(customers)[: int(rng.integers(1, len(customers) + 1))].tolist()
                cuts.append({"sites": members, "price": float(rng.uniform(-1, 5)), "of": members[0] if rng.random() < 0.5 else None})
            data = {
                "out": (scale * rng.normal(0.5, 1.0, len(problem.sites))).tolist(), "cuts": cuts,
                "in": (scale * rng.normal(0.5, 1.0, len(problem.sites))).tolist(),
                "rates": {str(rng.choice(RESOURCES)): float(rng.uniform(-0.2, 1.0))} if rng.random() < 0.5 else {},
            }  # fmt: skip
            bound = check_cut_multipliers(problem, data)
            assert not math.isnan(bound) and not excludes(problem, bound)
            judged += math.isfinite(bound) and enumerated(problem) is not None
    assert judged


def apart(objective, required, **fleet):
    """A depot, and far from it two groups of three sites, each 1 from the others of its group."""
    places = np.array([0.0, 10, 10, 10, -10, -10, -10])
    matrix = np.abs(places[:, None] - places) + 1.0
    np.fill_diagonal(matrix, 0.0)
    sites = Sites.of(range(7), reward=[0.0, *[4.0] * 6], demand=[0.0, *[1.0] * 6], required=[False, *[required] * 6])
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(**fleet),), objective)


def test_a_group_is_joined_to_the_depot():
    # The way to one group, through its three sites and back. Each site is worth 4; of its group each visit pays for the way there.
    problem = apart(Reward(), False, count=1, max_distance=24.0)
    data = {"out": [0.0] * 7, "in": [0.0, *[-4.0] * 6], "rates": {"distance": 0.6}}
    joined = [{"sites": half, "of": site, "price": 2.0} for half in ([1, 2, 3], [4, 5, 6]) for site in half]
    assert check_cut_multipliers(problem, data | {"rates": {}}) == 24.0
    assert check_cut_multipliers(problem, data | {"cuts": joined}) == 12.0
    assert check_cut_multipliers(problem, data) > 24.0


def test_as_many_routes_as_the_loads_take_enter_a_set():
    free = {"out": [0.0] * 7, "in": [0.0] * 7}
    around = free | {"cuts": [{"sites": half, "of": None, "price": 10.0} for half in ([1, 2, 3], [4, 5, 6])]}
    double, single = apart(TotalCost(), True, capacity=2.0), apart(TotalCost(), True, capacity=3.0)
    assert check_cut_multipliers(double, free) == 3.0 * 22.0  # three routes at least
    assert check_cut_multipliers(double, around) == 80.0 + 3.0 * 2.0  # two to each group: its optimum is 90
    assert check_cut_multipliers(single, around) == 40.0 + 2.0 * 2.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"out": [0.0]}, {"in": [math.nan] * 7}, {"rates": {"colour": 1.0}}, {"rates": [1]}, {"cuts": {}}, {"cuts": [{"price": 1.0}]},
        {"cuts": [{"sites": [0], "price": 1.0}]}, {"cuts": [{"sites": [1], "of": 2, "price": 1.0}]},
        {"cuts": [{"sites": [1], "price": math.inf}]}, {"cuts": [{"sites": [True], "price": 1.0}]},
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused(wrong):
    with pytest.raises(InputError):
        check_cut_multipliers(apart(TotalCost(), True), {"out": [0.0] * 7, "in": [0.0] * 7} | wrong)


def test_more_of_a_cost_is_bounded_by_nothing():
    assert check_cut_multipliers(apart(Reward() + TotalCost(), False), {"out": [0.0] * 7, "in": [0.0] * 7}) == math.inf
