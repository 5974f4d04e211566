"""Auctions of bins against their guarantees, on assignments whose optimum is enumerated or known by construction."""

import itertools
import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ....formulations.auctions.bin_assignment import BinAssignment
from ....heuristics.heuristic import Outcome
from ....instances.auctions.generators.assignment import orchard_distance
from ....instances.number_arrays import Floats
from ...ratios.families import Family, listed
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Case, Configuration
from ...ratios.optimum import Optimum, attained

Rng = np.random.Generator

MOST = 6
"""Robots and bins of random instances: 720 assignments."""


def best_assignment(problem: BinAssignment) -> Optimum:
    """The best of all assignments of a complete instance, robots to bins or bins to robots."""
    costs = problem.matrix()
    turned = problem.num_robots > problem.num_bins
    matrix = costs.T if turned else costs
    n, m = matrix.shape
    ways = np.array(list(itertools.permutations(range(m), n)))
    best = ways[matrix[np.arange(n), ways].sum(axis=1).argmin()]
    bins = np.full(problem.num_robots, -1)
    bins[best if turned else np.arange(n)] = np.arange(n) if turned else best
    return attained(problem, tuple(bins.tolist()), "enumeration")


def _case(costs: Floats, name: str) -> Case:
    problem = BinAssignment.from_matrix(costs, name=name)
    return Case(problem, best_assignment(problem))


def _sizes(rng: Rng, fewer_robots: bool) -> tuple[int, int]:
    n, m = (int(k) for k in rng.integers(1, MOST + 1, 2))
    return (min(n, m), max(n, m)) if fewer_robots else (n, m)


