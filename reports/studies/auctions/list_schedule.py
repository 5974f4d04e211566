"""Lists of full bins against their guarantees: jobs of fixed lengths on identical machines, whose optimum is enumerated or known."""

import itertools
from functools import partial
from typing import Any

import numpy as np

from ....formulations.auctions.orchard_day import OrchardDay
from ....instances.auctions.orchard_grid import OrchardGrid
from ....instances.auctions.orchard_jobs import OrchardJobs
from ...ratios.families import Family, listed
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Case, Configuration
from ...ratios.optimum import attained

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
    _, shares = min(answers, key=lambda shared_out: shared_out[0])
    return Case(problem, attained(problem, tuple(tuple((-1, k) for k in share) for share in shares), "enumeration"))


def _random(k: int, rng: Rng, objective: str) -> Case:
    columns = int(rng.integers(4, 14))
    cells = rng.integers(1, columns - 1, int(rng.integers(1, MOST_BINS + 1))).tolist()
    return _best(_day(cells, int(rng.integers(1, MOST_ROBOTS + 1)), columns, objective, f"lane-{k}"))


def full_bins(objective: str) -> Family:
    """Full bins anywhere in a lane."""
    return Family("full bins", "full bins in a lane, robots at the repository", partial(_random, objective=objective))


def _of_lengths(lengths: list[int], robots: int, shares: list[list[int]], name: str) -> Case:
    """Bins that take three steps a unit of ``lengths``, shared out in the best way."""
    problem = _day([2 * unit for unit in lengths], robots, 2 * max(lengths) + 3, "makespan", name)
    return Case(problem, attained(problem, tuple(tuple((-1, k) for k in share) for share in shares), "construction"))


def _one_long(m: int) -> Case:
    """Graham (1966): many short bins and a long one after them."""
    many = m * (m - 1)
    shares = [list(range(robot, many, m - 1)) for robot in range(m - 1)]
    return _of_lengths([1] * many + [m], m, [*shares, [many]], f"one-long-{m}")


def _pairs(m: int) -> Case:
    """Graham (1969): pairs of lengths from 2 m - 1 down to m + 1, and three of m."""
    lengths = [length for length in range(2 * m - 1, m, -1) for _ in range(2)] + [m] * 3
    # Whole sums of 3 m: the longest remaining with the shortest, and the three of m together.
    order = sorted(range(2 * m - 2), key=lengths.__getitem__)
    pairs = [[order[k], order[-1 - k]] for k in range(m - 1)]
    return _of_lengths(lengths, m, [*pairs, list(range(2 * m - 2, 2 * m + 1))], f"pairs-{m}")


ONE_LONG = listed("one long", "short bins, and one as long as a robot's share", [partial(_one_long, m) for m in (2, 3, 4)])
PAIRS = listed("pairs", "pairs of bins that fit together, and three that do so alone", [partial(_pairs, m) for m in (2, 3, 4)])


def _any_list(problem: Any) -> float:
    return 2.0 - 1.0 / float(problem.jobs.num_robots)


def _longest_first(problem: Any) -> float:
    return 4.0 / 3.0 - 1.0 / (3.0 * float(problem.jobs.num_robots))


guarantee_study(
    "list-schedule", "bins one after the other, the last step stated 2 - 1/m, longest first 4/3 - 1/(3 m)", 500,
    [
        Configuration("nearest first", "list-schedule", _any_list),
        Configuration("longest first", "list-schedule", _longest_first, {"order": "longest"}),
    ],
    [full_bins("makespan"), ONE_LONG, PAIRS],
)  # fmt: skip
guarantee_study(
    "list-schedule-sum", "bins one after the other, the sum of their steps stated 1 nearest first", 500,
    [Configuration("nearest first", "list-schedule", lambda problem: 1.0)], [full_bins("completion")],
)  # fmt: skip
