"""Answers at the edge of what the judge lets pass: whatever it accepts beats no verified bound."""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hostile_instances import FAMILIES, Rng, Units, numbers, risk_allocation, routing_at_risk, shaken, style
from hostile_judging import VANISHING
from truth.families import truth

from waybound import Allocation, CheckFailedError, InputError, Problem, Route, Routes, RoutingProblem, Selection, SubmodularSelection
from waybound.formulations.certificate import certify
from waybound.formulations.routing.judge import schedule
from waybound.formulations.routing.overrun import joint_overrun, route_overrun
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.instance import ENERGY_CHARGES, Energy
from waybound.instances.sata.constraints import Knapsack
from waybound.solvers.engines.risk.convex_allocation_steps.successive_tangents import SuccessiveTangents
from waybound.solving.bounding import find_bounds

SEED = 82
ROUNDING = 1e-12
MOST_ROUTES = 60


def hair(rng: Rng, size: Any = ()) -> Any:
    """Small parts of 1: on both sides of the tolerances that a judge has for vectors and for sums, and down to the last digit."""
    edges = rng.choice([5.99, 6.01, 8.99, 9.01, 10.99, 11.01], size)
    digits = np.where(rng.random(size) < 0.5, rng.uniform(10.5, 16.5, size), rng.uniform(5, 16, size))
    return 10.0 ** -np.where(rng.random(size) < 0.3, edges, digits)


def shares(rng: Rng) -> tuple[Problem, list[Any]]:
    """Vectors near an optimum, or anywhere: parts of it negative, its rows exceeded, by a hair."""
    problem = FAMILIES[str(rng.choice(["bottleneck-lp", "max-min", "min-max"]))](rng, Units.drawn(rng))
    best = truth(problem).samples
    size = problem.graph.num_actions if hasattr(problem, "graph") else problem.num_variables  # type: ignore[attr-defined]
    made = []
    for _ in range(40):
        x = best[0] if best and rng.random() < 0.7 else numbers(rng, size, style(rng))
        unit = float(np.abs(x).max(initial=0.0)) or 1.0
        stretch = 1.0 + float(rng.choice([-1.0, 1.0, 1.0])) * hair(rng) * rng.integers(0, 2, size)
        made.append(x * stretch + unit * hair(rng, size) * rng.choice([-1.0, 0.0, 1.0], size) * (rng.random() < 0.7))
        low = x * (1.0 + hair(rng))
        low[low == 0] = -unit * hair(rng)
        made.append(low)
    return problem, made


def vectors(rng: Rng) -> tuple[Problem, list[Any]]:
    """Points of programs near an optimum: variables and rows outside by a hair."""
    problem = FAMILIES["arrays"](rng, Units.drawn(rng))
    best, n = truth(problem).samples, problem.program.num_variables  # type: ignore[attr-defined]
    if not best:
        return problem, []
    unit = float(np.abs(best[0]).max(initial=0.0)) or 1.0
    return problem, [best[0] + unit * hair(rng, n) * rng.choice([-1.0, 0.0, 1.0], n) for _ in range(40)]


def choices(rng: Rng) -> tuple[Problem, list[Any]]:
    """All sets of elements, the budget a hair below what one of them costs."""
    units = Units.drawn(rng)
    drawn = FAMILIES["selection"](rng, units)
    assert isinstance(drawn, SubmodularSelection)
    n = drawn.num_elements
    costs = numbers(rng, n, style(rng)) * units.budget
    budget = math.fsum(costs[rng.random(n) < 0.6]) * (1.0 - hair(rng))
    sets = [Selection(s) for k in range(n + 1) for s in itertools.combinations(range(n), k)]
    return SubmodularSelection(drawn.function, Knapsack(costs, budget)), sets


def routes(rng: Rng) -> tuple[Problem, list[Any]]:
    """Ways to visit all sites, one limit of the problem a hair below what one route needs."""
    drawn = FAMILIES["routing"](rng, Units.drawn(rng))
    assert isinstance(drawn, RoutingProblem)
    customers = drawn.customers.tolist()
    tour = Route(tuple(rng.permutation(customers)[: int(rng.integers(1, len(customers) + 1))].tolist()))
    plan, v, less = schedule(drawn, tour), drawn.fleet[0], 1.0 - hair(rng)
    kind = int(rng.integers(5))
    if kind == 0:
        v = replace(v, capacity=plan.total_load * less)
    elif kind == 1:
        v = replace(v, max_distance=plan.total_distance * less)
    elif kind == 2:
        v = replace(v, max_duration=plan.duration * less)
    elif kind == 3:
        charge = str(rng.choice(ENERGY_CHARGES))
        rate = 1.0 if v.energy is None else v.energy.rate
        v = replace(v, energy=Energy(rate * plan.charged[charge] * less, rate, charge))
    sites, last = drawn.sites, tour.visits[-1]
    if kind == 4:
        due = sites.due.copy()
        due[last] = max(sites.ready[last], plan.arrival[-1] * (less if plan.arrival[-1] > 0 else 2.0 - less))
        sites = replace(sites, due=due)
    problem = replace(drawn, sites=sites, fleet=(v, *drawn.fleet[1:]))
    every = [Routes(tuple(Route(r) for r in parts)) for parts in _partitions(customers)]
    return problem, [every[k] for k in rng.permutation(len(every))[:MOST_ROUTES].tolist()]


