import numpy as np
import pytest

from waybound import RoutingProblem, Sites, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import beats_bound, better_bound, verified_bound
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.bounds.routing.spanning_tree import spanning_tree_bound

SQUARE = np.array([(0, 0), (3, 0), (3, 4), (0, 4)], dtype=float)
SITES, FLEET = Sites.of("oabc", demand=[0, 1, 1, 1]), (VehicleType(count=1),)


def test_comparisons_follow_the_sense():
    assert better_bound("min", 2.0, 1.0)
    assert better_bound("max", 1.0, 2.0)
    assert beats_bound("min", 0.9, 1.0)
    assert beats_bound("min", 1.0 - 5e-7, 1.0)
    assert not beats_bound("min", 1.0 - 5e-10, 1.0) and beats_bound("min", 1e-12 - 5e-16, 1e-12)
    assert beats_bound("max", 1.1, 1.0)


def test_evidence_for_one_instance_is_priced_anew_on_another():
    near, far = (
        RoutingProblem(SITES, Travel("euclidean", coordinates=SQUARE), FLEET),
        RoutingProblem(SITES, Travel(EXPLICIT, matrix=np.full((4, 4), 100.0)), FLEET),
    )
    evidence = spanning_tree_bound(far, Stop(60.0))
    assert verified_bound(far, evidence) == pytest.approx(400.0)
    assert verified_bound(near, evidence) <= 14.0 + 1e-9
