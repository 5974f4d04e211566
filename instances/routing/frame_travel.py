"""Distances and durations as people have them: matrices, lists of moves, road graphs, and what routing services answer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from ..clock import Times
from ..errors import InputError
from ..number_arrays import Flags, Floats
from .foreign_names import hint, ours
from .frame_columns import id_text
from .routing_service import table_from_file, table_of
from .sites import in_lines

Ids = tuple[str, ...]

MOVES = ("from", "to", "distance", "duration")
"""Titles of a list of moves; durations may be missing."""
UNUSED = "columns of moves that are not used: "


@dataclass(frozen=True, eq=False)
class Moves:
    """Distances between all sites, shape (sites, sites), durations where there are any, and the moves that cannot be made.

    Distances are finite; those of moves that cannot be made mean nothing.
    """

    distances: Floats
    durations: Floats | None = None
    forbidden: Flags | None = None
    notes: tuple[str, ...] = ()


def moves_of(travel: Any, durations: Any, sites: Ids, nodes: Ids, times: Times, weight: str, unit: str) -> Moves:
    """Moves as ``travel`` and ``durations`` of ``instance_from_frame`` give them.

    ``travel`` is a matrix, a frame, a list of moves, a sparse road graph, a networkx graph, a service's table or its file; ``durations`` a
    matrix or a frame, or the name of an attribute of edges. ``nodes`` are the names of the sites in a networkx graph, ``weight`` is its
    attribute of distances, and ``unit`` the unit of distance in which a service's answer is wanted.
    """
    notes: tuple[str, ...] = ()
    own: Floats | None = None
    if isinstance(travel, str | PathLike | Mapping):
        table = table_of(travel) if isinstance(travel, Mapping) else table_from_file(travel)
        distance, own, notes = table.in_units(unit, times.unit)
        distance = _sized(distance, sites, "distance")
        own = None if own is None else _sized(own, sites, "duration")
    elif is_graph(travel):
        distance = _along_roads(travel, nodes, sites, weight, "distance")
        if isinstance(durations, str):
            own, durations = _along_roads(travel, nodes, sites, durations, "duration"), None
    elif is_list(travel, sites):
        distance, own, notes = listed_moves(travel, sites, times)
        if own is not None and durations is not None:
            raise InputError("durations are given twice", "duplicate", expected="durations, or the column duration of the moves")
    else:
        distance = matrix_of(travel, sites, "distance", None)
    own = own if durations is None else matrix_of(durations, sites, "duration", times)
    return Moves(*without_infinities(distance, own), notes)


def is_graph(travel: Any) -> bool:
    """True if it looks like a networkx graph."""
    return hasattr(travel, "edges") and hasattr(travel, "nodes")


def without_infinities(distances: Floats, durations: Floats | None) -> tuple[Floats, Floats | None, Flags | None]:
    """The same with finite numbers, and the moves that were infinite, which cannot be made; None for none.

    Their numbers are then twice the largest one of the matrix, so that methods which look at numbers alone leave them out too.
    """
    shut = np.isinf(distances) if durations is None else np.isinf(distances) | np.isinf(durations)
    np.fill_diagonal(shut, True)
    distances, durations = _filled(distances, shut), None if durations is None else _filled(durations, shut)
    np.fill_diagonal(shut, False)
    return distances, durations, shut if shut.any() else None


def _filled(values: Floats, shut: Flags) -> Floats:
    filled = np.where(shut, 2.0 * float(values[~shut].max(initial=0.0)), values)
    np.fill_diagonal(filled, 0.0)
    return filled


def matrix_of(values: Any, ids: Ids, what: str, times: Times | None) -> Floats:
    """A square matrix in the order of the sites, from an array, a frame with the ids as labels, or a sparse road graph."""
    if hasattr(values, "tocsr"):
        return _sized(_shortest_paths(values, ids, what), ids, what)
    if isinstance(values, str | bytes | PathLike | Mapping):
        raise InputError(f"the {what} matrix must be an array or a frame", found=f"{type(values).__name__} {str(values)[:60]!r}")
    shape = tuple(getattr(values, "shape", None) or np.shape(values))
    if shape != (len(ids), len(ids)):
        _refuse_shape(shape, ids, what)
    if hasattr(values, "columns"):
        values = in_order(values, ids, what)
    try:
        matrix = np.array(values, dtype=np.float64) if times is None else times.spans(values, f"the {what} matrix")
    except (TypeError, ValueError) as error:
        raise InputError(f"the {what} matrix must hold numbers", found=str(error)) from None
    return _sized(matrix, ids, what)


def _refuse_shape(shape: tuple[int, ...], ids: Ids, what: str) -> None:
    n = len(ids)
    raise InputError(f"the {what} matrix and the sites have different sizes", "wrong-shape", expected=f"({n}, {n})", found=str(shape))


def _sized(matrix: Floats, ids: Ids, what: str) -> Floats:
    if matrix.shape != (len(ids), len(ids)):
        _refuse_shape(matrix.shape, ids, what)
    finite = what == "variance"
    bad = ~(matrix >= 0) | (np.isinf(matrix) & finite)
    np.fill_diagonal(bad, False)
    if bad.any():
        i, j = np.argwhere(bad)[0].tolist()
        message = f"{what} from site {ids[i]} to site {ids[j]} must be a number and not negative"
        expected = "a finite number" if finite else "inf for a move that cannot be made"
        raise InputError(message, "out-of-range", expected=expected, found=str(matrix[i, j]))
    return matrix


def in_order(frame: Any, ids: Ids, what: str) -> Any:
    """The values of a frame in the order of the sites, if its labels hold theirs; labels 0, 1, 2, ... stand for positions."""
    rows, columns = [str(v) for v in frame.index], [str(v) for v in frame.columns]
    if sorted(rows) == sorted(columns) == sorted(ids):
        order = {site: k for k, site in enumerate(rows)}, {site: k for k, site in enumerate(columns)}
        return frame.to_numpy()[np.ix_([order[0][s] for s in ids], [order[1][s] for s in ids])]
    positions = [str(k) for k in range(len(ids))]
    if rows != positions or columns != positions:
        raise InputError(f"the labels of the {what} frame are not the ids of the sites", "unknown-name", expected=", ".join(ids[:5]),
                         found=", ".join(rows[:5]))  # fmt: skip
    return frame.to_numpy()


def _along_roads(graph: Any, nodes: Ids, ids: Ids, weight: str, what: str) -> Floats:
    """Shortest ways through a networkx graph, which may have any other nodes, and edges beside each other."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import dijkstra

    number = {node: k for k, node in enumerate(graph.nodes)}
    named = {str(node): k for node, k in number.items()}
    absent = next((k for k, node in enumerate(nodes) if node not in named), None)
    if absent is not None:
        message = f"the graph has no node {nodes[absent]!r} for site {ids[absent]}"
        raise InputError(message, "unknown-name", expected="a node named as the site, or a column node")
    lengths: dict[tuple[int, int], float] = {}
    for tail, head, data in graph.edges(data=True):
        if weight not in data:
            message, held = f"the edge from {tail} to {head} has no attribute {weight!r}", ", ".join(map(str, data)) or "none"
            raise InputError(message, "missing", expected="weight= the one that holds distances", found=held)
        length = float(data[weight])
        if not length >= 0 or math.isinf(length):
            message = f"{weight} of the edge from {tail} to {head} must be finite and not negative"
            raise InputError(message, "out-of-range", found=str(data[weight]))
        for pair in ((number[tail], number[head]), *(() if graph.is_directed() else ((number[head], number[tail]),))):
            lengths[pair] = min(length, lengths.get(pair, math.inf))
    tails, heads = np.array(list(lengths), dtype=np.int64).reshape(-1, 2).T
    # A stored 0 is an edge to the sparse routines.
    roads = sp.csr_matrix((np.array(list(lengths.values())), (tails, heads)), shape=(len(number), len(number)))
    at = np.array([named[node] for node in nodes], dtype=np.int64)
    ways = np.asarray(dijkstra(roads, directed=True, indices=at), dtype=np.float64)[:, at]
    _refuse_cut_off(ways, ids, what)
    return ways


