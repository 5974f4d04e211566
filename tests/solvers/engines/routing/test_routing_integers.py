import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import HealthCheck, given, settings, strategies as st

from waybound import Energy, Group, InputError, Route, Routes, RoutingProblem, Shipment, Sites, Travel, VehicleType
from waybound.instances.routing.instance import ENERGY_CHARGES
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.engines.routing.integer_scales import FINE, UNLIMITED
from waybound.solvers.engines.routing.routing_integers import entangled, integer_routing


@st.composite
def rough_problems(draw: st.DrawFn) -> RoutingProblem:
    """Three customers with data that no scale can hold exactly, or all of one decimal."""
    n = 4
    coarse = draw(st.booleans())
    part = st.integers(0, 600).map(lambda v: v / 10) if coarse else st.floats(0, 60)
    several = lambda size: np.array(draw(st.lists(part, min_size=size, max_size=size)))  # noqa: E731
    matrix = several(n * n).reshape(n, n)
    durations = several(n * n).reshape(n, n) if draw(st.booleans()) else None
    ready = several(n) if draw(st.booleans()) else np.zeros(n)
    ready[0] -= draw(st.sampled_from([0.0, 7.7]))
    due = np.where(np.array(draw(st.lists(st.booleans(), min_size=n, max_size=n))), np.inf, ready + several(n) * 2)
    sites = Sites.of(range(n), demand=several(n), ready=ready, due=due, service=several(n) / 3 if not coarse else several(n))
    limit = lambda scale: draw(part) * scale if draw(st.booleans()) else math.inf  # noqa: E731
    energy = Energy(draw(part) * 4, 1.0, draw(st.sampled_from(ENERGY_CHARGES))) if draw(st.booleans()) else None
    vehicle = VehicleType(None, limit(3), max_duration=limit(6), max_distance=limit(6), energy=energy)
    travel = Travel(EXPLICIT, matrix=matrix, duration_matrix=durations, convention="exact")
    return RoutingProblem(sites, travel, (vehicle,))


def integer_feasible(problem: RoutingProblem, visits: tuple[int, ...]) -> bool:
    """Whether some departure makes the route feasible in the integer data, by trying every departure that can matter."""
    data = integer_routing(problem)
    vehicle = problem.fleet[0]
    stops = [vehicle.start, *visits, vehicle.end]
    moves, given = list(itertools.pairwise(stops)), data.moves[0]
    if sum(int(data.demand[i, 0]) for i in visits) > data.capacity[0, 0]:
        return False
    if sum(int(given.distance_up[m]) for m in moves) > data.max_distance[0]:
        return False
    if sum(int(given.duration[m]) for m in moves) > data.travel_limit[0]:
        return False
    if given.charge is not None:
        charge = [int(given.charge[m]) for m in moves[:-1]]
        last = int(data.service[moves[-1][0]]) + int(given.duration[moves[-1]])
        if sum(charge) + last > data.charge_limit[0]:
            return False
    opens, closes = int(data.ready[vehicle.start]), max(int(data.ready[vehicle.start]), int(data.due[vehicle.start]))

    def finish(departure: int) -> int | None:
        clock = departure
        for (i, j), last in zip(moves, [False] * (len(moves) - 1) + [True], strict=True):
            clock += (int(data.service[i]) if i != vehicle.start else 0) + int(given.duration[i, j])
            if not last:
                clock = max(clock, int(data.ready[j]))
            if clock > data.due[j]:
                return None
        return clock

    earliest = finish(opens)
    if earliest is None or earliest > data.latest_return[0]:
        return False
    # The latest departure that delays nothing is found by bisection: finish() grows with the departure.
    low, high = opens, min(closes, earliest)
    while low < high:
        middle = (low + high + 1) // 2
        if finish(middle) == earliest:
            low = middle
        else:
            high = middle - 1
    return earliest - low <= data.max_duration[0]