def _travel(k: int, rng: Rng, fewer_robots: bool) -> Case:
    """Points of a line, a plane or an orchard; times of waiting, as the larger of the two or added."""
    n, m = _sizes(rng, fewer_robots)
    kind = k % 3
    if kind == 2:
        lanes, columns = int(rng.integers(2, 11)), int(rng.integers(3, 11))
        cells = [np.column_stack([rng.integers(0, lanes, size), rng.integers(0, columns, size)]) for size in (n, m)]
        costs = np.ceil(orchard_distance(cells[0], cells[1], columns) / 2.0)
    else:
        a, b = (rng.integers(0, 100, (size, kind + 1)) if k % 2 else rng.random((size, kind + 1)) for size in (n, m))
        costs = np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=2).astype(float))
    filled = rng.integers(0, 3, m) * costs.max() / 4.0
    costs = (costs, np.maximum(costs, filled), costs + filled)[k // 3 % 3]
    return _case(costs, f"travel-{k}")


def _fewer_bins(k: int, rng: Rng) -> Case:
    n, m = sorted(rng.choice(np.arange(1, MOST + 1), 2, replace=False).tolist(), reverse=True)
    robots, bins = rng.random((n, 2)), rng.random((m, 2))
    return _case(np.sqrt(((robots[:, None] - bins[None]) ** 2).sum(axis=2)), f"fewer-bins-{k}")


def _arbitrary(k: int, rng: Rng) -> Case:
    n, m = _sizes(rng, False)
    return _case(rng.integers(0, 10, (n, m)).astype(float) if k % 2 else rng.random((n, m)), f"any-{k}")


def serial_line(n: int) -> Case:
    """The line on which serving robots in turn costs 2^n - 1 times the optimum, which is 1: each takes the next one's bin.

    Robots stand at 0, 1, 3, 7, ..., bins at 1, 3, 7, ... and at -1.
    """
    far = 2.0 ** np.arange(1, n) - 1.0
    robots, bins = np.concatenate([[0.0], far]), np.concatenate([far, [-1.0]])
    problem = BinAssignment.from_matrix(np.abs(robots[:, None] - bins[None]), name=f"serial-line-{n}")
    return Case(problem, attained(problem, (n - 1, *range(n - 1)), "construction"))


def greedy_line(doublings: int, short: float = 1e-12) -> Case:
    """The line of n = 2^doublings robots on which the cheapest pair again and again costs 2 n^(log2 3/2) - 1 times the optimum.

    Robot, bin, robot, bin, ...; two copies of the line before stand apart by its length less the part ``short``. At ``short`` = 0 the ratio
    all gaps are equal, and ties decide; at 1e-12 the ratio is attained to 11 digits.
    """
    points = np.array([0.0, 1.0])
    for _ in range(doublings):
        length = points[-1] - points[0]
        points = np.concatenate([points, points + length + length * (1.0 - short)])
    robots, bins = points[::2], points[1::2]
    problem = BinAssignment.from_matrix(np.abs(robots[:, None] - bins[None]), name=f"greedy-line-{len(robots)}")
    return Case(problem, attained(problem, tuple(range(len(robots))), "construction"))


TRAVEL = Family("travel", "random places and waiting", partial(_travel, fewer_robots=False))
FEWER_ROBOTS = Family(
    "travel, a bin for each robot", "random places and waiting, a bin for each robot", partial(_travel, fewer_robots=True)
)
FEWER_BINS = Family("travel, fewer bins than robots", "random places and waiting, where some robots get no bin", _fewer_bins)
ARBITRARY = Family("arbitrary", "random costs, every other one whole", _arbitrary)
SERIAL_LINES = listed("serial lines", "2^n - 1 is attained", [partial(serial_line, n) for n in range(1, 11)])
GREEDY_LINES = listed("greedy lines", "2 n^(log2 3/2) - 1 is attained", [partial(greedy_line, k) for k in range(6)])


def greedy_bound(problem: BinAssignment) -> float:
    """2 n^(log2 3/2) - 1 of the pairs."""
    return float(2.0 * min(problem.num_robots, problem.num_bins) ** math.log2(1.5) - 1.0)


def _cheapest_first(problem: Any, options: Any, seed: int, outcome: Outcome) -> Iterator[tuple[str, str]]:
    """Later bids may win, so that the pairs are those of taking the cheapest one again and again (Reingold and Tarjan 1981), ties apart."""
    costs = problem.matrix()
    if len(np.unique(costs)) < costs.size:
        return
    bins = np.full(problem.num_robots, -1)
    for place in np.argsort(costs, axis=None).tolist():
        robot, chosen = divmod(place, problem.num_bins)
        if bins[robot] < 0 and chosen not in bins:
            bins[robot] = chosen
    if tuple(bins.tolist()) != tuple(outcome.answer):
        yield "order", f"the bins are {tuple(outcome.answer)}, and {tuple(bins.tolist())} where the cheapest pair is taken again and again"


def _in_random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": rng.permutation(problem.num_robots).tolist()}


def _serial(problem: Any) -> float | None:
    """Nothing is known where there are too few bins: those served first may not be the ones to serve."""
    return float(2.0**problem.num_robots - 1.0) if problem.num_robots <= problem.num_bins else None


def _optimum(problem: Any) -> float:
    from scipy.optimize import linear_sum_assignment

    matrix = problem.matrix()
    return float(matrix[linear_sum_assignment(matrix)].sum())


def _within(part: float) -> Configuration:
    """An epsilon so large that n epsilon is 1 / ``part`` of the optimum."""

    def options(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
        return {"epsilon": _optimum(problem) / (part * max(problem.num_robots, problem.num_bins))}

    return Configuration(
        f"n epsilon = OPT / {part:g}", "bertsekas", lambda problem: (1.0, part / (part - 1.0)), options,
        takes=lambda problem: _optimum(problem) > 0.0,
    )  # fmt: skip


guarantee_study(
    "auction", "the cheapest bid wins a bin, stated 2 n^(log2 3/2) - 1 on costs of travel", 2000,
    [Configuration("deferred", "auction", greedy_bound, checks=_cheapest_first)],
    [TRAVEL, SERIAL_LINES, GREEDY_LINES],
)  # fmt: skip
guarantee_study(
    "online-greedy", "robots in turn, stated 2^n - 1 on costs of travel", 2000,
    [
        Configuration("in order", "online-greedy", _serial),
        Configuration("random order", "online-greedy", _serial, _in_random_order),
    ],
    [FEWER_ROBOTS, FEWER_BINS, SERIAL_LINES, GREEDY_LINES],
)  # fmt: skip
guarantee_study(
    "bertsekas", "prices rise by bids, optimal for whole costs, or n epsilon more for a given epsilon", 2000,
    [
        Configuration("default", "bertsekas", lambda problem: 1.0),
        _within(4.0),
        _within(1000.0),
    ],
    [TRAVEL, ARBITRARY, SERIAL_LINES, GREEDY_LINES],
)  # fmt: skip
