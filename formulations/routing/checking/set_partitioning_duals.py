"""Evidence ``set-partitioning-duals``: a Lagrangian bound from one price per customer, over the cheapest route at these prices.

Further rows may have prices too: those of subsets of customers, and of the vehicles that a set of customers needs. Routes are relaxed to
walks that may come back to a customer whom they forgot: at each customer some others are remembered, all others are forgotten there
(ng-routes). The least reduced cost of all such walks whose levels keep every limit is found here by labels: of all vehicles together, or
of each type apart, where sites may be left out too. The bounds are derived in docs/proofs.md#routes.
"""

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.printable import printable
from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import Grain, lift
from ...stop import current_stop
from ..problem import RoutingProblem
from ..statements import moves_of
from .fleet_walks import FleetMoves, Rows, limiting, remembered
from .known_features import EPS, Flags, Floats, Integers, routing_evidence, without_stops
from .one_route import beyond_one_route
from .relaxation import Relaxation, customers_moves, fewest_carriers, merged_moves, needed_moves, relax
from .told_visits import told_visits
from .vehicle_moves import Terms, constants, relaxed_terms, value_grain
from .walk_networks import FAR, Row
from .walks import Load, Multipliers, Walks

CUSTOMERS = 1_000
"""More are not looked at: nothing is proved."""

LABELS = 4_000_000
"""At a time at most; some 100 bytes each."""

WORK = 4_000_000_000
"""Moves and comparisons in one proof at most, some 20 s."""

ROWS = 4_000
"""Rows of each kind at most; more are refused."""


