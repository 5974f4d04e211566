"""Bound ``cutting-planes``: a linear program over edges, visits and shared limits, with cuts.

Cuts ask that every visit is joined to the depot, and every set by as many routes as its loads take. The program begins with the nearest
edges of each customer; others come in where their reduced cost is negative. Duals prove a bound at any time, once all moves are priced
with them, which the checker does.
"""

import math

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.programs.program import Program, Variables
from ....formulations.programs.rows import Part, rows
from ....formulations.routing.checking.known_features import without_stops
from ....formulations.routing.checking.vehicle_moves import VehicleMoves, alike, constants, needed_routes, terms_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from ...linear_session import LinearSession
from .. import bound_method, of_family
from .arcs import Flags, Floats, Integers, by_site, lacks_arc_costs, too_many_arcs
from .knapsack import lacks_rewards

NEIGHBOURS = 8
"""Edges of each node that the first program has at least."""

CUTS = 100
"""Cuts that are added at once at most."""

LARGEST_SET = 100
"""Most customers of a set with too much load."""

VIOLATED = 0.02
"""Part of a visit by which a cut must be violated."""

NEGATIVE = 1e-6
"""Part of the dearest edge or visit by which a reduced cost must be below 0 to count."""

BUDGET = 0.2
"""Part of the time for problems with several vehicles: it is enough where the program is small, and others do better where it is large."""


class _Costs:
    """Symmetric costs and weights of edges and visits, and what makes them so.

    ``visit`` has shape (nodes,), ``edge`` (nodes, nodes), with first moves in row 0, last ones in column 0, and infinity where there is no
    move; ``weight`` (resources, nodes, nodes); ``room`` (resources,) is what all vehicles have. Moves i-j cost ``skew`` of i more and of j
    less than the edge, and take as much more and less of each resource as ``weight_skew``, shape (resources, nodes), says.
    """

    def __init__(self, problem: RoutingProblem) -> None:
        relaxed, terms = without_stops(problem), terms_of(problem)
        assert terms is not None
        sites, customers, types = problem.sites, problem.sites.customers, alike(relaxed)
        n = len(customers)
        moves = [VehicleMoves.of(relaxed, v, terms, np.zeros(n), {}) for v in types]
        counts = [min(n, count) for count in types.values()]
        self.most, self.constant = min(n, sum(counts)), math.fsum(constants(relaxed, terms))
        rooms = {
            name: sum(c * (float(m.resources[name].upper[0]) - m.resources[name].start) for c, m in zip(counts, moves, strict=True))
            for name in moves[0].resources if name != "order" and all(name in m.resources for m in moves)
        }  # fmt: skip
        weights = {name: np.minimum.reduce([m.resources[name].weight for m in moves]) for name in rooms}
        self.names = [name for name, w in weights.items() if rooms[name] < w[:, 1:].max(axis=0).sum() + self.most * w[:, 0].max()]
        self.visit = np.append(0.0, terms.reward * sites.reward[customers] - terms.penalties * sites.penalty[customers])
        self.edge, self.skew = _symmetric(np.minimum.reduce([m.cost for m in moves]) - self.visit)
        both = [_symmetric(weights[name]) for name in self.names]
        self.weight = np.array([w for w, _ in both]).reshape(-1, n + 1, n + 1)
        self.weight_skew = np.array([s for _, s in both]).reshape(-1, n + 1)
        self.room = np.array([rooms[name] for name in self.names])


def _symmetric(matrix: Floats) -> tuple[Floats, Floats]:
    """The matrix with a number of each tail taken off and that of each head added, and these numbers; symmetric where it can be
    made so, else with the smaller of both directions."""
    inner = matrix[1:, 1:]
    both = np.isfinite(inner) & np.isfinite(inner.T)
    lean = np.where(both, np.where(both, inner, 0.0) - np.where(both, inner, 0.0).T, 0.0)
    skew = np.append(0.0, lean.sum(axis=1) / (2.0 * np.maximum(1, both.sum(axis=1))))
    symmetric = matrix - skew[:, None] + skew
    symmetric[1:, 1:] = np.minimum(symmetric[1:, 1:], symmetric[1:, 1:].T)
    return symmetric, skew


