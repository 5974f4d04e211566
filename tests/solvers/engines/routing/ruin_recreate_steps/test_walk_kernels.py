import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import varied

from waybound import Energy, Route, Routes, RoutingProblem, Shipment, Sites, VehicleType
from waybound.formulations.routing.schedule import schedule
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.engines.routing.routing_integers import searched_integers
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import Arrays, arrays


def made(problem: RoutingProblem) -> Arrays:
    return arrays(problem, searched_integers(problem)[0], 60, 1)


def limited(problem: RoutingProblem, of: str, rng: np.random.Generator) -> RoutingProblem:
    """The problem with limits of which a walk decides, tight enough to bind."""
    n, matrix = len(problem.sites), problem.travel.matrix
    around = float(matrix.max())
    if of == "closing":
        shut = np.where(rng.random((n, n)) < 0.4, rng.integers(5, 60, (n, n)).astype(float), math.inf)
        return replace(problem, travel=replace(problem.travel, closing=shut))
    if of == "windows":
        energy = Energy(around * float(rng.uniform(2, 5)), 1.0, "windows")
        return replace(problem, fleet=tuple(replace(v, energy=energy) for v in problem.fleet))
    if of == "move":
        hours = matrix + rng.integers(0, 9, (n, n))
        energy = Energy(float(hours.max()) * float(rng.uniform(1.5, 4)), 1.0, "travel")
        fleet = tuple(replace(v, energy=energy) for v in problem.fleet)
        travel = Travel(EXPLICIT, matrix=matrix, duration_matrix=hours, variances=problem.travel.variances)
        return replace(problem, travel=travel, fleet=fleet)
    if of == "none":
        return problem
    return replace(problem, fleet=tuple(replace(v, max_duration=around * float(rng.uniform(2, 4))) for v in problem.fleet))


@pytest.mark.parametrize(
    ("feature", "of"),
    [
        *((feature, of) for feature in ("several-windows", "closing-moves") for of in ("closing", "move", "duration")),
        ("shifts", "windows"),
        ("route-risk", "none"),
        ("route-risk", "move"),
    ],
)
def test_a_walk_says_what_the_judge_says(feature: str, of: str) -> None:
    kept = refused = 0
    for seed in range(60):
        rng = np.random.default_rng([seed, *of.encode()])
        problem = limited(varied(feature, seed, 5), of, rng)
        held = made(problem)
        if not held.flags & k.WALKED:
            continue
        visits = tuple(rng.permutation(problem.customers)[: rng.integers(1, 6)].tolist())
        route = Route(visits, int(rng.integers(len(problem.fleet))))
        judged = problem.evaluate(Routes((route,)))
        sound = {v.check for v in judged.violations} <= {"visits", "groups"}
        held.put(Routes((route,)))
        assert (len(held.routes(held.node[:, k.FOLLOWING])) == 1) == sound, seed
        if sound and held.flags & k.SPANNED:
            row = held.route[held.route[:, k.VISITS] > 0][0]
            assert row[k.SPENT] == pytest.approx(schedule(problem, route).duration * searched_integers(problem)[0].scales["time"]), seed
        kept, refused = kept + sound, refused + (not sound)
    assert kept > 3 and refused > 3


def test_a_route_to_one_site_costs_what_its_least_duration_does() -> None:
    """Whoever leaves at once comes too early for the only window that can be met; whoever leaves later is there when it opens."""
    xy = np.array([[0, 0], [10, 0]], dtype=float)
    sites = Sites.of(range(2), windows={1: [(0, 1), (90, 99)]}, coordinates=xy)
    vehicle = VehicleType(unit_duration_cost=1.0, unit_cost=0.0)
    assert made(RoutingProblem(sites, Travel("euclidean", xy), (vehicle,))).alone[0, 1] == 20
    assert made(RoutingProblem(sites, Travel("euclidean", xy), (replace(vehicle, max_duration=19.0),))).alone[0, 1] == k.NONE


@pytest.mark.parametrize("load", [4.0, 5.0])
def test_a_shipment_stays_on_board_while_the_vehicle_reloads(load: float) -> None:
    """Two sites are brought 6 each on two trips of a vehicle of 10; a shipment is on board from the first trip to the second."""
    xy = np.array([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]], dtype=float)
    sites = Sites.of(range(5), demand=[0, 6, 6, 0, 0], shipments=[Shipment(3, 4, (load,))], coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(1, 10.0, reloads=(0,)),))
    answer, held = Routes.of([[3, 1, 0, 2, 4]]), made(problem)
    held.put(answer)
    assert problem.evaluate(answer).feasible == (load == 4.0) == (len(held.routes(held.node[:, k.FOLLOWING])) == 1)


def test_the_risk_of_the_team_is_the_judges() -> None:
    kept = refused = 0
    for seed in range(60):
        problem, rng = varied("team-risk", seed, 5), np.random.default_rng(seed)
        held, sites = made(problem), rng.permutation(problem.customers).tolist()
        routes = [Route(tuple(part), kind) for kind, part in enumerate(np.array_split(sites, len(problem.fleet))) if len(part)]
        judged = problem.evaluate(Routes.of(routes))
        held.put(Routes.of(routes))
        sound = {v.check for v in judged.violations} <= {"visits", "groups"}
        assert (len(held.routes(held.node[:, k.FOLLOWING])) == len(routes)) == sound, seed
        if sound:
            told = -np.expm1(-np.ldexp(float(held.sums[k.HAZARDS]), -50))
            assert told == pytest.approx(judged.quantities["team-overrun"], rel=1e-5, abs=1e-12), seed
        kept, refused = kept + sound, refused + (not sound)
    assert kept > 3 and refused > 3


def test_an_answer_that_takes_the_place_of_another_keeps_its_routes() -> None:
    """The risk of the team counts the routes that are put in, none of those before."""
    for seed in range(40):
        problem, rng = varied("team-risk", seed, 5), np.random.default_rng(seed)
        held, kept = made(problem), []
        for _ in range(8):
            sites = rng.permutation(problem.customers)[: rng.integers(1, 6)].tolist()
            parts = [part for part in np.array_split(sites, len(problem.fleet)) if len(part)]
            answer = Routes.of([Route(tuple(part.tolist()), kind) for kind, part in enumerate(parts)])
            if {v.check for v in problem.evaluate(answer).violations} <= {"visits", "groups"}:
                kept.append(answer)
        for answer in kept:
            held.put(answer)
            assert len(held.routes(held.node[:, k.FOLLOWING])) == len(answer), seed
