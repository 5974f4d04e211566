"""Kinds of the battery's problems: small ones of every family, each kind hard in its own way."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...formulations.arrays.problem import ArrayProblem
from ...formulations.problem import Problem
from ...formulations.programs.program import Program, Rows, Variables
from ...formulations.risk.risky_path import RiskyPath
from ...formulations.routing.problem import RoutingProblem
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.max_min_lp import MaxMinLP
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ...instances.risk.elements import LocaleRisk, MoveRisk
from ...instances.risk.risky_graph import RiskyGraph
from ...instances.routing.instance import Sites, VehicleType
from ...instances.routing.travel import Travel
from ...instances.sata.constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from ...instances.sata.sensing_graph import SensingGraph, graph_of_edges
from ...instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation
from .auction_kinds import AUCTIONS
from .drawing import HUGE, TINY, Draw, Floats, Generator, weights, whole

# -- routing ---------------------------------------------------------------------------------------------------------


def _routing(
    matrix: Floats, demand: Floats, ready: Floats, due: Floats, fleet: Sequence[VehicleType], service: Any = 0.0, least: int = 0
) -> RoutingProblem:
    size = len(matrix)
    np.fill_diagonal(matrix, 0.0)
    sites = Sites.of(range(size), demand=demand, ready=ready, due=due, service=np.where(np.arange(size) > 0, service, 0.0))
    return RoutingProblem(sites, Travel("EXPLICIT", matrix=matrix), tuple(fleet), min_vehicles=least, name="battery", problem="vrptw")


def _windows(rng: Generator, unit: int = 1) -> RoutingProblem:
    """Asymmetric distances of 100 to 1000, windows 300 to 2000 wide, two vehicles of capacity 9; times ``unit`` the same range."""
    size = int(rng.integers(4, 7))
    matrix = whole(rng, (size, size), 100 * unit, 1000 * unit)
    demand, ready = whole(rng, size, 1, 3), whole(rng, size, 0, 1800 * unit)
    due = ready + whole(rng, size, 300 * unit, 2000 * unit)
    demand[0], ready[0], due[0] = 0.0, 0.0, 20000.0 * unit
    return _routing(matrix, demand, ready, due, [VehicleType(2, 9.0)])


def time_windows(rng: Generator) -> Problem:
    """Ordinary whole numbers, on which HiGHS 1.12 to 1.15 went wrong most."""
    return _windows(rng)


def huge_times(rng: Generator) -> Problem:
    """The same in numbers up to 1e9 and beyond."""
    return _windows(rng, 10 ** int(rng.integers(4, 7)))


def tiny_times(rng: Generator) -> Problem:
    """The same in units of a millionth."""
    problem = _windows(rng)
    sites, travel = problem.sites, problem.travel
    return _routing(travel.distances * TINY, sites.demand, sites.ready * TINY, sites.due * TINY, problem.fleet)


def equal_distances(rng: Generator) -> Problem:
    """Ties everywhere: distances of one or two values, demands and windows alike."""
    size = int(rng.integers(4, 7))
    near, far = 100.0, float(rng.choice([100, 200]))
    matrix = np.where(rng.random((size, size)) < 0.5, near, far)
    ready, due = np.zeros(size), np.full(size, math.inf)
    if rng.random() < 0.5:
        ready[1:] = 100.0 * rng.integers(0, 3, size - 1)
        due[1:] = ready[1:] + 100.0 * rng.integers(0, 4, size - 1)
    demand = np.r_[0.0, np.ones(size - 1)]
    return _routing(matrix, demand, ready, due, [VehicleType(int(rng.integers(1, 4)), float(rng.integers(2, size)))])


def risky_routes(rng: Generator) -> Problem:
    """Uncertain durations, and routes that may take too long with a probability of some hundredths, or of a millionth."""
    size = int(rng.integers(3, 6))
    matrix, demand = whole(rng, (size, size), 10, 99), np.r_[0.0, whole(rng, size - 1, 1, 5)]
    variances = whole(rng, (size, size), 0, 40) * (1.0 - np.eye(size))
    longest = float(rng.integers(100, 300)) + 0.5  # no sum of whole numbers is so long
    risk = float(rng.choice([0.01, 0.05, 0.2, 1e-6]))
    vehicle = VehicleType(int(rng.integers(1, 3)), float(rng.integers(5, 15)), max_duration=longest, risk=risk)
    problem = _routing(matrix, demand, np.zeros(size), np.full(size, math.inf), [vehicle])
    return replace(problem, travel=replace(problem.travel, variances=variances))


def tight_windows(rng: Generator) -> Problem:
    """Windows of no width, or almost, around the arrivals of some routes; fleets that just suffice."""
    size = int(rng.integers(4, 7))
    matrix, service = whole(rng, (size, size), 1, 99), float(rng.integers(0, 10))
    order = rng.permutation(np.arange(1, size))
    ready, due = np.zeros(size), np.full(size, 2000.0)
    demand = np.r_[0.0, whole(rng, size - 1, 1, 5)]
    tours = np.array_split(order, int(rng.integers(1, 3)))
    for tour in tours:
        clock, at = 0.0, 0
        for to in tour.tolist():
            clock += matrix[at, to] + (service if at else 0.0)
            slack = float(rng.choice([0, 0, 1, 10]))
            ready[to], due[to] = max(0.0, clock - slack), clock + slack
            at = to
    most = max(float(demand[tour].sum()) for tour in tours)
    return _routing(matrix, demand, ready, due, [VehicleType(len(tours), most)], service)


def unlimited_limits(rng: Generator) -> Problem:
    """Large numbers meant as no limit: capacities and lengths of 1e6 to 1e12."""
    size = int(rng.integers(4, 7))
    limit = 10.0 ** int(rng.integers(6, 13))
    loads, lengths = rng.random() < 0.7, rng.random() < 0.5
    fleet = VehicleType(3, limit if loads else math.inf, max_distance=math.inf if loads and not lengths else limit)
    demand = np.r_[0.0, whole(rng, size - 1, 1, 9)]
    least = int(rng.integers(0, 3))
    return _routing(whole(rng, (size, size), 1, 99), demand, np.zeros(size), np.full(size, math.inf), [fleet], least=least)


def no_routes(rng: Generator) -> Problem:
    """Loads and windows that the fleet mostly cannot serve, though it could serve each customer alone."""
    size = int(rng.integers(4, 7))
    matrix, demand = whole(rng, (size, size), 100, 300), np.r_[0.0, whole(rng, size - 1, 3, 7)]
    ready = np.r_[0.0, whole(rng, size - 1, 300, 700)]
    due = ready + np.r_[3000.0, whole(rng, size - 1, 0, 150)]
    return _routing(matrix, demand, ready, due, [VehicleType(int(rng.integers(1, 4)), float(rng.integers(8, 15)))])


def fleets(rng: Generator) -> Problem:
    """Two types of vehicle, fixed costs, lengths of routes limited, service times."""
    size = int(rng.integers(4, 6))
    matrix = whole(rng, (size, size), 10, 99)
    ready = np.r_[0.0, whole(rng, size - 1, 0, 60)]
    due = ready + np.r_[1000.0, whole(rng, size - 1, 30, 300)]
    kinds = [
        VehicleType(
            int(rng.integers(1, 3)), float(rng.integers(6, 15)), max_distance=float(rng.integers(150, 400)),
            fixed_cost=float(rng.integers(0, 100)), unit_cost=float(rng.integers(1, 4)), name=name,
        )
        for name in ("one", "other")[: int(rng.integers(1, 3))]
    ]  # fmt: skip
    return _routing(matrix, np.r_[0.0, whole(rng, size - 1, 1, 6)], ready, due, kinds, float(rng.integers(0, 10)))


# -- sensing, max-min and selection ----------------------------------------------------------------------------------


def _graph(rng: Generator) -> SensingGraph:
    robots, targets = int(rng.integers(1, 5)), int(rng.integers(1, 5))
    owner = np.repeat(np.arange(robots), rng.integers(1, 4, robots))
    action, target = np.nonzero(rng.random((len(owner), targets)) < 0.7)
    return graph_of_edges(owner, action, target, weights(rng, len(action)), robots=robots, targets=targets)


def bottleneck(rng: Generator) -> Problem:
    """Whole actions of a few robots."""
    return BottleneckSATA(_graph(rng))


def bottleneck_shares(rng: Generator) -> Problem:
    """Shares of actions: the linear program."""
    return BottleneckSATA(_graph(rng), fractional=True)


def winner_takes_all(rng: Generator) -> Problem:
    """One robot credited for each target."""
    return WinnerTakesAllSATA(_graph(rng))


def packing_covering(rng: Generator) -> Problem:
    """General max-min and min-max linear programs, rows and columns of all sizes."""
    columns, packs, covers = (int(v) for v in rng.integers(1, 4, 3))
    sense = str(rng.choice(["max", "min"]))
    packing = whole(rng, (packs, columns), 1, 9) * (rng.random((packs, columns)) < 0.7)
    covering = whole(rng, (covers, columns), 1, 9) * (rng.random((covers, columns)) < 0.7)
    packing[0, ~packing.any(axis=0)] = 1.0
    covering[~covering.any(axis=1), 0] = 2.0
    if rng.random() < 0.5:  # other units
        units = 2.0 ** rng.integers(-20, 30, columns)
        packing, covering = packing * units * 2.0 ** float(rng.integers(-20, 30)), covering * units
    return MaxMinLP(packing, covering, sense=sense, name="battery")


def selection(rng: Generator) -> Problem:
    """Coverage and facility location under a number of elements, a number per group, or a budget."""
    elements, items = int(rng.integers(2, 7)), int(rng.integers(1, 6))
    pattern = rng.random((elements, items)) < 0.6
    starts, indices = np.concatenate([[0], np.cumsum(pattern.sum(axis=1))]).astype(np.int32), np.nonzero(pattern)[1].astype(np.int32)
    function: Any = (
        lambda: Coverage(starts, indices, weights(rng, items)),
        lambda: FacilityLocation(starts, indices, weights(rng, len(indices)), items),
        lambda: DenseFacilityLocation(weights(rng, (elements, items)) * pattern),
    )[int(rng.integers(3))]()
    return SubmodularSelection(function, _constraint(rng, elements))


def _constraint(rng: Generator, elements: int) -> Constraint:
    kind = int(rng.integers(3))
    if kind == 0:
        return Cardinality(int(rng.integers(1, elements + 1)))
    if kind == 1:
        groups = rng.integers(0, 2, elements)
        return PartitionMatroid.of(groups, rng.integers(0, 3, 2))
    costs = whole(rng, elements, 1, 9)
    unit = float(rng.choice([1.0, TINY, HUGE, HUGE * HUGE]))
    return Knapsack(costs * unit, float(rng.integers(1, 1 + int(costs.sum()))) * unit)


# -- risk ------------------------------------------------------------------------------------------------------------


def risky_paths(rng: Generator) -> Problem:
    """Least hazard between two of a few states, by risks of places, moves and pairs of moves: hundredths, tiny, or certain failure."""
    size = int(rng.integers(3, 6))
    linked = (rng.random((size, size)) < 0.6) | np.eye(size, k=1, dtype=bool)
    tail, head = np.nonzero(linked & ~np.eye(size, dtype=bool))
    pairs = [(a, b, c) for a, b in zip(tail, head, strict=True) for c in range(size) if linked[b, c] and len({a, b, c}) == 3]
    pairs = [pair for pair in pairs if rng.random() < 0.5]
    before, state, after = np.array([*((-1, a, b) for a, b in zip(tail, head, strict=True)), *pairs]).T
    unit = 1e-6 if rng.random() < 0.25 else 1.0

    def risks(count: int) -> Floats:
        return np.where(rng.random(count) < 0.1, 1.0, unit * whole(rng, count, 0, 50) / 100.0)

    places = risks(size)
    places[0] = unit * 0.01
    elements = (LocaleRisk(places), MoveRisk(before, state, after, risks(len(after))))
    return RiskyPath(RiskyGraph(size, tail, head, elements, 0, True, (size - 1,), objective="hazard", name="battery"))


# -- bare programs ---------------------------------------------------------------------------------------------------


def _program(rng: Generator, integers: int, others: int, rows: int, quadratic: Floats | None = None) -> ArrayProblem:
    """Rows around a whole point, sometimes moved off it; columns, rows and objective each in a unit of its own half the time."""
    width = integers + others
    lower, cost = whole(rng, width, -3, 1), whole(rng, width, -9, 9)
    upper = lower + whole(rng, width, 0, 4)
    point = lower + np.floor(rng.random(width) * (upper - lower + 1))
    a = whole(rng, (rows, width), -9, 9) * (rng.random((rows, width)) < 0.7)
    middle, slack = a @ point, whole(rng, rows, 0, 12)
    low, high = middle - slack, middle + slack * (rng.random(rows) < 0.7)
    if rng.random() < 0.2 and rows:  # off the point by more than a rounding
        low, high = low + 13.0, high + 13.0
    low[rng.random(rows) < 0.4], high[rng.random(rows) < 0.4] = -math.inf, math.inf
    if quadratic is None:
        free = (np.arange(width) >= integers) & (rng.random(width) < 0.4)
        lower[free & (rng.random(width) < 0.3)] = -math.inf
        upper[free] = math.inf
    price = float(rng.choice([1.0, 1.0, 1e-6, 1e9]))
    if rng.random() < 0.5 and quadratic is None:
        row_unit, unit = 2.0 ** rng.integers(-20, 30, rows), np.where(np.arange(width) < integers, 1.0, 2.0 ** rng.integers(-10, 20, width))
        a, cost = a * row_unit[:, None] / unit, cost / unit
        low, high, lower, upper = low * row_unit, high * row_unit, lower * unit, upper * unit
    sense, offset = str(rng.choice(["min", "max"])), float(rng.integers(-9, 10)) * price
    columns = [(lower[j], upper[j], cost[j] * price, j < integers) for j in range(width)]
    return ArrayProblem(_arrays(sense, columns, a, low, high, offset, None if quadratic is None else quadratic * price))


def _arrays(
    sense: str, columns: Sequence[tuple[float, float, float, bool]], a: Floats, low: Floats, high: Floats, offset: float,
    quadratic: Floats | None = None,
) -> Program:  # fmt: skip
    import scipy.sparse as sp

    block = sp.csr_matrix(a)
    variables = tuple(
        Variables(f"x{j}", lower=np.array([lower]), upper=np.array([upper]), cost=np.array([cost]), integer=bool(integer))
        for j, (lower, upper, cost, integer) in enumerate(columns)
    )
    rows = Rows("row", (np.arange(len(a)),), indptr=block.indptr, indices=block.indices, data=block.data, lower=low, upper=high)
    return Program("arrays", sense, variables, (rows,), offset, None if quadratic is None else sp.csr_matrix(quadratic))


def linear(rng: Generator) -> Problem:
    """Linear programs, some infeasible, some unbounded."""
    return _program(rng, 0, int(rng.integers(1, 5)), int(rng.integers(0, 5)))


def mixed_integer(rng: Generator) -> Problem:
    """Whole and other variables together."""
    return _program(rng, int(rng.integers(1, 4)), int(rng.integers(1, 4)), int(rng.integers(1, 5)))


def integer(rng: Generator) -> Problem:
    """Whole variables alone: knapsacks, equations, parity."""
    return _program(rng, int(rng.integers(2, 6)), 0, int(rng.integers(1, 4)))


def unbounded(rng: Generator) -> Problem:
    """A program with one more variable, whole half the time, along which the objective falls for ever; some have no point at all."""
    inner = _program(rng, int(rng.integers(0, 3)), int(rng.integers(0, 3)), int(rng.integers(1, 4))).program
    price = max(1.0, float(np.abs(inner.cost).max(initial=0.0))) * (-1.0 if inner.sense == "min" else 1.0)
    lower, upper, integers = inner.lower.tolist(), inner.upper.tolist(), inner.integer.tolist()
    columns = list(zip(lower, upper, inner.cost.tolist(), integers, strict=True))
    extra = (0.0, math.inf, price, bool(rng.random() < 0.5))
    a = inner.matrix.toarray()
    # It may loosen rows that have one side, and is missing in the others.
    loosens = np.where(np.isinf(inner.row_lower), -1.0, np.where(np.isinf(inner.row_upper), 1.0, 0.0)) * (rng.random(len(a)) < 0.5)
    program = _arrays(inner.sense, [*columns, extra], np.column_stack([a, loosens]), inner.row_lower, inner.row_upper, inner.offset)
    return ArrayProblem(program)


def products(rng: Generator) -> Problem:
    """Products of binaries, of a binary and a bounded variable, and squares of whole numbers: neither convex nor concave."""
    integers, others = int(rng.integers(2, 5)), int(rng.integers(0, 2))
    width = integers + others
    q = np.triu(whole(rng, (width, width), -5, 5) * (rng.random((width, width)) < 0.7), 1)
    inner = _program(rng, integers, others, int(rng.integers(1, 3)), q + q.T).program
    binary = np.arange(width) < integers
    columns = [
        (0.0 if b else low, 1.0 if b else high, c, bool(b))
        for low, high, c, b in zip(inner.lower, inner.upper, inner.cost, binary, strict=True)
    ]
    return ArrayProblem(
        _arrays(inner.sense, columns, inner.matrix.toarray(), inner.row_lower, inner.row_upper, inner.offset, inner.quadratic.toarray())  # type: ignore[union-attr]
    )


def squares(rng: Generator) -> Problem:
    """Convex quadratic programs, and concave ones that are maximised."""
    width = int(rng.integers(1, 4))
    factor = whole(rng, (width, width), -2, 2)
    q = factor @ factor.T + np.eye(width)
    inner = _program(rng, 0, width, int(rng.integers(0, 3)), q).program
    sense = "min" if rng.random() < 0.5 else "max"
    columns = list(zip(inner.lower.tolist(), inner.upper.tolist(), inner.cost.tolist(), [False] * width, strict=True))
    curved = inner.quadratic.toarray() * (1.0 if sense == "min" else -1.0)  # type: ignore[union-attr]
    return ArrayProblem(_arrays(sense, columns, inner.matrix.toarray(), inner.row_lower, inner.row_upper, inner.offset, curved))


KINDS: dict[str, Draw] = {
    draw.__name__.replace("_", "-"): draw
    for draw in (
        time_windows, linear, bottleneck, selection, tight_windows, mixed_integer, huge_times, products, equal_distances, packing_covering,
        fleets, integer, no_routes, winner_takes_all, tiny_times, unbounded, unlimited_limits, bottleneck_shares, squares, risky_paths,
        risky_routes, *AUCTIONS,
    )
}  # fmt: skip
"""Kinds by name, in the order in which they take turns."""
