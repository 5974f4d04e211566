import math
from dataclasses import replace

import numpy as np
import pytest

from waybound import Energy, RoutingProblem, generate
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.deviation_chord import deviation_chord_bound
from waybound.solving.bounding import find_bounds

METHOD = BOUNDS["deviation-chord"]


def risky(limit: float, team_risk: float | None) -> RoutingProblem:
    made = generate("random", customers=9, capacity=0, deviation=0.5, seed=3, **{"max-duration": limit})
    return replace(made, team_risk=team_risk)


@pytest.mark.slow
def test_what_is_found_is_verified_and_more_than_the_means_prove() -> None:
    problem, found = risky(240.0, 0.05), deviation_chord_bound(risky(240.0, 0.05), Stop(60.0))
    assert found is not None and found.value == verified_bound(problem, found)
    certain = replace(problem, team_risk=None)
    means = [e for name in ("state-space", "branch-price-cut") if (e := BOUNDS[name].evidence(certain, Stop(60.0), None, None)) is not None]
    assert found.value > max(verified_bound(certain, e) for e in means)
    assert "with the chord of the deviation" in found.source


def test_that_there_is_no_answer_is_found_where_the_chord_puts_a_site_out_of_reach() -> None:
    problem = risky(205.0, 1e-15)
    found = deviation_chord_bound(problem, Stop(60.0))
    assert found is not None and verified_bound(problem, found) == math.inf


def test_it_ends_when_it_is_told_and_applies_where_there_are_risks() -> None:
    stop = Stop()
    stop.ask()
    assert deviation_chord_bound(risky(240.0, 0.05), stop) is None
    assert METHOD.missing(risky(240.0, None)) == {"certain durations"}
    assert METHOD.missing(generate("sata")) == {"max-min problems"}


@pytest.mark.slow
def test_it_stands_for_slow_methods_where_it_leaves_nothing_out() -> None:
    plain = risky(240.0, 0.05)
    assert METHOD.replaces(plain) == {"state-space", "branch-price-cut"} and not METHOD.replaces(risky(240.0, None))
    both = replace(plain, fleet=(replace(plain.fleet[0], energy=Energy(500.0)),))
    late = replace(plain, sites=replace(plain.sites, due=np.full(10, 900.0)))
    for other in (both, late):
        assert not METHOD.missing(other) and not METHOD.replaces(other)
    found = find_bounds(plain, 2.0)
    assert {e.kind for e in found} >= {"deviation-chord"} and not {e.kind for e in found} & {"state-space", "set-partitioning-duals"}
