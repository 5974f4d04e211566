"""Optima of small problems and programs, by enumeration in fractions.

Doubles are taken for the fractions that they are, and nothing is read of a problem but its data: no judge, form, checker or heuristic has
a say. The exact truths of the tests (``tests/truth``) share no code with these, so that the two check each other.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from statistics import NormalDist
from typing import Any

import numpy as np

from ...formulations.arrays.problem import ArrayProblem
from ...formulations.problem import Problem
from ...formulations.programs.program import Program
from ...formulations.risk.risky_path import RiskyPath
from ...formulations.routing.problem import RoutingProblem
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.max_min_lp import MaxMinLP
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.number_arrays import Floats
from ...instances.risk.elements import LocaleRisk, MoveRisk
from ...instances.routing.instance import VehicleType
from ...instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from .auction_truth import AUCTIONS, fractions
from .rational_simplex import ONE, ZERO, Region, Vector, minimised

BOX = 4
"""Values tried of a whole variable without a bound, where a program is unbounded if it has a point at all."""


@dataclass(frozen=True)
class Truth:
    """``status`` is ``optimal, infeasible`` or ``unbounded``; ``value`` that of the optimum."""

    status: str
    value: Fraction | None = None

    def __str__(self) -> str:
        return self.status if self.value is None else f"{self.status} at {float(self.value):.12g}"


def truth(problem: Problem) -> Truth:
    """The optimum of a small problem, or that it has none."""
    if isinstance(problem, RoutingProblem):
        return _best("min", routing_costs(problem))
    if isinstance(problem, SubmodularSelection):
        return _best("max", selection_values(problem))
    if isinstance(problem, BottleneckSATA) and not problem.fractional:
        return _best("max", bottleneck_values(problem))
    if isinstance(problem, BottleneckSATA | MaxMinLP):
        return max_min_truth(problem)
    if isinstance(problem, RiskyPath):
        return _best("min", path_hazards(problem))
    for family, values in AUCTIONS.items():
        if isinstance(problem, family):
            return _best(problem.sense, values(problem))
    if isinstance(problem, ArrayProblem):
        return program_truth(problem.program)
    raise NotImplementedError(f"nothing enumerates {problem.problem} problems")


def _best(sense: str, values: Iterator[Fraction]) -> Truth:
    best = min(values, default=None) if sense == "min" else max(values, default=None)
    return Truth("infeasible") if best is None else Truth("optimal", best)


# -- routing ---------------------------------------------------------------------------------------------------------


def routing_costs(problem: RoutingProblem) -> Iterator[Fraction]:
    """Total cost of every way to visit all customers: capacity, windows, service, distance limits, fleets of any types at one depot."""
    fleet = problem.fleet
    driven: list[tuple[int, frozenset[int], Fraction]] = []
    for kind, vehicle in enumerate(fleet):
        driven += [(kind, visits, cost) for visits, cost in _routes(problem, vehicle).items()]

    def covered(rest: frozenset[int], used: tuple[int, ...], cost: Fraction) -> Iterator[Fraction]:
        if not rest:
            if sum(used) >= problem.min_vehicles:
                yield cost
            return
        first = min(rest)
        for kind, visits, price in driven:
            count = fleet[kind].count
            if first in visits and visits <= rest and (count is None or used[kind] < count):
                yield from covered(rest - visits, tuple(u + (k == kind) for k, u in enumerate(used)), cost + price)

    return covered(frozenset(problem.customers.tolist()), (0,) * len(fleet), ZERO)


def _routes(problem: RoutingProblem, vehicle: VehicleType) -> dict[frozenset[int], Fraction]:
    """Least cost of a route of this type through each set of customers that one can serve."""
    sites = problem.sites
    distance, duration = fractions(problem.travel.distances.tolist()), fractions(problem.travel.durations.tolist())
    demand, ready, due, service = (fractions(a.tolist()) for a in (sites.demand, sites.ready, sites.due, sites.service))
    depot, cheapest = vehicle.start, dict[frozenset[int], Fraction]()
    spread = np.zeros(problem.travel.distances.shape) if problem.travel.variances is None else problem.travel.variances
    begun: list[tuple[tuple[int, ...], Fraction, Fraction, Fraction]] = [((), ready[depot], ZERO, ZERO)]
    while begun:
        visits, clock, length, load = begun.pop()
        at = visits[-1] if visits else depot
        leaves = clock + (service[at] if visits else ZERO)
        back = length + distance[at][depot]
        returns = leaves + duration[at][depot]
        if visits and returns <= due[depot] and back <= vehicle.max_distance and _in_time(vehicle, spread, visits, returns - ready[depot]):
            cost = Fraction(vehicle.fixed_cost) + Fraction(vehicle.unit_cost) * back
            cheapest[frozenset(visits)] = min(cheapest.get(frozenset(visits), cost), cost)
        for to in problem.customers.tolist():
            arrives, longer, heavier = leaves + duration[at][to], length + distance[at][to], load + demand[to]
            if to not in visits and arrives <= due[to] and longer <= vehicle.max_distance and heavier <= vehicle.capacity:
                begun.append(((*visits, to), max(arrives, ready[to]), longer, heavier))
    return cheapest


def _in_time(vehicle: VehicleType, variances: Floats, visits: tuple[int, ...], takes: Fraction) -> bool:
    """Check that a route of mean duration ``takes``, on which nobody waits, overruns no more likely than it may."""
    moves = itertools.pairwise((vehicle.start, *visits, vehicle.end))
    variance = math.fsum(float(variances[move]) for move in moves)
    margin = NormalDist().inv_cdf(1.0 - vehicle.risk) * math.sqrt(variance) if vehicle.risk is not None else 0.0
    return float(takes) + margin <= vehicle.max_duration


# -- selection and max-min -------------------------------------------------------------------------------------------


def selection_values(problem: SubmodularSelection) -> Iterator[Fraction]:
    """Value of every set that the constraint allows: each item is worth the most that a chosen element gives it."""
    views = problem.function.as_item_weights()
    assert views is not None
    worth = [[ZERO] * views.num_items for _ in range(problem.num_elements)]
    for element in range(problem.num_elements):
        items, weights = views.given_by(element)
        for item, weight in zip(
            range(views.num_items)[items] if isinstance(items, slice) else items.tolist(), weights.tolist(), strict=True
        ):
            worth[element][item] = Fraction(weight)
    for size in range(problem.num_elements + 1):
        for chosen in itertools.combinations(range(problem.num_elements), size):
            if _allows(problem.constraint, chosen):
                yield sum((max((worth[e][item] for e in chosen), default=ZERO) for item in range(views.num_items)), ZERO)


def _allows(constraint: Any, chosen: tuple[int, ...]) -> bool:
    if isinstance(constraint, Cardinality):
        return len(chosen) <= constraint.limit
    if isinstance(constraint, PartitionMatroid):
        groups = constraint.groups.tolist()
        return all(sum(groups[e] == g for e in chosen) <= limit for g, limit in enumerate(constraint.limits.tolist()))
    assert isinstance(constraint, Knapsack)
    costs = constraint.costs.tolist()
    return sum((Fraction(costs[e]) for e in chosen), ZERO) <= Fraction(constraint.budget)


def bottleneck_values(problem: BottleneckSATA) -> Iterator[Fraction]:
    """Quality at the worst-covered target, for all ways to give each robot one of its actions or none."""
    graph = problem.graph
    _, sees = _sensing(problem)
    own = [[a for a, robot in enumerate(graph.robot_of_action.tolist()) if robot == r] for r in range(graph.num_robots)]
    for chosen in itertools.product(*([None, *actions] for actions in own)):
        taken = [a for a in chosen if a is not None]
        yield min(sum((row[a] for a in taken), ZERO) for row in sees)


def _sensing(problem: BottleneckSATA) -> tuple[list[Vector], list[Vector]]:
    """Packing rows of the robots and covering rows of the targets."""
    graph = problem.graph
    robots = graph.robot_of_action.tolist()
    packing = [[ONE if robot == r else ZERO for robot in robots] for r in range(graph.num_robots)]
    covering = [[ZERO] * len(robots) for _ in range(graph.num_targets)]
    for action in range(len(robots)):
        for edge in range(int(graph.indptr[action]), int(graph.indptr[action + 1])):
            covering[int(graph.indices[edge])][action] = Fraction(float(graph.weights[edge]))
    return packing, covering


def max_min_truth(problem: BottleneckSATA | MaxMinLP) -> Truth:
    """The linear program itself: the greatest least entry of ``C x`` with ``A x <= 1``, or the other way round."""
    if isinstance(problem, BottleneckSATA):
        packing, covering = _sensing(problem)
    else:
        packing, covering = (_dense(m, problem.num_variables) for m in (problem.packing, problem.covering))
    width, most = len(covering[0]), problem.sense == "max"
    packed, needed = (ZERO, ONE) if most else (-ONE, ZERO)  # coefficients of the level, the last variable
    rows = [[*row, packed] for row in packing] + [[*(-e for e in row), needed] for row in covering]
    limits = [ONE if most else ZERO] * len(packing) + [ZERO if most else -ONE] * len(covering)
    optimum = minimised([ZERO] * width + [-ONE if most else ONE], rows, limits)
    return Truth(optimum.status, abs(optimum.value)) if optimum.status == "optimal" else Truth(optimum.status)


def _dense(matrix: Any, columns: int) -> list[Vector]:
    rows = [[ZERO] * columns for _ in range(matrix.rows)]
    for row in range(matrix.rows):
        for entry in range(int(matrix.indptr[row]), int(matrix.indptr[row + 1])):
            rows[row][int(matrix.indices[entry])] += Fraction(float(matrix.data[entry]))
    return rows


# -- risk ------------------------------------------------------------------------------------------------------------


def path_hazards(problem: RiskyPath) -> Iterator[Fraction]:
    """Hazard of every path to a goal that may survive, from its probability to do so: risks of places, moves and pairs of moves."""
    graph = problem.graph
    places, moves = [ONE] * graph.num_states, dict[tuple[int | None, ...], Fraction]()
    for element in graph.elements:
        if isinstance(element, LocaleRisk):
            places = [p * (ONE - Fraction(r)) for p, r in zip(places, element.risk.tolist(), strict=True)]
        elif isinstance(element, MoveRisk):
            table = zip(*(column.tolist() for column in (element.before, element.state, element.after, element.risk)), strict=True)
            for *key, risk in table:
                moves[tuple(key)] = moves.get(tuple(key), ONE) * (ONE - Fraction(risk))
        else:
            raise NotImplementedError(f"nothing enumerates risks of {element.kind}")
    arcs = list(zip(graph.tail.tolist(), graph.head.tolist(), strict=True))
    begun: list[tuple[tuple[int, ...], Fraction]] = [((graph.start,), places[graph.start])]
    while begun:
        path, survives = begun.pop()
        if path[-1] in graph.goals:
            yield Fraction(-math.log1p(float(survives - ONE)))
        for at, to in arcs:
            if at == path[-1] and to not in path:
                before = path[-2] if len(path) > 1 else None
                survives_move = survives * places[to] * moves.get((-1, at, to), ONE) * moves.get((before, at, to), ONE)
                if survives_move:
                    begun.append(((*path, to), survives_move))


# -- programs --------------------------------------------------------------------------------------------------------


def program_truth(program: Program) -> Truth:
    """Every choice of the whole variables, and over the others a linear program or a strictly convex quadratic one."""
    sign, width = (1 if program.sense == "min" else -1), program.num_variables
    cost = [sign * Fraction(c) for c in program.cost.tolist()]
    rows = [[ZERO] * width for _ in range(program.num_rows)]
    for row in range(program.num_rows):
        for entry in range(int(program.indptr[row]), int(program.indptr[row + 1])):
            rows[row][int(program.indices[entry])] += Fraction(float(program.data[entry]))
    region = Region(rows, program.row_lower.tolist(), program.row_upper.tolist(), program.lower.tolist(), program.upper.tolist())
    curved = None if program.quadratic is None else [[sign * Fraction(q) for q in row] for row in program.quadratic.toarray().tolist()]
    endless = curved is None and region.falls_for_ever(cost)
    best: Fraction | None = None
    for chosen in itertools.product(*_whole_values(program, endless)):
        value = _least_beside(dict(zip(program.integer.nonzero()[0].tolist(), chosen, strict=True)), region, cost, curved)
        if value is not None:
            if endless:
                return Truth("unbounded")
            best = value if best is None else min(best, value)
    return Truth("infeasible") if best is None else Truth("optimal", sign * best + Fraction(program.offset))


def _whole_values(program: Program, endless: bool) -> Iterator[range]:
    for low, high in zip(program.lower[program.integer].tolist(), program.upper[program.integer].tolist(), strict=True):
        if math.isinf(low) or math.isinf(high):
            if not endless:
                raise NotImplementedError("whole variables without bounds are enumerated in unbounded programs alone")
            low, high = (max(low, -BOX), BOX) if math.isinf(low) else (low, low + BOX)
        yield range(math.ceil(low), math.floor(high) + 1)


def _least_beside(whole: dict[int, int], region: Region, cost: Vector, curved: list[Vector] | None) -> Fraction | None:
    """The least value where the whole variables have the given values; any value where it falls for ever, None where there is no point."""
    free = [j for j in range(len(cost)) if j not in whole]
    used = [sum((row[j] * v for j, v in whole.items()), ZERO) for row in region.rows]
    within = Region(
        [[row[j] for j in free] for row in region.rows],
        [low if math.isinf(low) else Fraction(low) - u for low, u in zip(region.row_lower, used, strict=True)],
        [high if math.isinf(high) else Fraction(high) - u for high, u in zip(region.row_upper, used, strict=True)],
        [region.lower[j] for j in free], [region.upper[j] for j in free],
    )  # fmt: skip
    value = sum((cost[j] * v for j, v in whole.items()), ZERO)
    linear = [cost[j] for j in free]
    if not free and not all(low <= 0 <= high for low, high in zip(within.row_lower, within.row_upper, strict=True)):
        return None
    if curved is not None:
        value += sum((curved[i][j] * a * b for i, a in whole.items() for j, b in whole.items()), ZERO) / 2
        linear = [c + sum((curved[i][j] * a for i, a in whole.items()), ZERO) for c, j in zip(linear, free, strict=True)]
        bent = [[curved[i][j] for j in free] for i in free]
        if any(any(row) for row in bent):
            curved_part = least_convex(linear, bent, within)
            return None if curved_part is None else value + curved_part
    if not free:
        return value
    least = within.minimised(linear)
    return None if least.status == "infeasible" else value + least.value


def least_convex(linear: Vector, curved: list[Vector], region: Region) -> Fraction | None:
    """The least ``linear x + x' curved x / 2`` for a positive definite ``curved``: the best feasible of the points that are least where
    some sides hold with equality, of which the optimum is one; None if there is no feasible point."""
    sides, width = region.sides(), len(linear)
    best: Fraction | None = None
    for size in range(min(width, len(sides)) + 1):
        for tight in itertools.combinations(sides, size):
            # The gradient is a combination of the tight rows, and these hold with equality.
            system = [[*curved[i], *(row[i] for row, _ in tight), -linear[i]] for i in range(width)]
            system += [[*row, *[ZERO] * size, limit] for row, limit in tight]
            solved = _solved(system)
            if solved is None:
                continue
            x = solved[:width]
            if all(_dot(row, x) <= limit for row, limit in sides):
                value = _dot(linear, x) + sum((a * _dot(row, x) for a, row in zip(x, curved, strict=True)), ZERO) / 2
                best = value if best is None else min(best, value)
    return best


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)


def _solved(system: list[Vector]) -> Vector | None:
    """The solution of a square linear system, given with its right side; None where there is not exactly one."""
    size = len(system)
    for column in range(size):
        pivot = next((k for k in range(column, size) if system[k][column]), None)
        if pivot is None:
            return None
        system[column], system[pivot] = system[pivot], system[column]
        for k in range(size):
            factor = system[k][column] / system[column][column]
            if k != column and factor:
                system[k] = [a - factor * b for a, b in zip(system[k], system[column], strict=True)]
    return [row[-1] / row[k] for k, row in enumerate(system)]
