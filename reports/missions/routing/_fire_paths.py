"""Cheapest paths round a fire, over cells that cost more the nearer they are to it."""

from collections.abc import Sequence

import numpy as np

from ....instances.routing.spreading_fire import Flags, Floats, Whole, grid_moves, move_graph

SIDES = tuple((dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if (dx, dy) != (0, 0))
"""The eight directions in which a path leaves a cell."""


def cheapest_paths(burnt: Flags, places: Floats, blur: float, near: float, inside: float) -> tuple[Floats, Whole]:
    """Cost of the cheapest paths from ``places`` to all cells, and the cell before each; shape (places, cells). They are Dijkstra's.

    A unit of length costs 1, ``near`` times the fire blurred over ``blur`` cells, and ``inside`` in the fire: means of two cells.
    """
    from scipy import ndimage
    from scipy.sparse import csgraph

    cost = (1.0 + near * ndimage.gaussian_filter(burnt.astype(np.float64), blur) + inside * burnt).ravel()
    rows, columns = burnt.shape
    tail, head, way = grid_moves(rows, columns, SIDES)
    graph = move_graph(rows, columns, tail, head, np.hypot(*way.T) * (cost[tail] + cost[head]) / 2.0)
    costs, before = csgraph.dijkstra(graph, indices=cells_of(burnt, places), return_predecessors=True)
    return costs, before


def cells_of(burnt: Flags, places: Floats) -> Whole:
    """The cell of each place, by its number."""
    column, row = np.rint(places.T).astype(np.int64)
    return np.asarray(row * burnt.shape[1] + column)


def corners(burnt: Flags, before: Whole, origin: Floats, place: Floats) -> list[Floats]:
    """Corners of the path from ``origin`` on: centres of the cells between, and ``place`` itself."""
    start, cell = cells_of(burnt, np.vstack([origin, place])).tolist()
    way = [place]
    while cell != start and before[cell] != start:
        cell = int(before[cell])
        way.append(np.array([cell % burnt.shape[1], cell // burnt.shape[1]], dtype=np.float64))
    return way[::-1]


def advanced(place: Floats, way: Sequence[Floats], speed: float) -> tuple[Floats, list[Floats]]:
    """The place after a step along the corners of ``way``, and the corners that are left."""
    left, rest = speed * (1.0 + 1e-9), list(way)
    while rest:
        off = rest[0] - place
        length = float(np.hypot(*off))
        if length > left:
            return place + off * (left / length), rest
        place, left = rest.pop(0), left - length
    return place, rest
