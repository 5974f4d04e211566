import numpy as np
import pytest
from coded import coded
from scipy.sparse.csgraph import shortest_path

from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.errors import InputError

# from, to, distance, empty, full
GEOMETRY = [
    ((0, 0), (0, 5), 5, 3, 5), ((0, 0), (3, 4), 7, 4, 7), ((2, 2), (4, 3), 7, 4, 7), ((2, 7), (4, 8), 5, 3, 5), ((1, 4), (3, 5), 11, 6, 11),
    ((1, 5), (3, 5), 10, 5, 10), ((0, 0), (4, 8), 12, 6, 12), ((0, 9), (4, 0), 13, 7, 13), ((0, 0), (9, 8), 17, 9, 17),
]  # fmt: skip


@pytest.mark.parametrize(("start", "end", "distance", "empty", "full"), GEOMETRY)
def test_distances_and_times_are_those_of_the_reference(start, end, distance, empty, full):
    grid = OrchardGrid(10, 10)
    a, b = grid.cell(*start), grid.cell(*end)
    assert (grid.distances[a, b], grid.empty_times[a, b], grid.full_times[a, b]) == (distance, empty, full)


@pytest.mark.parametrize(("rows", "columns"), [(1, 6), (4, 5), (5, 10), (10, 10)])
def test_distances_are_shortest_ways_of_the_lanes(rows, columns):
    from scipy.sparse import lil_matrix

    grid = OrchardGrid(rows, columns)
    edges = lil_matrix((grid.size, grid.size))
    for row in range(rows):
        for column in range(columns):
            if column + 1 < columns:
                edges[grid.cell(row, column), grid.cell(row, column + 1)] = 1
            if row + 1 < rows and column in (0, columns - 1):
                edges[grid.cell(row, column), grid.cell(row + 1, column)] = 1
    assert (grid.distances == shortest_path(edges.tocsr(), directed=False, unweighted=True)).all()


def test_times_are_metrics():
    grid = OrchardGrid(5, 7, 2, empty_speed=3, full_speed=2)
    for times in (grid.empty_times, grid.full_times):
        assert (times[:, :, None] + times[None, :, :] >= times[:, None, :]).all()
        assert (times == times.T).all()


def test_the_way_between_two_cells_is_as_long_as_it_should_be():
    grid = OrchardGrid(4, 6)
    for a in range(grid.size):
        for b in range(grid.size):
            length = int(grid.distances[a, b])
            places = np.array([grid.along(a, b, k) for k in range(length + 1)])
            assert tuple(places[0]) == divmod(a, 6)
            assert tuple(places[-1]) == divmod(b, 6)
            assert (np.abs(np.diff(places, axis=0)).sum(axis=1) == 1).all()


def test_headlands_are_not_harvested():
    assert OrchardGrid(10, 10).harvested.size == 80
    assert OrchardGrid(5, 10).harvested.size == 40
    assert set(OrchardGrid(2, 4).harvested.tolist()) == {1, 2, 5, 6}


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"rows": 0}, "out-of-range"), ({"columns": 2}, "out-of-range"), ({"repository": 5}, "out-of-range"),
        ({"empty_speed": 0}, "out-of-range"), ({"full_speed": 1.5}, "out-of-range"), ({"rows": 100, "columns": 100}, "too-large"),
    ],
)  # fmt: skip
def test_sizes_out_of_range_are_refused(wrong, code):
    with pytest.raises(InputError, check=coded(code)):
        OrchardGrid(**{"rows": 5, "columns": 6, **wrong})


def test_cells_outside_are_refused():
    with pytest.raises(InputError, match=r"cell \(5, 0\) lies outside"):
        OrchardGrid(5, 6).cells([(0, 0), (5, 0)])
