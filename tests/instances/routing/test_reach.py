import itertools
import math
from typing import Any

import numpy as np
import pytest
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st

from waybound import InputError, RoutingInstance, Sites, VehicleType
from waybound.instances.routing import reach
from waybound.instances.routing.reach import least_levels, out_and_back, refuse_unreachable, shortest_ways
from waybound.instances.routing.travel import CONVENTIONS, Travel


def instance(d: Any, fleet: Any = (), **columns: Any) -> RoutingInstance:
    travel = Travel("EXPLICIT", matrix=d)
    return RoutingInstance("i", "test", Sites.of(range(len(d)), **columns), travel, tuple(fleet) or (VehicleType(),))


NEAR = [[0, 5, 7], [5, 0, 5], [7, 5, 0]]
DETOUR = [[0, 5, 90], [5, 0, 5], [90, 5, 0]]


def test_rounding_puts_no_customer_out_of_reach() -> None:
    """0.1 + 0.2 is 0.30000000000000004, and due at 0.3: the judge lets it pass, so the file is read."""
    travel = Travel("EXPLICIT", matrix=np.ones((2, 2)), duration_matrix=[[0, 0.2], [0.2, 0]])
    for due, read in ((0.3, True), (0.29, False)):
        made = RoutingInstance("i", "test", Sites.of(range(2), ready=[0.1, 0], due=[math.inf, due]), travel, (VehicleType(),))
        if read:
            refuse_unreachable(made)
        else:
            check_refused(InputError, "customer 1: earliest arrival", refuse_unreachable, made)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"d": NEAR, "due": [99, 99, 6]}, "customer 2: earliest arrival; expected at most 6; found at least 7"),
        ({"d": NEAR, "due": [13, 99, 99]}, "customer 2: earliest return to the depot; expected at most 13; found at least 14"),
        ({"d": NEAR, "due": [20, 99, 99], "ready": [0, 0, 14]}, "customer 2: earliest return"),
        ({"d": NEAR, "due": [99, 99, 8], "ready": [2, 0, 0]}, "customer 2: earliest arrival"),
        ({"d": NEAR, "due": [99, 10, 99], "service": [0, 95, 0]}, "customer 1: earliest return"),
        ({"d": NEAR, "fleet": [VehicleType(max_duration=13)]}, "customer 2: shortest duration of its route; expected at most 13"),
        ({"d": NEAR, "fleet": [VehicleType(max_duration=14)], "service": [0, 0, 1]}, "customer 2: shortest duration"),
        ({"d": NEAR, "fleet": [VehicleType(max_distance=13)]}, "customer 2: shortest length of its route; expected at most 13"),
        ({"d": DETOUR, "due": [99, 99, 9]}, "customer 2: earliest arrival; expected at most 9; found at least 10"),
    ],
)
def test_a_customer_out_of_reach_is_named_with_what_exceeds_what(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        refuse_unreachable(instance(**arguments), [10, 20, 30])
    assert caught.value.line == 10 * (1 + int(message.split()[1].rstrip(":")))


@pytest.mark.parametrize(
    "arguments",
    [
        {"d": NEAR},
        {"d": NEAR, "due": [14, 5, 7]},
        {"d": DETOUR, "due": [99, 99, 10]},  # through customer 1
        {"d": NEAR, "due": [99, 99, 6], "required": [False, True, False]},
        {"d": NEAR, "fleet": [VehicleType(max_duration=3, name="a"), VehicleType(max_duration=14, name="b")]},
        {"d": [[0, 1.9, 1.9], [1.9, 0, 1.9], [1.9, 1.9, 0]], "due": [2, 1, 1]},  # 1 each, if distances are cut to whole numbers
    ],
)
def test_what_some_vehicle_reaches_under_some_convention_is_accepted(arguments: dict[str, Any]) -> None:
    refuse_unreachable(instance(**arguments))


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(CONVENTIONS[1:]))
def test_nothing_that_a_route_could_serve_is_ever_refused(seed: int, convention: str) -> None:
    """Against all orders of all subsets: a refused customer is late in every one, under every convention."""
    rng = np.random.default_rng(seed)
    n = 4
    travel = Travel("EXPLICIT", matrix=rng.uniform(0, 10, (n, n)), convention=convention)
    ready = np.concatenate([[0], rng.integers(0, 8, n - 1)])
    due = ready + rng.integers(0, 12, n)
    due[0] += 12
    sites = Sites.of(range(n), ready=ready, due=due, service=rng.integers(0, 2, n) * (np.arange(n) > 0))
    made = RoutingInstance("i", "test", sites, travel, (VehicleType(max_duration=float(rng.integers(8, 40))),))
    servable: set[int] = set()
    for size in range(1, n):
        for order in itertools.permutations(range(1, n), size):
            time, waited, at = float(sites.ready[0]), 0.0, 0
            slack, on_time = math.inf, True
            for site in (*order, 0):
                arrival = time + (sites.service[at] if at else 0.0) + float(travel.duration(at, site))
                begin = max(arrival, float(sites.ready[site])) if site else arrival
                waited += begin - arrival
                slack = min(slack, waited + float(sites.due[site]) - begin)
                on_time = on_time and begin <= sites.due[site]
                time, at = begin, site
            if on_time and time - min(waited, slack) <= made.fleet[0].max_duration:
                servable.update(order)
    try:
        refuse_unreachable(made)
    except InputError as error:
        assert int(error.message.split("customer ")[1].split(":")[0]) not in servable


