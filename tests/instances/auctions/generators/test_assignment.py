import numpy as np
import pytest
from file_cases import check_refused

from waybound import BinAssignment, UsageError
from waybound.instances.auctions.generators.assignment import orchard_distance
from waybound.instances.generating import generate


@pytest.mark.parametrize(
    ("a", "b", "cells", "unloaded"),
    [
        ((0, 0), (0, 5), 5, 3), ((0, 0), (3, 4), 7, 4), ((2, 2), (4, 3), 7, 4), ((2, 7), (4, 8), 5, 3), ((1, 4), (3, 5), 11, 6),
        ((1, 5), (3, 5), 10, 5), ((0, 0), (4, 8), 12, 6), ((0, 9), (4, 0), 13, 7), ((0, 0), (9, 8), 17, 9),
    ],
)  # fmt: skip
def test_lanes_are_changed_in_the_headlands(a: tuple[int, int], b: tuple[int, int], cells: int, unloaded: int) -> None:
    found = orchard_distance(np.array([a]), np.array([b]), 10)
    assert found.tolist() == [[cells]] and np.ceil(found / 2.0).item() == unloaded


@pytest.mark.parametrize("lanes", [5, 10])
def test_distances_are_those_of_shortest_paths(lanes: int) -> None:
    cells = np.array([(r, c) for r in range(lanes) for c in range(10)])
    step = np.abs(cells[:, None] - cells[None])
    joined = (step.sum(axis=2) == 1) & ((step[:, :, 0] == 0) | np.isin(cells[:, 1], (0, 9))[:, None])
    far = np.where(joined, 1.0, np.inf)
    np.fill_diagonal(far, 0.0)
    for k in range(len(cells)):
        far = np.minimum(far, far[:, [k]] + far[[k]])
    np.testing.assert_array_equal(orchard_distance(cells, cells, 10), far)
    assert far.max() == {5: 13, 10: 18}[lanes]


@pytest.mark.parametrize("costs", ["uniform", "whole", "euclidean", "orchard"])
@pytest.mark.parametrize("arcs", [0, 3])
def test_every_robot_has_as_many_bins_as_are_asked_for_and_can_be_matched(costs: str, arcs: int) -> None:
    made = generate("assignment", 3, robots=12, bins=15, costs=costs, arcs=arcs)
    degree = np.diff(made.indptr)
    assert made.complete if not arcs else degree.max() <= 3 and degree.min() >= 1
    assert BinAssignment(made).pairs == 12


def test_too_many_pairs_are_refused() -> None:
    check_refused(UsageError, "more than 50,000,000 pairs; set arcs", generate, "assignment", 1, robots=100_000, bins=100_000)
