import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import random_function

from waybound import Cardinality, SubmodularSelection
from waybound.formulations.stop import NEVER
from waybound.heuristics.sata.greedy_steps import multilinear_kernels as multilinear
from waybound.instances.sata.set_functions import AT_ITEM, Coverage, FacilityLocation

Function = Coverage | FacilityLocation


def data_of(f: Function) -> tuple[object, ...]:
    """What the kernels take, at x = 0."""
    layout, indptr, indices, weights, *_ = f.as_item_weights().arrays
    of_entry = weights[indices] if layout == AT_ITEM else weights
    owner = np.repeat(np.arange(f.num_elements), np.diff(indptr))
    order = np.lexsort((owner, -of_entry, indices))
    position = np.empty(len(order), np.int64)
    position[order] = np.arange(len(order))
    starts = np.concatenate([[0], np.cumsum(np.bincount(indices, minlength=f.num_items))]).astype(np.int64)
    given_weights = of_entry[order]
    state = np.ones(f.num_items) if layout == AT_ITEM else given_weights.copy()
    return state, position, starts, owner[order].astype(np.int32), given_weights, layout, indptr, indices, weights


def expected(f: Function, x: np.ndarray) -> float:
    """By enumerating all sets that may be drawn."""
    problem = SubmodularSelection(f, Cardinality(max(1, f.num_elements)))
    total = 0.0
    for flags in itertools.product((False, True), repeat=f.num_elements):
        chosen = np.array(flags, dtype=bool)
        total += float(np.prod(np.where(chosen, x, 1 - x))) * problem.value(np.nonzero(chosen)[0])
    return total


@given(st.integers(0, 10**6), st.sampled_from(["coverage", "facility-location"]), st.booleans())
def test_values_and_slopes_after_any_moves(seed: int, kind: str, whole: bool) -> None:
    rng = np.random.default_rng(seed)
    n, steps = int(rng.integers(1, 7)), 8
    f = random_function(rng, kind, n, whole=whole)
    assert isinstance(f, Coverage | FacilityLocation)
    data, count = data_of(f), np.zeros(n, np.int64)
    for _ in range(12):
        e = int(rng.integers(n))
        if count[e] < steps:
            multilinear.move(e, int(rng.integers(0, steps)), count, steps, data)
    x = count / steps
    if f.num_items:
        assert multilinear.value(NEVER.flag, count, steps, data) == pytest.approx(expected(f, x), abs=1e-9)
    for e in range(n):
        high, low = x.copy(), x.copy()
        high[e], low[e] = 1.0, 0.0
        assert multilinear.slope(e, count, steps, data) == pytest.approx(expected(f, high) - expected(f, low), abs=1e-9)


@given(st.integers(0, 10**6), st.sampled_from(["coverage", "facility-location"]))
def test_pipage_makes_whole_what_sums_to_whole_and_loses_nothing(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    n, steps = int(rng.integers(2, 8)), 6
    f = random_function(rng, kind, n)
    assert isinstance(f, Coverage | FacilityLocation)
    data, count = data_of(f), np.zeros(n, np.int64)
    room = int(rng.integers(1, n))
    for _ in range(steps):  # the sum of that many sets of `room` elements
        for e in rng.permutation(n)[:room].tolist():
            if count[e] + 1 < steps or kind != "coverage":
                multilinear.move(e, int(count[e]) + 1, count, steps, data)
    missing = room * steps - int(count.sum())
    for e in range(n):  # and what coverage could not take beside a full element goes elsewhere
        more = min(missing, steps - 1 - int(count[e]))
        if more > 0:
            multilinear.move(e, int(count[e]) + more, count, steps, data)
            missing -= more
    if missing:
        return
    before = expected(f, count / steps)
    multilinear.pipage(NEVER.flag, np.array([0, n]), np.arange(n), count, steps, data)
    assert set(count.tolist()) <= {0, steps} and int(count.sum()) == room * steps
    assert expected(f, count / steps) >= before - 1e-9