@pytest.mark.slow
@settings(max_examples=draws(150), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(rough_problems())
def test_what_is_feasible_for_the_integers_is_feasible_for_the_data(problem: RoutingProblem) -> None:
    for visits in ((1,), (2, 3), (3, 1, 2)):
        if integer_feasible(problem, visits):
            verdict = problem.evaluate(Routes.of([Route(visits)]))
            assert not [v for v in verdict.violations if v.check != "visits"]


@pytest.mark.slow
@settings(max_examples=draws(100), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(rough_problems())
def test_exactly_scaled_data_lose_no_answer(problem: RoutingProblem) -> None:
    data = integer_routing(problem)
    if not data.scales["exact"] or math.isfinite(problem.fleet[0].max_duration) or problem.fleet[0].energy is not None:
        return
    for visits in ((1,), (2, 3), (3, 1, 2)):
        verdict = problem.evaluate(Routes.of([Route(visits)]))
        if not [v for v in verdict.violations if v.check != "visits"]:
            assert integer_feasible(problem, visits)


def test_a_window_without_an_integer_in_it_stays_reachable_and_safe() -> None:
    xy = np.array([[0.0, 0.0], [3.3, 4.4]])
    moment = 10.12345678
    sites = Sites.of(range(2), ready=[0, moment], due=[math.inf, moment], coordinates=xy)
    data = integer_routing(RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(),)))
    assert data.ready[1] == data.due[1]
    assert (data.due[1] / FINE) <= moment
    assert (data.due[1] + data.service[1]) / FINE >= moment


@pytest.mark.parametrize("unit", [1.0, 2.0**30, 2.0**-30])
def test_loads_are_counted_in_their_common_divisor(unit: float) -> None:
    sites = Sites.of(["o", "a", "b"], demand=[0, 6 * unit, 9 * unit])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(capacity=14 * unit), VehicleType()))
    made = integer_routing(problem)
    assert (made.demand.tolist(), made.capacity.tolist()) == ([[0], [2], [3]], [[4], [UNLIMITED]])
    assert made.scales["load"] == pytest.approx(1 / (3 * unit))


def test_the_depots_own_demand_and_service_do_not_count() -> None:
    xy = np.array([[0.0, 0.0], [3.0, 4.0]])
    sites = Sites.of(range(2), demand=[0.3333, 1], service=[9.1, 2], coordinates=xy)
    data = integer_routing(RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=1),)))
    assert data.scales == {"cost": 1, "distance": 1, "time": 1, "load": 1, "exact": True}
    assert data.demand.tolist() == [[0], [1]]
    assert data.service.tolist() == [0, 2]


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("distance", {"x": 300.0}),
        ("demand", {"demand": [0, 200, 3]}),
        ("service time", {"service": [0, 200]}),
        ("ready time", {"ready": [0, 200]}),
    ],
)
def test_values_too_large_for_integers_are_refused_by_name(name: str, parts: dict) -> None:
    parts = dict(parts)
    n = max([2, *(len(v) for v in parts.values() if isinstance(v, list))])
    xy = np.array([[0.0, 0.0], [parts.pop("x", 1.0), 0.0], [0.0, 0.0]])[:n]
    problem = RoutingProblem(Sites.of(range(n), coordinates=xy, **parts), Travel("euclidean", xy), (VehicleType(),))
    with pytest.raises(InputError, match=f"largest {name}"):
        integer_routing(problem, largest=100)
    integer_routing(problem)


def test_fixed_costs_with_decimals_are_kept() -> None:
    xy = np.array([[0.0, 0.0], [3.0, 4.0]])
    fleet = (VehicleType(fixed_cost=0.25, unit_cost=1.5),)
    data = integer_routing(RoutingProblem(Sites.of(range(2), coordinates=xy), Travel("euclidean", xy), fleet))
    cost = data.unit[0] * data.moves[0].distance[0, 1] + data.fixed[0]
    assert cost / data.cost_factor == pytest.approx(7.75)


def test_prices_of_time_are_whole_in_the_clocks_own_scale() -> None:
    matrix = np.array([[0.0, 1.25], [1.25, 0.0]])
    fleet = (VehicleType(unit_cost=0.5, unit_duration_cost=0.3, regular_duration=2.0, unit_overtime_cost=7.0),)
    data = integer_routing(RoutingProblem(Sites.of(range(2)), Travel(EXPLICIT, matrix=matrix), fleet))
    moved, lasts = (2 * int(m[0, 1]) for m in (data.moves[0].distance, data.moves[0].duration))
    beyond = lasts - int(data.regular_duration[0])
    cost = int(data.unit[0]) * moved + int(data.time[0]) * lasts + int(data.overtime[0]) * beyond
    assert data.scales["exact"] is True
    assert cost / data.cost_factor == pytest.approx(0.5 * 2.5 + 0.3 * 2.5 + 7.0 * 0.5, abs=1e-12)


