"""Brute force for tiny problems of robots with tasks, bins, jobs, errands, orchards and rooms."""

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np

from waybound import BalancedPartition, BinAssignment, GeneralisedAssignment, JointAssignment, OrchardDay, RoomExploration, TaskAllocation

from .base import PARTS, Truth, Values, ints, scale_of

ZERO = Fraction(0)


class TaskTruth(Truth):
    """All ways to lengthen the path of some robot by some task that is left."""

    def __init__(self, problem: TaskAllocation) -> None:
        super().__init__(("min",))
        self.robots, self.tasks, self.objective = problem.num_robots, problem.num_tasks, problem.objective
        self.unit = scale_of(problem.instance.distances)
        self.away = ints(problem.instance.distances, self.unit)
        self.lengthen(((),) * self.robots, 0)

    def lengthen(self, paths: tuple[tuple[int, ...], ...], robot: int) -> None:
        """Robots before ``robot`` have their whole paths."""
        undone = [task for task in range(self.tasks) if not any(task in path for path in paths)]
        if not undone:
            self.meet(self.worth(paths), True, paths)
            return
        for task in undone:
            self.lengthen((*paths[:robot], (*paths[robot], task), *paths[robot + 1 :]), robot)
        if robot + 1 < self.robots:
            self.lengthen(paths, robot + 1)

    def worth(self, paths: Any) -> Values:
        legs = [
            [self.away[self.robots + path[k - 1] if k else robot][task] for k, task in enumerate(path)] for robot, path in enumerate(paths)
        ]
        if self.objective == "mini-ave":
            return (Fraction(sum(leg * (len(own) - k) for own in legs for k, leg in enumerate(own)), self.unit * self.tasks),)
        lengths = [sum(own) for own in legs]
        return (Fraction(max(lengths) if self.objective == "mini-max" else sum(lengths), self.unit),)

    def value(self, answer: Any) -> Values | None:
        return self.worth(answer) if sorted(t for path in answer for t in path) == list(range(self.tasks)) else None


class PartTruth(Truth):
    """All ways to put one task after the other into a part."""

    def __init__(self, problem: BalancedPartition) -> None:
        super().__init__(("min",))
        self.parts_, self.tasks, self.edges = problem.num_robots, problem.num_tasks, problem.edges
        self.spread = problem.objective != "min-max"
        self.unit = scale_of(problem.weights, problem.instance.between)
        self.weight, self.away = (ints(a, self.unit) for a in (problem.weights, problem.instance.between))
        self.mixed = True
        for owners in itertools.product(range(self.parts_), repeat=self.tasks):
            answer = tuple(tuple(task for task, owner in enumerate(owners) if owner == part) for part in range(self.parts_))
            self.meet(self.worth(answer), True, answer)

    def cost(self, part: tuple[int, ...]) -> Fraction:
        """Weights, and distances of all pairs or of a least spanning tree (Kruskal)."""
        total, pairs = sum(self.weight[t] for t in part), itertools.combinations(part, 2)
        if self.edges == "clique":
            return Fraction(total + sum(self.away[a][b] for a, b in pairs), self.unit)
        joined: list[set[int]] = [{t} for t in part]
        for a, b in sorted(pairs, key=lambda pair: self.away[pair[0]][pair[1]]) if self.edges == "mst" else ():
            one, other = (next(group for group in joined if t in group) for t in (a, b))
            if one is not other:
                total += self.away[a][b]
                joined = [group for group in joined if group is not one and group is not other] + [one | other]
        return Fraction(total, self.unit)

    def worth(self, answer: Any) -> Values:
        costs = [self.cost(part) for part in answer]
        return (max(costs) - (min(costs) if self.spread else 0),)

    def value(self, answer: Any) -> Values | None:
        return self.worth(answer) if sorted(t for part in answer for t in part) == list(range(self.tasks)) else None


class PairTruth(Truth):
    """All ways to line up bins behind some of the robots, the most robots first."""

    def __init__(self, problem: BinAssignment) -> None:
        super().__init__(("min",))
        self.objective, self.shape = problem.objective, (problem.num_robots, problem.num_bins)
        self.price = _prices(problem)
        self.mixed = min(self.price.values(), default=0) < 0 < max(self.price.values(), default=0)
        robots, bins = map(range, self.shape)
        least = {"most": 0, "robots": len(robots), "bins": len(bins)}[problem.match]
        for size in range(least or min(self.shape), least - 1, -1):
            self.pairs = size
            for used in itertools.combinations(robots, size):
                for line in itertools.permutations(bins, size):
                    if all(pair in self.price for pair in zip(used, line, strict=True)):
                        own = dict(zip(used, line, strict=True))
                        self.meet(self.worth(own), True, tuple(own.get(robot, -1) for robot in robots))
            if self.best is not None:
                break

    def worth(self, own: dict[int, int]) -> Values:
        costs = [self.price[pair] for pair in own.items()]
        return (sum(costs, Fraction(0)) if self.objective == "sum" else max(costs, default=Fraction(0)),)

    def value(self, answer: Any) -> Values | None:
        own = {robot: at for robot, at in enumerate(answer) if at >= 0}
        fits = len(answer) == self.shape[0] and len(set(own.values())) == len(own) == self.pairs and self.price.keys() >= set(own.items())
        return self.worth(own) if fits else None