def test_a_way_of_length_0_is_a_way() -> None:
    moves = np.array([[0, 0, 9, 4], [9, 0, 0, 9], [9, 9, 0, 9], [0, 9, 9, 0]], dtype=float)
    ways = shortest_ways(moves, np.array([1, 2, 3]))
    assert ways.tolist() == [[0, 0, 0, 4], [9, 0, 0, 9], [9, 9, 0, 9], [0, 9, 9, 0]]


def walks(steps: Any, first: int, lower: Any, upper: Any) -> Any:
    """Least level at each node, by trying every order of nodes."""
    n = len(steps)
    best = np.full(n, math.inf)
    best[first] = lower[first]
    for size in range(1, n):
        for order in itertools.permutations([k for k in range(n) if k != first], size):
            level, at = lower[first], first
            for node in order:
                level, at = max(lower[node], level + steps[at, node]), node
                if level > upper[node]:
                    break
            else:
                best[at] = min(best[at], level)
    return best


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 20))
def test_least_levels_are_those_of_the_best_walk_however_few_moves_are_looked_at_at_once(seed: int, strip: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    steps = rng.integers(0, 9, (n, n)).astype(float)
    steps[rng.random((n, n)) < 0.2] = math.inf
    lower, upper = rng.integers(0, 12, n).astype(float), rng.integers(5, 30, n).astype(float)
    start = np.full(n, math.inf)
    start[0] = lower[0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reach, "STRIP", strip)
        found = least_levels(start, steps.__getitem__, lower, upper)
    assert found.tolist() == walks(steps, 0, lower, upper).tolist()


@settings(max_examples=draws(40), deadline=None)
@given(st.integers(0, 10**6))
def test_ways_out_and_back_are_those_between_all_pairs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 8))
    travel = Travel("EXPLICIT", matrix=rng.integers(0, 20, (n, n)))
    at = np.arange(1, n)
    out, back = out_and_back(travel.distance, VehicleType(), at)
    every = shortest_ways(travel.distances, at)
    assert out.tolist() == every[0, at].tolist()
    assert back.tolist() == every[at, 0].tolist()
    direct = out_and_back(travel.distance, VehicleType(), at, detours=False)
    assert direct[0].tolist() == travel.distances[0, at].tolist()
    assert (direct[1] >= back).all()


def test_service_on_the_way_counts_and_service_at_the_site_does_not() -> None:
    travel = Travel("EXPLICIT", matrix=DETOUR)
    out, back = out_and_back(travel.duration, VehicleType(), np.array([1, 2]), np.array([30.0, 7.0]))
    assert out.tolist() == [5, 40]
    assert back.tolist() == [5, 40]
