"""Bound ``ball``: the linear program over a part of a sensing graph, which bounds the whole from above
(docs/formulations/bottleneck.md#balls).

Source: linear programming duality for (3.5) of Sung (2019): the dual weights of the small program, and zeros elsewhere, are feasible for
the dual of the whole.
"""

import math

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.sata.balls import Floats, Indices, ball_graph, coverage as covered_by, even_shares, grown, near_one, num_edges
from ....formulations.sata.max_min_lp import RobotsOf
from ....formulations.stop import NEVER, Stop
from ....instances.errors import InputError
from ....instances.sata.sensing_graph import SensingGraph
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family

SEEDS = 3
"""Worst-covered targets that the first ball is grown around."""

MORE_SEEDS = 4
"""Factor from one number of seeds to the next."""

MOST_EDGES = 20_000
"""Largest ball: HiGHS takes a third of a second for it on graphs of a local kind, some ten seconds on expanders."""

STILL = 1e-7
"""Relative improvement below which a bound stands still."""

TIME_SHARE = 0.5
"""Share of a budget for all bounds; the rest is for the linear program over the whole graph."""

SIMPLEX = {"highs": {"solver": "simplex"}}
SIMPLEX_EDGES = 8_000
"""Up to here simplex is the faster of HiGHS' two methods (4 ms against 7 ms at 300 edges, 10 ms against 15 ms at 6,000)."""


def ball_weights(graph: SensingGraph, targets: Indices, stop: Stop, linear: LinearPrograms) -> tuple[float, Indices, Floats] | None:
    """Solve the linear program over the ball of ``targets`` (ascending, none twice).

    Returns the bound, the targets of positive dual weight and their weights; None if the program was not solved.
    """
    from ....formulations.sata.bottleneck_sata import BottleneckSATA

    part = ball_graph(graph, targets)
    part, unit = near_one(part)
    problem = BottleneckSATA(part, fractional=True)
    compiled = problem.compile("max-min")
    try:
        duals = linear.duals(compiled.program, stop, SIMPLEX if part.num_edges <= SIMPLEX_EDGES else None)
    except InputError:  # weights of sizes that the solver does not take
        return None
    if duals is None or compiled.dual_evidence is None:
        return None
    evidence = compiled.dual_evidence(duals)
    if not math.isfinite(evidence.value):
        return None
    priced = targets[np.asarray(evidence.data["targets"], dtype=np.int64)].astype(np.int64)
    return evidence.value / unit, priced, np.asarray(evidence.data["weights"], dtype=np.float64)


def weights_evidence(targets: Indices, weights: Floats, bound: float, source: str) -> Evidence:
    """Weights of targets as evidence for the bottleneck problem."""
    return Evidence("target-weights", source, bound, {"targets": targets.tolist(), "weights": weights.tolist()})


def unseen_evidence(graph: SensingGraph) -> Evidence:
    """Evidence that nothing more than 0 can be had, from a target that no action sees."""
    name = graph.target_name(int(graph.unseen_targets[0]))
    return weights_evidence(graph.unseen_targets[:1], np.ones(1), 0.0, f"target {name}, which no action sees")


def ball_evidence(
    graph: SensingGraph,
    coverage: Floats | None,
    stop: Stop = NEVER,
    linear: LinearPrograms | None = None,
    *,
    seeds: int = SEEDS,
    most_edges: int = MOST_EDGES,
) -> Evidence | None:
    """Evidence ``target-weights`` from linear programs over balls around the worst-covered targets; None where none was solved in time.

    A ball grows, to at least twice its edges at a time and ``most_edges`` at most, until its bound stands still; the first is grown around
    ``seeds`` targets, others around four times as many, as long as some target is covered worse than the best bound so far. ``coverage``,
    of shape (targets,), is that of the best answer known; by default that of robots that divide themselves evenly among their actions. For
    whole actions this is a bound of their relaxation.
    """
    linear = linear or LinearPrograms()
    if len(graph.unseen_targets):
        return unseen_evidence(graph)
    if coverage is None:
        coverage = covered_by(graph, even_shares(graph))
    best: tuple[float, Indices, Floats] | None = None
    count = min(seeds, graph.num_targets)
    while True:
        worst = np.sort(np.argpartition(coverage, count - 1)[:count])
        priced = None if num_edges(graph, worst) > most_edges else _grown_weights(graph, worst, stop, linear, most_edges)
        if priced is None:
            break
        if best is None or priced[0] < best[0]:
            best = priced
        if count == graph.num_targets or np.partition(coverage, count)[count] >= best[0] * (1.0 - STILL):
            break
        count = min(MORE_SEEDS * count, graph.num_targets)
    if best is None:
        return None
    bound, targets, weights = best
    return weights_evidence(targets, weights, bound, f"linear program over a ball of targets, {len(targets)} of them weighted")


def _grown_weights(
    graph: SensingGraph, seeds: Indices, stop: Stop, linear: LinearPrograms, most_edges: int
) -> tuple[float, Indices, Floats] | None:
    """The best of the bounds of a ball that grows until its bound stands still."""
    best: tuple[float, Indices, Floats] | None = None
    ball: Indices | None = seeds
    while ball is not None:
        priced = None if stop.reached() else ball_weights(graph, ball, stop, linear)
        if priced is None:
            break
        standing = best is not None and priced[0] >= best[0] * (1.0 - STILL)
        if best is None or priced[0] < best[0]:
            best = priced
        ball = None if standing else grown(graph, ball, most_edges)
    return best


MISSING = of_family("max-min", lambda problem: problem.features() & {"min-max", "several-packing-rows"})


@bound_method("ball", MISSING, order=1)
def ball_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from balls around the targets that robots who divide themselves evenly cover worst, in half of the time.

    For bottleneck problems of kind ``target-weights``, for max-min programs with one packing row a variable of kind
    ``packing-covering-duals``.
    """
    half = stop.within(TIME_SHARE * stop.seconds_left)
    robots = RobotsOf(problem)  # type: ignore[arg-type]
    evidence = ball_evidence(robots.graph, None, half, linear)
    return None if evidence is None else robots.evidence(evidence)
