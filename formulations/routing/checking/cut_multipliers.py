"""Evidence ``cut-multipliers``: a Lagrangian bound from prices of sites, of limits that all vehicles share, and of cuts around sets.

The rows are in docs/formulations/routing.md#cuts. At any prices the least of the Lagrangian over moves, visits and number of routes is a
bound; of the moves i-j and j-i an answer makes one at most.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import lift
from ..problem import RoutingProblem
from .known_features import EPS, RESOURCES, Flags, Floats, Integers, refuse_unknown_resources, routing_evidence
from .vehicle_moves import Terms, VehicleMoves, alike, constants, needed_routes, relaxed_terms, value_grain, worth_of_visits


@routing_evidence("cut-multipliers")
def check_cut_multipliers(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective that any prices prove (weak duality); maxima count by the farthest round trip.

    ``data``: ``out`` and ``in``, lists with one number per site (entries of depots are ignored); ``rates``, the price of a unit of a
    resource by its name; ``cuts``, objects with ``sites``, positions of customers, ``price``, and ``of``, the position of that one of
    them whose visit is the right side, or null for what the required ones among them need. Negative prices of resources and cuts are read
    as 0.

    Source: Fischetti, Salazar González, Toth (1998), "Solving the orienteering problem through branch-and-cut", for sets that hold a
    visit; Laporte, Nobert, Desrochers (1985) for those that need vehicles.
    """
    sites, customers = problem.sites, problem.sites.customers
    out, into = numbers(data, "out", len(sites)), numbers(data, "in", len(sites))
    stated = data.get("rates", {})
    refuse_unknown_resources(stated if isinstance(stated, Mapping) else [repr(stated)], RESOURCES, str(stated))
    rates = {str(name): max(0.0, number(stated, name)) for name in stated}
    inside, of, prices = _cuts(problem, data.get("cuts", []))
    relaxed, terms = relaxed_terms(problem)
    if terms is None:
        return -math.inf
    with np.errstate(over="ignore", invalid="ignore"):
        bound = _bound(relaxed, terms, out[customers], into[customers], rates, inside, of, prices)
    return lift(bound, "min", value_grain(problem, terms)) if bound > -math.inf else -math.inf


def _cuts(problem: RoutingProblem, cuts: object) -> tuple[Flags, Integers, Floats]:
    """Which customers each set holds, shape (cuts, customers), whose visit is its right side (-1: nobody's), and its price."""
    if not isinstance(cuts, list) or not all(isinstance(cut, Mapping) for cut in cuts):
        raise InputError("evidence 'cuts' must be a list of objects", found=str(cuts)[:80])
    node = {site: k for k, site in enumerate(problem.sites.customers.tolist())}
    inside, of = np.zeros((len(cuts), len(node)), dtype=bool), np.full(len(cuts), -1, np.int64)
    prices = np.array([max(0.0, number(cut, "price")) for cut in cuts], dtype=np.float64)
    for k, cut in enumerate(cuts):
        members, visit = cut.get("sites"), cut.get("of")
        if not isinstance(members, list) or not members or not all(type(site) is int and site in node for site in members):
            raise InputError("a cut of the evidence must be around customers", found=str(members)[:80])
        if visit is not None and (type(visit) is not int or visit not in members):
            raise InputError("a cut of the evidence is for a visit outside of it", "contradiction", found=str(visit)[:80])
        inside[k, [node[site] for site in members]] = True
        of[k] = -1 if visit is None else node[visit]
    return inside, of, prices


def _bound(
    problem: RoutingProblem, terms: Terms, out: Floats, into: Floats, rates: dict[str, float], inside: Flags, of: Integers,
    prices: Floats,
) -> float:  # fmt: skip
    n = len(out)
    cost, rooms, size, most = np.full((n + 1, n + 1), math.inf), dict.fromkeys(rates, 0.0), 0.0, 0
    weights = {name: np.full((n + 1, n + 1), math.inf) for name in rates}
    for vehicle, count in alike(problem).items():
        moves, count = VehicleMoves.of(problem, vehicle, terms, np.zeros(n), {}), min(n, count)
        usable = np.isfinite(moves.cost)
        np.minimum(cost, moves.cost, out=cost)
        for name in rates:
            r = moves.resources.get(name)
            if r is None or not math.isfinite(r.upper[0]):
                return -math.inf
            np.minimum(weights[name], np.where(usable, r.weight, math.inf), out=weights[name])
            rooms[name] += count * max(0.0, float(r.upper[0]) - r.start + r.slack)
        size, most = max(size, moves.size), most + count
    usable = np.isfinite(cost)
    reduced = cost
    for name, rate in rates.items():
        part = rate * np.where(usable, weights[name], 0.0)
        reduced = reduced + part
        size += float(part.max(initial=0.0))
    reduced[1:] -= out[:, None]
    reduced[:, 1:] -= into
    # A cut is crossed by a move with one end in it: m_i + m_j - 2 m_i m_j.
    member = np.concatenate([np.zeros((len(prices), 1)), inside], axis=1)
    share = prices @ member
    reduced -= share[:, None] + share - 2.0 * (member.T * prices) @ member
    size += float(np.abs(out).max()) + float(np.abs(into).max()) + 4.0 * float(prices.sum())
    visits = out + into + 2.0 * np.bincount(of[of >= 0], prices[of >= 0], minlength=n)
    parts = [*worth_of_visits(problem, visits).tolist(), *constants(problem, terms), *(-rate * rooms[name] for name, rate in rates.items())]
    parts += (2.0 * prices * needed_routes(problem, inside) * (of < 0)).tolist()
    slip = 8.0 * EPS * (len(prices) + 8) * size
    total = float(np.abs(parts).sum())
    if not math.isfinite(64.0 * (n + 2) ** 2 * (slip + size) + total):
        return -math.inf
    reduced -= slip
    # Of i-j and j-i one at most; each of few pairs below 0 counts.
    inner = np.minimum(reduced[1:, 1:], reduced[1:, 1:].T)
    pairs = math.fsum(inner[np.triu(inner < 0.0, k=1)])
    fewest = max(problem.min_vehicles, int(needed_routes(problem, np.ones(n, dtype=bool))))
    sums = np.concatenate([[0.0], np.cumsum(np.sort(reduced[0, 1:]) + np.sort(reduced[1:, 0]))])  # k first and k last moves
    ends = float(sums[fewest : min(n, most) + 1].min(initial=math.inf))
    bound = math.fsum([*parts, pairs, ends, -16.0 * EPS * (total + abs(pairs) + (n + 1) ** 2 * size)])
    return bound if math.isfinite(bound) else -math.inf
