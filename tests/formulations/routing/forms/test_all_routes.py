import pytest
from small_routing import WHOLE_FAMILY, varied
from truth.routing import Roads

from waybound.formulations.routing.forms._all_routes import MOST_ROUTES, Walk, orders_of_stops, way_home


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [name for name in WHOLE_FAMILY if name not in ("recharging", "initial-energy", "reloads")])
def test_routes_and_what_they_add_up_to_are_those_of_brute_force(feature: str) -> None:
    some = 0
    for seed in range(6):
        problem = varied(feature, seed)
        roads = Roads(problem)
        u = roads.unit
        for kind in range(len(problem.fleet)):
            found = {r.visits: r for r in Walk(problem, kind).routes()}
            truth = dict(roads.routes(kind))
            truth.pop((), None)
            assert found.keys() == truth.keys(), (seed, kind)
            for visits, exact in truth.items():
                priced = found[visits]
                seen = (priced.distance, priced.duration, priced.finish, priced.cost, priced.reward)
                assert seen == pytest.approx(
                    (exact.distance / u, exact.duration / u, exact.finish / u, exact.cost / u**2, exact.reward / u), abs=1e-9
                ), (seed, visits)
                some += 1
    assert some > 30


@pytest.mark.parametrize("feature", ["reloads", "recharging", "initial-energy"])
def test_routes_with_stops_at_depots_are_driven_as_brute_force_drives_them(feature: str) -> None:
    """Brute force tries fewer of them, and can drive all."""
    stops = 0
    for seed in range(4):
        problem = varied(feature, seed, 3 if feature == "reloads" else 2)
        roads = Roads(problem)
        for kind in range(len(problem.fleet)):
            found = {r.visits: r for r in Walk(problem, kind).routes()}
            assert found.keys() >= {visits for visits, _ in roads.routes(kind) if any(not roads.depot[k] for k in visits)}
            for visits, priced in found.items():
                exact = roads.drive(kind, visits)
                assert exact is not None, (seed, visits)
                assert (priced.duration, priced.distance) == pytest.approx((exact.duration / roads.unit, exact.distance / roads.unit))
                stops += any(roads.depot[k] for k in visits)
    assert stops > 10


def test_committed_vehicles_go_home_where_they_can() -> None:
    problem = varied("committed-vehicles", 0)
    kind = next(k for k, v in enumerate(problem.fleet) if v.committed)
    home = way_home(problem, kind)
    assert home is not None and home.visits == () and home.reward == 0.0
    assert home.distance == problem.travel_of(kind).distances[problem.fleet[kind].start, problem.fleet[kind].end]


def test_orders_of_stops_are_counted() -> None:
    """4 + 12 + 24 + 24 for each of the types; with two depots on the way five choices in each gap."""
    plain = varied("skills", 0)
    assert orders_of_stops(plain) == 64 * len(plain.fleet)
    paused = varied("recharging", 0, 2)
    assert orders_of_stops(paused) == sum(2 * 5**2 + 2 * 5**3 for _ in paused.fleet)
    assert orders_of_stops(varied("skills", 0, 30)) > MOST_ROUTES