def _prices(problem: BinAssignment) -> dict[tuple[int, int], Fraction]:
    """The cost of every pair that is allowed: travel, and waiting for a bin that is not full."""
    data, prices = problem.instance, {}
    robots = np.repeat(np.arange(data.num_robots), np.diff(data.indptr))
    for robot, at, cost in zip(robots.tolist(), data.bins.tolist(), data.cost.tolist(), strict=True):
        until = None if data.filled is None else float(data.filled[at])
        if until is None or until < math.inf:
            both = [Fraction(cost), *([] if until is None else [Fraction(until)])]
            prices[robot, at] = max(both) if problem.waiting == "max" else sum(both, Fraction(0))
    return prices


class CapacityTruth(Truth):
    """One job after the other, to any agent that has room left."""

    def __init__(self, problem: GeneralisedAssignment) -> None:
        super().__init__(("min" if problem.objective == "cost" else "max",))
        data = problem.instance
        self.used = [[Fraction(v) for v in row] for row in data.consumption.tolist()]
        self.rooms = [Fraction(v) for v in data.capacity.tolist()]
        self.worth = {
            (job, agent): Fraction(v) for agent, row in enumerate(data.values.tolist()) for job, v in enumerate(row) if math.isfinite(v)
        }
        self.mixed = min(self.worth.values(), default=0) < 0 < max(self.worth.values(), default=0)
        self.jobs, self.all_done = problem.num_jobs, problem.objective == "cost"
        self.give((), [*self.rooms], ZERO)

    def give(self, agents: tuple[int, ...], rooms: list[Fraction], total: Fraction) -> None:
        """Jobs before this one have their agents, which have ``left`` left."""
        job = len(agents)
        if job == self.jobs:
            self.meet((total,), min(rooms) >= 0, agents)
            return
        if not self.all_done:
            self.give((*agents, -1), rooms, total)
        for agent, room in enumerate(self.rooms):
            rest = rooms[agent] - self.used[agent][job]
            if (job, agent) in self.worth and rest >= -room / PARTS:
                self.give((*agents, agent), [*rooms[:agent], rest, *rooms[agent + 1 :]], total + self.worth[job, agent])

    def value(self, answer: Any) -> Values | None:
        pairs = [(job, agent) for job, agent in enumerate(answer) if agent >= 0]
        for agent, room in enumerate(self.rooms):
            if sum((self.used[agent][job] for job, own in pairs if own == agent), ZERO) > room * (1 + Fraction(1, PARTS)):
                return None
        fits = self.worth.keys() >= set(pairs) and (len(pairs) == self.jobs or not self.all_done)
        return (sum((self.worth[pair] for pair in pairs), ZERO),) if fits else None


class ErrandTruth(Truth):
    """All ways to line up as many bins as can be behind some robots, and as many requests behind some."""

    def __init__(self, problem: JointAssignment) -> None:
        super().__init__(("min",))
        self.data, self.robots = problem.instance, range(problem.num_robots)
        self.full = [math.inf] * problem.num_bins if self.data.filled is None else self.data.filled.tolist()
        fetching = [[math.isfinite(v + t) for v, t in zip(row, self.full, strict=True)] for row in self.data.to_bin.tolist()]
        bins = self.most(fetching)
        requests = self.most([[math.isfinite(v) for v in row] for row in self.data.to_request.tolist()])
        self.counts = len(bins[0]), len(requests[0])
        for fetched, served in itertools.product(bins, requests):
            answer = tuple((fetched.get(robot, -1), served.get(robot, -1)) for robot in self.robots)
            self.meet(self.worth(answer), True, answer)

    def most(self, allowed: list[list[bool]]) -> list[dict[int, int]]:
        """Every way to line up the most columns behind robots."""
        columns = range(len(allowed[0]))
        for size in range(min(len(allowed), len(columns)), 0, -1):
            ways = [
                dict(zip(used, line, strict=True))
                for used in itertools.combinations(self.robots, size)
                for line in itertools.permutations(columns, size)
                if all(allowed[robot][at] for robot, at in zip(used, line, strict=True))
            ]
            if ways:
                return ways
        return [{}]

    def worth(self, answer: Any) -> Values:
        total = ZERO
        for robot, (at, request) in enumerate(answer):
            way = ZERO if request < 0 else Fraction(float(self.data.to_request[robot, request]))
            if at >= 0:
                way += Fraction(float(self.data.to_bin[robot, at] if request < 0 else self.data.between[request, at]))
                way = max(way, Fraction(self.full[at]))
            total += way
        return (total,)

    def value(self, answer: Any) -> Values | None:
        for part, count in enumerate(self.counts):
            taken = [errand[part] for errand in answer if errand[part] >= 0]
            if len(set(taken)) < len(taken) or len(taken) != count:
                return None
        for robot, (at, request) in enumerate(answer):
            asked = [self.data.to_bin[robot, at], self.full[at]] if at >= 0 else []
            asked += [self.data.to_request[robot, request]] if request >= 0 else []
            if not all(map(math.isfinite, asked)):
                return None
        return self.worth(answer)


