import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from joint_assignments import WORKED, enumerated, random_joint

from waybound.formulations.auctions.checking.errand_prices import check_errand_prices
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import InputError
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound


@pytest.mark.parametrize("scale", [1.0, 2.0**-40, 1e-9, 1e9, 1e140])
def test_any_prices_prove_no_more_than_what_holds(scale: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(draws(60)):
        problem = random_joint(rng, scale)
        best = enumerated(problem)
        counts = {"bins": problem.num_bins, "requests": problem.num_requests}
        data = {key: (rng.integers(-4, 9, count) * scale).tolist() for key, count in counts.items()}
        for s, t in rng.random((3, 2)) * 20 * scale:
            assert check_errand_prices(problem, {**data, "pickup": float(s), "delivery": float(t)}) <= best * (1 + 1e-15)


def test_duals_of_the_relaxation_prove_most_optima() -> None:
    rng = np.random.default_rng(4)
    closed = tested = 0
    for _ in range(draws(40)):
        problem = random_joint(rng)
        if not problem.pickups + problem.deliveries:
            continue
        evidence, best = linear_relaxation_bound(problem), enumerated(problem)
        assert evidence is not None
        bound = verified_bound(problem, evidence)
        assert bound <= best + 1e-9
        closed += math.isclose(bound, best, abs_tol=1e-9)
        tested += 1
    assert closed > 0.8 * tested


def test_evidence_of_another_shape_is_refused() -> None:
    good = {"bins": [0.0, 0.0], "requests": [0.0, 0.0], "pickup": 0.0, "delivery": 0.0}
    assert check_errand_prices(WORKED, good) == 0.0
    for change in ({"bins": [0.0]}, {"requests": None}, {"pickup": None}, {"delivery": math.inf}, {"bins": [0.0, True]}):
        with pytest.raises(InputError, check=coded("malformed")):
            check_errand_prices(WORKED, {**good, **change})
