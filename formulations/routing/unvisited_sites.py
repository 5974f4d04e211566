"""Why an answer leaves sites out.

That no vehicle can serve a site, whatever else it does, is proved from the data (``reachability``, confirmed by ``checking``). All else
is said of this answer: what each place for the site in its routes, as they are, would break or change.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..evidence import LeftOut
from ..tolerance import EQUAL
from .insertion import LIMITS, Insertions, Places, is_plain, judged, orders
from .objective import Penalties, Reward
from .reachability import unreachable
from .routes import Floats, Integers, Route, Routes
from .schedule import opening, schedule

if TYPE_CHECKING:
    from .problem import RoutingProblem


MOST_JUDGED = 20_000
"""Routes that are judged one by one; sites for which more would be are only said to be left out."""

MOST_TOGETHER = 4
"""Sites that shipments bind to each other up to which their places are looked at."""

STRIP = 1 << 19
"""Places that are looked at at once."""

UNEXPLAINED = "optional, and left out of this answer"

WORDS = {
    "skills": "lacks a skill that it asks for",
    "moves": "needs a forbidden move",
    "load": "exceeds the capacity",
    "time-windows": "comes too late for a window or the return",
    "closing-moves": "comes too late for a closing move",
    "distance": "exceeds the longest distance",
    "duration": "exceeds the longest duration",
    "energy": "exceeds the energy store",
    "route-risk": "overruns a limit with too great a probability",
}


def left_out(problem: RoutingProblem, answer: Routes) -> tuple[LeftOut, ...]:
    """The customers that ``answer`` does not visit, in site order, each with the reason.

    Wordings and what they claim: docs/formulations/routing.md#sites-left-out.
    """
    visited = {site for route in answer for site in route.visits}
    unvisited = [site for site in problem.customers.tolist() if site not in visited]
    if not unvisited:
        return ()
    ids, groups = problem.sites.ids, {site: group.sites for group in problem.sites.groups for site in group.sites}
    reasons = dict.fromkeys(unvisited, UNEXPLAINED)
    beyond = {site: f"no vehicle can serve it: {why}" for site, why in unreachable(problem).items() if site in reasons}
    chosen = {site: next((k for k in groups.get(site, ()) if k in visited), None) for site in unvisited}
    reasons |= {site: f"its alternative {ids[k]} is visited" for site, k in chosen.items() if k is not None}
    reasons |= beyond
    open_sites = [site for site in unvisited if reasons[site] == UNEXPLAINED]
    wrong = {violation.check for violation in problem.evaluate(answer).violations}
    if open_sites and wrong <= {"visits", "groups"} and "team-risk" not in problem.features():  # which places alone do not tell
        reasons |= dict(_Answer(problem, answer).reasons(open_sites))
    for site in unvisited:
        if problem.sites.required[site] and reasons[site] == UNEXPLAINED:
            reasons[site] = UNEXPLAINED.replace("optional", "required", 1)
    return tuple(LeftOut(ids[site], reasons[site], site in beyond) for site in unvisited)


class _Answer:
    """The routes of an answer, and those that vehicles which have none could drive, with what they add up to."""

    def __init__(self, problem: RoutingProblem, answer: Routes) -> None:
        self.problem = problem
        fleet, used = problem.fleet, [sum(r.vehicle == kind for r in answer) for kind in range(len(problem.fleet))]
        free = [kind for kind, v in enumerate(fleet) if v.count is None or used[kind] < v.count]
        self.names = [*problem.vehicle_names(answer), *(f"a further {fleet[kind].name}" for kind in free)]
        self.routes = [*answer, *(Route((), kind) for kind in free)]
        self.full = not free
        idle = [(kind, (v.count or 0) - used[kind]) for kind, v in enumerate(fleet) if v.committed]
        driven = [*((True, r) for r in answer), *((fleet[kind].committed, Route((), kind)) for kind in free)]
        nobody = np.array([0.0, 0.0, -math.inf, 0.0])
        # One line a route: distance, duration, finish, cost.
        self.sums = np.array([self._sums(r) if drives else nobody for drives, r in driven]).reshape(-1, 4)
        further = [np.tile(self._sums(Route((), kind)), (count - 1, 1)) for kind, count in idle if count > 1]
        self.all_sums = np.concatenate([self.sums, *further])
        self.scales = [max(sizes, 0.0) for sizes in problem.evaluate(answer).sizes]

    def _sums(self, route: Route) -> Floats:
        plan = schedule(self.problem, route)
        amounts = np.array([plan.total_distance, plan.duration, plan.finish])
        return np.append(amounts, self._cost(route.vehicle, amounts[0], amounts[1]))

    def _cost(self, kind: int, distance: Floats, duration: Floats) -> Floats:
        v = self.problem.fleet[kind]
        cost = v.fixed_cost + v.unit_cost * distance
        if v.unit_duration_cost or v.unit_overtime_cost:
            cost = cost + v.unit_duration_cost * duration + v.unit_overtime_cost * np.maximum(0.0, duration - v.regular_duration)
        return np.asarray(cost)

    def reasons(self, sites: Sequence[int]) -> Iterator[tuple[int, str]]:
        """The reason of each site that is looked at, in the problem's words."""
        ends = {k for x in self.problem.sites.shipments for k in (x.pickup, x.delivery)}
        shipped = {k: self._with(k) for k in sites if k in ends}
        if is_plain(self.problem):
            alone = np.array([k for k in sites if k not in shipped], dtype=np.int64)
            yield from self._plain(alone)
            rest = list(shipped)
        else:
            rest = list(sites)
        budget = MOST_JUDGED
        for site in rest:
            lists = shipped.get(site, [(site,)])
            budget -= sum(len(lists) * math.comb(len(r) + len(lists[0]), len(r)) for r in self.routes) if lists else 0
            if not lists or budget < 0:
                continue
            tally = _Tally(1, len(self.problem.senses))
            for number, route in enumerate(self.routes):
                places = judged(self.problem, [Route(v, route.vehicle) for listed in lists for v in orders(route.visits, listed)])
                tally.add(number, places, *self._changes(number, places, np.array(lists[:1])))
            companions = ", ".join(self.problem.sites.ids[k] for k in lists[0] if k != site)
            yield site, (f"with {companions}: " if companions else "") + self._reason(tally, 0, lists[0])

    def _with(self, site: int) -> list[tuple[int, ...]]:
        """The sites that are visited with ``site`` or not at all, in each order of pickups before deliveries; none if they are many."""
        shipments, together, grown = self.problem.sites.shipments, {site}, True
        while grown:
            more = {k for x in shipments for k in (x.pickup, x.delivery) if {x.pickup, x.delivery} & together}
            grown, together = not more <= together, together | more
        pairs = [(x.pickup, x.delivery) for x in shipments if x.pickup in together]
        every = itertools.permutations(sorted(together)) if len(together) <= MOST_TOGETHER else iter(())
        return [listed for listed in every if all(listed.index(p) < listed.index(d) for p, d in pairs)]

    def _plain(self, sites: Integers) -> Iterator[tuple[int, str]]:
        tally = _Tally(len(sites), len(self.problem.senses))
        for number, route in enumerate(self.routes):
            places, step = Insertions(self.problem, route), max(1, STRIP // (len(route) + 1))
            for first in range(0, len(sites), step):
                part = slice(first, first + step)
                inserted = places.of(sites[part])
                tally.add(number, inserted, *self._changes(number, inserted, sites[part, None]), part)
        for k, site in enumerate(sites.tolist()):
            yield site, self._reason(tally, k, (site,))

    def _changes(self, number: int, places: Places, sites: Integers) -> tuple[Floats, Floats]:
        """Increase of each level of the objective for each insertion, shape (levels, sites, places), and the worth of the added visits."""
        problem, old = self.problem, self.sums[number]
        s, others = problem.sites, np.delete(self.all_sums, number, axis=0)
        most = others.max(axis=0, initial=0.0)
        most[2] = others[:, 2].max(initial=min(opening(problem, v) for v in problem.fleet))  # the latest return where nobody drives
        largest = np.maximum(most, old)
        changes = {
            "total-cost": self._cost(self.routes[number].vehicle, places.distance, places.duration) - old[3],
            "total-duration": places.duration - old[1],
            "makespan": np.maximum(places.duration, most[1]) - largest[1],
            "longest-route": np.maximum(places.distance, most[0]) - largest[0],
            "latest-return": np.maximum(places.finish, most[2]) - largest[2],
            "vehicles": np.full(places.distance.shape, float(not self.routes[number].visits)),
        }
        worth = {"reward": s.reward[sites].sum(axis=1), "penalties": -s.penalty[sites].sum(axis=1)}
        worse, prizes = [], []
        for level in problem.objective.levels():
            sign = 1.0 if level.sense == "min" else -1.0
            prizes.append(-sign * sum((w * worth[t.name] for w, t in level.terms if t.name in worth), start=np.zeros(len(sites))))
            zero = np.zeros(places.distance.shape)
            worse.append(sign * sum((w * changes[t.name] for w, t in level.terms if t.name in changes), start=zero) - prizes[-1][:, None])
        return np.array(worse), np.array(prizes)

    def _reason(self, tally: _Tally, k: int, sites: Sequence[int]) -> str:
        it, levels = "it" if len(sites) == 1 else "them", self.problem.objective.levels()
        if tally.best[0, k] == math.inf:
            return self._no_room(tally, k, it)
        for at, level in enumerate(levels):
            worse, prize = float(tally.best[at, k]), float(tally.prize[at, k])
            if abs(worse) <= EQUAL * max(self.scales[at], abs(prize)):
                continue
            if worse < 0:
                where = self._where(tally, k, sites)
                return f"inserting {it} ({where}) would make {level} better by {-worse:.6g}: this answer is not the best one"
            if prize > 0:
                name = " and ".join(t.name for _, t in level.terms if isinstance(t, Reward | Penalties))
                owned = {"reward": "reward", "penalties": "penalty"}.get(name, "reward and penalty")
                return f"in this answer inserting {it} costs {worse + prize:.6g} at best, {worse:.6g} more than the {owned} of {prize:.6g}"
            return f"in this answer inserting {it} makes {level} worse by {worse:.6g} at best"
        return f"in this answer inserting {it} ({self._where(tally, k, sites)}) would change no objective"

    def _where(self, tally: _Tally, k: int, sites: Sequence[int]) -> str:
        """The vehicle, and behind which visit; of several sites, which go to places of their own, the vehicle alone."""
        number, place = int(tally.route[k]), int(tally.place[k])
        name, visits = self.names[number], self.routes[number].visits
        if not visits:
            return f"{name}, on a route of its own"
        if len(sites) > 1:
            return name
        ids = self.problem.sites.ids
        return f"{name}, after {ids[visits[place - 1]]}" if place else f"{name}, before {ids[visits[0]]}"

    def _no_room(self, tally: _Tally, k: int, it: str) -> str:
        full = ", and no vehicle is left" if self.full else ""
        for name in LIMITS:
            if tally.least_everywhere[name][k] > 0.0:
                return f"in this answer inserting {it} anywhere {WORDS[name]}{_by(name, tally.least_everywhere[name][k])}{full}"
        broken = [name for name in LIMITS if tally.count[name][k]]
        parts = [f"{int(tally.count[name][k])} times it {WORDS[name]}{_by(name, tally.least[name][k])}" for name in broken]
        return f"in this answer there is no room for {it} in any of {int(tally.tried[k])} places{full}: {', '.join(parts)}"


def _by(name: str, amount: float) -> str:
    return "" if name in ("skills", "moves", "route-risk") else f" by at least {amount:.6g}"


class _Tally:
    """Excess and changes at all places that were looked at, one entry per site."""

    def __init__(self, sites: int, levels: int) -> None:
        self.tried = np.zeros(sites)
        self.count = {name: np.zeros(sites) for name in LIMITS}
        self.least = {name: np.full(sites, math.inf) for name in LIMITS}
        self.least_everywhere = {name: np.full(sites, math.inf) for name in LIMITS}
        self.best, self.prize = np.full((levels, sites), math.inf), np.zeros((levels, sites))
        self.route, self.place = np.zeros(sites, dtype=np.int64), np.zeros(sites, dtype=np.int64)

    def add(self, number: int, places: Places, worse: Floats, prize: Floats, part: slice = slice(None)) -> None:
        """Count the places of one route for the sites ``part``."""
        sites, count = places.distance.shape
        free = np.ones((sites, count), dtype=bool)
        self.tried[part] += count
        self.prize[:, part] = prize
        for name in LIMITS:
            over = places.excess.get(name)
            if over is None:
                self.least_everywhere[name][part] = 0.0
                continue
            first = free & (over > 0.0)
            self.count[name][part] += first.sum(axis=1)
            self.least[name][part] = np.minimum(self.least[name][part], np.where(first, over, math.inf).min(axis=1))
            self.least_everywhere[name][part] = np.minimum(self.least_everywhere[name][part], over.min(axis=1))
            free &= ~first
        rows = np.arange(sites)
        # The best place: least at the first level, then at the next.
        keep = free
        for level in worse:
            least = np.where(keep, level, math.inf).min(axis=1, keepdims=True)
            keep = keep & (level <= least)
        at, some = np.argmax(keep, axis=1), keep.any(axis=1)
        values, known = worse[:, rows, at], self.best[:, part]
        better, equal = np.zeros(len(rows), dtype=bool), np.ones(len(rows), dtype=bool)
        for mine, theirs in zip(values, known, strict=True):
            better |= equal & (mine < theirs)
            equal &= mine == theirs
        better &= some
        self.best[:, part] = np.where(better, values, known)
        self.route[part] = np.where(better, number, self.route[part])
        self.place[part] = np.where(better, at, self.place[part])
