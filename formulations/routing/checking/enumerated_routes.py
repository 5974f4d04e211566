"""Evidence ``enumerated-routes``: all routes that an answer below some value can have, and a tree of cases over them.

At any prices of ``set-partitioning-duals`` an answer with a route of large reduced cost is worth much. What is left are few sets of
customers, each with the cheapest route through it, which are listed here by labels. Choosing among them is a program of its own: at each
node of a tree prices bound it, and leave out further routes; branchings are on two customers being on one route (Ryan, Foster 1981).
docs/proofs.md#all-routes-below-a-reduced-cost.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.printable import printable
from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import lift
from ...stop import current_stop
from ..problem import RoutingProblem
from .known_features import Flags, Floats, Integers, routing_evidence
from .set_partitioning_duals import CUSTOMERS, Merged, customers_of, entering, entries, given_rows, merged_walks, signed
from .walk_networks import BITS, DONE, FAR
from .walks import Walks

LABELS = 300_000
"""At a time at most, of as many visits each; some 200 bytes each where rows and loads are few."""

FEW_WORDS = 4
"""Words of bits of a label beyond which there are fewer labels, in proportion."""

ROUTES = 200_000
"""Sets of customers at most."""

WORK = 2_000_000_000
"""Moves and comparisons of labels at most, and then members of rows in all sets: some 20 s."""

BIT = 60
"""No sum of prices has more bits."""

_KEYS = frozenset({"branch", "visits", "rows", "loads"})


@routing_evidence("enumerated-routes", "enumerated-routes are")
def check_enumerated_routes(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on total cost, the number of vehicles, or a weighted sum of them, by a tree over all routes that a better answer can have.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``goal``: a value, at most which is proved. ``prices``: as in ``set-partitioning-duals``, without ``apart``, ``ray`` and ``needed``;
        rows are remembered everywhere here, and of a load a route has what it is worth once. ``nodes``: a list of objects, each node before
        its subtrees; all keys are optional. ``visits``: one price a site. ``rows``: each with its ``sites``, ``weights``, whole numbers of
        1 or more (1 each if absent), ``parts``, a whole number of 2 or more (2 if absent), and its ``price``, 0 or less: how often routes
        have ``parts`` of the weights of those whom they visit, rounded down. ``loads``: each with its ``sites`` and its ``price``, 0 or
        more. ``branch``: two customers; the subtree of the answers in which one route visits both follows, then that of the others. A
        node without prices is bounded by what stands above it.

    Returns
    -------
    float
        Minus infinity where routes exceed their limits, infinity where no answer is left.

    Raises
    ------
    InputError
        If anything is malformed.

    Notes
    -----
    Source: Baldacci, Christofides, Mingozzi (2008) for all routes below a reduced cost; Ryan, Foster (1981) for branchings; Chvátal
    (1973) for rows of any weights, as in Pecin, Pessoa, Poggi, Uchoa (2017); docs/proofs.md#all-routes-below-a-reduced-cost.
    """
    goal, prices, nodes = number(data, "goal"), data.get("prices"), data.get("nodes")
    if not isinstance(prices, Mapping) or prices.keys() & {"apart", "ray", "needed"}:
        raise InputError("evidence 'prices' must be an object without apart, ray and needed", found=printable(prices, 80))
    if not isinstance(nodes, list) or not all(isinstance(node, Mapping) and _KEYS.issuperset(node) for node in nodes):
        expected = f"objects with keys of {', '.join(sorted(_KEYS))}"
        raise InputError("evidence 'nodes' must be a list of objects", expected=expected, found=printable(nodes, 80))
    visits, given, cases = numbers(prices, "visits", len(problem.sites)), given_rows(problem, prices), _cases(problem, nodes)
    claimed = number(prices, "least") if "least" in prices else None
    if len(problem.sites.customers) > CUSTOMERS:
        return -math.inf
    try:
        finest = min(BIT - math.frexp(size)[1] for size in (goal, *(case.size for case in cases)))
        merged = merged_walks(problem, visits, given, finest=finest)
        if isinstance(merged, float):
            return merged
        proved = _proved(merged, claimed, goal, cases)
    except OverflowError:
        return -math.inf
    if not abs(proved) < math.inf:
        return proved
    return lift(proved - merged.error(proved), "min", merged.relaxed.grain)


