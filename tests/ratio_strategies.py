"""Hypothesis strategies for small selection problems and sensing graphs, made so that they shrink to few elements and small weights."""

import numpy as np
from hypothesis import strategies as st

from waybound import BottleneckSATA, Cardinality, Knapsack, PartitionMatroid, SubmodularSelection, WinnerTakesAllSATA
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation

WEIGHTS = st.one_of(st.integers(0, 9).map(float), st.floats(1e-3, 10.0), st.sampled_from([1e-3, 1e3]))
"""Ties and zeros often, any size seldom."""


@st.composite
def functions(draw):
    n, items = draw(st.integers(1, 7)), draw(st.integers(1, 6))
    if draw(st.booleans()):
        sets = draw(st.lists(st.sets(st.integers(0, items - 1)), min_size=n, max_size=n))
        return Coverage.from_sets(sets, draw(st.lists(WEIGHTS, min_size=items, max_size=items)))
    matrix = np.array(draw(st.lists(st.lists(WEIGHTS, min_size=items, max_size=items), min_size=n, max_size=n)))
    if draw(st.booleans()):
        return DenseFacilityLocation(matrix)
    element, item = np.nonzero(matrix)
    starts = np.searchsorted(element, np.arange(n + 1)).astype(np.int32)
    return FacilityLocation(starts, item.astype(np.int32), matrix[element, item], items)


@st.composite
def selections(draw, *constraints):
    """A selection problem under one of the ``constraints``."""
    f = draw(functions())
    n, kind = f.num_elements, draw(st.sampled_from(constraints))
    if kind == "cardinality":
        rule = Cardinality(draw(st.integers(1, n)))
    elif kind == "partition":
        groups = draw(st.lists(st.integers(0, n - 1), min_size=n, max_size=n))
        rule = PartitionMatroid.of(groups, draw(st.lists(st.integers(1, 2), min_size=max(groups) + 1, max_size=max(groups) + 1)))
    else:
        rule = Knapsack(np.array(draw(st.lists(WEIGHTS, min_size=n, max_size=n))), draw(WEIGHTS))
    return SubmodularSelection(f, rule)


@st.composite
def graphs(draw, *, every_target_seen=False):
    """Up to 4 robots of up to 3 actions, and up to 5 targets."""
    owner = [robot for robot, own in enumerate(draw(st.lists(st.integers(1, 3), min_size=1, max_size=4))) for _ in range(own)]
    targets = draw(st.integers(1, 5))
    row = st.lists(WEIGHTS, min_size=targets, max_size=targets)
    weights = np.array(draw(st.lists(row, min_size=len(owner), max_size=len(owner))))
    if every_target_seen:
        unseen = np.nonzero(~(weights > 0).any(axis=0))[0]
        for target in unseen.tolist():
            weights[draw(st.integers(0, len(owner) - 1)), target] = 1.0
    action, target = np.nonzero(weights)
    return graph_of_edges(owner, action, target, weights[action, target], robots=max(owner) + 1, targets=targets)


def assignments():
    """Winner takes all."""
    return graphs().map(WinnerTakesAllSATA)


def bottlenecks():
    """Divisible robots, every target seen."""
    return graphs(every_target_seen=True).map(lambda graph: BottleneckSATA(graph, fractional=True))
