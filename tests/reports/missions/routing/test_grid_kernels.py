import numpy as np
from hypothesis import given, strategies as st
from scipy.sparse.csgraph import dijkstra

from waybound.reports.missions.routing.grid_kernels import FAR, steps_from


@given(st.integers(0, 10**6), st.integers(1, 7), st.integers(1, 7), st.floats(0.3, 1.0))
def test_steps_are_shortest_paths(seed, height, width, share):
    rng = np.random.default_rng(seed)
    floor = np.pad(rng.random((height, width)) < share, 1)
    floor[1, 1] = True
    flat, wide = floor.ravel(), width + 2
    cells = np.flatnonzero(flat)
    beside = np.array([[abs(a - b) in (1, wide) for b in cells] for a in cells])
    start = int(rng.choice(cells))
    lengths = dijkstra(beside, unweighted=True, indices=int(np.searchsorted(cells, start)))
    steps = steps_from(flat, start, wide)
    assert [FAR if np.isinf(length) else length for length in lengths] == steps[cells].tolist()
    assert (steps[~flat] == FAR).all()