def late(rng: Rng) -> tuple[Problem, list[Any]]:
    """Ways to visit all sites whose durations are uncertain, one risk a hair below that of one route, or of all of them."""
    drawn = routing_at_risk(rng, Units.drawn(rng))
    every = [Routes(tuple(Route(r) for r in parts)) for parts in _partitions(drawn.customers.tolist())]
    chosen = [every[k] for k in rng.permutation(len(every))[:MOST_ROUTES].tolist()]
    (vehicle,) = drawn.fleet
    overruns = [route_overrun(vehicle, schedule(drawn, route)) for route in chosen[0].routes]
    team = vehicle.risk is None
    risk = (joint_overrun(overruns) if team else max(overruns)) * (1.0 - hair(rng))
    if not 0.0 < risk <= 0.5:
        return drawn, chosen
    return replace(drawn, team_risk=risk) if team else replace(drawn, fleet=(replace(vehicle, risk=risk),)), chosen


def allocations(rng: Rng) -> tuple[Problem, list[Any]]:
    """Decisions near the best allocation: rows, bounds, limits and risks outside by a hair, and parts of the total given twice."""
    problem = risk_allocation(rng, Units.drawn(rng))
    part = problem.by_allocation() if problem.risk.kind == "joint" else problem
    found = SuccessiveTangents(part).run(Stop(10.0), 0.0).answer
    if found is None:
        return problem, []
    x, unit, made = found.decision, float(np.abs(found.decision).max(initial=0.0)) or 1.0, []
    for _ in range(20):
        moved = x + unit * hair(rng, len(x)) * rng.choice([-1.0, 0.0, 1.0], len(x))
        risks = problem.risks(moved) * (1.0 + hair(rng) * rng.choice([-1.0, 0.0, 1.0], len(problem.names)))
        made += [Allocation(moved), Allocation(moved, risks)] if problem.risk.kind == "allocated" else [Allocation(moved)]
    return problem, made


def _partitions(rest: list[int]) -> Iterator[tuple[tuple[int, ...], ...]]:
    """All ways to put sites into routes, in any order."""
    if not rest:
        yield ()
        return
    first, others = rest[0], rest[1:]
    for size in range(len(others) + 1):
        for group in itertools.combinations(others, size):
            left = [k for k in others if k not in group]
            for order in itertools.permutations((first, *group)):
                for more in _partitions(left):
                    yield (order, *more)


DRAWS: dict[str, Callable[[Rng], tuple[Problem, list[Any]]]] = {
    "shares": shares, "vectors": vectors, "choices": choices, "routes": routes, "late": late, "allocations": allocations,
}  # fmt: skip


def gains_of(name: str, case: int) -> tuple[int, int, list[str]]:
    """Answers tried, those accepted though they break something by a hair, and those that beat a bound."""
    rng = np.random.default_rng([SEED, case])
    problem, answers = DRAWS[name](rng)
    evidence = find_bounds(problem, 1.0) if answers else []
    evidence += [replace(e, data=shaken(rng, e.data)) for e in evidence]  # a bound holds for any evidence, however wrong
    bounds = [(verified_bound(problem, e), e) for e in evidence]
    sign, edge, found = 1.0 if problem.sense == "min" else -1.0, 0, []
    for answer in answers:
        evaluation = problem.evaluate(answer)
        if not evaluation.feasible:
            continue
        edge += any(c.residual > 0 for c in evaluation.checks)
        value = evaluation.values[0]
        for bound, e in bounds:
            beaten = sign * (bound - value) > ROUNDING * max(abs(value), abs(bound) if math.isfinite(bound) else 0.0) + VANISHING
            if name in ("vectors", "allocations"):  # what a broken row is worth is conceded where bound and answer meet
                beaten = _contradicts(problem, evaluation, e)
            if beaten:
                found.append(
                    f"case {case}: {value!r} beats the bound {bound!r} by {e.kind}, residuals {[c.residual for c in evaluation.checks]}"
                )
    return len(answers), edge, found


def _contradicts(problem: Problem, evaluation: Any, evidence: Any) -> bool:
    try:
        certify(problem, evaluation, [evidence])
    except CheckFailedError:
        return True
    return False


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(
    ("name", "few", "full"),
    [
        ("shares", 350, 47_000), ("vectors", 250, 20_000), ("choices", 200, 20_000), ("routes", 200, 8_000), ("late", 40, 1_500),
        ("allocations", 100, 5_000),
    ],
)  # fmt: skip
def test_no_accepted_answer_beats_a_bound(name: str, few: int, full: int, share: Callable[[int, int], int], tally: Any) -> None:
    goal, case, beaten = share(few, full), 0, []
    while tally["answers at the edge of the tolerance"] < goal:
        try:
            tried, edge, found = gains_of(name, case)
        except InputError as fault:
            raise AssertionError(f"case {case}: {fault}") from fault
        tally["answers at the edge of the tolerance"] += tried
        tally["answers accepted although they break something by a hair"] += edge
        beaten += found
        case += 1
    assert not beaten, f"{len(beaten)} of {goal}: {beaten[:5]}"