@routing_evidence("set-partitioning-duals", "set-partitioning-duals are")
def check_set_partitioning_duals(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on total cost, the number of vehicles, or a weighted sum of them, by any prices of visits (weak duality).

    With ``apart`` durations, rewards and penalties may be in the sum; prices, costs and claims are those of a minimisation.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``visits``: one number a site (entries of depots are ignored). ``memory``: how many of the nearest customers are remembered at each
        one, of those next to whom he can be visited; or, in its place, ``remembered``: one list a site of the indices of sites that are
        remembered there, an empty one for a depot; a customer always remembers himself. All else is optional. ``apart``: true for walks
        of each type of vehicle by itself; then sites may be left out. ``ray``: true for prices alone, as if no arc cost anything and no
        visit were worth anything. ``rows``: subset rows of multiplier 1/2, each with the indices of its ``sites``, an odd number
        of customers, its ``memory``, customers with those among them, and its ``price``, 0 or less. ``loads``: sets of customers that as
        many moves enter at least as vehicles are needed to carry the demands of those who are visited in each answer, and two where no
        route serves a few of them in time (not with ``apart``), each with its ``sites`` and its ``price``, 0 or more. ``needed``: sets of
        ``moves``, as statements name them, that hold all of a set of which some move is needed, each with its ``price``, 0 or more.
        ``least`` and ``least_needed``: numbers below which no walk, and none that makes a needed move, is said to cost; of walks that cost
        as much only that is looked at.

    Returns
    -------
    float
        Minus infinity where labels exceed their limits, infinity where no answer is left.

    Raises
    ------
    InputError
        If anything is malformed.

    Notes
    -----
    Source: Desrochers, Desrosiers, Solomon (1992) for the relaxation and its bound; Baldacci, Mingozzi, Roberti (2011) for ng-routes;
    Feillet, Dejax, Gendreau, Gueguen (2004) for customers out of reach; Jepsen, Petersen, Spoorendonk, Pisinger (2008) for subset rows,
    and Pecin, Pessoa, Poggi, Uchoa (2017) for their memories; docs/proofs.md#routes.
    """
    prices, ray, apart = numbers(data, "visits", len(problem.sites)), _flag(data, "ray"), _flag(data, "apart")
    given = given_rows(problem, data)
    claimed = [number(data, key) if key in data else None for key in ("least", "least_needed")]
    if len(problem.sites.customers) > CUSTOMERS:
        return -math.inf
    try:
        found = _apart(problem, prices, given, claimed, ray=ray) if apart else _together(problem, prices, given, claimed, ray=ray)
    except OverflowError:
        return -math.inf
    if not math.isfinite(found.bound):
        return found.bound
    if ray:
        return math.inf if found.bound > 0 else -math.inf
    return lift(found.bound - found.error, "min", found.grain) if math.isfinite(found.error) else -math.inf


class _Found(NamedTuple):
    """A bound in exact arithmetic, the rounding of what the judge adds up, and the number of which every value is a multiple."""

    bound: float
    error: float = 0.0
    grain: Grain | None = None


NOTHING, NO_ANSWER = _Found(-math.inf), _Found(math.inf)


def _together(problem: RoutingProblem, prices: Floats, given: "Given", claimed: Sequence[float | None], *, ray: bool) -> _Found:
    """The bound by walks of all types of vehicle merged into one."""
    merged = merged_walks(problem, prices, given, ray=ray)
    if isinstance(merged, float):
        return NOTHING if merged < 0.0 else NO_ANSWER
    bound = _whole_bound(merged.walks, merged.relaxed, *claimed)
    return _Found(bound, merged.error(bound), merged.relaxed.grain)


@dataclass(frozen=True, eq=False)
class Merged:
    """Walks of all types of vehicle merged into one, and the relaxation that they are of."""

    walks: Walks
    relaxed: Relaxation

    def error(self, bound: float) -> float:
        """The most by which a bound in exact arithmetic exceeds the sum in floating point by which answers are judged."""
        # The routes of an answer have fewer than 2 nodes moves. Each is added up from its first on: no sum is larger than nodes sizes.
        size, nodes = float(np.abs(self.walks.cost[self.walks.usable]).max()), len(self.walks.cost)
        return 8.0 * EPS * (2 * nodes * nodes * size + abs(bound))


def merged_walks(problem: RoutingProblem, prices: Floats, given: "Given", *, ray: bool = False, finest: int = 1000) -> Merged | float:
    """The walks at some prices, in multiples of ``2^-finest`` or larger ones; infinity where there is no answer, minus infinity where
    nothing is known of the problem.

    Raises OverflowError if numbers are too large to be added up.
    """
    relaxed = relax(problem)
    if relaxed is None:
        return -math.inf
    usable = np.isfinite(relaxed.cost)
    if relaxed.fewest > relaxed.most or not usable[1:].any(axis=1).all() or not usable[:, 1:].any(axis=0).all():
        return math.inf
    needed = [moves & usable for moves in needed_moves(problem)]
    if not all(moves.any() for moves in needed):
        return math.inf
    near = remembered(problem, usable, given.memory)
    loads = [Load(sites, routes, price) for (sites, price), routes in zip(given.loads, entering(problem, given.loads), strict=True)]
    priced = [(merged_moves(problem, among) & usable, price) for among, price in given.moves]
    # Once a set has a price, the least walk through it seldom proves more.
    needed = [moves for moves in needed if not any(price and (among | ~moves).all() for among, price in priced)]
    multipliers = Multipliers(prices[relaxed.customers], loads, given.rows, near, priced)
    cost = np.where(usable, 0.0, math.inf) if ray else relaxed.cost
    walks = Walks(cost, limiting(problem, relaxed.resources, usable), multipliers, needed, current_stop(), LABELS, WORK, finest)
    return Merged(walks, relaxed)


def entering(problem: RoutingProblem, loads: Sequence[tuple[Integers, float]]) -> list[int]:
    """The fewest routes that visit all of each set of customers, given with its price, because of loads or of windows."""
    groups = [sites for sites, _ in loads]
    carriers = fewest_carriers(problem, groups)
    open_sets = [sites if least == 1 and price else sites[:0] for (sites, price), least in zip(loads, carriers, strict=True)]
    late = beyond_one_route(problem, open_sets)
    return [routes + int(more) for routes, more in zip(carriers, late.tolist(), strict=True)]


def _apart(problem: RoutingProblem, prices: Floats, given: "Given", claimed: Sequence[float | None], *, ray: bool) -> _Found:
    """The bound by walks of each type of vehicle by itself."""
    relaxed, terms = relaxed_terms(problem)
    if terms is None or (terms.peaks and not ray):
        return NOTHING
    terms = Terms(0.0, 0.0, 0.0, 0.0, 0.0, {}) if ray else terms
    with np.errstate(over="ignore", invalid="ignore"):
        fleet, parts = FleetMoves.of(relaxed, terms, *told_visits(problem)), constants(relaxed, terms)
    if fleet is None:
        return NO_ANSWER
    rows = Rows(prices[problem.sites.customers], given.loads, given.rows, given.memory, given.moves)
    least = fleet.least(rows, claimed, LABELS, WORK)
    # Each route is added up from its first move on, so that no sum is larger than nodes sizes; there are n routes at most.
    sizes = (len(rows.visits) + 2) ** 2 * fleet.size + sum(map(abs, parts)) + abs(least)
    return _Found(math.fsum([least, *parts]) if math.isfinite(sizes) else least, 16.0 * EPS * sizes, value_grain(problem, terms))


def _whole_bound(walks: Walks, relaxed: Relaxation, claimed: float | None, claimed_needed: float | None) -> float:
    """The bound that the least walks prove, each set of needed moves by itself."""
    least = walks.least(None, claimed)
    if least is None or least == FAR:
        return -math.inf if least is None else math.inf
    bound = min(relaxed.fewest * least, relaxed.most * least)
    for which in range(len(walks.needed)):
        through = walks.least(which, claimed_needed)
        if through == FAR:
            return math.inf
        if through is not None:
            others = min((relaxed.fewest - 1) * least, (relaxed.most - 1) * least)
            bound = max(bound, max(through, least) + others)
    return math.ldexp(walks.constant + bound, -walks.exponent)


# -- reading -----------------------------------------------------------------------------------------------------------------------------


class Given(NamedTuple):
    """Evidence beside prices of visits; customers are nodes, ``memory`` is a number of the nearest, or a list a node, and ``moves`` are of
    shape (sites, sites)."""

    memory: int | NDArray[np.int32]
    rows: list[Row]
    loads: list[tuple[Integers, float]]
    moves: list[tuple[Flags, float]]


def _flag(data: Mapping[str, Any], key: str) -> bool:
    value = data.get(key, False)
    if not isinstance(value, bool):
        raise InputError(f"evidence {key!r} must be true or false", found=printable(value, 80))
    return value


def given_rows(problem: RoutingProblem, data: Mapping[str, Any]) -> Given:
    """Evidence beside prices of visits, read."""
    node = np.zeros(len(problem.sites), dtype=np.int64)
    node[problem.sites.customers] = np.arange(1, len(problem.sites.customers) + 1)
    nodes = node.tolist()
    rows = []
    for entry in entries(data, "rows", {"sites", "memory", "price"}):
        sites, memory = (
            customers_of(entry["sites"], nodes, "the sites of a row"),
            customers_of(entry["memory"], nodes, "the memory of a row"),
        )
        if len(sites) < 3 or len(sites) % 2 == 0:
            raise InputError("a row of evidence has an odd number of sites", "out-of-range", expected="3 or more", found=str(len(sites)))
        if not set(sites) <= set(memory):
            raise InputError("the memory of a row of evidence lacks a site of the row", "missing")
        rows.append(Row(np.array(sites), np.array(memory), signed(entry, -1.0)))
    loads = []
    for entry in entries(data, "loads", {"sites", "price"}):
        sites = customers_of(entry["sites"], nodes, "the sites of a load")
        if not sites:
            raise InputError("a load of evidence has no sites", "missing")
        loads.append((np.array(sites), signed(entry, 1.0)))
    moves, known = [], customers_moves(without_stops(problem))
    for entry in entries(data, "needed", {"moves", "price"}):
        among = np.zeros((len(nodes),) * 2, dtype=bool)
        among.flat[moves_of(problem, entry["moves"])] = True
        if not any((among | ~of).all() for of in known):
            raise InputError("evidence has a price for moves none of which is needed", "contradiction", found=printable(entry, 80))
        moves.append((among, signed(entry, 1.0)))
    return Given(_memory(data, nodes), rows, loads, moves)


def _memory(data: Mapping[str, Any], nodes: list[int]) -> int | NDArray[np.int32]:
    memory, lists = data.get("memory"), data.get("remembered")
    if lists is None:
        if type(memory) is not int or memory < 0:
            raise InputError("evidence 'memory' must be a whole number", "out-of-range", expected="0 or more", found=printable(memory, 80))
        return min(memory, len(nodes))
    if memory is not None or not isinstance(lists, list) or len(lists) != len(nodes):
        expected = f"{len(nodes)} lists, and no 'memory'"
        raise InputError("evidence 'remembered' must be one list a site", "wrong-shape", expected=expected, found=printable(lists, 80))
    read = [customers_of(sites, nodes, "the sites that are remembered") for sites in lists]
    if any(sites and not nodes[k] for k, sites in enumerate(read)):
        raise InputError("evidence 'remembered' lists sites at a depot, where nobody is remembered", "out-of-range")
    kept = [[other for other in sites if other != nodes[k]] for k, sites in enumerate(read)]
    table = np.full((1 + max(nodes), max(map(len, kept), default=0)), -1, np.int32)
    for k, sites in enumerate(kept):
        table[nodes[k], : len(sites)] = sites
    return table


def entries(data: Mapping[str, Any], key: str, keys: Set[str], optional: Set[str] = frozenset()) -> Sequence[Mapping[str, Any]]:
    """Objects of a list in evidence, which have all of some keys, and no others but some that they need not have."""
    values = data.get(key, [])
    right = isinstance(values, list) and all(isinstance(entry, Mapping) and keys <= entry.keys() <= keys | optional for entry in values)
    if not right:
        expected = f"a list of objects with {', '.join(sorted(keys))}"
        raise InputError(f"evidence {key!r} is malformed", expected=expected, found=printable(values, 80))
    if len(values) > ROWS:
        raise InputError(f"evidence has too many {key}", "too-large", expected=f"at most {ROWS:,}", found=f"{len(values):,}")
    return list(values)


def customers_of(sites: Any, nodes: list[int], what: str) -> list[int]:
    """Customers of a list of indices of sites, as nodes."""
    if not isinstance(sites, list) or not set(map(type, sites)) <= {int}:
        raise InputError(f"{what} in evidence must be a list of indices", found=printable(sites, 80))
    if not all(0 <= site < len(nodes) and nodes[site] for site in sites) or len(set(sites)) < len(sites):
        message = f"{what} in evidence are not all different customers"
        raise InputError(message, "unknown-name", expected=f"indices from 0 to {len(nodes) - 1}, no depots", found=printable(sites, 80))
    return [nodes[site] for site in sites]


def signed(entry: Mapping[str, Any], sign: float) -> float:
    """The price of an entry, which is 0 or has a sign."""
    price = number(entry, "price")
    if sign * price < 0.0:
        expected = "0 or more" if sign > 0.0 else "0 or less"
        raise InputError("evidence 'price' has the wrong sign", "out-of-range", expected=expected, found=f"{price:g}")
    return price
