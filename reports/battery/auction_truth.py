"""Optima of small problems of robots and tasks, bins, agents, errands, orchards and rooms, by enumeration in fractions; see ``truth``."""

import itertools
import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

from ...formulations.auctions.balanced_partition import BalancedPartition
from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.auctions.joint_assignment import JointAssignment
from ...formulations.auctions.orchard_day import OrchardDay
from ...formulations.auctions.room_exploration import RoomExploration
from ...formulations.auctions.task_allocation import TaskAllocation
from ...formulations.problem import Problem
from ...instances.auctions.orchard_grid import OrchardGrid
from .rational_simplex import ZERO


def fractions(values: Any) -> list[Any]:
    """Nested lists of fractions; infinities stay what they are."""
    return [fractions(v) if isinstance(v, list) else v if math.isinf(v) else Fraction(v) for v in values]


def path_values(problem: TaskAllocation) -> Iterator[Fraction]:
    """Objective of every way to do all tasks: each order of them, cut into one path per robot."""
    robots, tasks = problem.num_robots, problem.num_tasks
    away = fractions(problem.instance.distances.tolist())
    for order in itertools.permutations(range(tasks)):
        for cuts in itertools.combinations_with_replacement(range(tasks + 1), robots - 1):
            ways: list[Fraction] = []
            lengths = []
            for robot, (first, last) in enumerate(itertools.pairwise((0, *cuts, tasks))):
                at, way = robot, ZERO
                for task in order[first:last]:
                    way += away[at][task]
                    ways.append(way)
                    at = robots + task
                lengths.append(way)
            yield {"mini-sum": sum(lengths, ZERO), "mini-max": max(lengths), "mini-ave": sum(ways, ZERO) / tasks}[problem.objective]


def part_values(problem: BalancedPartition) -> Iterator[Fraction]:
    """Objective of every partition whose parts cost weights, and all pairs or none."""
    robots, tasks = problem.num_robots, problem.num_tasks
    away, weight = fractions(problem.instance.distances.tolist())[robots:], fractions(problem.instance.weights.tolist())  # type: ignore[union-attr]
    if problem.edges == "mst":
        raise NotImplementedError("nothing enumerates partitions into trees")
    for owners in itertools.product(range(robots), repeat=tasks):
        costs = [ZERO] * robots
        for a, owner in enumerate(owners):
            costs[owner] += weight[a]
            if problem.edges == "clique":
                costs[owner] += sum((away[a][b] for b in range(a) if owners[b] == owner), ZERO)
        yield max(costs) - (min(costs) if problem.objective == "min-difference" else ZERO)


def pair_values(problem: BinAssignment) -> Iterator[Fraction]:
    """Objective of every assignment of as many pairs as are asked for: each robot takes a bin that is left, or none."""
    data = problem.instance
    robots, bins = data.num_robots, data.num_bins
    price: list[dict[int, Fraction]] = [{} for _ in range(robots)]
    filled = [0.0] * bins if data.filled is None else data.filled.tolist()
    for robot in range(robots):
        for entry in range(int(data.indptr[robot]), int(data.indptr[robot + 1])):
            at, travel = int(data.bins[entry]), Fraction(float(data.cost[entry]))
            if not math.isinf(filled[at]):
                until = Fraction(filled[at])
                price[robot][at] = travel if data.filled is None else max(travel, until) if problem.waiting == "max" else travel + until
    by_size: dict[int, list[Fraction]] = {}
    for taken in itertools.product(*([None, *own] for own in price)):
        costs = [own[at] for own, at in zip(price, taken, strict=True) if at is not None]
        if len({at for at in taken if at is not None}) == len(costs):
            value = sum(costs, ZERO) if problem.objective == "sum" else max(costs, default=ZERO)
            by_size.setdefault(len(costs), []).append(value)
    yield from by_size.get({"most": max(by_size), "robots": robots, "bins": bins}[problem.match], [])


def capacity_values(problem: GeneralisedAssignment) -> Iterator[Fraction]:
    """Cost or profit of every way to give each job an agent, or, of profits, none."""
    data, costs = problem.instance, problem.instance.objective == "cost"
    values, used, most = (fractions(part.tolist()) for part in (data.values, data.consumption, data.capacity))
    for agents in itertools.product([*range(len(most)), *([] if costs else [None])], repeat=len(values[0])):
        done = [(agent, job) for job, agent in enumerate(agents) if agent is not None]
        loads = [sum((used[i][job] for i, job in done if i == agent), ZERO) for agent in range(len(most))]
        if all(isinstance(values[i][j], Fraction) for i, j in done) and all(load <= room for load, room in zip(loads, most, strict=True)):
            yield sum((values[i][j] for i, j in done), ZERO)


