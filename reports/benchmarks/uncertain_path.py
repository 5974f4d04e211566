"""Uncertain paths: comparisons a second, agreement with sampling, non-dominated sets, and what each policy takes.

- Pairs of random sets of up to 20 paths, and of exactly 20: CPU time of ``cheaper_probability``, one pair after the other.
- The same probabilities by sampling the paths' costs, in standard errors; and those of paths that share edges, by the joint
  distribution, against sampling the edges.
- Non-dominated sets and proved optima on random roadmaps of 100 vertices: sizes and CPU time.
- Policies: CPU time of what is computed once a graph, and of one walk.

One thread. Medians and largest values, after a first call outside the clock.
"""

import os
from collections.abc import Callable
from typing import Annotated

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import waybound as wb
from waybound.extending import NEVER
from waybound.formulations.risk.path_sets import PathSet, cheaper_probability, cheapest_set_probabilities
from waybound.formulations.risk.shared_edges import JointCosts, joint_probabilities, sampled_probabilities
from waybound.heuristics.risk._graph_policies import DStarLite, Greedy, LeastMean, Policy
from waybound.heuristics.risk.rags import RiskAware
from waybound.instances.risk.worlds.uncertain_graph import UncertainGraphWorld
from waybound.solvers.engines.risk.non_dominated_paths import non_dominated_paths
from waybound.solvers.engines.risk.supported_paths import supported_paths

from ._harness import Option, command, generated, met, timed

MOST_PATHS = 20
RATE, SECONDS, ERRORS = 1e4, 0.1, 4.0
"""Targets: comparisons a second, seconds a non-dominated set, standard errors."""


def random_sets(rng: np.random.Generator, size: int) -> tuple[PathSet, PathSet]:
    """Two sets of path costs as roadmaps have them: means of some hundreds, a few apart, variances of 20 to 80."""
    counts = rng.integers(1, MOST_PATHS + 1, 2) if size == 0 else (size, size)
    a, b = (PathSet(rng.normal(200.0, 5.0, k), rng.uniform(20.0, 80.0, k)) for k in counts)
    return a, b


def compare(comparisons: int, samples: int, seed: int) -> tuple[list[str], bool]:
    rng = np.random.default_rng(seed)
    lines, good = [], True
    for size, what in ((0, f"up to {MOST_PATHS}"), (MOST_PATHS, f"of {MOST_PATHS}")):
        pairs = [random_sets(rng, size) for _ in range(comparisons)]
        cheaper_probability(*pairs[0])
        runs = [timed(lambda pairs=pairs: [cheaper_probability(a, b) for a, b in pairs]) for _ in range(3)]  # type: ignore[misc]
        rates = [comparisons / seconds for seconds, _ in runs]
        good = good and max(rates) >= RATE
        lines.append(f"sets {what:9} {comparisons:,} comparisons: {max(rates):,.0f} a second (best of 3; least {min(rates):,.0f})")
    worst = 0.0
    for a, b in [random_sets(rng, 0) for _ in range(20)]:
        p = cheaper_probability(a, b)
        means, variances = np.append(a.means, b.means), np.append(a.variances, b.variances)
        groups = np.repeat([0, 1], [len(a.means), len(b.means)])
        drawn, error = sampled_probabilities(JointCosts(means, np.eye(len(means)), variances), groups, samples, rng)
        worst = max(worst, abs(p - drawn[0]) / max(error[0], 1e-12) if 0 < drawn[0] < 1 else 0.0)
    lines.append(f"20 pairs against {samples:,} samples each: at most {worst:.2f} standard errors apart")
    return lines, good and worst <= ERRORS


def share(samples: int, graphs: int, seed: int) -> tuple[list[str], bool]:
    """The first choice on roadmaps where there is one, all its paths at once."""
    worst, seconds, apart = 0.0, [], []
    for graph in range(1, graphs + 1):
        g = _roadmap(graph, 20.0)
        paths = non_dominated_paths(g).paths
        heads = sorted({path[1] for path in paths})
        groups = np.array([heads.index(path[1]) for path in paths])
        if len(heads) < 2:
            continue
        costs = JointCosts.of_paths(g, paths)
        spent, (exact, own) = timed(lambda costs=costs, groups=groups: joint_probabilities(costs.mean, costs.covariance, groups))  # type: ignore[misc]
        seconds.append(spent)
        drawn, _ = sampled_probabilities(costs, groups, samples, np.random.default_rng(seed))
        error = np.sqrt(np.maximum(exact, 1.0 / samples) / samples)  # one win in all is no deviation of none
        worst = max(worst, float((np.abs(exact - drawn) / np.hypot(error, own)).max()))
        variances = costs.covariance.diagonal()
        separate = [PathSet(costs.mean[groups == k], variances[groups == k]) for k in range(len(heads))]
        apart.append(float(np.abs(cheapest_set_probabilities(separate) - exact).max()))
    text = f"paths that share edges, {len(seconds)} roadmaps: joint distribution within {worst:.2f} standard errors of sampling, "
    lines = [
        text + f"{np.median(seconds):.2f} s (median); as if independent: up to {max(apart):.3f} apart, {np.mean(apart):.3f} in the mean"
    ]
    return lines, worst <= ERRORS


