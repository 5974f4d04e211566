"""Kinds of the battery's problems: robots and tasks, bins, agents, errands, orchards and rooms."""

import math
from typing import Any

import numpy as np

from ...formulations.auctions.balanced_partition import OBJECTIVES as PARTS, BalancedPartition
from ...formulations.auctions.bin_assignment import MATCH, OBJECTIVE as PAIRED, WAITING, BinAssignment
from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.auctions.joint_assignment import JointAssignment
from ...formulations.auctions.orchard_day import OBJECTIVE as ENDS, OrchardDay
from ...formulations.auctions.room_exploration import RoomExploration
from ...formulations.auctions.task_allocation import OBJECTIVES as PATHS, TaskAllocation
from ...formulations.problem import Problem
from ...instances.auctions.assignment import AssignmentInstance
from ...instances.auctions.exploration_map import ExplorationMap
from ...instances.auctions.generalised_assignment import OBJECTIVES as WORTH
from ...instances.auctions.orchard_grid import OrchardGrid
from ...instances.auctions.orchard_jobs import OrchardJobs
from ...instances.auctions.robot_tasks import RobotTasks
from .drawing import HUGE, TINY, Draw, Generator, weights, whole


def _team(rng: Generator) -> RobotTasks:
    """Whole distances of one of a few sizes, all alike now and then; weights of both signs."""
    robots, tasks = int(rng.integers(1, 4)), int(rng.integers(1, 5))
    unit = float(rng.choice([1.0, 1.0, TINY, HUGE]))
    high = 1 if rng.random() < 0.2 else 99
    between = np.triu(whole(rng, (tasks, tasks), 1, high), 1)
    weight = whole(rng, tasks, -9, 20) * unit
    return RobotTasks.of_distances(
        whole(rng, (robots, tasks), 0, high) * unit, (between + between.T) * unit, weights=weight, name="battery"
    )


def task_paths(rng: Generator) -> Problem:
    """Open paths of a few robots through a few tasks: their sum, the longest, or the mean way."""
    return TaskAllocation(_team(rng), PATHS[int(rng.integers(len(PATHS)))])


def task_parts(rng: Generator) -> Problem:
    """Partitions whose largest part, or spread, is least, with pairs that cost or weights alone."""
    return BalancedPartition(_team(rng), PARTS[int(rng.integers(len(PARTS)))], "clique" if rng.random() < 0.7 else "none")


def bin_pairs(rng: Generator) -> Problem:
    """Robots to bins, as many of them or fewer or more, at the least sum or largest cost, with pairs forbidden and bins still being filled.

    As many pairs as there can be are asked for, or all robots or all bins, which may be more.
    """
    robots, bins = (int(v) for v in rng.integers(1, 5, 2))
    costs = weights(rng, (robots, bins)) * float(rng.choice([1.0, 1.0, 1.0, -1.0]))
    costs[rng.random(costs.shape) < rng.choice([0.0, 0.0, 0.3, 0.6])] = math.inf
    filled = None
    if rng.random() < 0.25:
        filled = np.where(rng.random(bins) < 0.2, math.inf, whole(rng, bins, 0, 9) * float(rng.choice([1.0, TINY, HUGE])))
    match = "most" if rng.random() < 0.7 else str(rng.choice(MATCH.choices))
    asked = {"objective": str(rng.choice(PAIRED.choices)), "match": match, "waiting": str(rng.choice(WAITING.choices))}
    return BinAssignment(AssignmentInstance.from_matrix(costs, filled=filled, name="battery"), **asked)


def shared_capacities(rng: Generator) -> Problem:
    """Jobs to agents of limited capacity: all at the least cost, which may not fit, or any for the most profit, with pairs forbidden."""
    agents, jobs = int(rng.integers(1, 4)), int(rng.integers(1, 6))
    objective = str(rng.choice(WORTH))
    values = weights(rng, (agents, jobs)) * float(rng.choice([1.0, 1.0, 1.0, -1.0]))
    values[rng.random(values.shape) < rng.choice([0.0, 0.2])] = math.inf if objective == "cost" else -math.inf
    unit = float(rng.choice([1.0, 1.0, TINY, HUGE]))
    consumption, most = whole(rng, (agents, jobs), 0, 9), whole(rng, agents, 0, 5 * jobs)
    return GeneralisedAssignment.from_arrays(values, consumption * unit, most * unit, objective, name="battery")


def errands(rng: Generator) -> Problem:
    """Robots that bring something to a request on the way to their bin, with robots that bring nothing and bins that nobody fills."""
    robots, bins, requests = int(rng.integers(1, 4)), int(rng.integers(1, 4)), int(rng.integers(0, 3))
    unit, high = float(rng.choice([1.0, 1.0, TINY, HUGE])), int(rng.choice([2, 20, 1000]))
    shapes: tuple[Any, ...] = ((robots, bins), (robots, requests), (requests, bins), bins)
    to_bin, to_request, between, filled = (whole(rng, shape, 0, high) * unit for shape in shapes)
    to_bin[rng.random(to_bin.shape) < 0.2] = math.inf
    to_request[rng.random(robots) < 0.3] = math.inf
    filled[rng.random(bins) < 0.1] = math.inf
    return JointAssignment.from_arrays(to_bin, to_request, between, filled, name="battery")


def standing_bins(rng: Generator) -> Problem:
    """Bins that stand in an orchard, some filled after others, and robots at the repository or in the field: the last step, or the sum."""
    grid = OrchardGrid(int(rng.integers(1, 4)), int(rng.integers(3, 6)), 0, int(rng.integers(1, 3)), 1)
    robots, bins = int(rng.integers(1, 4)), int(rng.integers(1, 5))
    groups = rng.integers(0, bins, bins).tolist()
    after = [max((k for k in range(b) if groups[k] == groups[b]), default=-1) for b in range(bins)]
    cells = np.where(rng.random(robots) < 0.6, grid.home, rng.integers(0, grid.size, robots))
    jobs = OrchardJobs(
        grid, cells, rng.integers(0, 4, robots), rng.choice(grid.harvested, bins), np.array(after), np.ones(bins, dtype=bool),
        rng.integers(0, 5, bins), name="battery",
    )  # fmt: skip
    return OrchardDay(jobs, str(rng.choice(ENDS.choices)))


def rooms_in_contact(rng: Generator) -> Problem:
    """A few rooms and one or two robots that must be heard again and again; where they start far out there may be no way."""
    rooms, robots = int(rng.integers(1, 4)), int(rng.integers(1, 3))
    beside = np.diag(np.ones(rooms - 1, dtype=bool), 1)
    doors, heard = (np.argwhere(np.triu(rng.random((rooms, rooms)) < often, 1) | kept) for often, kept in ((0.6, beside), (0.3, False)))
    visits, types, targets = (-np.sort(-weights(rng, (rooms, int(rng.integers(0, 3)))), axis=1) for _ in range(3))
    starts = rng.integers(0, rooms, robots) * int(rng.random() < 0.7)
    steps = int(rng.integers(1, 5 if robots == 1 else 3))
    silence = int(rng.integers(0, 3))
    return RoomExploration(ExplorationMap(doors, visits, types, targets, starts, 0, heard, silence, steps, name="battery"))


AUCTIONS: tuple[Draw, ...] = (task_paths, task_parts, bin_pairs, shared_capacities, errands, standing_bins, rooms_in_contact)
"""Kinds in the order in which they take turns."""