def test_vehicles_of_one_travel_and_speed_share_their_moves() -> None:
    matrix, other = np.full((3, 3), 4.0), np.full((3, 3), 7.0)
    own = Travel(EXPLICIT, matrix=other)
    fleet = tuple(VehicleType(1, speed=s, travel=t) for s, t in ((1.0, None), (2.0, None), (1.0, own), (2.0, None)))
    data = integer_routing(RoutingProblem(Sites.of(range(3)), Travel(EXPLICIT, matrix=matrix), fleet))
    assert data.profile.tolist() == [0, 1, 2, 1]
    assert [int(data.moves_of(k).duration[0, 1]) for k in range(4)] == [4, 2, 7, 2]
    assert [int(data.moves_of(k).distance[0, 1]) for k in range(4)] == [4, 4, 7, 4]


def test_shifts_and_windows_are_rounded_inwards() -> None:
    third = 1.0 / 3.0
    sites = Sites.of(range(2), due=[50, 40], windows={1: [(third, 2 + third), (5 + third, 9.0)]})
    vehicle = VehicleType(shift=(third, 40 + third))
    data = integer_routing(RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((2, 2))), (vehicle,)))
    assert data.windows[1] == ((333334, 2333333), (5333334, 9000000))
    assert (data.opens[0], data.leaves[0], data.closes[0]) == (333334, 40333333, 40333333)


def test_all_loads_are_counted_in_one_unit() -> None:
    sites = Sites.of(range(3), demand=[[0, 0], [4, 2], [0, 6]], pickup=[[0, 0], [8, 0], [2, 0]], shipments=[Shipment(1, 2, (6.0,))])
    fleet = (VehicleType(capacity=9.0, further_capacity=(5.0,)), VehicleType(capacity=math.inf))
    data = integer_routing(RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((3, 3))), fleet))
    assert data.demand.tolist() == [[0, 0], [2, 1], [0, 3]]
    assert (data.pickup[:, 0].tolist(), data.shipped.tolist()) == ([0, 4, 1], [[3, 0]])
    assert data.capacity.tolist() == [[4, 2], [UNLIMITED, UNLIMITED]]
    assert data.limited == [0, 1]


def test_one_decimal_that_an_engine_has_no_room_for_is_rounded() -> None:
    """14.9 in another unit still has one decimal; ten times as much is more than 32 bits hold."""
    xy = np.array([[0.0, 0.0], [14.9, 0.0], [0.0, 14.9]]) * 2.0**30
    problem = RoutingProblem(Sites.of(range(3)), Travel("euclidean", xy), (VehicleType(),))
    made = integer_routing(problem, largest=2**32 - 1, total=2**32 - 1, fine=10)
    assert made.moves[0].distance_up.max() < 2**30


def test_matrices_made_in_strips_are_those_of_all_distances_and_are_made_anew_once_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.solvers.engines.routing.extents.STRIP", 10)
    xy = np.random.default_rng(1).uniform(0, 100, (7, 2))
    for convention in ("exact", "round"):
        travel = Travel("euclidean", coordinates=xy, convention=convention)
        data = integer_routing(RoutingProblem(Sites.of(range(7)), travel, (VehicleType(),)))
        moves, factor = data.moves[0], data.scales["distance"]
        assert np.array_equal(moves.distance, np.rint(travel.distances * factor))
        assert (moves.distance_up >= travel.distances * factor * (1 - 1e-12)).all()
        assert (moves.longest, moves.slowest) == (moves.distance_up.max(), moves.duration.max())
        assert (moves.duration is moves.distance) == (convention == "round")
        once = moves.distance
        moves.forget()
        assert moves.distance is not once and np.array_equal(moves.distance, once)


FIVE = Travel("euclidean", np.arange(10.0).reshape(5, 2))


def shipping(*shipments: Shipment, **sites: object) -> RoutingProblem:
    made = Sites.of(range(5), **sites)  # type: ignore[arg-type]
    return RoutingProblem(replace(made, shipments=shipments), FIVE, (VehicleType(),))


def test_ends_of_one_shipment_alone_are_not_entangled() -> None:
    assert not entangled(shipping(Shipment(1, 2, (1.0,)), Shipment(3, 4, (1.0,))))
    assert not entangled(shipping())


def test_what_else_ends_have_is_named() -> None:
    assert entangled(shipping(Shipment(1, 2, (1.0,)), Shipment(1, 3, (1.0,)))) == {"several shipments of one site"}
    assert entangled(shipping(Shipment(1, 2, (1.0,)), demand=[0, 0, 3, 0, 0])) == {"shipments of sites with demands or pickups"}
    assert not entangled(shipping(Shipment(1, 2, (1.0,)), demand=[0, 0, 0, 3, 0]))
    optional = shipping(Shipment(1, 2, (1.0,)), required=[False] * 5)
    assert entangled(replace(optional, sites=replace(optional.sites, groups=(Group((2, 3)),)))) == {"shipments of groups"}
