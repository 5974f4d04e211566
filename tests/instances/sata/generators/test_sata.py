from typing import Any

import networkx as nx
import numpy as np
import pytest
from draws import draws
from file_cases import check_refused
from hypothesis import assume, given, settings, strategies as st

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate
from waybound.instances.generators import Draw
from waybound.instances.sata.generators.sata import _connecting, _others


def made(seed: int = 1, **given_settings: Any) -> Any:
    return generate("sata", seed, **given_settings)


@pytest.mark.parametrize(
    ("robots", "targets", "phi"), [(4, 50, 15), (20, 50, 15), (8, 50, 30), (3, 7, 100), (12, 200, 9.5), (40, 60, 33.3)]
)
def test_the_density_is_exact(robots: int, targets: int, phi: float) -> None:
    for seed in range(5):
        g = made(seed, robots=robots, targets=targets, phi=phi)
        assert (g.num_robots, g.num_actions, g.num_targets) == (robots, 2 * robots, targets)
        assert g.num_edges == round(phi / 100 * 2 * robots * targets)
        assert g.density == pytest.approx(phi, abs=50 / (2 * robots * targets) + 1e-9)


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(1, 9), st.integers(1, 4), st.integers(1, 12), st.floats(1, 100), st.integers(0, 10**9))
def test_every_action_and_target_has_an_edge_and_all_is_connected(robots: int, actions: int, targets: int, phi: float, seed: int) -> None:
    try:
        g = made(seed, robots=robots, actions=actions, targets=targets, phi=phi)
    except UsageError:
        assume(False)
    assert np.diff(g.indptr).min() >= 1
    assert np.diff(g.by_target.indptr).min() >= 1
    assert g.notes == ()
    assert nx.is_connected(g.to_networkx())
    assert (g.weights == 1).all()


def test_weights_are_binary_or_uniform() -> None:
    assert (made().weights == 1).all()
    weights = made(weights="uniform").weights
    assert weights.min() >= 0.5 and weights.max() <= 1.5
    assert weights.mean() == pytest.approx(1.0, abs=0.05)
    assert (made().indices == made(weights="uniform").indices).all()


def test_a_density_below_what_a_connected_graph_needs_is_refused_with_the_least_one() -> None:
    with pytest.raises(UsageError) as caught:
        made(robots=4, phi=12)
    message = str(caught.value)
    assert "phi=12 asks for 48 edges, but 53 are needed for an edge at every action and target of a connected graph" in message
    assert "ask for phi of at least 13.25" in message


def test_a_density_below_what_the_recipe_makes_is_refused_and_the_named_one_is_made() -> None:
    with pytest.raises(
        UsageError, match=r"phi=3\.5 asks for 70 edges, but with this seed it takes 89 edges to reach all and connect them"
    ) as caught:
        made(robots=20, phi=3.5)
    least = float(str(caught.value).split("at least ")[1].split(",")[0])
    assert made(robots=20, phi=least).num_edges == 89


def test_too_many_edges_are_refused_before_they_are_drawn() -> None:
    check_refused(UsageError, "at most 50000000 are made", made, robots=100_000, targets=100_000, phi=50)


@given(st.integers(0, 2**32 - 1), st.integers(2, 60), st.data())
def test_other_pairs_are_new_and_all_different(seed: int, pairs: int, data: st.DataObject) -> None:
    taken = np.array(sorted(data.draw(st.sets(st.integers(0, pairs - 1), max_size=pairs))), dtype=np.int64)
    count = data.draw(st.integers(0, pairs - len(taken)))
    others = _others(Draw(np.random.default_rng(seed)), taken, count, pairs)
    assert len(others) == count
    assert len(np.unique(np.concatenate([taken, others]))) == len(taken) + count
    assert count == 0 or (others.min() >= 0 and others.max() < pairs)


def test_added_edges_are_equally_likely() -> None:
    counts = np.zeros(30)
    for seed in range(600):
        for pairs, count in ((30, 4), (30, 20)):  # drawn one by one, and out of a permutation
            counts[_others(Draw(np.random.default_rng(seed)), np.array([3, 7]), count, pairs)] += 1
    assert counts[[3, 7]].sum() == 0
    expected = 600 * 24 / 28
    assert np.abs(np.delete(counts, [3, 7]) - expected).max() < 5 * np.sqrt(expected)


def test_the_shortest_connecting_prefix_is_found() -> None:
    owner = np.array([0, 0, 1, 1])  # robots 0 and 1; keys are action * 3 + target
    keys = np.array([0, 4, 6, 11, 10, 8])  # robot 0: targets 0, 1; robot 1: targets 0, 2, 1, 2
    assert _connecting(keys, 1, owner, 2, 3) == 4
    assert _connecting(keys, 5, owner, 2, 3) == 5
    assert _connecting(keys[:3], 1, owner, 2, 3) is None
