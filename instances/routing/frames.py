"""Routing instances from what people have: a frame of sites, a frame of vehicles, and distances from anywhere."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..clock import Times
from ..errors import InputError
from ..suggestions import did_you_mean
from ..text import label
from .fleet import equal_fleet, with_problems
from .frame_arguments import loads_given, number_given, text_given, titles_given, whole_given
from .frame_columns import Columns, columns_of
from .frame_fleet import fleet_given, fleet_of, see_times, shared_bans
from .frame_lists import groups_of, see_windows, shipments_of, windows_of
from .frame_travel import Moves, in_order, is_graph, matrix_of, moves_of
from .geography import coordinates_of, warn_of_swapped
from .instance import RoutingInstance, Sites, VehicleType
from .reach import refuse_powerless
from .routing_service import is_table, unit_of_distance
from .sites import unused
from .travel import EXPLICIT, GEOGRAPHIC, METRICS, Travel

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]


def instance_from_frame(
    sites: pd.DataFrame,
    *,
    travel: Any = None,
    durations: Any = None,
    vehicles: int | None = None,
    capacity: float | Sequence[float] = math.inf,
    max_duration: Any = math.inf,
    max_distance: float = math.inf,
    fixed_cost: float = 0.0,
    unit_cost: float = 1.0,
    speed: float | None = None,
    fleet: Any = None,
    columns: Mapping[Any, Any] | str | None = None,
    extra: Iterable[Any] | bool = (),
    time_unit: str | None = None,
    distance_unit: str = "km",
    weight: str = "weight",
    convention: str = "",
    name: str = "frame",
    closing: Any = None,
    min_vehicles: int = 0,
    windows: Any = None,
    shipments: Any = (),
    groups: Any = (),
    variances: Any = None,
    team_risk: float | None = None,
    source: str = "frame",
) -> RoutingInstance:
    """An instance from pandas frames; parameters as of ``RoutingProblem.from_frame``, and the ``source`` that is told as its format.

    Returns
    -------
    RoutingInstance
        Of format ``source``.

    Raises
    ------
    InputError
        Naming the column, site or pair of sites that is wrong, and what to do.
    UsageError
        For a unit that does not exist.
    """
    for what, text in (("name", name), ("distance_unit", distance_unit), ("weight", weight), ("convention", convention)):
        text_given(text, what)
    fleet = fleet_given(fleet)
    table, times, unit = columns_of(sites, columns, titles_given(extra, "extra")), Times(time_unit), unit_of_distance(distance_unit)
    if weight != "weight" and not is_graph(travel):
        raise InputError(
            f"weight={weight!r} names the distances of a graph's edges, and there is no graph", expected="travel=graph (networkx)"
        )
    if "node" in table and not is_graph(travel):
        table = table.without("node")
    for title in ("ready", "due"):
        if title in table:
            times.see(table[title])
    see_windows(windows, times)
    see_times(fleet, times)
    if closing is not None:
        times.see(closing)
    geographic, xy, notes = coordinates_of(table)
    if table.depot.all():
        raise InputError("there is no customer", expected="a row that is no depot", found=f"{len(table.ids)} sites, all of them depots"
                         if len(table.ids) > 1 else "the depot alone")  # fmt: skip
    made = _sites(table, times, xy, geographic, windows, shipments, groups)
    moves = _moves(travel, durations, table, times, weight, unit, geographic, xy)
    notes += moves.notes if isinstance(moves, Moves) else ()
    if unit != "km" and not (_is_service(travel, moves) or (travel is None and geographic)):
        expected = "columns lat and lon, the table of a routing service, or no distance_unit"
        raise InputError(f"distance_unit={unit!r} counts for nothing: distances are as they are given", expected=expected)
    _need_units(made, moves, durations, speed, fleet, time_unit, max_duration, xy is not None and geographic, travel)
    closes = None if closing is None else _closing(closing, table.ids, times)
    if hasattr(variances, "tocsr"):
        raise InputError("variances belong to moves, not to roads", expected="a full matrix", found="a sparse one")
    own: dict[str, Any] = {
        "convention": convention, "closing": closes,
        "variances": None if variances is None else matrix_of(variances, table.ids, "variance", None),
    }  # fmt: skip
    forbidden = None
    if isinstance(moves, Moves):
        forbidden = moves.forbidden
        if len(made) > 1 and made.required.any() and forbidden is not None and forbidden.sum() == len(made) * (len(made) - 1):
            raise InputError("all distances between sites are infinite, so that no move can be made", expected="inf for some moves")
        ways = Travel(EXPLICIT, matrix=moves.distances, duration_matrix=moves.durations, **own)
    else:
        held = None if durations is None else matrix_of(durations, table.ids, "duration", times)
        ways = Travel(moves, coordinates=xy, duration_matrix=held, **own)
    ways = ways.at_speed(1.0 if speed is None else _speed(speed, ways, times))
    if fleet is not None and (
        vehicles is not None
        or (_plain(capacity), max_duration, max_distance, fixed_cost, unit_cost) != (math.inf, math.inf, math.inf, 0.0, 1.0)
    ):
        expected = "fleet, or vehicles, capacity, max_duration, max_distance, fixed_cost and unit_cost"
        raise InputError("fleet tells the vehicles already", expected=expected)
    if fleet is None:
        kinds = _equal(made, vehicles, capacity, times.span(max_duration, "max_duration"), max_distance, fixed_cost, unit_cost)
        if len(kinds) > 1:
            notes += (f"{'any number of' if vehicles is None else vehicles} vehicles at each of {len(kinds)} depots",)
    else:
        kinds, forbidden = shared_bans(fleet_of(fleet, made, times), forbidden, made)
    _need_capacities(made, kinds, fleet)
    notes += unused(map(str, table.extra))
    clock = times.clock
    if clock is not None:
        notes += (f"times are in {clock}",)
    instance = RoutingInstance(
        label(name),
        source,
        made,
        ways,
        kinds,
        min_vehicles=whole_given(min_vehicles, "min_vehicles"),
        notes=notes,
        team_risk=None if team_risk is None else number_given(team_risk, "team_risk"),
        forbidden=forbidden,
        clock=clock,
    )
    refuse_powerless(instance)
    return with_problems(instance)


def _sites(
    table: Columns,
    times: Times,
    xy: Floats | None,
    geographic: bool,
    windows: Any,
    shipments: Any,
    groups: Any,
) -> Sites:
    index = {site: k for k, site in enumerate(table.ids)}
    held: dict[str, Any] = {key: table.reals(key) for key in ("reward", "penalty") if key in table}
    held |= {key: table.loads(key) for key in ("demand", "pickup")}
    if "ready" in table:
        held["ready"] = table.moments("ready", times, 0.0)
    if "due" in table:
        held["due"] = table.moments("due", times, math.inf)
    if "service" in table:
        held["service"] = table.spans("service", times)
    if "required" in table:
        held["required"] = table.flags("required")
    return Sites.of(
        table.ids, depot=table.depot, coordinates=xy, windows=windows_of(windows, index, times),
        skills=table.skills() if "skills" in table else None, shipments=shipments_of(shipments, index), groups=groups_of(groups, index),
        attributes=table.attributes(), geographic=geographic, **held,
    )  # fmt: skip


def _moves(
    travel: Any, durations: Any, table: Columns, times: Times, weight: str, unit: str, geographic: bool, xy: Floats | None
) -> Moves | str:
    """What tells distances: moves of their own, or the name of a metric."""
    if isinstance(travel, str) and (travel in METRICS or not Path(travel).suffix):
        if travel not in METRICS:
            expected = f"a matrix, the file of a table, or one of {', '.join(METRICS)}"
            raise InputError(f"travel by {travel!r} is unknown{did_you_mean(travel, METRICS)}", expected=expected)
        if xy is None:
            raise InputError(
                f"travel by {travel} needs coordinates", expected="columns lat and lon" if travel in GEOGRAPHIC else "columns x and y"
            )
        if (travel in GEOGRAPHIC) != geographic:
            expected = "columns lat and lon" if travel in GEOGRAPHIC else "travel='haversine', or columns x and y"
            raise InputError(f"travel by {travel} does not fit the coordinates", expected=expected)
        return travel
    if travel is not None:
        nodes = tuple(str(v) for v in table["node"].tolist()) if "node" in table else table.ids
        return moves_of(travel, durations, table.ids, nodes, times, weight, unit)
    if xy is None:
        expected = "columns x and y, lat and lon, or travel=matrix"
        raise InputError("there are neither coordinates nor distances", expected=expected)
    if geographic:
        warn_of_swapped(xy)
        return "haversine" if unit == "km" else f"haversine-{unit}"
    return "euclidean"


def _need_units(
    sites: Sites,
    moves: Moves | str,
    durations: Any,
    speed: float | None,
    fleet: Any,
    unit: str | None,
    max_duration: Any,
    geographic: bool,
    travel: Any,
) -> None:
    """Raise InputError where times of sites or vehicles would be compared with distances, or with durations of another unit."""
    timed = bool(sites.ready.any() or np.isfinite(sites.due).any() or sites.service.any() or max_duration != math.inf)
    if not timed:
        return
    if _is_service(travel, moves) and unit is None:
        raise InputError("durations of the routing service are in seconds, and the unit of the other times is not said",
                         expected="time_unit='s', min, h or d")  # fmt: skip
    if not (isinstance(moves, str) and moves in GEOGRAPHIC and durations is None):
        return
    rows = [] if fleet is None or hasattr(fleet, "columns") else list(fleet)
    own = "speed" in getattr(fleet, "columns", ()) or any(isinstance(row, Mapping) and "speed" in row for row in rows)
    if own and speed is not None:
        raise InputError("speeds are told twice", expected="speed, or the column speed of the fleet", found=f"speed={speed:g} and a column")
    if speed is None and not own:
        raise InputError("distances on the globe are lengths, and there are times of sites or vehicles beside them",
                         expected="speed=50 (an hour), or durations=matrix")  # fmt: skip
    if unit is None:
        raise InputError("a speed is a distance in an hour, and the unit of times is not said", expected="time_unit='min', or s, h, d")


def _is_service(travel: Any, moves: Moves | str) -> bool:
    """Whether a routing service's table, or its file, told the moves."""
    return (isinstance(travel, str | PathLike) and not isinstance(moves, str)) or is_table(travel)