def sets(graphs: int) -> tuple[list[str], bool]:
    sizes, seconds, labels, proofs = [], [], [], []
    non_dominated_paths(_roadmap(1, 20.0))
    supported_paths(wb.UncertainPath(_roadmap(1, 20.0)), NEVER)
    for graph in range(1, graphs + 1):
        g = _roadmap(graph, 20.0)
        spent, frontier = timed(lambda g=g: non_dominated_paths(g))  # type: ignore[misc]
        seconds.append(spent)
        sizes.append(len(frontier.paths))
        labels.append(frontier.labels)
        problem = wb.UncertainPath(g)
        proofs.append(timed(lambda problem=problem: supported_paths(problem, NEVER))[0])  # type: ignore[misc]
    lines = [
        f"non-dominated paths, {graphs} roadmaps of 100 vertices: {np.mean(sizes):.1f} (deviation {np.std(sizes):.1f}, {min(sizes)} to "
        f"{max(sizes)}), {np.mean(labels):.0f} labels; {1e3 * np.median(seconds):.1f} ms (median), {1e3 * max(seconds):.1f} ms (largest)",
        f"least cost at risk 0.05 with its proof: {1e3 * np.median(proofs):.1f} ms (median), {1e3 * max(proofs):.1f} ms (largest)",
    ]
    return lines, max(seconds) < SECONDS


def policies(graphs: int, draws: int) -> list[str]:
    lines = [f"policies on {graphs} roadmaps, {draws} walks each: ms once a graph, ms a walk (mean, deviation)"]
    makers: dict[str, Callable[[wb.UncertainGraph], Policy]] = {
        "rags": lambda g: RiskAware(g, non_dominated_paths(g)),
        "a-star": LeastMean,
        "greedy": lambda g: Greedy(g, non_dominated_paths(g)),
        "d-star-lite": DStarLite,
    }
    for variance in (5.0, 10.0, 20.0):
        for name, make in makers.items():
            once, walks = [], []
            for graph in range(1, graphs + 1):
                g = _roadmap(graph, variance)
                spent, policy = timed(lambda make=make, g=g: make(g))  # type: ignore[misc]
                once.append(spent)
                for draw in range(draws):
                    world = UncertainGraphWorld(g, np.random.default_rng(draw))
                    walks.append(_walk(policy.fresh(), world))
            lines.append(
                f"  variances to {variance:4g}  {name:12} {1e3 * np.mean(once):8.2f} {1e3 * np.mean(walks):8.2f} {1e3 * np.std(walks):8.2f}"
            )
    return lines


def _walk(policy: Policy, world: UncertainGraphWorld) -> float:
    """CPU seconds of all decisions of one walk."""
    spent = 0.0
    while not (o := world.observe()).arrived:
        seconds, to = timed(lambda o=o: policy.next_vertex(o.at, o.known))  # type: ignore[misc]
        spent += seconds
        world.step({0: to})
    return spent


def _roadmap(seed: int, variance: float) -> wb.UncertainGraph:
    return generated(wb.UncertainGraph, "prm-graph", seed, variance=variance)


@command
def main(
    comparisons: int = 2000,
    samples: int = 1_000_000,
    graphs: Annotated[int, Option(help="roadmaps for the non-dominated sets")] = 100,
    walked: Annotated[int, Option(help="roadmaps that policies walk")] = 5,
    draws: Annotated[int, Option(help="walks on each")] = 20,
    seed: int = 1,
) -> tuple[str, bool]:
    parts = [compare(comparisons, samples, seed), share(samples, min(graphs, 10), seed), sets(graphs), (policies(walked, draws), True)]
    verdicts = [good for _, good in parts]
    lines = [line for part, _ in parts for line in part]
    targets = (
        f"{RATE:,.0f} comparisons a second, within {ERRORS:g} standard errors",
        "the same where edges are shared",
        f"non-dominated sets in {SECONDS:g} s",
    )
    lines += [f"{what}: {met(good)}" for what, good in zip(targets, verdicts, strict=False)]
    return "\n".join(lines), all(verdicts)