class _Relaxation:
    """The linear program of edges, visits and cuts.

    Columns are visits, the number of routes, then edges (``tail < head``, and the depot's twice: out and back); rows are degrees, first and
    last moves, resources, then cuts.
    """

    def __init__(self, problem: RoutingProblem, costs: _Costs, seed: int) -> None:
        n = len(costs.visit) - 1
        self.costs, self.n = costs, n
        self.relaxed = without_stops(problem)
        self.required = np.append(False, problem.sites.required[problem.customers])
        self.demand = np.where(self.required, np.append(0.0, problem.sites.demand[problem.customers]), 0.0)
        self.largest = max(v.capacity for v in self.relaxed.fleet)
        self.keys = np.random.default_rng(seed).random(n + 1)
        dearest = float(np.abs(costs.edge[np.isfinite(costs.edge)]).max(initial=0.0))
        self.unit = max(1e-300, float(np.abs(costs.visit).max()), dearest) / 100.0
        self.units = np.maximum(1e-300, costs.weight.mean(axis=(1, 2)))
        self.tail, self.head = np.zeros(0, np.int64), np.zeros(0, np.int64)
        self.inside, self.of = np.zeros((0, n + 1), dtype=bool), np.zeros(0, np.int64)
        self.known = ~np.isfinite(costs.edge)
        self.known[0, 0] = True
        self.known[1:, 1:] |= np.tri(n, dtype=bool)
        self.rows = n + 2 + len(costs.names)
        fewest = max(problem.min_vehicles, int(needed_routes(self.relaxed, self.required[1:])))
        columns = (
            Variables("visit", lower=self.required[1:].astype(np.float64), upper=np.ones(n), cost=costs.visit[1:] / self.unit),
            Variables("routes", lower=np.array([float(fewest)]), upper=np.array([float(max(fewest, costs.most))]), cost=np.zeros(1)),
        )
        none, each = np.zeros(n + 2), np.arange(n)
        low, high = np.append(none, np.full(len(costs.names), -math.inf)), np.append(none, costs.room / self.units)
        equal = rows("degree", self.rows, [(each, each, -2.0), (np.array([n, n + 1]), np.array([n, n]), -1.0)], low, high)
        self.session = LinearSession(Program("cuts", "min", columns, (equal,)), seed)
        near = _nearest(costs)
        if self.required.any():  # whoever must be visited may need many routes
            near[0] = near[:, 0] = True
        self.join(near)

    def join(self, wanted: Flags) -> int:
        """Add edges; returns how many."""
        wanted = wanted.copy()
        wanted[1:, 1:] |= wanted[1:, 1:].T
        tail, head = np.nonzero(wanted & ~self.known)
        if not len(tail):
            return 0
        self.known[tail, head] = True
        size, n, c = len(tail), self.n, self.costs
        column = np.arange(size)
        parts: list[Part] = [(column, np.where(tail > 0, tail - 1, n), 1.0), (column, np.where(head > 0, head - 1, n + 1), 1.0)]
        parts += [(column, np.full(size, n + 2 + k), w[tail, head] / u) for k, (w, u) in enumerate(zip(c.weight, self.units, strict=True))]
        cut, crossing = np.nonzero(self.inside[:, tail] != self.inside[:, head])
        joined = rows("edges", size, [*parts, (crossing, self.rows + cut, 1.0)])
        self.session.add(c.edge[tail, head] / self.unit, joined.indptr[:-1], joined.indices, joined.data, np.ones(size))
        self.tail, self.head = np.append(self.tail, tail), np.append(self.head, head)
        return size

    def cut(self, inside: Flags, of: Integers) -> None:
        """Add the cuts around sets, as ``violated`` names them."""
        cut, crossing = np.nonzero(inside[:, self.tail] != inside[:, self.head])
        served = np.nonzero(of)[0]
        around = rows("cuts", len(of), [(cut, crossing + self.n + 1, 1.0), (served, of[served] - 1, -2.0)])
        right = np.where(of > 0, 0.0, 2.0 * needed_routes(self.relaxed, inside[:, 1:]))
        self.session.add_rows(right, around.indptr[:-1], around.indices, around.data)
        self.inside, self.of = np.concatenate([self.inside, inside]), np.append(self.of, of)

    def violated(self, x: Floats, stop: Stop) -> tuple[Flags, Integers]:
        """Sets whose cuts a point breaks, and for each the customer whose visit it serves; 0 for sets with required customers."""
        from .cut_kernels import cuts_below, overloaded_sets

        flow = x[self.n + 1 :]
        used = flow > 1e-9
        a, b, flow = self.tail[used], self.head[used], flow[used]
        ends, others, edge = np.append(a, b), np.append(b, a), np.tile(np.arange(len(a)), 2)
        order = np.argsort(ends, kind="stable")
        place = np.empty(len(order), np.int64)
        place[order] = np.arange(len(order))
        twins = place[(order + len(a)) % max(1, len(order))]
        starts, heads, capacity = np.searchsorted(ends[order], np.arange(self.n + 2)), others[order], flow[edge[order]]
        visit = np.append(0.0, x[: self.n])
        ask = np.argsort(-visit, kind="stable")[: int((visit > VIOLATED).sum())]
        inside = np.zeros((2 * CUTS, self.n + 1), dtype=bool)
        count = cuts_below(stop.flag, starts, heads, twins, capacity, 2.0 * visit, ask, 2.0 * VIOLATED, inside[:CUTS])
        if 0.0 < self.largest < math.inf:
            count += overloaded_sets(
                stop.flag, starts, heads, capacity, self.demand, self.keys, self.largest, 2.0 * VIOLATED, LARGEST_SET,
                inside[count : count + CUTS],
            )  # fmt: skip
        inside = inside[:count]
        of = np.argmax(np.where(inside, visit, -1.0), axis=1) if count else np.zeros(0, np.int64)
        return inside, np.where((inside & self.required).any(axis=1), 0, of)

    def priced(self, duals: Floats) -> tuple[Floats, Floats, Floats]:
        """Node prices, rates and cut prices of duals, in the problem's units."""
        price = np.append(0.0, duals[: self.n]) * self.unit
        rates = np.maximum(0.0, -duals[self.n + 2 : self.rows]) * self.unit / self.units
        return price, rates, np.maximum(0.0, duals[self.rows :]) * self.unit

    def reduced(self, duals: Floats) -> Floats:
        """Reduced costs of all edges."""
        price, rates, cuts = self.priced(duals)
        on = cuts > 0.0
        member = self.inside[on].astype(np.float64)
        share = cuts[on] @ member
        reduced = self.costs.edge + np.tensordot(rates, self.costs.weight, 1) - (price + share)[:, None] - (price + share)
        reduced += 2.0 * (member.T * cuts[on]) @ member
        reduced[0] -= duals[self.n] * self.unit
        reduced[:, 0] -= duals[self.n + 1] * self.unit
        return reduced


