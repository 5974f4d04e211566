"""Statements by which a proof distinguishes cases, and the problem that is left where statements hold."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import InputError
from ...instances.printable import printable
from ..problem import Decision
from .objective import PEAKS, LatestReturn, LongestRoute, Objective, Penalties, Reward, Vehicles

if TYPE_CHECKING:
    from ...instances.routing.sites import Sites
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem

NEARLY = 1e-8
"""Part of a sum: by less a value may differ and still count as the same."""


SETS = 1 << 20
"""Moves in sets that are known again; some 50 bytes each."""


def check_statement(problem: RoutingProblem, statement: Any) -> None:
    """``{"arc": [id, id]}``: some route goes from the one site to the other without a stop between; ``{"routes": k}``: at most k routes;
    ``{"moves": {id: [id, ...], ...}}``: some route goes from one of the sites straight to one of those in its list; ``{"visited": id}``:
    the site is visited, and with ``"by": [k, ...]`` by a vehicle of one of these types, as they are numbered in the fleet; ``{"term": name,
    "at_most": x}``: the makespan, the longest route or the latest return is at most x."""
    parts = statement if isinstance(statement, Mapping) else {}
    if "visited" in parts and len(parts) == 1 + ("by" in parts):
        _check_visit(problem, parts)
        return
    if parts.keys() == {"term", "at_most"}:
        _check_peak(parts)
        return
    parts = parts if len(parts) == 1 else {}
    arc, routes, moves = parts.get("arc"), parts.get("routes"), parts.get("moves")
    if type(routes) is int and 1 <= routes <= len(problem.sites):
        return
    if moves is not None:
        moves_of(problem, moves)
        return
    index = problem.site_index
    if not isinstance(arc, list) or len(arc) != 2 or not all(isinstance(site, str) and site in index for site in arc):
        expected = '{"arc": [id, id]}, {"moves": {id: [ids]}}, {"visited": id}, {"routes": a number}, or {"term": name, "at_most": x}'
        raise InputError(
            "not a statement on moves, visits, the number of routes or the largest",
            expected=expected,
            found=printable(statement, 80),
        )


def _check_visit(problem: RoutingProblem, statement: Mapping[str, Any]) -> None:
    site, kinds, most = statement["visited"], statement.get("by", [0]), len(problem.fleet) - 1
    if not isinstance(site, str) or site not in problem.site_index or problem.sites.depot[problem.site_index[site]]:
        raise InputError("a statement on a visit names no customer", "unknown-name", found=printable(site, 80))
    known = isinstance(kinds, list) and all(type(kind) is int and 0 <= kind <= most for kind in kinds)
    if not known or not kinds or len(set(kinds)) < len(kinds):
        expected = f"different numbers from 0 to {most}, of one type at least"
        message = "a statement on a visit does not say by which types of vehicle"
        raise InputError(message, "unknown-name", expected=expected, found=printable(kinds, 80))


def _check_peak(statement: Mapping[str, Any]) -> None:
    term, most = statement["term"], statement["at_most"]
    if not isinstance(term, str) or term not in PEAKS:
        message = "a statement on the largest of all routes names no such term"
        raise InputError(message, "unknown-name", expected=", ".join(PEAKS), found=printable(term, 80))
    if type(most) not in (int, float) or not abs(most) < math.inf:
        raise InputError("a statement on the largest of all routes has no finite number", found=printable(most, 80))


def moves_of(problem: RoutingProblem, moves: Any) -> NDArray[np.int64]:
    """Positions of a statement's set of moves in a matrix of all, read row by row.

    A tree states them once and asks for them at each leaf: what was read is known again, as long as it says the same.
    """
    read: dict[int, tuple[Any, Any, NDArray[np.int64]]] = problem.__dict__.setdefault("_move_sets", {})
    known = read.get(id(moves))
    if known is not None and known[1] == moves:
        return known[2]
    found = _positions(problem, moves)
    if sum(len(at) for *_, at in list(read.values())) + len(found) > SETS:
        read.clear()
    read[id(moves)] = moves, {tail: list(heads) for tail, heads in moves.items()}, found  # what is held keeps its number
    return found


def _positions(problem: RoutingProblem, moves: Any) -> NDArray[np.int64]:
    index, width = problem.site_index, len(problem.sites)
    expected = '{"moves": {the id of a site: [the ids of others, ...], ...}}, each move once'
    if not isinstance(moves, dict) or not moves or not all(isinstance(heads, list) and heads for heads in moves.values()):
        raise InputError("a statement on a set of moves has no such set", expected=expected, found=printable(moves, 80))
    try:
        tails = np.repeat([index[tail] for tail in moves], [len(heads) for heads in moves.values()])
        heads = np.array([index[head] for ids in moves.values() for head in ids], dtype=np.int64)
    except (KeyError, TypeError) as fault:
        message = "a statement on a set of moves names a site that does not exist"
        raise InputError(message, "unknown-name", found=printable(fault, 80)) from None
    found: NDArray[np.int64] = tails * width + heads
    if len(np.unique(found)) < len(found) or (tails == heads).any():
        raise InputError("a statement on a set of moves names a move twice, or one that goes nowhere", expected=expected)
    return found


def in_words(problem: RoutingProblem, statement: Any, holds: bool) -> str:
    """A statement, or its opposite, for people."""
    if "routes" in statement:
        routes = statement["routes"] if holds else statement["routes"] + 1
        return f"there {'is' if routes == 1 else 'are'} at {'most' if holds else 'least'} {routes} route{'' if routes == 1 else 's'}"
    if "term" in statement:
        return f"the {statement['term'].replace('-', ' ')} is {'at most' if holds else 'more than'} {statement['at_most']:.10g}"
    if "visited" in statement:
        by = " or ".join(problem.fleet[kind].name for kind in statement.get("by", ()))
        return f"{statement['visited']} is {'' if holds else 'not '}visited{by and f' by {by}'}"
    if "moves" in statement:
        count = sum(map(len, statement["moves"].values()))
        if count > 1:
            return f"some route makes one of {count:,} moves" if holds else f"no route makes any of {count:,} moves"
        ((tail, (head,)),) = statement["moves"].items()
    else:
        tail, head = statement["arc"]
    return f"{'some' if holds else 'no'} route goes from {tail} straight to {head}"


def restricted(problem: RoutingProblem, decisions: Sequence[Decision]) -> RoutingProblem:
    """The same problem without moves: those that are not made, and those beside one that is, for a customer is left and entered once.

    Sets of which some move is made are kept with the problem; whoever is visited is so by one of those that come to him. Types of vehicle
    that do not visit a site lack a skill. Of each type there are as many as there are routes at most. Where the largest of all routes has a
    limit each vehicle has it; where that is exceeded the number is kept with the problem.
    """
    sites, needed = problem.sites, list(problem.needed)
    moves = np.zeros((len(sites),) * 2, dtype=bool) if problem.forbidden is None else problem.forbidden.copy()
    least, most = problem.min_vehicles, len(sites)
    fleet, exceeded = problem.fleet, dict(problem.exceeded)
    able: list[tuple[int, set[int]]] = []
    for statement, holds in decisions:
        problem.check_statement(statement)
        if "routes" in statement:
            least, most = (least, min(most, statement["routes"])) if holds else (max(least, statement["routes"] + 1), most)
            continue
        if "term" in statement:
            term, limit = statement["term"], float(statement["at_most"])
            if holds:
                fleet = _limited(problem, fleet, term, limit)
            else:
                exceeded[term] = max(limit, exceeded.get(term, limit))
            continue
        if "moves" in statement:
            among = moves_of(problem, statement["moves"])
            if holds:
                needed.append(np.zeros_like(moves))
                needed[-1].flat[among] = True
            else:
                moves.flat[among] = True
            continue
        if "visited" in statement:
            site, every = problem.site_index[statement["visited"]], set(range(len(problem.fleet)))
            by = set(statement.get("by", every))
            if holds and not sites.required[site]:
                needed.append(np.zeros_like(moves))
                needed[-1][:, site] = np.arange(len(sites)) != site
            if not holds and by == every:
                moves[site] = moves[:, site] = True
            elif by < every:
                able.append((site, by if holds else every - by))
            continue
        i, j = (problem.site_index[site] for site in statement["arc"])
        if not holds:
            moves[i, j] = True
            continue
        if any(not sites.depot[site] and not sites.required[site] for site in (i, j)):
            needed.append(np.zeros_like(moves))
            needed[-1][i, j] = True
        kept = moves[i, j]
        if not sites.depot[i]:
            moves[i] = True
        if not sites.depot[j]:
            moves[:, j] = True
        moves[i, j] = kept
    fleet = _at_most(fleet, most) if most < len(sites) else fleet
    sites, fleet = _skilled(sites, fleet, able) if able else (sites, fleet)
    return problem.altered(forbidden=moves, needed=tuple(needed), min_vehicles=least, fleet=fleet, sites=sites, exceeded=exceeded)


def _limited(problem: RoutingProblem, fleet: tuple[VehicleType, ...], term: str, most: float) -> tuple[VehicleType, ...]:
    """The vehicle types with routes of at most ``most``; a longest duration to which a risk applies is kept."""
    if term == LatestReturn.name:
        return tuple(replace(v, shift=(v.shift[0], max(v.shift[0], min(v.shift[1], most)))) for v in fleet)
    if term == LongestRoute.name:
        return tuple(replace(v, max_distance=max(0.0, min(v.max_distance, most))) for v in fleet)
    certain = [problem.team_risk is None and v.risk is None for v in fleet]
    return tuple(replace(v, max_duration=max(0.0, min(v.max_duration, most))) if c else v for v, c in zip(fleet, certain, strict=True))


def _skilled(sites: Sites, fleet: tuple[VehicleType, ...], able: Sequence[tuple[int, set[int]]]) -> tuple[Sites, tuple[VehicleType, ...]]:
    """Sites that ask for one skill more each, which the types of vehicle have that are named with them, and no others."""
    asked, has = list(sites.skills or [frozenset[str]()] * len(sites)), [v.skills for v in fleet]
    taken = frozenset[str]().union(*asked, *has)
    words = (word for k in itertools.count(1) if (word := f"statement {k}") not in taken)
    for (site, kinds), word in zip(able, words, strict=False):
        asked[site] |= {word}
        has = [skills | {word} if kind in kinds else skills for kind, skills in enumerate(has)]
    return replace(sites, skills=tuple(asked)), tuple(replace(v, skills=skills) for v, skills in zip(fleet, has, strict=True))


def later_levels(problem: RoutingProblem, values: Sequence[float]) -> RoutingProblem | None:
    """The levels after those of ``values``.

    Where a level before counts vehicles alone, there are no more of them than its value says; where it counts rewards or penalties alone,
    sites without whom its value is out of reach are required. Other levels restrict nothing, so that bounds hold for more answers than they
    need to.
    """
    levels = problem.objective.levels()
    if not 0 < len(values) < len(levels):
        return None
    fleet, sites = problem.fleet, problem.sites
    for level, value in zip(levels, values, strict=False):
        ((weight, term), *others) = level.terms
        if others or weight <= 0 or not math.isfinite(value):
            continue
        if isinstance(term, Vehicles):
            fleet = _at_most(fleet, max(1, math.floor(value / weight * (1.0 + 1e-9))))
        elif isinstance(term, Reward | Penalties):
            sites = _with_needed(sites, term, value / weight)
    return problem.altered(fleet=fleet, sites=sites, objective=Objective(levels[len(values) :]))


def _at_most(fleet: tuple[VehicleType, ...], count: int) -> tuple[VehicleType, ...]:
    return tuple(v if v.count is not None and v.count <= count else replace(v, count=count) for v in fleet)


def _with_needed(sites: Sites, term: Reward | Penalties, value: float) -> Sites:
    """``sites``, of which those are required whose loss alone is more than rewards, or penalties, of ``value`` leave.

    Members of groups are not, for a group may have another.
    """
    worth = sites.reward if isinstance(term, Reward) else np.where(sites.required, 0.0, sites.penalty)
    total = math.fsum(worth)
    sizes = math.fsum(sites.reward if isinstance(term, Reward) else sites.penalty)
    spare = (total - value if isinstance(term, Reward) else value) + NEARLY * max(sizes, abs(value))
    needed = ~sites.depot & (worth > spare)
    for group in sites.groups:
        needed[list(group.sites)] = False
    ends = [[s.pickup, s.delivery] for s in sites.shipments]  # both are visited, or none
    while any(needed[pair].any() != needed[pair].all() for pair in ends):
        for pair in ends:
            needed[pair] = needed[pair].any()
    try:
        return replace(sites, required=sites.required | needed)
    except InputError:  # no answer visits them: then more answers are looked at than there are
        return sites