def _plain(capacity: Any) -> Any:
    """A capacity that may be compared with another; an array may not."""
    return capacity if isinstance(capacity, float | int) else None


def _speed(speed: float, travel: Travel, times: Times) -> float:
    """Units of distance in a unit of time; a speed on the globe is one in an hour."""
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0 < speed < math.inf:
        raise InputError("speed must be positive and finite", found=str(speed))
    clock = times.clock
    if travel.metric not in GEOGRAPHIC or travel.duration_matrix is not None or clock is None:
        return float(speed)
    return float(speed) * clock.seconds / 3600.0


def _equal(
    sites: Sites,
    vehicles: int | None,
    capacity: Any,
    max_duration: float,
    max_distance: float,
    fixed_cost: float,
    unit_cost: float,
) -> tuple[VehicleType, ...]:
    count = None if vehicles is None else whole_given(vehicles, "the number of vehicles")
    loads = loads_given(capacity, "capacity")
    return equal_fleet(
        sites, count=count, capacity=loads[0], further_capacity=tuple(loads[1:]), max_duration=max_duration,
        max_distance=number_given(max_distance, "max_distance"), fixed_cost=number_given(fixed_cost, "fixed_cost"),
        unit_cost=number_given(unit_cost, "unit_cost"),
    )  # fmt: skip


