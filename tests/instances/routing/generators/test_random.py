from typing import Any

import numpy as np
import pytest

from waybound.instances.generating import generate


def made(**settings: Any) -> Any:
    return generate("random", 2, **settings)


def test_the_defaults_make_a_cvrp() -> None:
    i = made()
    assert (i.problem, len(i.sites), i.fleet[0].count, i.travel.metric) == ("cvrp", 7, None, "euclidean")
    assert i.sites.demand[0] == 0 and (i.sites.demand[1:] >= 1).all()


@pytest.mark.parametrize(
    ("settings", "problem"), [({"windows": True}, "vrptw"), ({"capacity": 0, "vehicles": 1}, "tsp"), ({"capacity": 0}, "min-cost-vrp")]
)
def test_settings_choose_the_problem(settings: dict[str, Any], problem: str) -> None:
    assert made(**settings).problem == problem


def test_windows_are_windows_and_service_is_bounded() -> None:
    i = made(customers=50, windows=True, service=20)
    s = i.sites
    assert np.isfinite(s.due).all() and (s.ready <= s.due).all() and (s.ready[1:] > 0).any()
    assert s.service.max() <= 20 and s.service[0] == 0


def test_explicit_distances_differ_by_direction() -> None:
    d = made(metric="explicit").travel.distances
    assert not np.array_equal(d, d.T)


def test_durations_may_be_uncertain_and_limited_and_all_else_stays_as_it_is() -> None:
    plain, i = made(customers=20), made(customers=20, deviation=0.3, **{"max-duration": 250})
    assert np.array_equal(plain.sites.coordinates, i.sites.coordinates) and np.array_equal(plain.sites.demand, i.sites.demand)
    assert plain.travel.variances is None and plain.fleet[0].max_duration == np.inf and i.fleet[0].max_duration == 250
    parts = np.sqrt(i.travel.variances)[i.travel.durations > 0] / i.travel.durations[i.travel.durations > 0]
    assert 0.2 < parts.max() <= 0.3 + 1e-12 and parts.min() < 0.1
