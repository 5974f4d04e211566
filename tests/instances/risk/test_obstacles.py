import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.risk.obstacles import blocked, boxes_of, merged_boxes, visible


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ((0, 0), (3, 3), True),
        ((0, 1), (3, 1), False),  # along a side
        ((0, 0), (1, 1), False),  # to a corner
        ((0, 2), (2, 0), False),  # past a corner
        ((0, 1.5), (0.9, 1.5), False),  # ends before it
        ((1.5, 1.5), (1.6, 1.5), True),  # inside
        ((1.5, 0), (1.5, 3), True),
    ],
)
def test_touching_is_allowed_and_passing_through_is_not(start, end, expected):
    boxes = boxes_of([[1, 1, 2, 2]])
    assert bool(blocked(start, end, boxes)[0]) is expected
    assert bool(blocked(end, start, boxes)[0]) is expected


def test_no_line_slips_between_boxes_that_touch():
    wall = boxes_of([[0, 1, 1, 2], [1, 1, 2, 2]])
    assert bool(blocked((1, 0), (1, 3), wall)[0])
    assert not bool(blocked((1, 0), (1, 1), wall)[0])
    assert not bool(blocked((2, 0), (2, 3), wall)[0])


def test_many_segments_in_space():
    boxes = boxes_of([[1, 1, 1, 2, 2, 2]])
    ends = np.array([(3, 3, 3), (3, 3, 0), (0, 0, 3)])
    assert blocked((0, 0, 0), ends, boxes).tolist() == [True, False, False]


def test_cells_behind_an_obstacle_are_out_of_sight():
    points = [(x + 0.5, y + 0.5) for y in range(4) for x in range(4)]
    kept = visible((0.5, 0.5), points, [[1, 1, 2, 2]]).reshape(4, 4)
    assert kept.tolist() == [[True] * 4, [True, False, False, True], [True, False, False, False], [True, True, False, False]]


def test_occupied_cells_become_few_boxes_of_the_same_area():
    rng = np.random.default_rng(0)
    for _ in range(20):
        occupied = rng.random((6, 7)) < 0.4
        boxes = merged_boxes(occupied, 0.5)
        drawn = np.zeros((6, 7), dtype=int)
        for x0, y0, x1, y1 in (boxes * 2).astype(int).tolist():
            drawn[y0:y1, x0:x1] += 1
        assert (drawn == occupied).all()
    assert merged_boxes(np.ones((3, 4), dtype=bool)).tolist() == [[0, 0, 4, 3]]


@pytest.mark.parametrize(
    ("boxes", "message"),
    [
        ([[1, 2, 3]], "must be boxes of 4 numbers"),
        ([[2, 2, 1, 3]], "obstacle 0 must have finite corners"),
        ([[0, 0, 1, float("nan")]], "finite"),
    ],
)
def test_what_is_no_box_is_refused(boxes, message):
    with pytest.raises(InputError, match=message):
        boxes_of(boxes)
