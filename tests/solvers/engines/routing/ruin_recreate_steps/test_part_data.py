from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

import waybound as wb
from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import arrays
from waybound.solvers.engines.routing.ruin_recreate_steps.part_data import OF_SITES, OF_TYPES, Divisible


@pytest.mark.parametrize(
    "feature", ["capacity", "time-windows", "heterogeneous-fleet", "multiple-depots", "several-loads", "skills", "vehicle-travel", "reward"]
)
def test_sites_and_vehicles_have_the_integers_that_they_have_in_the_whole(feature: str) -> None:
    problem = small(feature, 1, "trunc1")
    data = with_slope(problem, integer_routing(problem))
    counts = np.array([k % 2 + (k == 0) for k in range(len(problem.fleet))])
    part = Divisible(problem, data).part(problem.customers[1:4], counts)
    assert set(problem.customers[1:4]) <= set(part.sites.tolist()) and part.kinds.tolist() == np.nonzero(counts)[0].tolist()
    for name in OF_SITES:
        assert np.array_equal(getattr(part.data, name), getattr(data, name)[part.sites])
    for name in set(OF_TYPES) - {"profile"}:
        assert np.array_equal(getattr(part.data, name), getattr(data, name)[part.kinds])
    for own, kind in enumerate(part.kinds.tolist()):
        for name in ("distance", "distance_up", "duration"):
            every = getattr(data.moves_of(kind), name)
            assert np.array_equal(getattr(part.data.moves_of(own), name), every[np.ix_(part.sites, part.sites)])
        ends = [(v.start, v.end) for v in (problem.fleet[kind], part.problem.fleet[own])]
        assert [problem.sites.ids[k] for k in ends[0]] == [part.problem.sites.ids[k] for k in ends[1]]
    assert part.data.cost_factor == data.cost_factor and part.data.scales == data.scales


def test_a_part_of_all_is_the_whole() -> None:
    problem = small("heterogeneous-fleet", 2, "round")
    data = integer_routing(problem)
    counts = np.array([len(problem.customers) if v.count is None else v.count for v in problem.fleet])
    part = Divisible(problem, data).part(problem.customers, counts)
    whole, own = arrays(problem, data, 5, 1), arrays(part.problem, part.data, 5, 1)
    assert part.sites.tolist() == list(range(len(problem.sites)))
    for name in ("ways", "site", "near", "reach", "drive", "alone"):
        assert np.array_equal(getattr(whole, name), getattr(own, name)), name


def test_forbidden_moves_stay_forbidden() -> None:
    problem = small("capacity", 0, "round")
    forbidden = np.zeros((len(problem.sites),) * 2, dtype=bool)
    a, b = problem.customers[:2].tolist()
    forbidden[a, b] = True
    problem = replace(problem, forbidden=forbidden)
    part = Divisible(problem, integer_routing(problem)).part(problem.customers[:3], np.ones(len(problem.fleet), dtype=np.int64))
    assert part.problem.forbidden is not None and part.problem.forbidden.sum() == 1
    place = part.sites.tolist()
    assert part.problem.forbidden[place.index(a), place.index(b)]


def test_attributes_of_sites_are_left_behind() -> None:
    xy = np.zeros((3, 2))
    sites = wb.Sites.of(range(3), coordinates=xy, attributes={"shop": ("a", "b", "c")})
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(),))
    part = Divisible(problem, integer_routing(problem)).part(problem.customers[:1], np.array([1]))
    assert not part.problem.sites.attributes and len(part.problem.sites) == 2
