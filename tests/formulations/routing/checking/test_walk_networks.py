import itertools
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound.formulations.routing.checking import walk_networks
from waybound.formulations.routing.checking.relaxation import Resource
from waybound.formulations.routing.checking.walk_networks import BITS, FAR, Levels, Network, Row, network_of, whole_levels, with_needed


def resource(rng: np.random.Generator, n: int, scale: float) -> Resource:
    weight = rng.uniform(0.1, 1.0, (n, n)) * scale
    lower = np.append(0.0, rng.uniform(0.0, 2.0, n - 1) * scale)
    return Resource(weight, 0.0, lower, lower + rng.uniform(0.5, 3.0, n) * scale, 1e-14 * scale, 4.0 * scale)


def everywhere(n: int) -> np.ndarray:
    return ~np.eye(n, dtype=bool)


@settings(max_examples=draws(60), deadline=None)
@given(seed=st.integers(0, 10**6), scale=st.sampled_from([1e-9, 1.0, 0.3, 1e12]))
def test_walks_that_keep_their_levels_keep_the_whole_ones_too(seed: int, scale: float) -> None:
    rng, n = np.random.default_rng(seed), 5
    one = resource(rng, n, scale)
    levels = whole_levels([one], everywhere(n), counted=False)
    for walk in itertools.permutations(range(1, n), 3):
        level, whole = one.start, int(levels.start[0])
        for tail, head in itertools.pairwise([0, *walk, 0]):
            level = max(one.lower[head], level + one.weight[tail, head])
            whole = max(int(levels.lower[head, 0]), whole + int(levels.weight[0, tail, head]))
            if level > one.upper[head]:
                break
            assert whole <= levels.upper[head, 0]


def keeps(levels: Levels, walk: tuple[int, ...]) -> bool:
    """Whether a walk from the depot and back keeps its first level."""
    level = int(levels.start[0])
    for tail, head in itertools.pairwise([0, *walk, 0]):
        level = max(int(levels.lower[head, 0]), level + int(levels.weight[0, tail, head]))
        if level > levels.upper[head, 0]:
            return False
    return True


@pytest.mark.parametrize("seed", range(5))
def test_what_can_be_gone_can_be_gone_backwards(seed: int) -> None:
    n, rng = 5, np.random.default_rng(seed)
    one = resource(rng, n, 1.0)
    levels = whole_levels([replace(one, upper=np.append(5.0, one.upper[1:]))], everywhere(n), counted=False)
    walks = [walk for k in range(1, n) for walk in itertools.permutations(range(1, n), k)]
    kept = [keeps(levels, walk) for walk in walks]
    assert kept == [keeps(levels.backwards(), walk[::-1]) for walk in walks] and 0 < sum(kept) < len(kept)


def test_the_level_that_the_fewest_visits_use_up_comes_first() -> None:
    rng, n = np.random.default_rng(1), 4
    wide, tight = (resource(rng, n, 1.0) for _ in range(2))
    wide = replace(wide, upper=np.full(n, 1000.0))
    tight = replace(tight, upper=np.full(n, 2.0))
    levels = whole_levels([wide, tight], everywhere(n), counted=False)
    assert levels.weight.shape == (2, n, n) and levels.most <= 20
    assert levels.weight[0, 0, 1] / levels.weight[1, 0, 1] > 100  # both are as fine as their limits let them be


def test_visits_are_counted_where_walks_could_go_on_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    n, one = 12, resource(np.random.default_rng(1), 12, 1.0)
    assert whole_levels([one], everywhere(n), counted=False).weight.shape[0] == 1
    counted = whole_levels([one], everywhere(n), counted=True)
    assert (counted.weight[1] == everywhere(n)).all() and counted.upper[1, 1] == counted.most == n - 1
    still = one.weight.copy()
    still[1, 2] = 0.0
    last = whole_levels([replace(one, weight=still)], everywhere(n), counted=False)
    assert (last.weight[1] == everywhere(n)).all()
    nothing = whole_levels([replace(one, weight=np.zeros((n, n)))], everywhere(n), counted=False)
    assert (nothing.weight[0] == everywhere(n)).all()
    monkeypatch.setattr(walk_networks, "LONGEST", 1)
    assert whole_levels([one], everywhere(n), counted=False).weight.shape[0] == 2


def made(n: int, rows: list[tuple[Row, int]], seed: int = 1) -> Network:
    rng = np.random.default_rng(seed)
    usable = everywhere(n) & (rng.random((n, n)) < 0.7)
    levels = whole_levels([resource(rng, n, 1.0)], usable, counted=False)
    listed = np.tile(np.arange(n, dtype=np.int32), (n, 1))
    listed = np.array([[k for k in row if k not in (0, j)] + [-1] * (j == 0) for j, row in enumerate(listed)][1:], dtype=np.int32)
    listed = np.vstack([np.full((1, listed.shape[1]), -1, np.int32), listed])
    return network_of(rng.integers(-9, 9, (n, n)), usable, levels, listed, rows)


def test_a_network_lists_the_moves_of_each_node_and_who_is_remembered() -> None:
    network = made(6, [])
    tails = np.repeat(np.arange(6), np.diff(network.first))
    assert len(tails) == len(network.moves) and not network.moves[:, 1].any()
    assert (network.listed[1:, 1] == np.arange(1, 6)).all() and (network.listed[:, 0] == -1).all() and (network.place[0] == -1).all()
    for j, k in itertools.product(range(1, 6), repeat=2):
        assert network.listed[j, network.place[j, k]] == k
    marked = with_needed(network, np.arange(len(tails)) % 2)
    assert (marked.moves[:, 1] == np.arange(len(tails)) % 2).all() and not network.moves[:, 1].any()


def test_nobody_counts_as_out_of_reach_to_whom_a_way_leads() -> None:
    for seed in range(20):
        network = made(6, [], seed)
        way = np.full((6, 6), FAR // 4)
        tails = np.repeat(np.arange(6), np.diff(network.first))
        way[tails, network.moves[:, 0]] = network.moves[:, 3]
        for m in range(1, 6):
            way = np.minimum(way, way[:, m, None] + way[None, m])
        for j, k in itertools.permutations(range(1, 6), 2):
            if way[j, k] < FAR // 4:
                assert network.reach[j, network.place[j, k], 0] >= network.upper[k, 0] - way[j, k]


def test_rows_have_a_bit_wherever_they_are_remembered() -> None:
    rng, n = np.random.default_rng(1), 9
    rows = []
    for k in range(2 * BITS):
        sites = rng.choice(np.arange(1, n), 3, replace=False)
        rows.append((Row(sites, np.union1d(sites, rng.choice(np.arange(1, n), 5)), -1.0), k + 1))
    network = made(n, rows)
    for k, (row, price) in enumerate(rows):
        for j in range(n):
            bit = network.row_place[j, k]
            assert (bit >= 0) == (j in row.memory)
            if bit >= 0:
                assert network.rows_at[j, bit] == k and network.prices[j, bit] == price
                assert (network.turned[j, bit // BITS] >> (bit % BITS)) & 1 == (j in row.sites)


def test_levels_that_fall_are_refused() -> None:
    one = resource(np.random.default_rng(1), 4, 1.0)
    with pytest.raises(OverflowError):
        whole_levels([replace(one, weight=-one.weight)], everywhere(4), counted=False)