def _refuse_cut_off(ways: Floats, ids: Ids, what: str) -> None:
    """Raise InputError for a site that has no way at all to or from the others: one pair without a way is a move that cannot be made."""
    if len(ids) < 2:
        return
    apart = np.isinf(ways)
    np.fill_diagonal(apart, True)
    for k in np.nonzero(apart.all(axis=1) | apart.all(axis=0))[0].tolist():
        way = "from" if apart[k].all() else "to"
        raise InputError(f"no road leads {way} site {ids[k]}", "missing", expected=f"{what}s that connect it to some site")


def _shortest_paths(graph: Any, ids: Ids, what: str) -> Floats:
    from scipy.sparse.csgraph import dijkstra

    if tuple(graph.shape) != (len(ids), len(ids)):
        _refuse_shape(tuple(graph.shape), ids, what)
    roads = graph.tocsr().astype(np.float64)
    bad = ~(roads.data >= 0) | np.isinf(roads.data)
    if bad.any():
        at = int(np.argmax(bad))
        i = int(np.searchsorted(roads.indptr, at, side="right")) - 1
        road = f"the road from site {ids[i]} to site {ids[int(roads.indices[at])]}"
        raise InputError(f"{what} of {road} must be finite and not negative", "out-of-range", found=str(roads.data[at]))
    lengths = np.asarray(dijkstra(roads, directed=True), dtype=np.float64)
    if np.isinf(lengths).any():
        i, j = np.argwhere(np.isinf(lengths))[0].tolist()
        raise InputError(f"no path leads from site {ids[i]} to site {ids[j]}", "missing", expected="a road graph that connects all sites")
    return lengths


