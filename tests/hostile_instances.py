"""Tiny problems of every family with wild data, the same again in any units: what the attacks of ``tests/hostile`` are drawn from.

A draw depends on the generator alone; ``Units`` then multiply each kind of quantity. Two draws from equal generators in different units
are therefore the same problem, measured differently.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from statistics import NormalDist
from typing import Any, Self

import numpy as np
import scipy.sparse as sp

from waybound import BalancedPartition, BinAssignment, GeneralisedAssignment, JointAssignment, Problem, RoomExploration, TaskAllocation
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.formulations.risk.risky_path import RiskyPath
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.formulations.routing.objective import Composable, LongestRoute, Makespan, Objective, Reward, TotalCost, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.sata.max_min_lp import MaxMinLP
from waybound.formulations.sata.submodular_selection import SubmodularSelection
from waybound.formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.instances.auctions.exploration_map import ExplorationMap
from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError
from waybound.instances.risk.allocation import Affine, ChanceConstraints, CostTerm, Risk, RiskAllocationInstance
from waybound.instances.risk.elements import LocaleRisk, MoveRisk
from waybound.instances.risk.gaussian import Quantities
from waybound.instances.risk.risky_graph import RiskyGraph
from waybound.instances.risk.traverse_elements import CollectedRisk
from waybound.instances.risk.uncertain_graph import UncertainGraph
from waybound.instances.routing.instance import ENERGY_CHARGES, Energy, Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.instances.sata.constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation, UserFunction

Floats = np.ndarray[Any, np.dtype[np.float64]]
Rng = np.random.Generator


@dataclass(frozen=True)
class Units:
    """A factor for each kind of quantity. ``weight`` is that of what is covered or gained, ``budget`` that of knapsack costs."""

    distance: float = 1.0
    time: float = 1.0
    load: float = 1.0
    energy: float = 1.0
    cost: float = 1.0
    reward: float = 1.0
    weight: float = 1.0
    budget: float = 1.0

    @classmethod
    def common(cls, factor: float) -> Self:
        return cls(*[factor] * len(fields(cls)))

    @classmethod
    def drawn(cls, rng: Rng) -> Self:
        """One factor between 1e-9 and 1e9 for all, or one each; powers of two, of ten, or any."""
        many = len(fields(cls))
        powers = rng.uniform(-9, 9, many) if rng.random() < 0.4 else np.repeat(rng.uniform(-9, 9), many)
        kind = rng.integers(4)
        if kind == 0:
            return cls()
        made = 10.0**powers if kind == 1 else 10.0 ** np.round(powers) if kind == 2 else 2.0 ** np.round(powers * math.log2(10.0))
        return cls(*made.tolist())


STYLES = ("whole", "ties", "equal", "decimal", "float", "mixed", "tiny", "close", "zeros", "near-thousandths", "subnormal")


def numbers(rng: Rng, size: Any, style: str) -> Floats:
    """Numbers >= 0 of one style."""
    k, u = rng.integers(0, 10, size).astype(float), rng.random(size)
    made: dict[str, Callable[[], Any]] = {
        "whole": lambda: k,
        "ties": lambda: np.floor(3.0 * u),
        "equal": lambda: np.full(size, float(rng.integers(1, 8))),
        "decimal": lambda: np.floor(100.0 * u) / 10.0,
        "float": lambda: 10.0 * u,
        "mixed": lambda: 10.0 ** rng.uniform(-12, 12, size),
        "tiny": lambda: np.where(u < 0.5, k + 1.0, (k + 1.0) * 10.0 ** -float(rng.integers(5, 17))),
        "close": lambda: 1.0 + k * 10.0 ** -float(rng.integers(5, 15)),
        "zeros": lambda: np.where(u < 0.6, 0.0, k),
        "near-thousandths": lambda: k / 1000.0 + np.where(u < 0.5, 0.0, 10.0 ** -float(rng.integers(6, 14))),
        "subnormal": lambda: np.where(u < 0.6, 5e-324 * (k + 1.0), k),
    }
    return np.asarray(made[style](), dtype=np.float64)


def style(rng: Rng) -> str:
    """Ordinary ones half the time, subnormal numbers seldom."""
    if rng.random() < 0.5:
        return str(rng.choice(["whole", "ties", "decimal", "float"]))
    return str(rng.choice(STYLES[:-1])) if rng.random() < 0.96 else "subnormal"


def near(rng: Rng, value: float) -> float:
    """A limit that something meets exactly, misses by a hair, or is far from."""
    return value * float(rng.choice([1.0, 1.0, 1.0, 1.0 - 1e-7, 1.0 - 1e-5, 1.0 + 1e-7, 0.7, 1.5]))


def shaken(rng: Rng, value: Any) -> Any:
    """The same evidence, every number another one."""
    if isinstance(value, dict):
        return {name: shaken(rng, v) for name, v in value.items()}
    if isinstance(value, list):
        return [shaken(rng, v) for v in value]
    return value * float(rng.choice([1.0, rng.uniform(0.3, 1.7)])) if isinstance(value, float) else value


# -- routing -----------------------------------------------------------------------------------------------------------


def routing(rng: Rng, units: Units, *, most: int = 4, plain: bool | None = None) -> RoutingProblem:
    """Any mix of features; ``plain`` ones are those that savings takes: one depot and type, total cost, all sites required."""
    plain = bool(rng.random() < 0.45) if plain is None else plain
    n = int(rng.integers(1, most + 1))
    depots = 1 if plain or rng.random() < 0.7 else 2
    size = n + depots
    matrix, times = _travel(rng, size), None
    if rng.random() < 0.25:
        times = _travel(rng, size)
    moves = matrix if times is None else times
    limit = lambda: rng.random() < 0.35  # noqa: E731
    tour = [0, *(rng.permutation(n) + depots).tolist(), 0]
    cut = int(rng.integers(1, n + 1))
    path = [*tour[: cut + 1], 0]
    service = numbers(rng, size, style(rng)) * (rng.random() < 0.5)
    demand = numbers(rng, size, style(rng))
    ready, due = np.zeros(size), np.full(size, math.inf)
    if limit():
        clock, ready = 0.0, numbers(rng, size, style(rng)) * (rng.random(size) < 0.5)
        if rng.random() < 0.3:
            ready[0] = -float(rng.integers(1, 9))
        clock = ready[0]
        for i, j in itertools.pairwise(tour):
            clock = clock + (service[i] if i else 0.0) + moves[i, j]
            arrived, clock = clock, max(clock, ready[j])
            if j and rng.random() < 0.7:
                due[j] = max(ready[j], near(rng, arrived))
        if rng.random() < 0.4:
            due[0] = max(ready[0], near(rng, clock))
    driven = math.fsum(matrix[i, j] for i, j in itertools.pairwise(path))
    moved = math.fsum(moves[i, j] for i, j in itertools.pairwise(path))
    served = math.fsum(service[path[1:-1]])

    def vehicle(name: str) -> VehicleType:
        energy = None
        if not plain and rng.random() < 0.3:
            rate, charge = float(rng.choice([1.0, 0.5, 0.1, 3.0])), str(rng.choice(ENERGY_CHARGES))
            spent = rate * (moved if charge == "travel" else moved + served)
            energy = Energy(near(rng, spent) * units.energy, rate * units.energy / units.time, charge)
        unit = float(rng.choice([1.0, 1.0, 0.5, 0.1, 0.0, 3.0]))
        fixed = float(numbers(rng, (), style(rng))) if rng.random() < 0.3 else 0.0
        ends = (0, 0) if depots == 1 else (int(rng.integers(2)), int(rng.integers(2)))
        return VehicleType(
            count=None if rng.random() < 0.5 else int(rng.integers(1, n + 1)),
            capacity=near(rng, math.fsum(demand[path[1:-1]])) * units.load if limit() else math.inf,
            start=ends[0], end=ends[1],
            max_duration=near(rng, moved + served) * units.time if limit() else math.inf,
            max_distance=near(rng, driven) * units.distance if limit() else math.inf,
            energy=energy, fixed_cost=fixed * units.cost, unit_cost=unit * units.cost / units.distance, name=name,
        )  # fmt: skip

    fleet = tuple(vehicle(f"type {k}") for k in range(1 if plain or rng.random() < 0.6 else 2))
    counts = [n if v.count is None else v.count for v in fleet]
    reward = numbers(rng, size, style(rng))
    required = None if plain or rng.random() < 0.7 else rng.random(size) < 0.5
    least = 0 if plain or rng.random() < 0.7 else int(rng.integers(0, min(n, sum(counts)) + 1))
    objective = TotalCost() if plain else _objective(rng, units)
    places = Sites.of(
        range(size), depot=np.arange(size) < depots, demand=demand * units.load, ready=ready * units.time, due=due * units.time,
        service=service * units.time, reward=reward * units.reward, required=required,
    )  # fmt: skip
    # One unit of distance takes one unit of time where there are no durations: in other units that needs a matrix.
    own = times is not None or units.time != units.distance
    travel = Travel("EXPLICIT", matrix=matrix * units.distance, duration_matrix=moves * units.time if own else None)
    kind = str(rng.choice(["vrptw", "cvrp", "tsp", "min-cost-vrp"]))
    return RoutingProblem(places, travel, fleet, Objective.of(objective), least, "drawn", kind)


def routing_at_risk(rng: Rng, units: Units) -> RoutingProblem:
    """Uncertain durations of any style, and a limit that some route meets exactly with its risk, misses by a hair, or is far from."""
    while True:
        base = routing(rng, units, most=3, plain=True)
        size, vehicle = len(base.sites), base.fleet[0]
        variances = numbers(rng, (size, size), style(rng)) * units.time**2
        tour = [0, *(rng.permutation(size - 1) + 1)[: int(rng.integers(1, size))].tolist(), 0]
        moves = list(itertools.pairwise(tour))
        mean = math.fsum([*(base.travel.durations[i, j] for i, j in moves), *base.sites.service[tour[1:-1]]])
        risk = float(rng.choice([1e-12, 1e-3, 0.05, 0.3, 0.5]))
        limit = near(rng, mean + NormalDist().inv_cdf(1.0 - risk) * math.sqrt(math.fsum(variances[i, j] for i, j in moves)))
        team = float(rng.choice([0.01, 0.3, 0.5])) if rng.random() < 0.5 else None
        try:
            fleet = (replace(vehicle, max_duration=limit, energy=None, risk=None if team and rng.random() < 0.5 else risk),)
            return replace(base, travel=replace(base.travel, variances=variances), fleet=fleet, team_risk=team)
        except InputError:  # somebody may have to wait, or a square is beyond all numbers
            continue


def _travel(rng: Rng, size: int) -> Floats:
    """Euclidean between points of which some coincide, or any matrix."""
    made = style(rng)
    if rng.random() < 0.5:
        xy = numbers(rng, (size, 2), made)
        if rng.random() < 0.3:
            xy[rng.integers(size)] = xy[rng.integers(size)]
        with np.errstate(under="ignore"):
            matrix = np.hypot(xy[:, None, 0] - xy[None, :, 0], xy[:, None, 1] - xy[None, :, 1])
        matrix = np.floor(10 * matrix) / 10 if made == "decimal" else matrix
    else:
        matrix = numbers(rng, (size, size), made)
        if rng.random() < 0.5:
            matrix = np.minimum(matrix, matrix.T)
    np.fill_diagonal(matrix, 0.0)
    return matrix


def _objective(rng: Rng, units: Units) -> Composable:
    kinds: list[Composable] = [
        TotalCost(), Vehicles(), Makespan(), LongestRoute(), Reward(), Vehicles() * (10.0 * units.cost) + TotalCost(),
        Reward() - (0.5 * units.reward / units.cost) * TotalCost(), Vehicles().then(TotalCost()), Reward().then(TotalCost()),
        Makespan().then(Vehicles()),
    ]  # fmt: skip
    return kinds[0 if rng.random() < 0.4 else int(rng.integers(len(kinds)))]


# -- sensing and max-min -------------------------------------------------------------------------------------------------


def graph(rng: Rng, units: Units) -> SensingGraph:
    robots, targets = int(rng.integers(1, 5)), int(rng.integers(1, 5))
    owner = np.repeat(np.arange(robots), rng.integers(1, 4, robots))
    weights = numbers(rng, (len(owner), targets), style(rng)) * (rng.random((len(owner), targets)) < 0.65)
    action, target = np.nonzero(weights * units.weight > 0)
    given = (weights * units.weight)[action, target]
    return graph_of_edges(owner, action, target, given, robots=robots, targets=targets)


def max_min(rng: Rng, units: Units, sense: str) -> MaxMinLP:
    """Small matrices whose pattern allows an optimum; one packing row a variable often."""
    n, rows, covers = (int(v) for v in rng.integers(1, 5, 3))
    a, c = numbers(rng, (rows, n), style(rng)), numbers(rng, (covers, n), style(rng))
    a *= rng.random((rows, n)) < 0.6
    c *= rng.random((covers, n)) < 0.7
    if rng.random() < 0.5:
        a *= np.arange(rows)[:, None] == rng.integers(0, rows, n)[None, :]
    idle = ~(a > 0).any(axis=0)
    a[rng.integers(0, rows, n)[idle], np.nonzero(idle)[0]] = 1.0 + rng.integers(0, 3, int(idle.sum()))
    empty = ~(c > 0).any(axis=1)
    c[np.nonzero(empty)[0], rng.integers(0, n, covers)[empty]] = 1.0
    # ``weight`` is the unit of what is covered, ``load`` that of what is packed; where a number would vanish they are 1.
    if all(((m * unit > 0) == (m > 0)).all() for m, unit in ((a, units.load), (c, units.weight))):
        a, c = a * units.load, c * units.weight
    return MaxMinLP(a, c, sense=sense, name="drawn")


# -- selection -----------------------------------------------------------------------------------------------------------


def selection(rng: Rng, units: Units) -> SubmodularSelection:
    n, items = int(rng.integers(1, 6)), int(rng.integers(1, 6))
    kind = str(rng.choice(["coverage", "facility-location", "dense", "dense32", "user"]))
    pattern = rng.random((n, items)) < 0.6
    weights = numbers(rng, (n, items), style(rng)) * pattern * units.weight
    worth = numbers(rng, items, style(rng)) * units.weight
    constraint = _constraint(rng, units, n)
    if kind.startswith("dense"):
        with np.errstate(under="ignore", over="ignore"):
            return SubmodularSelection(DenseFacilityLocation(weights.astype(np.float32 if kind == "dense32" else np.float64)), constraint)
    if kind == "user":
        f = UserFunction(
            lambda masks: (masks @ pattern.astype(float) > 0) @ worth, n, monotone=True, submodular=True, label="covered weight"
        )
        return SubmodularSelection(f, constraint)
    kept = pattern if kind == "coverage" else weights > 0
    starts, indices = np.concatenate([[0], np.cumsum(kept.sum(axis=1))]).astype(np.int32), np.nonzero(kept)[1].astype(np.int32)
    if kind == "coverage":
        return SubmodularSelection(Coverage(starts, indices, worth), constraint)
    return SubmodularSelection(FacilityLocation(starts, indices, weights[kept], items), constraint)


def _constraint(rng: Rng, units: Units, n: int) -> Constraint:
    kind = rng.integers(3)
    if kind == 0:
        return Cardinality(int(rng.integers(1, n + 2)))
    if kind == 1:
        groups = rng.integers(0, int(rng.integers(1, n + 1)), n)
        return PartitionMatroid.of(groups, rng.integers(0, 3, int(groups.max()) + 1))
    costs = numbers(rng, n, style(rng))
    budget = near(rng, math.fsum(costs[rng.random(n) < 0.5]))
    return Knapsack(costs * units.budget, budget * units.budget)


# -- programs ------------------------------------------------------------------------------------------------------------


def arrays(rng: Rng, units: Units) -> ArrayProblem:
    """Linear programs, mixed-integer ones half the time. ``cost`` is the unit of the objective, ``load`` that of the rows."""
    n, rows = int(rng.integers(1, 5)), int(rng.integers(0, 5))
    a = numbers(rng, (rows, n), style(rng)) * rng.choice([-1.0, 0.0, 1.0, 1.0], (rows, n))
    cost = numbers(rng, n, style(rng)) * rng.choice([-1.0, 1.0, 1.0], n)
    lower, integer = rng.integers(-2, 2, n).astype(float), (rng.random(n) < 0.5) & (rng.random() < 0.5)
    upper = lower + rng.integers(0, 4, n)
    lower[~integer & (rng.random(n) < 0.15)] = -math.inf
    upper[~integer & (rng.random(n) < 0.35)] = math.inf
    inside = np.where(np.isfinite(lower), lower, 0.0) + np.where(integer, 1.0, rng.random(n))
    middle = a @ np.minimum(inside, upper)
    width = numbers(rng, rows, style(rng))
    low, high = middle - np.where(rng.random(rows) < 0.3, 0.0, width), middle + width * (rng.random(rows) < 0.5)
    if rng.random() < 0.15 and rows:
        low, high = low + 3.0, high + 3.0
    low[rng.random(rows) < 0.4] = -math.inf
    high[rng.random(rows) < 0.4] = math.inf
    block = sp.csr_matrix(a * units.load)
    columns = tuple(
        Variables(f"x{j}", lower=lower[j : j + 1], upper=upper[j : j + 1], cost=cost[j : j + 1] * units.cost, integer=bool(integer[j]))
        for j in range(n)
    )
    made = Rows("row", indptr=block.indptr, indices=block.indices, data=block.data, lower=low * units.load, upper=high * units.load)
    offset = float(numbers(rng, (), style(rng))) * units.cost if rng.random() < 0.3 else 0.0
    return ArrayProblem(Program("drawn", str(rng.choice(["min", "max"])), columns, (made,), offset))


# -- risk ----------------------------------------------------------------------------------------------------------------


def _arcs(rng: Rng, size: int) -> tuple[Any, Any]:
    """Arcs of a small graph in which every vertex can be reached from those before it."""
    return np.nonzero(((rng.random((size, size)) < 0.5) | np.eye(size, k=1, dtype=bool)) & ~np.eye(size, dtype=bool))


def uncertain_path(rng: Rng, units: Units) -> UncertainPath:
    """Normal costs in units of ``cost``; variances are in its square."""
    size = int(rng.integers(2, 7))
    tails, heads = _arcs(rng, size)
    mean, variance = (numbers(rng, len(tails), style(rng)) for _ in range(2))
    graph = UncertainGraph(size, tails, heads, mean * units.cost, variance * units.cost**2, 0, size - 1, name="drawn")
    return UncertainPath(graph, float(rng.choice([0.5, 0.05, 1e-9])))


def risky_path(rng: Rng, units: Units) -> RiskyPath:
    """Risks of places, moves and what was collected, rewards in units of ``reward``; nothing is without risk."""
    size = int(rng.integers(2, 6))
    tail, head = _arcs(rng, size)
    unit = float(rng.choice([1.0, 1e-3, 1e-9]))
    places, moves = (unit * rng.uniform(0.01, 0.6, many) for many in (size, len(tail)))
    elements: list[Any] = [LocaleRisk(places), MoveRisk(np.full(len(tail), -1), tail, head, moves)]
    if rng.random() < 0.5:
        wet = rng.random(size) < 0.5
        elements.append(CollectedRisk(wet, np.array([np.zeros(size), unit * rng.uniform(0.0, 0.9, size)]), "mud"))
    rewards = numbers(rng, size, style(rng))
    rewards[-1] = 1.0
    goals = (size - 1,) if rng.random() < 0.6 else ()
    objective = str(rng.choice(["risk", "hazard", "reward-per-risk"])) if goals else "reward-per-risk"
    discount = float(rng.choice([1.0, 1.0, 0.5, 0.0]))
    graph = RiskyGraph(size, tail, head, tuple(elements), 0, True, goals, rewards * units.reward, discount, objective, name="drawn")
    return RiskyPath(graph)


def risk_allocation(rng: Rng, units: Units) -> RiskAllocation:
    """Decisions in units of ``load``, their noisy quantities in ``weight``, rows in ``budget``, what is bent in ``distance``."""
    n, many = int(rng.integers(1, 4)), int(rng.integers(1, 5))
    ordinary = lambda *size: numbers(rng, size, str(rng.choice(["whole", "decimal", "float"])))  # noqa: E731
    chance = ordinary(many, n) * (rng.random((many, n)) < 0.7)
    chance[np.arange(many), rng.integers(0, n, many)] = 1.0
    noise = rng.normal(size=(many, many)) * rng.uniform(0.0, 1.0, many)[:, None]
    total, none, sense = float(10.0 ** rng.uniform(-6.0, -0.4)), np.zeros, str(rng.choice(["min", "max"]))
    bent = float(sense == "min")  # of a reward less a cost no digits might be left
    row, bend = ordinary(1, n), rng.choice([-1.0, 0.0, 1.0], (1, n))
    covariance = noise @ noise.T
    instance = RiskAllocationInstance(
        none(n), np.full(n, 30.0 * units.load), tuple(f"x{k}" for k in range(n)),
        Quantities(chance * units.weight / units.load, none(many), covariance * units.weight**2, tuple(f"y{k}" for k in range(many))),
        Affine(ordinary(1, n) * units.cost / units.load, none((1, many)), none(1)),
        ChanceConstraints(
            Affine(none((many, n)), np.eye(many), none(many)), (ordinary(many) + 6.0) * units.weight, tuple(f"c{k}" for k in range(many)),
            np.arange(many),
        ),
        Risk(str(rng.choice(["allocated", "allocated", "joint"])), total, np.full(many, total)),
        Affine(row * units.budget / units.load, none((1, many)), none(1)), np.full(1, -math.inf),
        (float(row.sum()) + 1.0) * rng.uniform(0.5, 9.0, 1) * units.budget, ("row",),
        (CostTerm("absolute", bent * units.cost / units.distance,
                  Affine(bend * units.distance / units.load, none((1, many)), -ordinary(1) * units.distance)),),
        sense=sense, name="drawn",
    )  # fmt: skip
    return RiskAllocation(instance)


def bin_assignment(rng: Rng, units: Units) -> BinAssignment:
    """Costs of one style, pairs forbidden or not, sums and bottlenecks."""
    n, m = (int(k) for k in rng.integers(1, 6, 2))
    costs = numbers(rng, (n, m), style(rng)) * units.cost
    costs[rng.random((n, m)) < float(rng.choice([0.0, 0.3, 0.7]))] = math.inf
    return BinAssignment.from_matrix(costs, objective=str(rng.choice(["sum", "bottleneck"])), name="drawn")


def generalised_assignment(rng: Rng, units: Units) -> GeneralisedAssignment:
    """Costs or profits in one style and consumption in another, capacities that jobs meet, miss by a hair, or are far from."""
    agents, jobs = int(rng.integers(1, 4)), int(rng.integers(1, 5))
    values, used = numbers(rng, (agents, jobs), style(rng)) * units.cost, numbers(rng, (agents, jobs), style(rng))
    capacity = np.array([near(rng, float(row[rng.random(jobs) < 0.6].sum())) for row in used])
    objective = str(rng.choice(["cost", "profit"]))
    values[rng.random(values.shape) < float(rng.choice([0.0, 0.3]))] = math.inf if objective == "cost" else -math.inf
    return GeneralisedAssignment.from_arrays(values, used * units.load, capacity * units.load, objective, name="drawn")


def joint_assignment(rng: Rng, units: Units) -> JointAssignment:
    """Times of any styles, in units of ``cost``."""
    n, m, q = int(rng.integers(1, 4)), int(rng.integers(1, 4)), int(rng.integers(0, 3))
    shapes = ((n, m), (n, q), (q, m), (m,))
    to_bin, to_request, between, filled = (numbers(rng, shape, style(rng)) * units.cost for shape in shapes)
    to_bin[rng.random((n, m)) < float(rng.choice([0.0, 0.3]))] = math.inf
    to_request[rng.random((n, q)) < float(rng.choice([0.0, 0.3]))] = math.inf
    return JointAssignment.from_arrays(to_bin, to_request, between, filled, name="drawn")


def room_exploration(rng: Rng, units: Units) -> RoomExploration:
    """A tree of rooms with gains of any styles, in units of ``reward``."""
    rooms, robots = int(rng.integers(1, 5)), int(rng.integers(1, 3))
    doors = [(k, int(rng.integers(0, k))) for k in range(1, rooms)]
    heard = [door for door in doors if rng.random() < 0.6]
    gains = [-np.sort(-numbers(rng, (rooms, 2), style(rng)), axis=1) * units.reward for _ in range(3)]
    steps, silence = int(rng.integers(1, 4)), int(rng.integers(0, 3))
    return RoomExploration(ExplorationMap(doors, *gains, [0] * robots, 0, heard, silence, steps, name="drawn"))


def team(rng: Rng, units: Units) -> RobotTasks:
    """Robots and tasks with any distances, weights among them, both in units of ``weight``."""
    robots, tasks = (int(v) for v in rng.integers(1, 5, 2))
    starts, between, weights = (numbers(rng, size, style(rng)) for size in ((robots, tasks), (tasks, tasks), tasks))
    between = np.triu(between, 1) + np.triu(between, 1).T
    return RobotTasks.of_distances(starts * units.weight, between * units.weight, weights=weights * units.weight, name="drawn")


def task_allocation(rng: Rng, units: Units) -> TaskAllocation:
    return TaskAllocation(team(rng, units), str(rng.choice(["mini-sum", "mini-max", "mini-ave"])))


def balanced_partition(rng: Rng, units: Units) -> BalancedPartition:
    return BalancedPartition(team(rng, units), str(rng.choice(["min-max", "min-difference"])), str(rng.choice(["mst", "clique", "none"])))


FAMILIES: dict[str, Callable[[Rng, Units], Problem]] = {
    "routing": routing,
    "bottleneck": lambda rng, units: BottleneckSATA(graph(rng, units)),
    "bottleneck-lp": lambda rng, units: BottleneckSATA(graph(rng, units), fractional=True),
    "max-min": lambda rng, units: max_min(rng, units, "max"),
    "min-max": lambda rng, units: max_min(rng, units, "min"),
    "selection": selection,
    "winner-takes-all": lambda rng, units: WinnerTakesAllSATA(graph(rng, units)),
    "arrays": arrays,
}
"""By name, a problem drawn from a generator in the given units."""

AT_RISK: dict[str, Callable[[Rng, Units], Problem]] = {"routing-at-risk": routing_at_risk}
"""Routes whose durations are uncertain; what counts in whole numbers may refuse their squares in one unit alone."""

UNCERTAIN: dict[str, Callable[[Rng, Units], Problem]] = {
    "uncertain-path": uncertain_path, "risky-path": risky_path, "risk-allocation": risk_allocation, "bin-assignment": bin_assignment,
    "generalised-assignment": generalised_assignment, "joint-assignment": joint_assignment, "room-exploration": room_exploration,
    "task-allocation": task_allocation, "balanced-partition": balanced_partition,
}  # fmt: skip
"""The same, with values that are no fractions, or of which exact arithmetic tells nothing that the tests of their room do not."""
