"""First-order methods for the whole game of a max-min linear program: passes over the graph until the gap is small.

A pass is a product with the matrix and one with its transpose; mirror-prox takes two a step. Predictive regret matching+ and the restarted
Halpern method are the saddle engine's own loops. What they are compared with is written in numpy, for counts and not for seconds:
primal-dual hybrid gradients restarted at their mean, as PDLP does (Applegate et al. 2021), the same with polishing of the answer
(Applegate et al. 2024: after a restart, an eighth of the passes so far goes on shares alone, to reach what the bound allows), and entropic
mirror-prox (Nemirovski 2004) with steps as long as its theory allows. Gaps are between the best value and the best bound seen.
"""

import math
from collections.abc import Callable, Iterator
from typing import Annotated

import numpy as np
from scipy.sparse import csr_matrix

from waybound.formulations.sata.balls import Floats, coverage, even_shares, weights_bound
from waybound.formulations.stop import Stop
from waybound.instances.sata.sensing_graph import SensingGraph
from waybound.solvers.engines.sata.saddle_steps.game import Game, Limits, Record, RegretMatching
from waybound.solvers.engines.sata.saddle_steps.halpern import FIRST_WEIGHT, HalpernPrimalDual
from waybound.solvers.engines.sata.saddle_steps.programs import Programs

from ._harness import Option, command
from .saddle import FAMILIES, GAPS

ROUND = 40
"""Passes between two looks at the gap."""

Pair = tuple[Floats, Floats]
Method = Callable[[SensingGraph], Iterator[tuple[int, tuple[Pair, ...]]]]
"""Passes so far, and pairs of shares and prices to be looked at, without an end."""


def own(kind: type[RegretMatching] | type[HalpernPrimalDual]) -> Method:
    def method(graph: SensingGraph) -> Iterator[tuple[int, tuple[Pair, ...]]]:
        limits = Limits(Stop(math.inf))
        loop = kind(Game(graph, Record(graph, 0.0), limits, Programs(limits.stop)))
        while True:
            loop.run(ROUND)
            yield loop.steps, (loop.means(),)

    return method


class Sides:
    """The matrix of a graph, step sizes, and projections."""

    def __init__(self, graph: SensingGraph) -> None:
        self.owner, self.robots, self.targets = graph.robot_of_action, graph.num_robots, graph.num_targets
        self.matrix = csr_matrix((graph.weights, graph.indices, graph.indptr), (graph.num_actions, graph.num_targets))
        self.transposed = self.matrix.T.tocsr()
        load, heaviest = np.asarray(self.matrix.sum(axis=1)).ravel(), np.zeros(self.robots)
        np.maximum.at(heaviest, self.owner, load)
        self.tau, self.sigma = 1.0 / heaviest[self.owner], 1.0 / np.asarray(self.matrix.sum(axis=0)).ravel()

    def shares(self, aims: Floats) -> Floats:
        """The projection of ``aims`` on shares that sum to 1 for each robot."""
        kept = np.ones(len(aims), bool)
        while True:
            total = np.bincount(self.owner, np.where(kept, aims, 0.0), self.robots) - 1.0
            above = aims > (total / np.bincount(self.owner, kept, self.robots))[self.owner]
            if not (kept & ~above).any():
                return np.maximum(0.0, aims - (total / np.bincount(self.owner, kept, self.robots))[self.owner])
            kept &= above

    def prices(self, aims: Floats) -> Floats:
        """The nearest prices that sum to their number, distances in parts of ``sigma``."""
        breaks = np.argsort(-aims / self.sigma)
        total, slope = np.cumsum(aims[breaks]), np.cumsum(self.sigma[breaks])
        level = (self.targets - total) / slope
        last = int(np.nonzero(aims[breaks] + level * self.sigma[breaks] > 0.0)[0][-1])
        return np.asarray(np.maximum(0.0, aims + level[last] * self.sigma))


