import math

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.risk.occupancy import OccupancyGrid, classed, elevation, faded


def grid(*rows: str, cell: float = 1.0) -> OccupancyGrid:
    return OccupancyGrid(np.array([[c == "@" for c in row] for row in rows]), cell)


@pytest.mark.parametrize(("connectivity", "shape", "moves"), [(4, (3, 3), 24), (8, (3, 3), 40), (6, (2, 2, 2), 24), (26, (2, 2, 2), 56)])
def test_neighbours_of_an_empty_grid(connectivity, shape, moves):
    tail, head = OccupancyGrid(np.zeros(shape, dtype=bool)).arcs(connectivity)
    assert len(tail) == len(head) == moves
    assert {(a, b) for a, b in zip(tail, head, strict=True)} == {(b, a) for a, b in zip(tail, head, strict=True)}


def test_cells_that_share_distance_differ_in_scale_or_visibility_and_the_reverse():
    beside_wall = grid("@@@@@@@@@", ".........", ".........", ".........", ".........", cell=0.5)
    corridor = grid("@@@@@@@@@", ".........", "@@@@@@@@@", ".........", ".........", cell=0.5)
    a, b = beside_wall.state((1, 4)), corridor.state((1, 4))
    assert beside_wall.clearance()[a] == corridor.clearance()[b] == 0.5
    assert beside_wall.scale(0.4)[a] == pytest.approx(5.0) and corridor.scale(0.4)[b] == pytest.approx(1.25)
    wide, short = grid("." * 21, "@" * 21), grid("@" * 8 + "....." + "@" * 8, "@" * 21)
    c, d = wide.state((0, 10)), short.state((0, 10))
    assert wide.scale(1.0)[c] == short.scale(1.0)[d] == 1.0 and wide.clearance()[c] == short.clearance()[d] == 1.0
    assert wide.visibility(4)[c] > short.visibility(4)[d]


def test_isovists_end_at_walls_and_at_the_edge():
    room = grid(".....", ".....", "....@")
    assert room.visibility(4)[room.state((2, 1))] == pytest.approx((2.5 + 1.5 + 0.5 + 2.5) / 4)
    assert room.visibility(1)[room.state((0, 0))] == pytest.approx(4.5)
    rng = np.random.default_rng(1)
    noisy = OccupancyGrid(rng.random((6, 6)) < 0.3)
    at, boxes = noisy.positions, noisy.boxes
    for rays in (1, 8):
        seen = noisy.visibility(rays)
        for state in range(0, len(at), 5):
            total = 0.0
            for angle in np.arange(rays) * 2 * math.pi / rays:
                steps = np.arange(0, 9, 1e-3)[:, None] * [math.cos(angle), math.sin(angle)] + at[state]
                out = ((steps < 0) | (steps > 6)).any(axis=1)
                for x0, y0, x1, y1 in boxes:
                    out |= (steps[:, 0] > x0 + 1e-9) & (steps[:, 0] < x1 - 1e-9) & (steps[:, 1] > y0 + 1e-9) & (steps[:, 1] < y1 - 1e-9)
                total += float(np.argmax(out)) * 1e-3
            assert seen[state] == pytest.approx(total / rays, abs=2e-3)


def test_clearance_may_count_the_edge_of_the_map():
    room = grid("...", "...", "..@")
    assert room.clearance()[room.state((0, 0))] == pytest.approx(math.sqrt(8))
    assert room.clearance(edges=True)[room.state((0, 0))] == 1.0
    assert np.isinf(grid("..").clearance()).all()


def test_risks_fade_and_classes_step():
    assert faded([0, 1, 2, 3, math.inf], 1, 3, 0.04) == pytest.approx([0.04, 0.04, 0.02, 0, 0])
    assert classed([0.5, 1, 1.5, 2, 3], 0.3, 0.1, 0.01) == pytest.approx([0.3, 0.3, 0.1, 0.1, 0.01])
    assert elevation((0, 0, 0), [(0, 0, 2), (1, 0, 0), (1, 0, 1)]) == pytest.approx([90, 0, 45])


def test_places_of_cells():
    room = grid(".@", "..", cell=0.5)
    assert room.names == ("0,0", "1,0", "1,1")
    assert room.positions.tolist() == [[0.25, 0.25], [0.25, 0.75], [0.75, 0.75]]
    assert room.boxes.tolist() == [[0.5, 0, 1.0, 0.5]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: OccupancyGrid(np.zeros(3)), "rows and columns"),
        (lambda: OccupancyGrid(np.zeros((2, 2)), 0.0), "side of a cell must be positive"),
        (lambda: grid("..").arcs(6), "no such number of neighbours; expected 4, 8; found 6"),
        (lambda: grid(".@").state((0, 1)), "cell 0, 1 is occupied"),
        (lambda: grid(".@").state((0, 2)), "cell 0, 2 is not on the map"),
        (lambda: grid("..").scale(0), "size of the vehicle"),
        (lambda: grid("..").visibility(0), "1 to 3600 isovists"),
        (lambda: OccupancyGrid(np.zeros((2, 2, 2))).visibility(), "isovists are drawn in the plane"),
        (lambda: faded([1], 3, 1, 0.1), "from a smaller to a larger value"),
        (lambda: faded([1], 1, 3, 1.1), r"must lie in \[0, 1\]"),
    ],
)
def test_what_is_no_map_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
