"""Bound ``sifted-relaxation``: the linear relaxation of a routing problem, begun with the nearest moves of each customer."""

import math
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.forms import FORMS
from ....formulations.programs.size import ProgramSize
from ....formulations.routing.preparation import Preparation, Resource
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ...linear_programs import LinearPrograms
from .. import bound_method, instead_of, of_family
from ..linear_relaxation import ENTRIES_PER_SECOND
from .arcs import Flags, Floats, lacks_arc_costs, too_many_arcs

FORM = "two-index-time-flow"
"""The strongest of the two-index forms, and the one whose duals are evidence."""

NO_VERTEX = {"highs": {"solver": "ipm", "run_crossover": "off"}}
"""Duals of an interior point are as good as those of a vertex, and came up to five times sooner (26 s against 5 s on R112)."""

NEIGHBOURS = (3, 10)
"""Moves out of and into each customer that the first LP has at least (with fewer it says too little to be worth its time) and at most."""


def _lacks(problem: RoutingProblem) -> frozenset[str]:
    return lacks_arc_costs(problem) | FORMS[FORM].missing(problem)


@bound_method("sifted-relaxation", of_family("routing", _lacks), order=2, replaces=instead_of("linear-relaxation", "routing"))
def sifted_relaxation_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the duals of the linear relaxation of ``two-index-time-flow``; None where even a small LP exceeds the budget.

    A problem with more moves than the budget allows is begun with the nearest moves of each customer. Duals of that LP are as valid as any
    others once all moves are priced with them, which the checker does; moves of negative reduced cost are added and the LP is solved again
    while there is time (sifting: Bixby et al. 1992).
    """
    from ....formulations.routing.forms.two_index import build, needed_resources
    from ....formulations.routing.preparation import prepare

    linear = linear or LinearPrograms()
    if stop.reached() or too_many_arcs(problem, stop.seconds_left):
        return None
    seconds, size = stop.seconds_left, FORMS[FORM].size(problem)
    if size is not None:  # of the program a part is written down, but all moves are prepared
        ProgramSize(0.0, 0.0, 0.0, size.work).refuse_beyond_memory(FORM)
    prep = prepare(problem)
    resources = needed_resources(problem, prep)
    if set(resources) == {"order"}:
        return None  # little more than an assignment (46 % gap on TSPLIB, spanning trees 1 %)
    entries = 2 + 6 * len(resources)  # an arc is in two visits, and in six entries of each resource
    room = ENTRIES_PER_SECOND * seconds / entries
    kept = _nearest(prep, room)
    best: Evidence | None = None
    while kept is not None:
        began = time.perf_counter()
        compiled = build(problem, FORM, lambda name: True, _restricted(prep, kept))
        duals = linear.duals(compiled.relaxed().program, stop, NO_VERTEX)
        if duals is None or compiled.dual_evidence is None:
            return best
        evidence = compiled.dual_evidence(duals)
        evidence = replace(evidence, value=verified_bound(problem, evidence))
        if best is None or evidence.value > best.value:
            best = evidence
        negative = _reduced_costs(prep, evidence.data, resources) < -1e-7 * abs(evidence.value) / prep.nodes
        missing = np.nonzero(negative & ~kept)[0]
        took = time.perf_counter() - began
        if len(missing) == 0 or 1.3 * took > stop.seconds_left:
            return best
        kept = kept.copy()
        kept[missing] = True
    return best


def _nearest(prep: Preparation, room: float) -> Flags | None:
    """The nearest moves out of and into each customer, as far as there is room, and all at the depot; None where these are too few."""
    depot = (prep.tail == 0) | (prep.head == prep.end)
    count = int((room - int(depot.sum())) / (1.5 * max(1, prep.customers)))  # about half of the nearest in are nearest out as well
    count = min(count, NEIGHBOURS[1], prep.customers)
    if count < min(NEIGHBOURS[0], prep.customers):
        return None
    far = np.full((prep.nodes, prep.nodes), math.inf)
    # A move is near if it is cheap and needs little waiting.
    idle = np.maximum(0.0, prep.time.lower[prep.head] - prep.time.upper[prep.tail] - prep.time.weight)
    far[prep.tail, prep.head] = np.where(depot, math.inf, prep.distance + 0.2 * idle)
    near = np.zeros(far.shape, dtype=bool)
    out, into = np.argpartition(far, count, axis=1)[:, :count], np.argpartition(far, count, axis=0)[:count]
    np.put_along_axis(near, out, True, axis=1)
    np.put_along_axis(near, into, True, axis=0)
    kept: Flags = near[prep.tail, prep.head] | depot
    return kept


def _restricted(prep: Preparation, kept: Flags) -> Preparation:
    """The preparation with the moves that are kept."""
    resources = {name: replace(r, weight=r.weight[kept]) for name, r in prep.resources.items()}
    return replace(
        prep, tail=prep.tail[kept], head=prep.head[kept], distance=prep.distance[kept], duration=prep.duration[kept],
        cost=prep.cost[kept], resources=resources, whole=prep.whole and bool(kept.all()),
    )  # fmt: skip


def _reduced_costs(prep: Preparation, data: dict[str, Any], resources: Mapping[str, Resource]) -> Floats:
    """Reduced cost of each move at the multipliers of an evidence, with flows at their best."""
    i, j = prep.tail, prep.head

    def at_nodes(values: list[float]) -> Floats:
        prices = np.asarray(values, dtype=np.float64)[prep.sites]
        prices[[0, -1]] = 0.0
        return prices

    reduced: Floats = prep.cost - at_nodes(data["out"])[i] - at_nodes(data["in"])[j] - data["fleet"] * (i == 0)
    for name, values in data["resources"].items():
        r, mu = resources[name], at_nodes(values)
        slope = mu[j] - mu[i]
        level = np.where(slope > 0, r.lower[i], np.minimum(r.upper[i], r.upper[j] - r.weight))
        reduced += mu[j] * r.weight + slope * np.where(i == 0, r.lower[0], level)
    return reduced
