from fractions import Fraction as F

import numpy as np
from draws import draws
from hypothesis import given, settings, strategies as st
from scipy.optimize import linprog
from truth.local_algorithm import ExactLocal, random_graph, robots_of


def exact_case(seed: int, h: int) -> ExactLocal:
    return ExactLocal(robots_of(random_graph(np.random.default_rng(seed), most_robots=5)), h)


def pair_optimum(exact: ExactLocal) -> float:
    """Optimum of the program with a row for each pair of a robot's actions in place of its own."""
    targets = sorted(exact.viewers)
    cover = np.zeros((len(targets), exact.size + 1))
    for row, k in enumerate(targets):
        cover[row, exact.viewers[k]] = [-float(exact.sees[v][k]) for v in exact.viewers[k]]
        cover[row, -1] = 1
    pairs = [(v, w) for v in range(exact.size) for w in exact.part[v]]
    pack = np.zeros((len(pairs), exact.size + 1))
    for row, (v, w) in enumerate(pairs):
        pack[row, v] += 1
        pack[row, w] += 1
    limits = np.r_[np.zeros(len(targets)), [float(exact.cap[v]) for v, _ in pairs]]
    found = linprog(np.r_[np.zeros(exact.size), -1], A_ub=np.vstack([cover, pack]), b_ub=limits, method="highs")
    return -float(found.fun)


@settings(max_examples=draws(40))
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_the_pairs_optimum_and_half_the_ceiling_are_valid_and_nothing_above_the_ceiling_is(seed: int, h: int) -> None:
    exact = exact_case(seed, h)
    levels, best = exact.largest_levels(), pair_optimum(exact)
    for level, ceiling in zip(levels, exact.ceilings, strict=True):
        assert ceiling / 2 <= level <= ceiling
        assert float(level) >= best * (1 - 1e-7)


@settings(max_examples=draws(40))
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_a_level_is_valid_exactly_up_to_the_largest(seed: int, h: int) -> None:
    exact = exact_case(seed, h)
    for root, level in enumerate(exact.largest_levels()):
        at, above = (exact.recursion(lambda v, layer, q=q: q) for q in (level, level * F(1001, 1000)))  # type: ignore[misc]
        assert exact.valid(root, at)
        assert not exact.valid(root, above)


@settings(max_examples=draws(40))
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_the_layered_solution_is_feasible_and_every_copy_gets_its_smoothed_level(seed: int, h: int) -> None:
    exact = exact_case(seed, h)
    levels = exact.largest_levels()
    z, smoothed = exact.copies(levels), exact.smoothed(levels)
    assert min(z.values()) >= 0
    for v in range(exact.size):
        for layer in range(h + 1):
            assert all(z["R", v, layer] + z["B", w, layer] <= exact.cap[v] for w in exact.part[v])
            if layer < h:
                for k in exact.sees[v]:
                    others = sum(exact.weight(k, w) * z["R", w, layer + 1] for w in exact.others(k, v))
                    assert exact.weight(k, v) * z["B", v, layer] + others >= smoothed(v, layer)


@settings(max_examples=draws(40))
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_averages_are_shares_and_every_target_gets_its_part_of_the_smoothed_levels(seed: int, h: int) -> None:
    exact = exact_case(seed, h)
    levels = exact.largest_levels()
    shares, smoothed = exact.shares(levels), exact.smoothed(levels)
    for mates in exact.mates:
        assert sum(shares[v] for v in mates) <= 1
        if len(mates) <= 2:
            assert sum(shares[v] for v in mates) == 1
    for k, viewers in exact.viewers.items():
        m = max(2, len(viewers))
        least = min(smoothed(v, layer) for v in viewers for layer in range(h))
        assert sum(exact.sees[v][k] * shares[v] for v in viewers) >= least / (2 * (1 - F(1, m)) * (1 + F(1, h)))
