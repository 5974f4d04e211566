"""Routing instances from pandas frames and matrices of one's own."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..text import label
from .fleet import equal_fleet, with_problems
from .instance import Group, RoutingInstance, Shipment, Sites, VehicleType
from .json_vehicles import decode_vehicle
from .reach import refuse_powerless
from .travel import EXPLICIT, Travel

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

COLUMNS = ("id", "x", "y", "demand", "pickup", "ready", "due", "service", "reward", "required", "penalty", "depot", "skills")

_NUMBERED = re.compile(r"(demand|pickup)[2-9]")


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
    closing: Any = None,
    fleet: Any = None,
    min_vehicles: int = 0,
    windows: Mapping[Any, Sequence[tuple[float, float]]] | None = None,
    shipments: Iterable[Sequence[Any]] = (),
    groups: Iterable[Any] = (),
    variances: Any = None,
    team_risk: float | None = None,
) -> RoutingInstance:
    """An instance from a pandas frame, one row a site.

    Parameters
    ----------
    sites : DataFrame
        Columns ``id`` (else the index), ``x, y, demand, pickup, ready, due, service, reward, required, penalty, depot, skills``, all but
        the coordinates (or ``travel``) optional; ``demand2, pickup2, ...`` are further load dimensions, ``skills`` words with commas
        between. Without ``depot`` the first row is the depot. Others are refused, so that a misspelt one is not dropped.
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
    closing : array or DataFrame of shape (sites, sites), optional
        Latest times at which moves may begin.
    fleet : DataFrame or sequence of mappings or VehicleType, optional
        One entry a vehicle type, with the keys of waybound's JSON (docs/formats.md), sites by id; in place of ``vehicles, capacity,
        max_duration``.
    min_vehicles : int
        Routes that must be used at least.
    windows : mapping from id to a list of pairs, optional
        Sites with several time windows.
    shipments : iterable of (pickup id, delivery id) or (pickup id, delivery id, load)
        Pairs of sites that one vehicle visits in this order.
    groups : iterable of iterables of ids
        Alternatives, of which exactly one is visited; ``{"sites": [...], "required": False}`` for at most one.
    variances : array or DataFrame of shape (sites, sites), optional
        Variances of the durations of moves, independent and normal; ``risk`` in ``fleet`` limits what they do to one route.
    team_risk : float, optional
        Largest probability that any route overruns its longest duration or its store.

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
        if title not in COLUMNS and not _NUMBERED.fullmatch(title):
            raise InputError(f"column {title!r} is unknown", expected=", ".join(COLUMNS))
        if titles.count(title) > 1:
            raise InputError(f"column {title!r} stands twice")
    ids = tuple(str(v) for v in (sites["id"] if "id" in titles else sites.index).tolist())
    index = {site: k for k, site in enumerate(ids)}
    reals: dict[str, Floats] = {key: _reals(sites, key) for key in ("ready", "due", "service", "reward", "penalty") if key in titles}
    reals |= {key: _loads(sites, key, titles) for key in ("demand", "pickup")}
    flags = {key: _flags(sites, key) for key in ("required", "depot") if key in titles}
    if ("x" in titles) != ("y" in titles):
        raise InputError("coordinates need two columns", expected="x and y", found="one of them")
    xy = np.column_stack([_reals(sites, "x"), _reals(sites, "y")]) if "x" in titles else None
    made = Sites.of(
        ids, coordinates=xy, windows={_at(site, index, "windows"): w for site, w in (windows or {}).items()},
        skills=_skills(sites) if "skills" in titles else None, shipments=[_shipment(s, index) for s in shipments],
        groups=[_group(g, index) for g in groups], **reals, **flags,
    )  # fmt: skip
    times = None if durations is None else _matrix(durations, ids, "duration")
    closes = None if closing is None else _closing(closing, ids)
    if hasattr(variances, "tocsr"):
        raise InputError("variances belong to moves, not to roads", expected="a full matrix", found="a sparse one")
    spread = None if variances is None else _matrix(variances, ids, "variance")
    if travel is not None:
        matrix = _matrix(travel, ids, "distance")
        moves = Travel(EXPLICIT, matrix=matrix, duration_matrix=times, convention=convention, closing=closes, variances=spread)
    elif xy is None:
        raise InputError("there are neither coordinates nor distances", expected="columns x and y, or travel=matrix")
    else:
        moves = Travel("euclidean", coordinates=xy, duration_matrix=times, convention=convention, closing=closes, variances=spread)
    if vehicles is not None and (isinstance(vehicles, bool) or int(vehicles) != vehicles):
        raise InputError("the number of vehicles must be whole", found=str(vehicles))
    kinds: tuple[VehicleType, ...]
    if fleet is None:
        kinds = equal_fleet(
            made, count=None if vehicles is None else int(vehicles), capacity=float(capacity), max_duration=float(max_duration)
        )
    elif vehicles is not None or capacity < math.inf or max_duration < math.inf:
        raise InputError("fleet tells the vehicles already", expected="fleet, or vehicles, capacity and max_duration")
    else:
        kinds = _fleet(fleet, made)
    problem = RoutingInstance(label(name), "frame", made, moves, kinds, min_vehicles=min_vehicles, team_risk=team_risk)
    refuse_powerless(problem)
    return with_problems(problem)