def _proved(merged: Merged, claimed: float | None, goal: float, cases: "Sequence[_Case]") -> float:
    """The bound in exact arithmetic."""
    walks, relaxed = merged.walks, merged.relaxed
    least = walks.least(None, claimed)
    if least is None or least == FAR:
        return -math.inf if least is None else math.inf
    wanted = math.ceil(math.ldexp(goal, walks.exponent))
    some = Choice(relaxed.fewest, relaxed.most, wanted)
    limit = some.limit(walks.constant, least)
    if not -FAR < limit < FAR:
        return -math.inf
    found = listed_routes(walks, limit)
    if found is None:
        return -math.inf
    bound = _over_cases(cases, some, some.bound(walks.constant, least), walks.exponent, *found)
    return math.ldexp(bound, -walks.exponent)


@dataclass(frozen=True)
class Choice:
    """How many routes an answer has, and the value below which answers are looked for."""

    fewest: int
    most: int
    goal: int

    def bound(self, constant: int, least: int) -> int:
        """Lower bound on answers all of whose routes have reduced costs of at least ``least``."""
        return constant + min(self.fewest * least, self.most * least)

    def limit(self, constant: int, least: int) -> int:
        """The reduced cost from which on a route is in no answer below the goal."""
        return self.goal - constant - min((self.fewest - 1) * least, (self.most - 1) * least)


