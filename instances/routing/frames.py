"""Routing instances from pandas frames and matrices of one's own."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..text import label
from .fleet import equal_fleet, with_problems
from .instance import RoutingInstance, Sites
from .travel import EXPLICIT, Travel

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

COLUMNS = ("id", "x", "y", "demand", "ready", "due", "service", "reward", "required", "depot")


def instance_from_frame(
    sites: pd.DataFrame,
    *,
    travel: Any = None,
    durations: Any = None,
    vehicles: int | None = None,
    capacity: float = math.inf,
    max_duration: float = math.inf,
    convention: str = "",
    name: str = "frame",
) -> RoutingInstance:
    """An instance from a pandas frame, one row a site.

    Parameters
    ----------
    sites : DataFrame
        Columns ``id`` (else the index), ``x, y, demand, ready, due, service, reward, required, depot``, all but the
        coordinates (or ``travel``) optional. Without ``depot`` the first row is the depot. Others are refused, so that
        a misspelt one is not dropped.
    travel, durations : array, DataFrame or scipy.sparse of shape (sites, sites), optional
        Distances and durations; Euclidean from ``x, y`` without them. A frame whose labels are the ids is put in the order
        of the sites. A sparse matrix is a road graph with one entry a road, and its shortest paths are taken.
    vehicles : int, optional
        Number of vehicles (at each depot, where there are several); unlimited by default.
    capacity, max_duration : float
        Of each vehicle.
    convention : str
        Distance convention, ``exact`` by default.
    name : str

    Returns
    -------
    RoutingInstance
        Of format ``frame``.

    Raises
    ------
    InputError
        Naming the column, site or pair of sites that is wrong; the pair also where a road graph has no path.
    """
    if len(sites) == 0:
        raise InputError("the frame has no rows")
    titles = [str(column) for column in sites.columns]
    for title in titles:
        if title not in COLUMNS:
            raise InputError(f"column {title!r} is unknown", expected=", ".join(COLUMNS))
        if titles.count(title) > 1:
            raise InputError(f"column {title!r} stands twice")
    ids = tuple(str(v) for v in (sites["id"] if "id" in titles else sites.index).tolist())
    reals = {key: _reals(sites, key) for key in ("demand", "ready", "due", "service", "reward") if key in titles}
    flags = {key: _flags(sites, key) for key in ("required", "depot") if key in titles}
    if ("x" in titles) != ("y" in titles):
        raise InputError("coordinates need two columns", expected="x and y", found="one of them")
    xy = np.column_stack([_reals(sites, "x"), _reals(sites, "y")]) if "x" in titles else None
    made = Sites.of(ids, coordinates=xy, **reals, **flags)
    times = None if durations is None else _matrix(durations, ids, "duration")
    if travel is not None:
        moves = Travel(EXPLICIT, matrix=_matrix(travel, ids, "distance"), duration_matrix=times, convention=convention)
    elif xy is None:
        raise InputError("there are neither coordinates nor distances", expected="columns x and y, or travel=matrix")
    else:
        moves = Travel("euclidean", coordinates=xy, duration_matrix=times, convention=convention)
    if vehicles is not None and (isinstance(vehicles, bool) or int(vehicles) != vehicles):
        raise InputError("the number of vehicles must be whole", found=str(vehicles))
    fleet = equal_fleet(made, count=None if vehicles is None else int(vehicles), capacity=float(capacity), max_duration=float(max_duration))
    return with_problems(RoutingInstance(label(name), "frame", made, moves, fleet))


def _reals(sites: pd.DataFrame, title: str) -> Floats:
    try:
        return np.array(sites[title].to_numpy(), dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"column {title} must hold numbers", found=str(error)) from None


def _flags(sites: pd.DataFrame, title: str) -> NDArray[np.bool_]:
    values = sites[title].to_numpy()
    good = np.array([v in (True, False) for v in values.tolist()])
    if not good.all():
        raise InputError(f"column {title} must hold true and false", found=str(values[int(np.argmin(good))]))
    return values.astype(bool)


def _matrix(values: Any, ids: tuple[str, ...], what: str) -> Floats:
    n = len(ids)
    shape = tuple(getattr(values, "shape", np.shape(values)))
    if shape != (n, n):
        raise InputError(f"the {what} matrix and the sites have different sizes", expected=f"({n}, {n})", found=str(shape))
    if hasattr(values, "tocsr"):
        return _shortest_paths(values, ids, what)
    if hasattr(values, "columns"):
        values = _in_order(values, ids, what)
    try:
        matrix = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"the {what} matrix must hold numbers", found=str(error)) from None
    bad = ~(matrix >= 0) | np.isinf(matrix)
    np.fill_diagonal(bad, False)
    if bad.any():
        i, j = np.argwhere(bad)[0].tolist()
        raise InputError(f"{what} from site {ids[i]} to site {ids[j]} must be finite and not negative", found=str(matrix[i, j]))
    return matrix


def _in_order(frame: Any, ids: tuple[str, ...], what: str) -> Any:
    """The values of a frame in the order of the sites, if its labels are theirs; labels 0, 1, 2, ... stand for positions."""
    rows, columns = [str(v) for v in frame.index], [str(v) for v in frame.columns]
    if sorted(rows) == sorted(columns) == sorted(ids):
        order = {site: k for k, site in enumerate(rows)}, {site: k for k, site in enumerate(columns)}
        return frame.to_numpy()[np.ix_([order[0][s] for s in ids], [order[1][s] for s in ids])]
    positions = [str(k) for k in range(len(ids))]
    if rows != positions or columns != positions:
        raise InputError(f"the labels of the {what} frame are not the ids of the sites", expected=", ".join(ids[:5]),
                         found=", ".join(rows[:5]))  # fmt: skip
    return frame.to_numpy()


def _shortest_paths(graph: Any, ids: tuple[str, ...], what: str) -> Floats:
    from scipy.sparse.csgraph import dijkstra

    roads = graph.tocsr().astype(np.float64)
    bad = ~(roads.data >= 0) | np.isinf(roads.data)
    if bad.any():
        at = int(np.argmax(bad))
        i = int(np.searchsorted(roads.indptr, at, side="right")) - 1
        raise InputError(
            f"{what} of the road from site {ids[i]} to site {ids[int(roads.indices[at])]} must be finite and not negative",
            found=str(roads.data[at]),
        )
    lengths = np.asarray(dijkstra(roads, directed=True), dtype=np.float64)
    if np.isinf(lengths).any():
        i, j = np.argwhere(np.isinf(lengths))[0].tolist()
        raise InputError(f"no path leads from site {ids[i]} to site {ids[j]}", expected="a road graph that connects all sites")
    return lengths
