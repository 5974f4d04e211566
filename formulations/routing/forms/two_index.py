"""Two-index forms: one binary variable per arc, whatever the number of vehicles, and *resources* that grow along routes.

All vehicles are alike and start and end at the same depots. Rows, resources, node levels and arc flows, and which form writes which:
docs/formulations/routing.md#two-index-forms. A route i_0 = 0, i_1, ... may use levels v with v_0 = lo_0, v_j >= v_i + w_ij and
lo_j <= v_j <= up_j: exactly those routes are feasible. ``two-index-unit-flow`` writes limited resources with node levels, and beside them
always the order as arc flows: f_ij counts the visits up to i, one commodity that leaves the depot and gains one unit per customer, so that
every customer is connected to the depot whatever durations are. Durations and their costs are costs of arcs where nobody can have to
wait.

The duals of visit-out, visit-in, fleet and r-balance in the LP relaxation of ``two-index-time-flow`` (minimisation, all customers
required) are evidence ``arc-multipliers``: the Lagrangian of these rows, which at the optimal duals is the LP's value.

Source: Gavish and Graves (1978) for the flows, of units and of loads, with windows Bard, Kontoravdis and Yu (2002); Miller, Tucker,
Zemlin (1960) for node levels, Desrochers and Laporte (1991) for the lifted rows.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.number_arrays import Integers
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Decision, Problem
from ...programs.circuits import Circuit
from ...programs.compiled import Compiled
from ...programs.duals import dual_value
from ...programs.exactness import Exactness
from ...programs.program import Floats, Program
from ...programs.rows import Part, rows
from ..preparation import Preparation, Resource, leaves_cycles, offset, prepare, waiting_is_possible
from ..problem import RoutingProblem
from ..reachability import minimum_vehicles
from ..routes import Routes
from . import _sizes
from ._routes import ArcIndex, Blocks, levels, point_of, routes_of, used, with_levels

Ints = NDArray[np.integer[Any]]

EVIDENCED = frozenset(
    {
        "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "energy:travel", "energy:elapsed",
        "energy:elapsed-fixed-start", "energy:windows", "limited-fleet", "min-vehicles", "multiple-depots", "open-routes", "fixed-cost",
        "separate-durations", "forbidden-moves", "objective:total-cost", "objective:vehicles", "objective:weights",
    }
)  # fmt: skip
"""Features under which the checker of ``arc-multipliers`` has the same rows and costs."""

FEATURES = EVIDENCED | {
    "optional-sites", "duration-cost", "shifts", "vehicle-speeds", "vehicle-travel", "several-loads", "groups", "skills", "initial-energy",
    "objective:reward", "objective:total-duration", "objective:penalties", "objective:priorities",
}  # fmt: skip
"""Several depots and open routes only as far as one vehicle type has them: its routes start at one depot and end at another."""

EVIDENCE_RESOURCES = ("time", "load", "distance", "duration", "energy", "order")


UNIT_FLOW = "two-index-unit-flow"


def refuses(problem: RoutingProblem) -> frozenset[str]:
    """Elapsed time is no sum over arcs where a vehicle may wait and choose its departure."""
    elapsed = problem.features() & {"max-duration", "energy:elapsed", "duration-cost", "objective:total-duration"}
    return elapsed if elapsed and waiting_is_possible(problem) else frozenset()


def needed_resources(problem: RoutingProblem, prep: Preparation, connected: bool = False) -> dict[str, Resource]:
    """The resources that a form must write down: all limited ones, and ``order`` if the others leave cycles, or it is asked for."""
    limits_time = bool(np.isfinite(problem.sites.due[prep.sites]).any()) or "energy:elapsed-fixed-start" in problem.features()
    limits_time |= math.isfinite(problem.fleet[prep.vehicle].shift[1])
    chosen = {name: r for name, r in prep.resources.items() if name != "time" or limits_time}
    if connected or leaves_cycles(prep, chosen.values()):
        n = prep.customers
        lower, upper = np.ones(n + 2), np.full(n + 2, float(n))
        lower[0], lower[-1], upper[-1] = 0.0, 0.0, n + 1.0
        chosen["order"] = Resource("order", np.ones(len(prep.tail)), lower, upper)
    return chosen


def beyond_rounding(difference: Floats, *terms: Floats) -> NDArray[np.bool_]:
    """True for each difference, computed from ``terms``, that is positive by more than its rounding error.

    The others must not become coefficients: solvers scale a row by its entries, and one of 1e-16 spoils that.
    """
    size: Floats = np.sum([np.abs(np.where(np.isfinite(term), term, 0.0)) for term in terms], axis=0)
    return np.asarray(difference > 8.0 * math.ulp(1.0) * size)


class ArcColumns(Blocks):
    """A column per arc, and the other columns and rows of one program, block after block."""

    def __init__(self, problem: RoutingProblem, prep: Preparation) -> None:
        super().__init__(problem)
        self.prep = prep
        self.ids = problem.sites.ids
        self.node_names = [self.ids[s] for s in prep.sites]
        self.arcs = np.arange(len(prep.tail))
        self.add_columns("x", (prep.tail, prep.head), (self.node_names, self.node_names), 0.0, 1.0, prep.cost, integer=True)
        self.inner = (prep.tail != 0) & (prep.head != prep.end)
        self.customers = np.arange(1, prep.nodes - 1)
        self.encoders: list[Callable[[Floats, Integers, Integers], None]] = []
        self.prices: dict[str, Callable[[Floats], Floats]] = {}

    def add_rows(self, name: str, keys: tuple[Ints, ...], parts: Any, lower: Any = -math.inf, upper: Any = math.inf) -> slice:
        before = sum(b.size for b in self.rows)
        size = len(keys[0]) if keys else len(np.atleast_1d(np.asarray(lower)))
        self.rows.append(rows(name, size, parts, lower, upper, keys, (self.node_names,) * len(keys)))
        return slice(before, before + size)

    def assignment(self) -> None:
        """Visits, flow and fleet."""
        prep = self.prep
        required = prep.required[1:-1]
        leaving, entering = self.arcs[prep.tail != 0], self.arcs[prep.head != prep.end]
        out = self.add_rows("visit-out", (self.customers,), [(prep.tail[leaving] - 1, leaving, 1.0)], np.where(required, 1.0, 0.0), 1.0)
        must, may = self.customers[required], self.customers[~required]
        position = np.full(prep.nodes, -1)
        position[must] = np.arange(len(must))
        into = entering[prep.required[prep.head[entering]]]
        enter = self.add_rows("visit-in", (must,), [(position[prep.head[into]], into, 1.0)], 1.0, 1.0)
        if len(may):
            position[may] = np.arange(len(may))
            into = entering[~prep.required[prep.head[entering]]]
            back = leaving[~prep.required[prep.tail[leaving]]]
            parts = [(position[prep.head[into]], into, 1.0), (position[prep.tail[back]], back, -1.0)]
            self.add_rows("flow", (may,), parts, 0.0, 0.0)
        fleet = self.fleet()
        if self.problem.sites.groups:
            self.add_groups(self._visits_by_group())
        self.prices = {"out": lambda y: y[out], "in": lambda y: y[enter], "fleet": lambda y: y[fleet]}

    def fleet(self) -> slice:
        """Least and greatest number of routes; where the rows are."""
        prep = self.prep
        first = self.arcs[prep.tail == 0]
        least, most = float(minimum_vehicles(self.problem)), float(prep.fleet)
        # Sides that cross are no row; two rows tell a solver that there is no answer.
        sides = [(least, most)] if least <= most else [(least, math.inf), (-math.inf, most)]
        parts = [(np.full(len(first), k), first, 1.0) for k in range(len(sides))]
        return self.add_rows("fleet", (), parts, [a for a, _ in sides], [b for _, b in sides])

    def _visits_by_group(self) -> Iterator[Part]:
        for number, group in enumerate(self.problem.sites.groups):
            leaving = self.arcs[(self.prep.tail != 0) & np.isin(self.prep.sites[self.prep.tail], group.sites)]
            yield np.full(len(leaving), number), leaving, 1.0

    def node_levels(self, r: Resource) -> None:
        """A resource as one level per customer."""
        prep, lo, up, w = self.prep, r.lower, r.upper, r.weight
        first = self.add_columns(r.name, (self.customers,), (self.node_names,), lo[1:-1], up[1:-1])

        def level(nodes: Ints) -> Ints:
            return first + nodes - 1

        big = up[prep.tail] + w - lo[prep.head]
        arc = self.arcs[self.inner & (big > 0)]
        i, j, row = prep.tail[arc], prep.head[arc], np.arange(len(arc))
        parts = [(row, level(i), 1.0), (row, level(j), -1.0), (row, arc, big[arc])]
        if not r.waits:
            back = ArcIndex(prep).find(j, i)
            lift = np.where(back >= 0, big[arc] - w[arc] - w[back], 0.0)
            keep = beyond_rounding(lift, big[arc], w[arc], np.where(back >= 0, w[back], 0.0))
            parts.append((row[keep], back[keep], lift[keep]))
        self.add_rows(r.name, (i, j), parts, upper=big[arc] - w[arc])

        rise = lo[prep.tail] + w - lo[prep.head]
        arc = self.arcs[(prep.head != prep.end) & beyond_rounding(rise, lo[prep.tail], w, lo[prep.head])]
        self._bounding(f"{r.name}-earliest", prep.head[arc], arc, -rise[arc], level, lower=lo)
        drop = up[prep.tail] - np.minimum(up[prep.tail], up[prep.head] - w)
        arc = self.arcs[(prep.tail != 0) & beyond_rounding(drop, up[prep.tail], up[prep.head], w)]
        self._bounding(f"{r.name}-latest", prep.tail[arc], arc, drop[arc], level, upper=up)

        def encode(x: Floats, nodes: Integers, arcs: Integers) -> None:
            x[level(nodes[1:-1])] = levels(r, nodes, arcs)[1:-1]

        self.encoders.append(encode)

    def _bounding(self, name: str, node: Ints, arc: Ints, value: Floats, level: Callable[[Ints], Ints], **side: Floats) -> None:
        """Rows ``level + sum value x`` against the ``lower`` or ``upper`` range, for the nodes that have any such arc."""
        nodes, row = np.unique(node, return_inverse=True)
        parts = [(np.arange(len(nodes)), level(nodes), 1.0), (row, arc, value)]
        self.add_rows(name, (nodes,), parts, **{which: bounds[nodes] for which, bounds in side.items()})

    def arc_flows(self, r: Resource) -> None:
        """A resource as one flow an arc that leaves a customer."""
        prep, lo, up, w = self.prep, r.lower, r.upper, r.weight
        arc = self.arcs[prep.tail != 0]
        i, j = prep.tail[arc], prep.head[arc]
        room = np.maximum(0.0, np.minimum(up[i], up[j] - w[arc]) - lo[i])
        first = self.add_columns(f"{r.name}-flow", (i, j), (self.node_names, self.node_names), 0.0, room)
        flow, row = first + np.arange(len(arc)), np.arange(len(arc))
        self.add_rows(f"{r.name}-link", (i, j), [(row, flow, 1.0), (row, arc, -room)], upper=0.0)
        inner = self.inner[arc]
        start = self.arcs[prep.tail == 0]
        parts = [
            (i - 1, flow, 1.0), (i - 1, arc, lo[i]),
            (j[inner] - 1, flow[inner], -1.0), (j[inner] - 1, arc[inner], -(lo[i] + w[arc])[inner]),
            (prep.head[start] - 1, start, -(lo[0] + w[start])),
        ]  # fmt: skip
        balance = self.add_rows(f"{r.name}-balance", (self.customers,), parts, lower=0.0)
        if r.name in EVIDENCE_RESOURCES:
            self.prices[r.name] = lambda y: y[balance]
        flow_of = np.full(len(prep.tail), -1)
        flow_of[arc] = flow

        def encode(x: Floats, nodes: Integers, arcs: Integers) -> None:
            x[flow_of[arcs[1:]]] = levels(r, nodes, arcs)[1:-1] - lo[nodes[1:-1]]

        self.encoders.append(encode)


def build(problem: RoutingProblem, form: str, flows: Callable[[str], bool], prep: Preparation | None = None) -> Compiled:
    """The program of a two-index form for the first level of the objective, which writes resources as arc flows where ``flows`` says so.

    ``prep`` are arcs to write down in place of all of ``prepare(problem)``: a restriction, for duals that are priced out over the rest.
    """
    prep = prepare(problem) if prep is None else prep
    blocks = ArcColumns(problem, prep)
    blocks.assignment()
    for name, resource in needed_resources(problem, prep, connected=form == UNIT_FLOW).items():
        if flows(name):
            blocks.arc_flows(resource)
        else:
            blocks.node_levels(resource)
    compiled = written(blocks, form)
    if form != "two-index-time-flow" or problem.sense != "min" or not problem.features() - {"objective:priorities"} <= EVIDENCED:
        return compiled

    def at_most(column: int, most: int) -> Decision:
        ends = prep.sites[prep.tail[column]], prep.sites[prep.head[column]]
        return {"arc": [problem.sites.ids[site] for site in ends]}, most >= 1

    def evidence(row_duals: Floats, of: Problem | None = None) -> Evidence:
        value = dual_value(compiled.program, row_duals)
        return Evidence("arc-multipliers", "LP relaxation of two-index-time-flow", value, _multipliers(blocks, row_duals))

    def ray_evidence(ray: Floats) -> Evidence:
        return Evidence("arc-multipliers", "a ray of two-index-time-flow", math.inf, {**_multipliers(blocks, ray), "ray": True})

    return replace(compiled, dual_evidence=evidence, ray_evidence=ray_evidence, at_most=at_most)


def written(blocks: ArcColumns, form: str, circuits: tuple[Circuit, ...] = ()) -> Compiled:
    """The program of all columns and rows, with the way from arcs to routes and back."""
    problem, prep = blocks.problem, blocks.prep
    m, names, index = len(prep.tail), problem.sites.ids, ArcIndex(prep)

    def decode(x: Floats) -> Routes:
        return Routes(tuple(routes_of(prep, np.nonzero(used(x[:m]))[0], names)))

    def encode(answer: Routes) -> Floats:
        x = bare.lower.copy()
        for route in answer:
            nodes = index.nodes_of(route, names)
            arcs = index.arcs_of(nodes, names)
            x[arcs] += 1.0
            for write in blocks.encoders:
                write(x, nodes, arcs)
        return point_of(bare, x)

    bare = Program(form, problem.sense, tuple(blocks.variables), tuple(blocks.rows), offset=offset(problem), circuits=circuits)
    return Compiled(bare, problem, decode, encode, exactness=Exactness.EXACT if prep.whole else Exactness.RESTRICTION)


def _multipliers(blocks: ArcColumns, row_duals: Floats) -> dict[str, Any]:
    """Multipliers of visits, fleet and balances in site order."""
    duals = np.asarray(row_duals, dtype=np.float64)
    sites = blocks.prep.sites[1:-1]

    def in_site_order(values: Floats) -> list[float]:
        spread = np.zeros(len(blocks.problem.sites))
        spread[sites] = values
        return [float(v) for v in spread]

    return {
        "out": in_site_order(blocks.prices["out"](duals)),
        "in": in_site_order(blocks.prices["in"](duals)),
        "fleet": float(blocks.prices["fleet"](duals).sum()),
        "resources": {
            name: in_site_order(np.maximum(0.0, blocks.prices[name](duals))) for name in EVIDENCE_RESOURCES if name in blocks.prices
        },
    }


def _with_levels(problem: RoutingProblem, form: str, flows: Callable[[str], bool]) -> Compiled:
    return with_levels(problem, partial(build, form=form, flows=flows))


# As measured with HiGHS on the first 25 customers of C101, C103, C104, C201, R101, R103, R104, R201, RC101, RC103, RC104 and RC201
# (one thread, 20 s each): load flow proves 9 optima of 12, time flow the same 9 in twice the time, node levels the easiest 6.
for _order, (_name, _flows) in enumerate(
    (
        ("two-index-load-flow", lambda name: name != "time"),
        ("two-index-time-flow", lambda name: True),
        ("two-index-mtz", lambda name: False),
        (UNIT_FLOW, lambda name: name == "order"),
    )
):
    _size = partial(_sizes.two_index, flows=_flows, connected=_name == UNIT_FLOW)
    _build = partial(_with_levels, form=_name, flows=_flows)
    FORMS.enter(Form(_name, "routing", FEATURES, _build, refuses=refuses, order=_order, size=_size))