def listed_routes(walks: Walks, limit: int) -> tuple[Flags, Integers] | None:
    """All sets of customers with a route of reduced cost below ``limit``, shape (customers, sets), and the least that its moves cost; None
    where they are too many."""
    from .cheap_route_kernels import cheap_routes

    network, rest = walks.bounded(limit)
    tails = np.repeat(np.arange(len(network.first) - 1), np.diff(network.first))
    paid = np.floor(np.ldexp(walks.cost[tails, network.moves[:, 0]], walks.exponent)).astype(np.int64)
    nodes = len(walks.usable)
    worth = np.append(0, walks.visits)
    loads = [(load.sites, load.price) for load in walks.multipliers.loads]
    gains = np.array([int(np.rint(np.ldexp(price, walks.exponent))) for _, price in loads], dtype=np.int64)
    inside = _bits([row.sites for row, _ in walks.rows], nodes)
    fines = np.array([price for _, price in walks.rows], dtype=np.int64)
    among = _bits([sites for sites, _ in loads], nodes)
    keys = np.random.default_rng(0).integers(1 << 62, size=nodes)
    words = inside.shape[1] + among.shape[1]
    room = LABELS * FEW_WORDS // max(FEW_WORDS, words)
    status, number, sets, least = cheap_routes(
        walks.stop.flag, network, rest, paid, worth, inside, fines, among, gains, keys, limit, room, ROUTES, WORK
    )
    if status != DONE:
        return None
    customers = np.arange(1, nodes)
    return (sets[:number, customers // BITS] >> (customers % BITS) & 1).T.astype(bool), least[:number].copy()


def _bits(members: Sequence[Integers], nodes: int) -> Integers:
    """The sets that each node belongs to, as bits; shape (nodes, words)."""
    bits = np.zeros((nodes, -(-len(members) // BITS)), np.int64)
    for k, nodes_of in enumerate(members):
        bits[nodes_of, k // BITS] |= np.int64(1) << (k % BITS)
    return bits


def _over_cases(cases: "Sequence[_Case]", some: Choice, above: int, exponent: int, sets: Flags, cost: Integers) -> int:
    """The worst, over the leaves of a tree, of the best bound at each or above it, or the goal where no route is left; the least at any
    node is ``above``."""
    waiting, found, work = [(np.arange(len(cost)), above)], some.goal, WORK
    for case in cases:
        current_stop().check()
        at, bound = waiting.pop()
        if case.priced and len(at):
            work -= len(at) * case.members
            if work < 0:
                return above
            constant, reduced = case.reduced(sets, cost, at, exponent)
            least = int(reduced.min())
            bound = max(bound, some.bound(constant, least))
            at = at[reduced < some.limit(constant, least)]
        if case.pair is None:
            found = min(found, bound if len(at) else some.goal)
        else:
            work -= len(at)
            if work < 0:
                return above
            one, other = (sets[customer, at] for customer in case.pair)
            waiting += [(at[~(one & other)], bound), (at[one == other], bound)]
    return found


@dataclass(frozen=True, eq=False)
class _Case:
    """Prices at a node of a tree: of visits, shape (customers,), of rows with weights and parts, and of loads with the fewest routes; then
    the customers of each, and the pair that is branched on. Customers are positions."""

    visits: Floats
    rows: Sequence[tuple[float, Integers, int, Integers]]
    loads: Sequence[tuple[float, int, Integers]]
    pair: tuple[int, int] | None
    priced: bool

    @property
    def size(self) -> float:
        """No sum of prices is larger."""
        rows = (abs(price) * (int(weights.sum()) // parts) for price, weights, parts, _ in self.rows)
        return math.fsum([*np.abs(self.visits).tolist(), *rows, *(price * fewest for price, fewest, _ in self.loads)])

    @property
    def members(self) -> int:
        return 1 + len(self.visits) // 8 + sum(len(row[3]) for row in self.rows) + sum(len(load[2]) for load in self.loads)

    def reduced(self, sets: Flags, cost: Integers, at: Integers, exponent: int) -> tuple[int, Integers]:
        """The sum of all prices, and reduced costs of some routes, by their positions: prices are rounded, for any are valid."""

        def whole(price: float) -> int:
            return round(math.ldexp(price, exponent))

        prices = [whole(price) for price in self.visits.tolist()]
        constant, reduced = sum(prices), cost[at].copy()
        for price, having in zip(prices, sets, strict=True):
            if price:
                reduced[having[at]] -= price
        for of_row, weights, parts, members in self.rows:
            reduced -= whole(of_row) * (weights @ sets[members[:, None], at].astype(np.int64) // parts)
            constant += whole(of_row) * (int(weights.sum()) // parts)
        for of_load, fewest, members in self.loads:
            reduced[sets[members[:, None], at].any(axis=0)] -= whole(of_load)
            constant += whole(of_load) * fewest
        return constant, reduced


def _cases(problem: RoutingProblem, nodes: Sequence[Mapping[str, Any]]) -> list[_Case]:
    """The nodes of a tree, read, each before its subtrees."""
    node = {site: k for k, site in enumerate(problem.sites.customers.tolist(), start=1)}
    index = [node.get(site, 0) for site in range(len(problem.sites))]
    read, missing = list[_Case](), 1
    for entry in nodes:
        if not missing:
            raise InputError("the tree over routes has more nodes than its branchings lead to", "wrong-shape", found=f"{len(nodes)} nodes")
        pair = customers_of(entry["branch"], index, "a branching over routes") if "branch" in entry else None
        if pair is not None and len(pair) != 2:
            raise InputError("a branching over routes is on two customers", "wrong-shape", found=printable(entry["branch"], 80))
        missing += -1 if pair is None else 1
        visits = numbers(entry, "visits", len(problem.sites))[problem.sites.customers] if "visits" in entry else np.zeros(len(node))
        groups = [
            (np.array(customers_of(load["sites"], index, "the sites of a load"), dtype=np.int64), signed(load, 1.0))
            for load in entries(entry, "loads", {"sites", "price"})
        ]
        if not all(len(members) for members, _ in groups):
            raise InputError("a load over routes has no sites", "missing")
        fewest = entering(problem, groups)
        loads = [(price, routes, members - 1) for (members, price), routes in zip(groups, fewest, strict=True)]
        rows = [_row(row, index) for row in entries(entry, "rows", {"sites", "price"}, {"weights", "parts"})]
        read.append(_Case(visits, rows, loads, None if pair is None else (pair[0] - 1, pair[1] - 1), bool(entry.keys() - {"branch"})))
    if missing:
        raise InputError("the tree over routes lacks nodes", "missing", expected=f"{missing} subtrees more")
    return read


def _row(row: Mapping[str, Any], index: list[int]) -> tuple[float, Integers, int, Integers]:
    sites = customers_of(row["sites"], index, "the sites of a row")
    weights, parts = row.get("weights", [1] * len(sites)), row.get("parts", 2)
    right = isinstance(weights, list) and len(weights) == len(sites) and all(type(w) is int and 1 <= w < 1000 for w in weights)
    if not right or type(parts) is not int or not 2 <= parts < 1000:
        message = "a row over routes has a weight a site, and parts of 2 or more, all whole and below 1000"
        raise InputError(message, "out-of-range", found=printable(row, 80))
    return signed(row, -1.0), np.array(weights, dtype=np.int64), parts, np.array(sites, dtype=np.int64) - 1