def restarted(polish: bool) -> Method:
    def method(graph: SensingGraph) -> Iterator[tuple[int, tuple[Pair, ...]]]:
        sides, weight, passes, since, last = Sides(graph), FIRST_WEIGHT, 0, 0, math.inf
        x, y = even_shares(graph), np.ones(graph.num_targets)
        start, mean = (x, y), (np.zeros(len(x)), np.zeros(len(y)))
        while True:
            for _ in range(ROUND):
                new = sides.shares(x + weight * sides.tau * (sides.matrix @ y))
                y = sides.prices(y - sides.sigma / weight * (sides.transposed @ (2.0 * new - x)))
                x, since = new, since + 1
                mean = mean[0] + (x - mean[0]) / since, mean[1] + (y - mean[1]) / since
            passes += ROUND
            here, there = both(graph, (x, y)), both(graph, mean)
            yield passes, ((x, y), mean)
            gaps = here[1] - here[0], there[1] - there[0]
            if min(gaps) < 0.5 * last or since > 0.5 * passes:
                x, y = mean if gaps[1] < gaps[0] else (x, y)
                far = math.sqrt(float(((x - start[0]) ** 2 / sides.tau).sum()))
                wide = math.sqrt(float(((y - start[1]) ** 2 / sides.sigma).sum()))
                weight = math.sqrt(weight * far / wide) if far > 0.0 and wide > 0.0 else weight
                last, since, start, mean = min(gaps), 0, (x, y), (np.zeros(len(x)), np.zeros(len(y)))
                if polish:
                    steps = max(ROUND, passes // 8)
                    passes += steps
                    yield passes, ((polished(sides, x, min(here[1], there[1]), weight, steps), y),)

    return method


def polished(sides: Sides, x: Floats, level: float, weight: float, steps: int) -> Floats:
    """Shares near ``x`` that cover all targets up to ``level``, as near as so many steps come: prices from 0, without a sum."""
    y = np.zeros(sides.targets)
    for _ in range(steps):
        new = sides.shares(x + weight * sides.tau * (sides.matrix @ y))
        y = np.maximum(0.0, y + sides.sigma / weight * (level - sides.transposed @ (2.0 * new - x)))
        x = new
    return x


def mirror_prox(graph: SensingGraph) -> Iterator[tuple[int, tuple[Pair, ...]]]:
    """Extragradient steps in the entropies of the shares of each robot and of the prices."""
    sides, n, steps = Sides(graph), graph.num_targets, 0
    x, y, mean = even_shares(graph), np.full(n, 1.0 / n), (np.zeros(graph.num_actions), np.zeros(n))
    heaviest = np.zeros(graph.num_robots)
    np.maximum.at(heaviest, sides.owner, np.maximum.reduceat(graph.weights, graph.indptr[:-1]))

    def moved(at: Pair) -> Pair:
        ahead = x * np.exp(n / heaviest[sides.owner] * (sides.matrix @ at[1]))
        cover = sides.transposed @ at[0]
        prices = y * np.exp((cover.min() - cover) / graph.weights.max())
        ahead = np.maximum(ahead / np.bincount(sides.owner, ahead, graph.num_robots)[sides.owner], 1e-200)
        return ahead, np.maximum(prices / prices.sum(), 1e-200)

    while True:
        for _ in range(ROUND // 2):
            half = moved((x, y))
            x, y = moved(half)
            steps += 1
            mean = mean[0] + (half[0] - mean[0]) / steps, mean[1] + (half[1] - mean[1]) / steps
        yield 2 * steps, ((x, y), mean)


METHODS: dict[str, Method] = {
    "regret matching": own(RegretMatching),
    "restarted Halpern": own(HalpernPrimalDual),
    "restarted at the mean": restarted(False),
    "the same, polished": restarted(True),
    "mirror-prox": mirror_prox,
}


def both(graph: SensingGraph, pair: Pair) -> tuple[float, float]:
    """Value of the shares and bound of the prices."""
    return float(coverage(graph, pair[0]).min()), weights_bound(graph, np.arange(graph.num_targets), pair[1])


def passes_until(method: Method, graph: SensingGraph, most: int) -> tuple[list[int | None], float]:
    """Passes until each of ``GAPS``, none where that takes more than ``most``; and the gap at the end."""
    value, bound, gap = 0.0, math.inf, math.inf
    counts: dict[float, int | None] = dict.fromkeys(GAPS)
    for passes, pairs in method(graph):
        for pair in pairs:
            reached = both(graph, pair)
            value, bound = max(value, reached[0]), min(bound, reached[1])
        gap = (bound - value) / value if value > 0.0 else math.inf
        for wanted in GAPS:
            if gap <= wanted and counts[wanted] is None:
                counts[wanted] = passes
        if passes >= most or counts[GAPS[-1]] is not None:
            break
    return [counts[wanted] for wanted in GAPS], gap


@command
def main(
    families: Annotated[tuple[str, ...], Option(choices=FAMILIES)] = ("expander", "planted", "torus"),
    robots: int = 10_000,
    methods: Annotated[tuple[str, ...], Option(choices=METHODS)] = tuple(METHODS),
    most: Annotated[int, Option(help="passes of a method")] = 4_000,
) -> None:
    print(f"{'family':12s}{'method':24s}" + "".join(f"{f'to {gap:.0e}':>9s}" for gap in GAPS) + f"{'gap':>10s}")
    for family in families:
        graph = FAMILIES[family](robots)
        for name in methods:
            until, gap = passes_until(METHODS[name], graph, most)
            print(f"{family:12s}{name:24s}" + "".join(f"{'-' if n is None else n:>9}" for n in until) + f"{gap:10.1e}", flush=True)
