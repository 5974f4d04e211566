"""Why sites are left out: each reason against brute force over all places, and over all routes where it says that no vehicle can."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, varied
from truth.routing import RoutingTruth

import waybound as wb
from waybound import Group, Route, Routes, Shipment, Sites, Travel, VehicleType
from waybound.formulations.routing import unvisited_sites as module
from waybound.formulations.routing.insertion import orders
from waybound.formulations.routing.unvisited_sites import UNEXPLAINED, left_out

ONE = (VehicleType(1, 10, max_distance=12),)
LINE = np.array([[0.0, 0], [3, 0], [4, 0], [9, 0], [5, 0]])


def line(fleet=ONE, objective=None, **sites):
    held = {"required": False, "reward": [0, 5, 5, 5, 5]} | sites
    return wb.RoutingProblem(Sites.of("oabcd", **held), Travel("euclidean", LINE), fleet, objective or wb.Reward())


def reasons(problem, *routes):
    answer = Routes.of(Route(tuple(problem.sites.index()[k] for k in r)) if isinstance(r, str) else r for r in routes)
    return {one.where: one.reason for one in left_out(problem, answer)}


def verdicts(problem, answer, together):
    """The judge's, of the answer with the sites ``together`` put in at each place, in each order of pickups before deliveries."""
    pairs = [(x.pickup, x.delivery) for x in problem.sites.shipments]
    listed = [o for o in itertools.permutations(together) if all(o.index(p) < o.index(d) for p, d in pairs if {p, d} <= set(o))]
    routes = [*answer.routes, *(Route((), kind) for kind in range(len(problem.fleet)))]
    for number, route in enumerate(routes):
        for visits in (v for sites in listed for v in orders(route.visits, sites)):
            verdict = problem.evaluate(Routes((*(r for k, r in enumerate(answer) if k != number), Route(visits, route.vehicle))))
            if "fleet" not in {v.check for v in verdict.violations}:
                yield verdict


def loss(problem, before, after):
    return tuple(
        round((b - a) * (1 if sense == "min" else -1), 6) for a, b, sense in zip(before, after, problem.senses, strict=True)
    )  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_every_reason_is_true(feature):
    told, rng = 0, np.random.default_rng(2)
    for seed in range(5):
        problem = varied(feature, seed, {"reloads": 3, "recharging": 2, "initial-energy": 2}.get(feature, 4))
        must = problem.sites.required & (rng.random(len(problem.sites)) < 0.5)
        must[[k for x in problem.sites.shipments for k in (x.pickup, x.delivery)]] = False
        problem = replace(problem, sites=replace(problem.sites, required=must))
        truth, index = RoutingTruth(problem), problem.sites.index()
        for answer in [a for a in truth.samples if problem.evaluate(a).feasible][:3]:
            before, left = problem.evaluate(answer).values, left_out(problem, answer)
            visited = {k for r in answer for k in r.visits}
            assert [index[one.where] for one in left] == [k for k in problem.customers.tolist() if k not in visited]
            for one in left:
                told, site = told + 1, index[one.where]
                if one.proved:
                    assert all(site not in visits for _, visits in truth.driven), (seed, one)
                    continue
                if feature == "team-risk":  # of which single routes do not tell
                    assert one.reason == UNEXPLAINED
                    continue
                if "alternative" in one.reason:
                    assert any(site in g.sites and visited & set(g.sites) for g in problem.sites.groups)
                    continue
                together = {site} | {index[k] for k in re.findall(r"^with ([\w, ]+):", one.reason) for k in k.split(", ")}
                found = list(verdicts(problem, answer, sorted(together)))
                good = [loss(problem, before, v.values) for v in found if v.feasible]
                words = re.sub(r"^with [\w, ]+: ", "", one.reason)
                numbers = [float(v) for v in re.findall(r"(?:by at least|worse by|costs|better by|best,) ([\d.e+-]+)", words)]
                if "no room" in one.reason or "anywhere" in one.reason:
                    assert not good, (seed, one)
                    if "anywhere" in one.reason and numbers and "late" not in one.reason:
                        check = next(c for c in ("load", "distance", "duration", "energy", "route-risk") if module.WORDS[c] in one.reason)
                        amounts = [max((v.amount for v in x.violations if v.check == check), default=0.0) for x in found]
                        assert 0 < numbers[0] <= min(a for a in amounts if a > 0) + 1e-4, (seed, one)
                    continue
                best = min(good)
                deciding = next((v for v in best if abs(v) > 1e-9), 0.0)
                if "better" in one.reason:
                    assert deciding == pytest.approx(-numbers[-1], rel=1e-4), (seed, one, best)
                elif "change no" in one.reason:
                    assert deciding == 0.0, (seed, one, best)
                else:
                    assert deciding > 0 and deciding == pytest.approx(numbers[-1], rel=1e-4), (seed, one, best)
    assert told > 5 or feature == "closing-moves"


