"""From arcs to routes and back: what is no route is refused in words."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles import SQUARE_4, routing

from waybound.formulations.routing.forms._routes import ArcIndex, levels, routes_of, used
from waybound.formulations.routing.preparation import Preparation, Resource, prepare
from waybound.formulations.routing.routes import Route
from waybound.instances.errors import InputError

NAMES = list("oabcd")


def prepared(**more: Any) -> Preparation:
    return prepare(routing(xy=SQUARE_4, **more))


def arcs(prep: Preparation, *moves: tuple[int, int]) -> Any:
    """Positions of moves between nodes; 5 is the return."""
    tail, head = (np.array([m[k] for m in moves]) for k in (0, 1))
    return ArcIndex(prep).find(tail, head)


def test_arcs_become_routes_whatever_their_order() -> None:
    prep = prepared()
    found = routes_of(prep, arcs(prep, (2, 5), (0, 3), (4, 5), (3, 1), (0, 2), (1, 4)), NAMES)
    assert sorted(r.visits for r in found) == [(2,), (3, 1, 4)]


@pytest.mark.parametrize(
    ("moves", "words"),
    [
        ([(0, 1), (1, 2), (1, 3)], "site a is left twice"),
        ([(0, 1), (1, 2)], "a route ends at site b, away from the depot"),
        ([(0, 1), (1, 5), (2, 3), (3, 2)], "cycle without the depot; found b, c"),
    ],
)
def test_arcs_that_are_no_routes_are_refused(moves: list[tuple[int, int]], words: str) -> None:
    prep = prepared()
    with pytest.raises(InputError, match=words):
        routes_of(prep, arcs(prep, *moves), NAMES)


def test_points_are_read_as_0_and_1_within_what_solvers_leave() -> None:
    assert used(np.array([1e-6, 1 - 1e-6, 0.0, 1.0])).tolist() == [False, True, False, True]
    with pytest.raises(InputError, match=r"an arc 0\.5 away from 0 and 1"):
        used(np.array([0.0, 0.5]))
    with pytest.raises(InputError, match="an arc nan away"):
        used(np.array([0.0, np.nan]))


def test_moves_that_no_route_can_make_are_not_found() -> None:
    """At most 7 far, nobody goes on from one corner to the opposite one."""
    prep = prepared(max_distance=10.0)
    index = ArcIndex(prep)
    assert (index.find(np.array([0, 1, 0]), np.array([1, 5, 5])) >= 0).tolist() == [True, True, False]
    assert all(
        (prep.tail[k], prep.head[k]) == (i, j) for k, i, j in zip(index.find(prep.tail, prep.head), prep.tail, prep.head, strict=True)
    )
    with pytest.raises(InputError, match="no feasible route goes from c to d"):
        index.arcs_of(np.array([0, 3, 4, 5]), NAMES)
    with pytest.raises(InputError, match="visits site o, which is no customer"):
        index.nodes_of(Route((1, 0)), NAMES)
    with pytest.raises(InputError, match="visits site 9, which is no customer"):
        index.nodes_of(Route((9,)), NAMES)


def test_levels_are_sums_raised_to_what_a_node_asks_for() -> None:
    clock = Resource("time", np.array([3.0, 4.0, 2.0]), np.array([1.0, 6.0, 0.0, 0.0]), np.full(4, 99.0), waits=True)
    nodes, along = np.arange(4), np.arange(3)
    assert levels(clock, nodes, along).tolist() == [1.0, 6.0, 10.0, 12.0]
    assert levels(clock, nodes, along, 5.0).tolist() == [5.0, 8.0, 12.0, 14.0]
