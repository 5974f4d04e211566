import numpy as np
import pytest
import risky_cases as cases

from waybound.reports.studies.risk.families.risky_graphs import decoys, enumerated, least_risk, random_map, rewarded


@pytest.mark.parametrize("family", [least_risk(), rewarded(1.0), rewarded(0.0), decoys()], ids=lambda family: family.name)
def test_optima_are_those_of_all_paths(family):
    for k in range(3):
        case = family.case(k, seed=5)
        assert case.solved().value == pytest.approx(cases.best(case.problem))


def test_maps_are_small_and_repeat():
    first, second = (random_map(np.random.default_rng(2), "map", rewards=True) for _ in range(2))
    assert first.digest() == second.digest() and first.graph.num_states <= 9
    assert enumerated(first).solved().answer[0] == first.graph.start