def _need_capacities(sites: Sites, kinds: tuple[VehicleType, ...], fleet: Any) -> None:
    """Raise InputError where one load of several alone is limited, and nothing says that the others are not; as in VRPLIB's files."""
    further = [k for k in range(2, sites.dimensions + 1) if sites.further_demand[:, k - 2].any() or sites.further_pickup[:, k - 2].any()]
    further += [k for k in range(2, sites.dimensions + 1) if any(len(s.load) >= k and s.load[k - 1] for s in sites.shipments)]
    said = any(v.further_capacity for v in kinds) or any(f"capacity{k}" in getattr(fleet, "columns", ()) for k in further)
    limited = next((v for v in kinds if math.isfinite(v.capacity)), None)
    if not further or said or limited is None:
        return
    each = ", ".join([f"{limited.capacity:g}", *("inf" for _ in range(sites.dimensions - 1))])
    expected = "a column capacity2, ..., inf for no limit" if hasattr(fleet, "columns") else f"capacity=[{each}], with inf for no limit"
    raise InputError(f"sites have {sites.dimensions} loads, and capacity is told of the first alone", expected=expected)


def _closing(values: Any, ids: tuple[str, ...], times: Times) -> Floats:
    if hasattr(values, "columns"):
        values = in_order(values, ids, "closing")
    try:
        return times.moments(values, "closing times")
    except (TypeError, ValueError) as error:
        raise InputError("closing times must be numbers", found=str(error)) from None
