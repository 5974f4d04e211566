"""Days in an orchard whose bins are all full: jobs of fixed lengths on identical machines, their optimum enumerated or known."""

from __future__ import annotations

import itertools
from functools import partial

import numpy as np

from ......formulations.auctions.orchard_day import OrchardDay
from ......instances.auctions.orchard_grid import OrchardGrid
from ......instances.auctions.orchard_jobs import OrchardJobs
from ....families import Family, listed
from ....judging import Case
from ....optimum import attained

Rng = np.random.Generator

MOST_BINS, MOST_ROBOTS = 7, 3


def _day(cells: list[int], robots: int, columns: int, objective: str, name: str) -> OrchardDay:
    """Full bins in one lane, by their cells, and robots at the repository; each takes half as many steps there as back."""
    count, nothing = len(cells), np.zeros(robots, dtype=np.int64)
    jobs = OrchardJobs(
        OrchardGrid(1, columns), nothing, nothing, np.array(cells), np.full(count, -1), np.ones(count, dtype=bool),
        np.zeros(count, dtype=np.int64), name=name,
    )  # fmt: skip
    return OrchardDay(jobs, objective)


def _best(problem: OrchardDay) -> Case:
    """Every way to share the bins out, each robot's shortest first."""
    jobs = problem.jobs
    length = (jobs.out + jobs.home).tolist()
    answers = []
    for owner in itertools.product(range(jobs.num_robots), repeat=jobs.num_bins):
        shares = [sorted((k for k, r in enumerate(owner) if r == robot), key=length.__getitem__) for robot in range(jobs.num_robots)]
        ends = [list(itertools.accumulate(length[k] for k in share)) for share in shares]
        value = max((e[-1] for e in ends if e), default=0) if problem.objective == "makespan" else sum(map(sum, ends))
        answers.append((value, shares))
    _, shares = min(answers, key=lambda found: found[0])
    return Case(problem, attained(problem, tuple(tuple((-1, k) for k in share) for share in shares), "enumeration"))


def _random(k: int, rng: Rng, objective: str) -> Case:
    columns = int(rng.integers(4, 14))
    cells = rng.integers(1, columns - 1, int(rng.integers(1, MOST_BINS + 1))).tolist()
    return _best(_day(cells, int(rng.integers(1, MOST_ROBOTS + 1)), columns, objective, f"lane-{k}"))


def full_bins(objective: str) -> Family:
    """Bins anywhere in a lane."""
    return Family("full bins", "full bins in a lane, robots at the repository", partial(_random, objective=objective))


def _of_lengths(lengths: list[int], robots: int, shares: list[list[int]], name: str) -> Case:
    """Bins that take three steps a unit of ``lengths``, and the best way to share them out."""
    problem = _day([2 * unit for unit in lengths], robots, 2 * max(lengths) + 3, "makespan", name)
    return Case(problem, attained(problem, tuple(tuple((-1, k) for k in share) for share in shares), "construction"))


def shortest_first() -> Family:
    """Graham (1966): many short bins and a long one after them."""
    cases = []
    for m in (2, 3, 4):
        many = m * (m - 1)
        shares = [list(range(robot, many, m - 1)) for robot in range(m - 1)]
        cases.append(partial(_of_lengths, [1] * many + [m], m, [*shares, [many]], f"one-long-{m}"))
    return listed("one long", "short bins, and one as long as a robot's share", cases)


def longest_first() -> Family:
    """Graham (1969): pairs of lengths from 2 m - 1 down to m + 1, and three of m."""
    cases = []
    for m in (2, 3, 4):
        lengths = [length for length in range(2 * m - 1, m, -1) for _ in range(2)] + [m] * 3
        long, short = list(range(m - 1)), list(range(m - 1, 2 * m - 2))
        # Whole sums of 3 m: the longest with the shortest that are left, and the three of m together.
        left = sorted([*long, *short], key=lengths.__getitem__)
        pairs = [[left[k], left[-1 - k]] for k in range(len(left) // 2)]
        cases.append(partial(_of_lengths, lengths, m, [*pairs, list(range(len(lengths) - 3, len(lengths)))], f"pairs-{m}"))
    return listed("pairs", "pairs of bins that fit together, and three that do so alone", cases)
