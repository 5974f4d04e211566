"""Walks of each type of vehicle by itself, and the least that visits and routes of an answer are worth at prices of rows.

docs/proofs.md#each-type-of-vehicle-apart.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...stop import current_stop
from ..problem import RoutingProblem
from .known_features import Flags, Floats, Integers, with_fleet
from .relaxation import Resource, carried_loads, customers_moves, fewest_carriers, merged_moves, smallest
from .told_visits import says_more
from .vehicle_moves import Terms, VehicleMoves, alike, worth_of_visits
from .walk_networks import FAR, Ints, Row
from .walks import Load, Multipliers, Walks


class Rows(NamedTuple):
    """Prices of visits, of sets that loads enter, of subset rows and of sets of needed moves, which are of shape (sites, sites); customers
    are nodes but in ``visits``.

    ``memory`` is who is remembered: so many of the nearest, or a list per node.
    """

    visits: Floats
    loads: Sequence[tuple[Integers, float]]
    subsets: Sequence[Row]
    memory: int | Ints
    moves: Sequence[tuple[Flags, float]] = ()


class Slot(NamedTuple):
    """The least reduced cost of a route of some type, and how many of it there are at most."""

    least: int
    most: int


@dataclass(frozen=True, eq=False)
class KindMoves:
    """Costs of a type's moves between depot and customers, its resources that limit walks, its moves in each needed set, and how many of
    it can be on a route."""

    cost: Floats
    resources: Sequence[Resource]
    needed: Sequence[Flags]
    count: int
    alone: RoutingProblem

    def walks(self, multipliers: Multipliers, room: int, work: int, finest: int = 1000) -> Walks:
        return Walks(self.cost, self.resources, multipliers, self.needed, current_stop(), room, work, finest)


@dataclass(frozen=True, eq=False)
class FleetMoves:
    """Moves of all types of vehicle on a problem without stops, who is visited in each answer and in none, and how many routes there are.

    There are ``sets`` of needed moves; no cost of a move is a sum of more than ``size``.
    """

    problem: RoutingProblem
    kinds: Sequence[KindMoves]
    surely: Flags
    never: Flags
    fewest: int
    most: int
    sets: int
    size: float

    @classmethod
    def of(cls, problem: RoutingProblem, terms: Terms, surely: Flags, never: Flags) -> "FleetMoves | None":
        """None where there is no answer; raises OverflowError where costs are too large to be added up."""
        n, kinds, size = len(surely), list[KindMoves](), 0.0
        sets = smallest([moves for moves in customers_moves(problem) if says_more(problem, moves, surely)])
        reached, inner = np.zeros(n, dtype=bool), np.zeros((n, n), dtype=bool)
        for vehicle, count in alike(problem).items():
            alone = with_fleet(problem, (vehicle,))
            moves = VehicleMoves.of(problem, vehicle, terms, np.zeros(n), {})
            size = max(size, moves.size)
            if not math.isfinite(64.0 * (n + 2) ** 2 * moves.size):
                raise OverflowError
            usable = np.isfinite(moves.cost)
            usable[1:] &= ~never[:, None]
            usable[:, 1:] &= ~never
            reached, inner = reached | (usable[:, 1:].any(axis=0) & usable[1:].any(axis=1)), inner | usable[1:, 1:]
            if usable[0].any() and usable[:, 0].any():
                limits, needed = (
                    limiting(alone, moves.resources, usable),
                    [merged_moves(alone, through) & usable for through in sets],
                )
                kinds.append(KindMoves(np.where(usable, moves.cost, math.inf), limits, needed, min(n, count), alone))
        never = never | ~reached
        node = {site: k for k, site in enumerate(problem.sites.customers.tolist())}
        asked = [[node[site] for site in group.sites] for group in problem.sites.groups if group.required]
        if (surely & never).any() or any(never[members].all() for members in asked):
            return None
        fewest = max(problem.min_vehicles, int(bool(asked or customers_moves(problem))))
        fewest = max(fewest, *(int((surely & ~inner.any(axis=axis)).sum()) for axis in (0, 1)))
        if surely.any():
            fewest = max(fewest, *fewest_carriers(problem, [np.flatnonzero(surely) + 1]))
        most = min(n, sum(kind.count for kind in kinds))
        if fewest > most or not all(any(kind.needed[k].any() for kind in kinds) for k in range(len(sets))):
            return None
        return cls(problem, kinds, surely, never, fewest, most, len(sets), size)

    def least(self, rows: Rows, claimed: Sequence[float | None], room: int, work: int) -> float:
        """The least that visits and routes are worth, each set of needed moves by itself; infinite where there is no answer, and minus
        infinity where walks are not all gone through within ``room`` and ``work``, or in time. Two numbers are claimed, of the least walks
        and of those with a needed move.

        Raises OverflowError where numbers are too large to be added up.
        """
        visited = [nodes[self.surely[nodes - 1]] for nodes, _ in rows.loads]
        carriers = fewest_carriers(self.problem, visited)
        loads = [Load(s, k * bool(len(v)), p) for (s, p), v, k in zip(rows.loads, visited, carriers, strict=True)]
        made = []
        for kind in self.kinds:
            listed = remembered(self.problem, np.isfinite(kind.cost), rows.memory)
            moves = [(merged_moves(kind.alone, among), price) for among, price in rows.moves]
            made.append(kind.walks(Multipliers(rows.visits, loads, rows.subsets, listed, moves), room, work))
        if not made:
            return 0.0
        exponent = min(walks.exponent for walks in made)  # one for all, so that prices are rounded once
        made = [
            walks if walks.exponent == exponent else k.walks(walks.multipliers, room, work, exponent)
            for k, walks in zip(self.kinds, made, strict=True)
        ]
        slots, budget = [], Budget(work)
        for kind, walks in zip(self.kinds, made, strict=True):
            least = budget.least(walks, None, claimed[0])
            if least is None:
                return -math.inf
            slots.append(Slot(least, kind.count * (least < FAR)))
        bounds = [cheapest(slots, self.fewest, self.most)]
        for k in range(self.sets):
            totals = []
            for at, (kind, walks, slot) in enumerate(zip(self.kinds, made, slots, strict=True)):
                through = budget.least(walks, k, claimed[1]) if slot.most and kind.needed[k].any() else FAR
                others = [*slots[:at], Slot(slot.least, slot.most - 1), *slots[at + 1 :]]
                rest = cheapest(others, max(0, self.fewest - 1), self.most - 1) if through != FAR else None
                if rest is not None:
                    totals.append(rest + max(slot.least, slot.least if through is None else through))
            bounds.append(min(totals, default=None))
        known = [bound for bound in bounds if bound is not None]
        if len(known) < len(bounds):
            return math.inf
        visits = made[0].visits
        worth = worth_of_visits(self.problem, visits.astype(np.float64), self.surely, self.never)
        constant = made[0].constant - sum(visits.tolist()) + sum(map(int, worth.tolist()))
        return math.ldexp(constant + max(known), -exponent)


@dataclass
class Budget:
    """Moves and comparisons that are left for several walks."""

    work: int

    def least(self, walks: Walks, which: int | None, claimed: float | None) -> int | None:
        walks.work = min(walks.work, self.work)
        found = walks.least(which, claimed)
        self.work = walks.work
        return found


def cheapest(slots: Sequence[Slot], fewest: int, most: int) -> int | None:
    """The least sum of the costs of that many routes; None where there are fewer."""
    total, used = 0, 0
    for least, count in sorted(slots):
        taken = min(count, most - used if least < 0 else max(0, fewest - used))
        total, used = total + taken * least, used + taken
    return total if used >= fewest else None


def limiting(problem: RoutingProblem, resources: Mapping[str, Resource], usable: Flags) -> list[Resource]:
    """Resources that limit walks over ``usable`` moves; at least one, for the length of a walk is limited all the same."""
    ends = [v.end for v in problem.fleet]
    timed = any(v.energy is not None and v.energy.charge == "elapsed-fixed-start" for v in problem.fleet)
    timed = timed or bool(np.isfinite(problem.sites.due[[*problem.sites.customers, *ends]]).any())
    timed = timed or any(math.isfinite(v.shift[1]) for v in problem.fleet)
    limits = [r for name, r in resources.items() if name not in ("order", "load") and (name != "time" or timed)]
    return [*limits, *carried_loads(problem, usable)] or [resources["time"]]


def remembered(problem: RoutingProblem, usable: Flags, memory: int | Ints) -> Ints:
    """The customers that a walk remembers at each node, none at the depot; if ``memory`` is a number, that many of the nearest that can be
    its neighbours on a route."""
    if not isinstance(memory, int):
        return memory
    at = problem.sites.customers
    far, beside = problem.travel.distances[np.ix_(at, at)], usable[1:, 1:] | usable[1:, 1:].T
    far = np.where(beside, np.minimum(far, far.T), math.inf)
    np.fill_diagonal(far, -math.inf)
    near = np.argsort(far, axis=1, kind="stable")[:, 1 : memory + 1] + 1
    return np.vstack([np.full((1, near.shape[1]), -1), near]).astype(np.int32)