def _nearest(costs: _Costs) -> Flags:
    """The edges of each node that cost and take least."""
    usable = np.isfinite(costs.edge)
    edge = np.where(usable, costs.edge, 0.0)
    far = edge / max(1e-300, float(np.abs(edge).max())) + sum(w / max(1e-300, float(w.max())) for w in costs.weight)
    far = np.where(usable, far, math.inf)
    np.fill_diagonal(far, math.inf)
    near = np.zeros(far.shape, dtype=bool)
    count = min(NEIGHBOURS, len(far) - 1)
    np.put_along_axis(near, np.argpartition(far, count - 1, axis=1)[:, :count], True, axis=1)
    near[:, 0] |= near[0]
    near[0] |= near[:, 0]
    return near & usable


def _lacks(problem: RoutingProblem) -> frozenset[str]:
    """Features and objectives that ``lacks_rewards`` names, unless all that counts is costs of routes with loads and without windows."""
    lacking = lacks_rewards(problem)
    if not lacking or lacks_arc_costs(problem):
        return lacking
    return frozenset() if problem.features() & {"capacity"} and not problem.features() & {"time-windows"} else lacking


KERNELS = ("waybound.solvers.bounds.routing.cut_kernels",)


@bound_method("cutting-planes", of_family("routing", _lacks), order=1, kernels=KERNELS)
def cutting_planes_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence ``cut-multipliers`` from the duals of the program that proves most.

    Source: Fischetti, Salazar González, Toth (1998) for the cuts; Padberg and Rinaldi (1991) for edges that are priced in.
    """
    if stop.reached() or too_many_arcs(problem, stop.seconds_left):
        return None
    if problem.vehicle_limit != 1:
        stop = stop.within(BUDGET * stop.seconds_left)
    costs = _Costs(problem)
    program = _Relaxation(problem, costs, (linear or LinearPrograms()).seed)
    best, proved = -math.inf, None
    while not stop.reached():
        solved = program.session.solve(stop)
        if solved.status != "optimal":
            break
        reduced = program.reduced(solved.duals)
        missing = np.where(program.known, 0.0, np.minimum(reduced, 0.0))
        value = solved.value * program.unit + float(missing.sum())
        if value > best:
            best, proved = value, (solved.duals, len(program.of))
        inside, of = program.violated(solved.x, stop)
        if len(of):
            program.cut(inside, of)
        joined = program.join(missing < -NEGATIVE * 100.0 * program.unit)
        if not joined and not len(of):
            break
    return None if proved is None else _evidence(problem, costs, program, best, *proved)


def _evidence(problem: RoutingProblem, costs: _Costs, program: _Relaxation, value: float, duals: Floats, cuts: int) -> Evidence:
    price, rates, prices = program.priced(duals)
    skew = costs.skew + rates @ costs.weight_skew
    customers = problem.customers
    listed = [
        {"sites": customers[np.nonzero(program.inside[k, 1:])[0]].tolist(), "price": float(prices[k]),
         "of": int(customers[program.of[k] - 1]) if program.of[k] else None}
        for k in np.nonzero(prices[:cuts] > 0.0)[0].tolist()
    ]  # fmt: skip
    data = {
        "out": by_site(problem, (price + skew)[1:]), "in": by_site(problem, (costs.visit + price - skew)[1:]),
        "rates": dict(zip(costs.names, rates.tolist(), strict=True)), "cuts": listed,
    }  # fmt: skip
    value = (1.0 if problem.sense == "min" else -1.0) * (value + costs.constant)
    return Evidence("cut-multipliers", "linear relaxation with cuts", value, data)
