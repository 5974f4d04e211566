from dataclasses import replace

import numpy as np
import pytest
from random_sensing import optimum
from truth.local_algorithm import random_graph

from waybound import BottleneckSATA, SensingGraph
from waybound.solvers.engines.sata.local_max_min.shares import local_shares

HEIGHTS = (1, 2, 3, 5, 10)


def worst_excess(graph: SensingGraph, best: float, h: int, **options: object) -> float:
    """How much more than guaranteed the optimum is, in parts of the guarantee: not positive where the guarantee holds."""
    run = local_shares(graph, h, **options)  # type: ignore[arg-type]
    value = float(BottleneckSATA(graph, fractional=True).coverage(run.shares).min())
    clean = run.clean
    ratio = clean.delta_r * (1 - 1 / clean.delta_t) * (1 + 1 / h) * (1 + run.relative_eps)
    return best / value / ratio - 1


def check(seeds: range, most_robots: int) -> None:
    for seed in seeds:
        graph = random_graph(np.random.default_rng(seed), most_robots=most_robots, most_actions=5)
        best = optimum(graph)
        for h in HEIGHTS:
            for normalise in (False, True):
                assert worst_excess(graph, best, h, eps=0.02, normalise=normalise) <= 1e-7, f"seed {seed}, h {h}"
        assert worst_excess(graph, best, 3, search="step", step=0.1) <= 1e-7, f"seed {seed}, step"
        assert worst_excess(graph, best, 3, smoothing="ball", normalise=False) <= 1e-7, f"seed {seed}, ball"


@pytest.mark.share(4)
@pytest.mark.parametrize("block", range(4))
def test_no_random_instance_breaks_the_guarantee(block: int) -> None:
    check(range(100 * block, 100 * (block + 1)), 12)


@pytest.mark.long
def test_none_of_ten_thousand_random_instances_breaks_the_guarantee() -> None:
    check(range(1000, 11000), 20)


@pytest.mark.slow
def test_the_step_search_would_break_a_guarantee_with_the_step_in_place_of_eps() -> None:
    # Small weights: a step of 0.1 is no relative precision of 0.1, and the run says so.
    rng, broken = np.random.default_rng(5), 0
    for _ in range(300):
        graph = random_graph(rng, most_robots=8, weights="unit")
        small = replace(graph, weights=rng.uniform(0.01, 1.0, graph.num_edges))
        best, run = optimum(small), local_shares(small, 5, search="step", step=0.1, normalise=False)
        value = float(BottleneckSATA(small, fractional=True).coverage(run.shares).min())
        ratio = run.clean.delta_r * (1 - 1 / run.clean.delta_t) * (1 + 1 / 5)
        broken += best / value > ratio * 1.1
        assert best / value <= ratio * (1 + run.relative_eps) * (1 + 1e-7)
    assert broken > 0