class DayTruth(Truth):
    """Days on which all bins stand: some robot fetches some bin that is left, until none is."""

    def __init__(self, problem: OrchardDay) -> None:
        super().__init__(("min",))
        self.jobs, self.last = problem.jobs, problem.objective == "makespan"
        assert self.jobs.standing.all()
        self.fetch(((),) * self.jobs.num_robots, 0)

    def fetch(self, lists: tuple[tuple[int, ...], ...], robot: int) -> None:
        """Robots before ``robot`` have their whole lists."""
        undone = [k for k in range(self.jobs.num_bins) if not any(k in own for own in lists)]
        if not undone:
            self.meet(self.worth(lists), True, tuple(tuple((-1, k) for k in own) for own in lists))
            return
        for k in undone:
            self.fetch((*lists[:robot], (*lists[robot], k), *lists[robot + 1 :]), robot)
        if robot + 1 < len(lists):
            self.fetch(lists, robot + 1)

    def worth(self, lists: Any) -> Values:
        ends, home = [], self.jobs.grid.repository * self.jobs.grid.columns
        for robot, own in enumerate(lists):
            at, clock = int(self.jobs.robot_cells[robot]), int(self.jobs.robot_free[robot])
            for k in own:
                cell = int(self.jobs.bin_cells[k])
                clock = max(clock + math.ceil(Fraction(self.away(at, cell), self.jobs.grid.empty_speed)), self.full(k))
                clock += math.ceil(Fraction(self.away(cell, home), self.jobs.grid.full_speed))
                at = home
                ends.append(clock)
        return (Fraction(max(ends) if self.last else sum(ends)),)

    def away(self, a: int, b: int) -> int:
        """Cells: along one lane, or over the nearer headland of the two."""
        width = self.jobs.grid.columns
        (r, c), (s, d) = divmod(a, width), divmod(b, width)
        return abs(c - d) if r == s else abs(r - s) + min(c + d, 2 * (width - 1) - c - d)

    def full(self, k: int) -> int:
        before = int(self.jobs.after[k])
        return int(self.jobs.work[k]) + (self.full(before) if before >= 0 else 0)

    def value(self, answer: Any) -> Values | None:
        lists = [[fetch for _, fetch in trips] for trips in answer]
        stand = all(bring < 0 for trips in answer for bring, _ in trips)
        return self.worth(lists) if stand and sorted(k for own in lists for k in own) == list(range(self.jobs.num_bins)) else None


class RoomTruth(Truth):
    """All plans of each robot by itself, put together in every way."""

    def __init__(self, problem: RoomExploration) -> None:
        super().__init__(("max",))
        data = self.data = problem.instance
        self.tables = [table.tolist() for table in (data.exploring, data.mapping, data.searching)]
        self.doors, self.heard = ([set(pair) for pair in pairs.tolist()] for pairs in (data.doors, data.heard))
        for team in itertools.product(*(self.plans(start, data.steps) for start in data.starts.tolist())):
            value = self.value(team)
            if value is not None:
                self.meet(value, True, team)

    def plans(self, at: int, steps: int) -> list[Any]:
        if not steps:
            return [()]
        deeds = [(at, 0), (at, 1), (at, 2), *((to, 0) for to in range(self.data.num_rooms) if {at, to} in self.doors)]
        return [(deed, *rest) for deed in deeds for rest in self.plans(deed[0], steps - 1)]

    def value(self, answer: Any) -> Values | None:
        done: dict[tuple[int, int], int] = {}
        total = ZERO
        for start, plan in zip(self.data.starts.tolist(), answer, strict=True):
            at = start
            for room, kind in plan:
                if room != at and (kind or {at, room} not in self.doors):
                    return None
                if kind or room != at:
                    times = done[kind, room] = done.get((kind, room), 0) + 1
                    gains = self.tables[kind][room]
                    total += Fraction(gains[times - 1]) if times <= len(gains) else ZERO
                at = room
        silent = [0] * len(answer)
        for step in range(self.data.steps):
            there = [plan[step][0] for plan in answer]
            joined = {self.data.base}
            for _ in there:
                joined |= {room for room in there if any(room == one or {room, one} in self.heard for one in joined)}
            silent = [0 if room in joined else count + 1 for room, count in zip(there, silent, strict=True)]
            if max(silent) > self.data.silence:
                return None
        return None if any(silent) else (total,)


AUCTIONS: dict[type, type] = {
    TaskAllocation: TaskTruth, BalancedPartition: PartTruth, BinAssignment: PairTruth, GeneralisedAssignment: CapacityTruth,
    JointAssignment: ErrandTruth, OrchardDay: DayTruth, RoomExploration: RoomTruth,
}  # fmt: skip
