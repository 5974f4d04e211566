import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.csgraph import maximum_flow

from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds.routing.cut_kernels import cuts_below, overloaded_sets


@pytest.fixture(autouse=True, scope="module")
def _kernels():
    """Compiled when they are used: not by every process that collects tests."""
    global cuts_below, overloaded_sets


def edges(capacity):
    """Arrays of the kernel, of a symmetric matrix."""
    tails, heads = np.nonzero(capacity)
    place = {edge: k for k, edge in enumerate(zip(tails.tolist(), heads.tolist(), strict=True))}
    twins = np.array([place[h, t] for t, h in zip(tails.tolist(), heads.tolist(), strict=True)], dtype=np.int64)
    return (
        np.searchsorted(tails, np.arange(len(capacity) + 1)), np.ascontiguousarray(heads), twins, capacity[tails, heads].astype(np.float64),
    )  # fmt: skip


def asked(capacity, need, node, stop=NEVER):
    inside = np.zeros((3, len(capacity)), dtype=bool)
    count = cuts_below(stop.flag, *edges(capacity), need, np.array([node]), 0.5, inside)
    return inside[:count]


@pytest.mark.parametrize("seed", range(6))
def test_a_cut_is_found_where_the_flow_is_less_than_needed_and_it_is_a_least_one(seed):
    rng = np.random.default_rng(seed)
    capacity = np.triu(rng.integers(1, 9, (9, 9)) * (rng.random((9, 9)) < 0.35), 1)
    capacity = capacity + capacity.T
    for node in range(1, 9):
        flow = maximum_flow(sp.csr_matrix(capacity.astype(np.int32)), 0, node).flow_value
        assert not len(asked(capacity, np.full(9, float(flow)), node))
        (found,) = asked(capacity, np.full(9, flow + 1.0), node)
        assert found[node] and not found[0]
        assert capacity[found][:, ~found].sum() == flow


def test_the_smaller_of_two_least_cuts_is_taken_and_nobody_in_it_is_asked_about_again():
    capacity = np.zeros((6, 6))
    for i, j, c in ((0, 1, 9), (1, 2, 1), (2, 3, 9), (3, 4, 1), (4, 5, 9)):
        capacity[i, j] = capacity[j, i] = c
    (found,) = asked(capacity, np.full(6, 2.0), 4)
    assert np.nonzero(found)[0].tolist() == [4, 5]
    inside = np.zeros((3, 6), dtype=bool)
    count = cuts_below(NEVER.flag, *edges(capacity), np.full(6, 2.0), np.array([5, 4, 3, 2, 1]), 0.5, inside)
    assert [np.nonzero(s)[0].tolist() for s in inside[:count]] == [[4, 5], [2, 3, 4, 5]]


def test_who_is_asked_to_stop_finds_nothing():
    stop = Stop()
    stop.ask()
    assert not len(asked(np.zeros((3, 3)), np.full(3, 2.0), 1, stop))


def overloaded(capacity, demand, largest, size=9):
    inside = np.zeros((9, len(capacity)), dtype=bool)
    starts, heads, _, flow = edges(capacity)
    keys = np.random.default_rng(1).random(len(capacity))
    count = overloaded_sets(NEVER.flag, starts, heads, flow, np.asarray(demand, dtype=np.float64), keys, largest, 0.1, size, inside)
    return [np.nonzero(members)[0].tolist() for members in inside[:count]]


def test_a_set_with_too_much_load_for_its_edges_is_found_once():
    # One route over 1, 2 and 3, another over 4 and 5.
    capacity = np.zeros((6, 6))
    for i, j in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (4, 5), (5, 0)):
        capacity[i, j] = capacity[j, i] = 1.0
    demand = [0.0, 2.0, 2.0, 2.0, 1.0, 2.0]
    assert overloaded(capacity, demand, 3.0)[0] in ([1, 2], [1, 2, 3])
    assert overloaded(capacity, demand, 5.0) == [[1, 2, 3]]
    assert overloaded(capacity, demand, 5.0, size=2) == []
    assert overloaded(capacity, demand, 6.0) == []