def errand_values(problem: JointAssignment) -> Iterator[Fraction]:
    """Sum of times of all errands that have the most bins, and the most requests."""
    data = problem.instance
    assert data.filled is not None
    to_bin, to_request, between, filled = (fractions(p.tolist()) for p in (data.to_bin, data.to_request, data.between, data.filled))
    own: list[list[tuple[int | None, int | None, Fraction]]] = []
    for robot in range(len(to_bin)):
        asked = [(None, ZERO), *((q, time) for q, time in enumerate(to_request[robot]) if isinstance(time, Fraction))]
        errands: list[tuple[int | None, int | None, Fraction]] = [(None, q, time) for q, time in asked]
        for at, way in enumerate(to_bin[robot]):
            if isinstance(way, Fraction) and isinstance(filled[at], Fraction):
                errands += [(at, q, max(way if q is None else time + between[q][at], filled[at])) for q, time in asked]
        own.append(errands)
    by_counts: dict[tuple[int, int], list[Fraction]] = {}
    for team in itertools.product(*own):
        bins, requests = ([errand[k] for errand in team if errand[k] is not None] for k in (0, 1))
        if len(set(bins)) == len(bins) and len(set(requests)) == len(requests):
            by_counts.setdefault((len(bins), len(requests)), []).append(sum((time for _, _, time in team), ZERO))
    yield from by_counts[max(by_counts)]


def day_values(problem: OrchardDay) -> Iterator[Fraction]:
    """The last step, or the sum of all, of every order of bins that stand, cut into one list per robot that fetches them in turn."""
    jobs = problem.jobs
    if not jobs.standing.all():
        raise NotImplementedError("nothing enumerates days with bins to be brought")
    full: list[int] = []
    for before, work in zip(jobs.after.tolist(), jobs.work.tolist(), strict=True):
        full.append(work + (full[before] if before >= 0 else 0))
    count, robots, cells, home = jobs.num_bins, jobs.num_robots, jobs.bin_cells.tolist(), jobs.grid.home
    away = [_steps_from(jobs.grid, cell) for cell in cells]
    empty, slow = jobs.grid.empty_speed, jobs.grid.full_speed
    for order in itertools.permutations(range(count)):
        for cuts in itertools.combinations_with_replacement(range(count + 1), robots - 1):
            ends = []
            for robot, (first, last) in enumerate(itertools.pairwise((0, *cuts, count))):
                at, clock = int(jobs.robot_cells[robot]), int(jobs.robot_free[robot])
                for k in order[first:last]:
                    clock = max(clock + -(-away[k][at] // empty), full[k]) + -(-away[k][home] // slow)
                    at = home
                    ends.append(clock)
            yield Fraction(max(ends) if problem.objective == "makespan" else sum(ends))


def _steps_from(grid: OrchardGrid, cell: int) -> list[int]:
    """Cells of a shortest way to each: along lanes everywhere, across them in the first and last column."""
    steps, ahead = {cell: 0}, [cell]
    for at in ahead:
        row, column = divmod(at, grid.columns)
        beside = [(row, column - 1), (row, column + 1)]
        if column in (0, grid.columns - 1):
            beside += [(row - 1, column), (row + 1, column)]
        for r, c in beside:
            to = r * grid.columns + c
            if 0 <= r < grid.rows and 0 <= c < grid.columns and to not in steps:
                steps[to] = steps[at] + 1
                ahead.append(to)
    return [steps[to] for to in range(grid.size)]


def room_values(problem: RoomExploration) -> Iterator[Fraction]:
    """Gain of every plan that keeps contact, step by step: all robots' doors, stays and observations at once."""
    data = problem.instance
    gains = [fractions(table.tolist()) for table in (data.exploring, data.mapping, data.searching)]
    doors, heard = ({frozenset(pair) for pair in pairs.tolist()} for pairs in (data.doors, data.heard))

    def after(here: tuple[int, ...], silent: tuple[int, ...], done: dict[tuple[int, int], int], steps: int) -> Iterator[Fraction]:
        if not steps:
            if not any(silent):
                yield sum((sum(gains[kind][room][:times], ZERO) for (kind, room), times in done.items()), ZERO)
            return
        deeds = [[(at, None), (at, 1), (at, 2), *((to, 0) for to in range(data.num_rooms) if frozenset((at, to)) in doors)] for at in here]
        for team in itertools.product(*deeds):
            there = tuple(room for room, _ in team)
            joined, ahead = set[int](), [data.base]
            while ahead:
                one = ahead.pop()
                reached = {room for room in there if room not in joined and (room == one or frozenset((room, one)) in heard)}
                joined |= reached
                ahead += reached
            now = tuple(0 if room in joined else count + 1 for room, count in zip(there, silent, strict=True))
            if max(now) <= data.silence:
                more = dict(done)
                for room, kind in team:
                    if kind is not None:
                        more[kind, room] = more.get((kind, room), 0) + 1
                yield from after(there, now, more, steps - 1)

    return after(tuple(data.starts.tolist()), (0,) * data.num_robots, {}, data.steps)


AUCTIONS: dict[type[Problem], Callable[[Any], Iterator[Fraction]]] = {
    TaskAllocation: path_values, BalancedPartition: part_values, BinAssignment: pair_values, GeneralisedAssignment: capacity_values,
    JointAssignment: errand_values, OrchardDay: day_values, RoomExploration: room_values,
}  # fmt: skip
"""The enumeration of the values of all answers, by family."""