def test_each_reason_in_words():
    problem = line()
    assert reasons(problem, "ab") == {
        "c": "no vehicle can serve it: a route to it is 18 long at least, the longest distance is 12",
        "d": "inserting it (vehicle 1, before a) would make reward better by 5: this answer is not the best one",
    }
    tight = line((VehicleType(1, 10, max_distance=9),))
    assert reasons(tight, "ab")["d"] == "no vehicle can serve it: a route to it is 10 long at least, the longest distance is 9"
    apart = Travel("euclidean", np.array([[0.0, 0], [3, 0], [4, 0], [-9, 0], [-5, 0]]))
    assert reasons(replace(problem, travel=apart), "ab")["d"] == (
        "in this answer inserting it anywhere exceeds the longest distance by at least 6, and no vehicle is left"
    )
    costly = line((VehicleType(1, max_distance=12, fixed_cost=2),), wb.TotalCost() - wb.Reward(), reward=[0, 9, 9, 9, 1.5])
    assert reasons(costly, "ab")["d"] == "in this answer inserting it costs 2 at best, 0.5 more than the reward of 1.5"
    assert reasons(costly)["d"] == "in this answer inserting it costs 12 at best, 10.5 more than the reward of 1.5"
    kept = line((VehicleType(1),), wb.TotalCost() + wb.Penalties(), penalty=[0, 9, 9, 9, 1])
    assert reasons(kept, "abc")["d"].startswith("inserting it (vehicle 1, after b) would make total-cost + penalties better by 1")
    assert reasons(kept, "ab")["c"] == "in this answer inserting it costs 10 at best, 1 more than the penalty of 9"


def test_a_site_beyond_one_route_and_the_capacity_of_the_other_says_both():
    fleet = (VehicleType(1, 3, max_distance=20, name="van"), VehicleType(1, 9, max_distance=9, name="bike"))
    why = reasons(line(fleet, demand=[0, 2, 2, 2, 2]), Route((2,), 0), Route((1,), 1))
    assert why["d"] == (
        "in this answer there is no room for it in any of 4 places, and no vehicle is left: 2 times it exceeds the capacity by at least 1, "
        "2 times it exceeds the longest distance by at least 1"
    )


def test_alternatives_and_shipments_are_told_of():
    problem = line(groups=[Group((1, 2), False)], shipments=[Shipment(3, 4, (11.0,))], reward=[0, 5, 5, 1, 1])
    why = reasons(replace(problem, fleet=(VehicleType(1, 10),)), "a")
    assert why["b"] == "its alternative a is visited"
    assert why["c"] == "no vehicle can serve it: the shipment from c to d weighs 11, the capacity is 10"


def test_a_shipment_that_has_no_place_is_told_of_with_its_other_end():
    problem = line((VehicleType(1, 10, max_duration=15),), shipments=[Shipment(4, 2, (4.0,))], service=[0, 2, 2, 2, 2])
    why = reasons(problem, "a")
    assert why["d"] == "with b: in this answer inserting them anywhere exceeds the longest duration by at least 1, and no vehicle is left"
    assert why["b"].startswith("with d: ")


def test_of_sites_that_go_to_places_of_their_own_the_vehicle_is_told():
    """From a (3) by c (9) home: d (5) and b (4) are dropped on the way back, behind both visits."""
    problem = line((VehicleType(1, 10),), wb.Reward().then(wb.TotalCost()), shipments=[Shipment(4, 2, (4.0,))], ready=[0, 0, 0, 0, 15])
    better = "would make reward better by 10: this answer is not the best one"
    assert reasons(problem, "ac")["d"] == f"with b: inserting them (vehicle 1) {better}"


def test_where_too_many_routes_would_have_to_be_judged_nothing_more_is_said(monkeypatch):
    problem = line((VehicleType(1),), windows={4: [(0, 1), (90, 99)]})
    assert "better" in reasons(problem, "abc")["d"]
    monkeypatch.setattr(module, "MOST_JUDGED", 3)
    assert reasons(problem, "abc")["d"] == UNEXPLAINED


def test_of_an_answer_that_breaks_limits_nothing_is_claimed():
    assert reasons(line(), "abc") == {"d": UNEXPLAINED}
    must = line(required=[False, True, True, False, True])
    assert reasons(must, "abc") == {"d": "required, and left out of this answer"}


def test_a_thousand_sites_are_explained_at_once():
    rng = np.random.default_rng(1)
    sites = Sites.of(range(1001), demand=rng.integers(1, 9, 1001), required=False, reward=rng.integers(1, 20, 1001), due=900.0)
    problem = wb.RoutingProblem(
        sites, Travel("euclidean", rng.random((1001, 2)) * 30), [VehicleType(12, 60, max_duration=400)], wb.TotalCost() - wb.Reward()
    )
    found = left_out(problem, Routes.of(np.array_split(np.arange(1, 97), 12)))
    assert len(found) == 904 and not any(one.reason == UNEXPLAINED for one in found)


def test_a_solution_tells_it_as_a_frame_and_in_its_json():
    solution = wb.solve(line(), "highs", bound_time=0)
    frame = solution.left_out()
    assert list(frame.columns) == ["where", "reason", "proved"]
    assert frame.set_index("where").loc["c", "proved"]
    assert solution.to_json()["left_out"] == frame.to_dict("records")