def _fleet(given: Any, sites: Sites) -> tuple[VehicleType, ...]:
    rows = given.to_dict("records") if hasattr(given, "columns") else list(given)
    index, kinds = sites.index(), []
    for k, row in enumerate(rows):
        if isinstance(row, VehicleType):
            kinds.append(row)
            continue
        if not isinstance(row, Mapping):
            raise InputError(f"fleet[{k}] must be a mapping or a VehicleType", found=type(row).__name__)
        held = {str(key): _plain(value) for key, value in row.items()}
        held = {key: value for key, value in held.items() if value is not None}
        for key in ("count", "max_reloads"):
            if isinstance(held.get(key), float) and held[key].is_integer():
                held[key] = int(held[key])
        for key in ("start", "end"):
            if key in held:
                held[key] = str(held[key])
        for key in ("reloads",):
            if key in held:
                held[key] = [str(site) for site in held[key]]
        held.setdefault("name", f"vehicle {k + 1}" if len(rows) > 1 else "vehicle")
        kinds.append(decode_vehicle(held, f"fleet[{k}]", index, sites))
    names = [v.name for v in kinds]
    if len(set(names)) < len(names):
        raise InputError("vehicle types must have different names", found=", ".join(names))
    return tuple(kinds)


def _plain(value: Any) -> Any:
    """A value of a frame as one of JSON; None where it is missing or no limit."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float) and not -math.inf < value < math.inf:
        if value == -math.inf:
            raise InputError("a number of the fleet is minus infinity", expected="a number of at least 0")
        return None
    if isinstance(value, tuple | set | frozenset):
        value = sorted(value) if not isinstance(value, tuple) else list(value)
    return [_plain(v) for v in value] if isinstance(value, list) else value


def _at(site: Any, index: dict[str, int], what: str) -> int:
    if str(site) not in index:
        raise InputError(f"{what} name the unknown site {str(site)!r}", expected="an id of the frame")
    return index[str(site)]


def _shipment(given: Sequence[Any], index: dict[str, int]) -> Shipment:
    if isinstance(given, str) or len(given) not in (2, 3):
        raise InputError("a shipment has a pickup, a delivery and perhaps a load", found=str(given)[:80])
    return Shipment(_at(given[0], index, "shipments"), _at(given[1], index, "shipments"), given[2] if len(given) == 3 else (0.0,))


def _group(given: Any, index: dict[str, int]) -> Group:
    members = given["sites"] if isinstance(given, Mapping) else given
    required = given.get("required", True) if isinstance(given, Mapping) else True
    return Group(tuple(_at(site, index, "groups") for site in members), bool(required))


def _skills(sites: pd.DataFrame) -> dict[int, list[str]]:
    found = {}
    for k, value in enumerate(sites["skills"].tolist()):
        if isinstance(value, str):
            found[k] = [word.strip() for word in value.split(",") if word.strip()]
        elif isinstance(value, Iterable):
            found[k] = [str(word) for word in value]
        elif value is not None and value == value:
            raise InputError("column skills must hold words with commas between", found=str(value))
    return found


def _loads(sites: pd.DataFrame, title: str, titles: list[str]) -> Floats:
    """All load dimensions of a column, shape (sites, dimensions); a dimension that is not there has no load."""
    last = max([1, *(int(t[-1]) for t in titles if t[:-1] == title)])
    columns = [title, *(f"{title}{k}" for k in range(2, last + 1))]
    return np.column_stack([_reals(sites, c) if c in titles else np.zeros(len(sites)) for c in columns])


def _closing(values: Any, ids: tuple[str, ...]) -> Floats:
    if hasattr(values, "columns"):
        values = _in_order(values, ids, "closing")
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("closing times must be numbers", found=str(error)) from None


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