# -- lists of moves -----------------------------------------------------------------------------------------------------


def is_list(travel: Any, ids: Ids) -> bool:
    """Whether a frame lists moves: it has columns for both ends of one, by our titles or common others, and these name no sites."""
    if not hasattr(travel, "columns"):
        return False
    titles = [str(title) for title in travel.columns]
    own = {title.casefold() for title in titles}
    meant = {ours(title, "moves") for title in titles}
    return not set(titles) <= set(ids) and (bool({"from", "to"} & own) or {"from", "to"} <= meant)


def listed_moves(frame: Any, ids: Ids, times: Times) -> tuple[Floats, Floats | None, tuple[str, ...]]:
    """Distances, durations if there are any, and notes on unused columns; a pair of sites without a row is no move.

    Raises InputError for a column that is missing, or named as other toolkits name one that counts, and for rows that are no moves between
    the sites.
    """
    titles, unused = _titles(frame)
    index = {site: k for k, site in enumerate(ids)}
    ends = []
    for title in ("from", "to"):
        column = frame[titles[title]]
        if column.isna().any():
            row = int(np.argmax(np.asarray(column.isna()))) + 1
            raise InputError(f"row {row} of the moves has no {title}", "missing", expected="the id of a site")
        names = [id_text(v) for v in column.tolist()]
        strange = next((name for name in names if name not in index), None)
        if strange is not None:
            raise InputError(f"the list of moves names the unknown site {strange!r}", "unknown-name", expected="an id of the sites")
        ends.append(np.array([index[name] for name in names], dtype=np.int64))
    place = ends[0] * len(ids) + ends[1]
    if len(np.unique(place)) < len(place):
        order = np.argsort(place, kind="stable")
        k = int(order[1:][np.diff(place[order]) == 0][0])
        raise InputError(f"the move from {ids[ends[0][k]]} to {ids[ends[1][k]]} stands twice in the list of moves", "duplicate")

    def square(values: Any, what: str) -> Floats:
        matrix = np.full((len(ids), len(ids)), math.inf)
        matrix.ravel()[place] = values
        np.fill_diagonal(matrix, 0.0)
        if (bad := ~(matrix >= 0)).any():
            i, j = np.argwhere(bad)[0].tolist()
            message = f"{what} of the move from {ids[i]} to {ids[j]} must be a number and not negative"
            raise InputError(message, "out-of-range", expected="no row, or inf, for a move that cannot be made", found=str(matrix[i, j]))
        return matrix

    try:
        lengths = np.asarray(frame[titles["distance"]], dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("column distance of the moves must hold numbers", found=str(error)) from None
    distances = square(lengths, "distance")
    durations = square(times.spans(frame[titles["duration"]], "column duration of the moves"), "duration") if "duration" in titles else None
    return distances, durations, in_lines(UNUSED, unused)


def _titles(frame: Any) -> tuple[dict[str, Any], list[str]]:
    """The frame's titles by ours, in any case, and those of columns that are not used."""
    known: dict[str, Any] = {}
    others = []

    def refuse_second(own: str, title: Any) -> None:
        if own in known:
            message = f"columns {str(known[own])!r} and {str(title)!r} of the moves both tell {own}"
            raise InputError(message, "ambiguous", expected="one of them")

    for title in frame.columns:
        own = str(title).casefold()
        if own in MOVES:
            refuse_second(own, title)
            known[own] = title
        else:
            others.append(str(title))
    for title in others:
        refuse_second(ours(title, "moves") or "", title)
        if cure := hint(title, "moves", [own for own in MOVES if own not in known]):
            expected = f"{', '.join(MOVES)}; leave out what shall not count"
            raise InputError(f"the moves have an unknown column {title!r}{cure}", "unknown-name", expected=expected)
    lacking = next((own for own in MOVES[:3] if own not in known), None)
    if lacking is not None:
        message = f"the moves have no column {lacking!r}"
        raise InputError(message, "missing", expected=", ".join(MOVES), found=", ".join(map(str, frame.columns))[:80])
    return known, others
