import itertools
import math

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.risk.obstacles import blocked, boxes_of
from waybound.instances.risk.tether import Tether

BOXES = [[1, 1, 2, 2], [3, 0, 4, 1.5], [2.5, 2.5, 3.5, 4]]


def walk(seed: int, steps: int = 60):
    """Short moves that pass through no obstacle, from beside the reel."""
    rng, boxes, at = np.random.default_rng(seed), boxes_of(BOXES), np.array([0.3, 0.3])
    made = [at]
    while len(made) < steps:
        nearer = at + rng.uniform(-0.3, 0.35, 2)
        if (nearer >= 0).all() and (nearer <= 5).all() and not blocked(at, nearer, boxes)[0]:
            at = nearer
            made.append(at)
    return made


@pytest.mark.parametrize("seed", range(6))
def test_no_part_of_a_tether_passes_through_an_obstacle_and_every_contact_is_a_corner(seed):
    tether, boxes = Tether((0.1, 0.2), BOXES, spacing=0.05), boxes_of(BOXES)
    corners = {(x, y) for x0, y0, x1, y1 in BOXES for x in (x0, x1) for y in (y0, y1)}
    for (contacts, length), at in zip(tether.along(path := walk(seed)), path, strict=True):
        points = [*contacts, tuple(at)]
        assert not any(bool(blocked(a, b, boxes)[0]) for a, b in itertools.pairwise(points))
        assert set(contacts[1:]) <= corners
        assert length == pytest.approx(sum(math.dist(a, b) for a, b in itertools.pairwise(points)))
        assert length >= math.dist((0.1, 0.2), at) - 1e-12


def test_the_way_back_takes_every_contact_off_again():
    tether = Tether((0, 0), [[1, 1, 2, 2]], spacing=0.1)
    way = [(3, 0), (3, 2), (2.5, 3), (1, 3), (-1, 1), (-1, 0.2)]
    assert [len(contacts) - 1 for contacts, _ in tether.along([*way, *way[::-1]])] == [0, 1, 1, 2, 3, 3, 3, 3, 2, 1, 1, 0]


def test_walls_of_several_boxes_bend_a_tether_at_their_ends_alone():
    whole = Tether((0, 0), [[-1, 1, 3, 2]], spacing=0.1)
    parts = Tether((0, 0), [[-1, 1, 1, 2], [1, 1, 3, 2]], spacing=0.1)
    way = [(4, 0), (4, 3), (0, 3)]
    assert whole.along(way)[-1] == parts.along(way)[-1]


@pytest.mark.parametrize(("spacing", "waypoints"), [(0.2, 31), (0.5, 13), (1.0, 7), (1.5, 5), (3.0, 3)])
def test_a_spacing_cuts_a_move_at_as_many_waypoints_as_in_the_source(spacing, waypoints, monkeypatch):
    ends = []
    monkeypatch.setattr(Tether, "_piece", lambda self, contacts, before, after: ends.append(after) or contacts)
    Tether((0, 0), [], spacing).moved(((0.0, 0.0),), (1, 0), (7, 0))
    assert len(ends) + 1 == waypoints and ends[-1] == pytest.approx([7, 0])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Tether((0, 0), [[0, 0, 0, 1, 1, 1]]), "obstacles in the plane"),
        (lambda: Tether((0, 0, 0), []), "point of the plane"),
        (lambda: Tether((0, 0), [], spacing=0), "spacing of a tether must be positive"),
        (lambda: Tether((0, 0), BOXES).along([(5, 5)]), "cannot be seen from the reel"),
        (lambda: Tether((0, 0), BOXES).along([(0, 1.5), (2.2, 1.5)]), "leads through an obstacle"),
    ],
)
def test_what_is_no_tether_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
