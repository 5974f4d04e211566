"""Routing instances from what people have: a frame of sites, a frame of vehicles, and distances from anywhere."""

import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..clock import Times
from ..errors import InputError
from ..number_arrays import Floats
from ..suggestions import did_you_mean
from ..text import label
from .fleet import equal_fleet, with_problems
from .frame_arguments import FrameArguments, loads_of, number_of, titles_of, whole_of
from .frame_columns import Columns, columns_of
from .frame_fleet import entries_of, fleet_of, see_times, shared_bans
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


def instance_from_frame(sites: "pd.DataFrame", *, source: str = "frame", **keywords: Any) -> RoutingInstance:
    """An instance of format ``source`` from pandas frames; ``keywords`` and errors are those of ``RoutingProblem.from_frame``."""
    arguments = FrameArguments(**keywords)
    travel, fleet = arguments.travel, entries_of(arguments.fleet)
    table, times = columns_of(sites, arguments.columns, titles_of(arguments.extra, "extra")), Times(arguments.time_unit)
    unit = unit_of_distance(arguments.distance_unit)
    if not is_graph(travel):
        if arguments.weight != "weight":
            message = f"weight={arguments.weight!r} names the distances of a graph's edges, and there is no graph"
            raise InputError(message, "contradiction", expected="travel=graph (networkx)")
        table = table.without("node") if "node" in table else table
    _see_moments(arguments, table, fleet, times)
    geographic, xy = coordinates_of(table)
    if table.depot.all():
        all_of_them = f"{len(table.ids)} sites, all of them depots" if len(table.ids) > 1 else "the depot alone"
        raise InputError("there is no customer", "missing", expected="a row that is no depot", found=all_of_them)
    places = _sites(arguments, table, times, xy, geographic)
    moves = _moves(arguments, table, times, xy, geographic)
    notes = moves.notes if isinstance(moves, Moves) else ()
    if unit != "km" and not (_is_service(travel, moves) or (travel is None and geographic)):
        expected = "columns lat and lon, the table of a routing service, or no distance_unit"
        raise InputError(f"distance_unit={unit!r} counts for nothing: distances are as they are given", "contradiction", expected=expected)
    _need_units(arguments, places, moves, fleet)
    ways, forbidden = _travel(arguments, places, moves, times, xy)
    if fleet is None:
        kinds = _equal(arguments, places, times)
        if len(kinds) > 1:
            count = "any number of" if arguments.vehicles is None else arguments.vehicles
            notes += (f"{count} vehicles at each of {len(kinds)} depots",)
    elif arguments.limits_vehicles:
        expected = "fleet, or vehicles, capacity, max_duration, max_distance, fixed_cost and unit_cost"
        raise InputError("fleet tells the vehicles already", "contradiction", expected=expected)
    else:
        kinds, forbidden = shared_bans(fleet_of(fleet, places, times), forbidden, places)
    _need_capacities(places, kinds, fleet)
    notes += unused(map(str, table.extra))
    clock = times.clock
    notes += () if clock is None else (f"times are in {clock}",)
    min_vehicles = whole_of(arguments.min_vehicles, "min_vehicles")
    team_risk = None if arguments.team_risk is None else number_of(arguments.team_risk, "team_risk")
    instance = RoutingInstance(
        label(arguments.name), source, places, ways, kinds, min_vehicles=min_vehicles, notes=notes, team_risk=team_risk,
        forbidden=forbidden, clock=clock,
    )  # fmt: skip
    refuse_powerless(instance)
    return with_problems(instance)


def _see_moments(arguments: FrameArguments, table: Columns, fleet: Any, times: Times) -> None:
    """Let all moments count for the origin of time."""
    for title in ("ready", "due"):
        if title in table:
            times.see(table[title])
    see_windows(arguments.windows, times)
    see_times(fleet, times)
    if arguments.closing is not None:
        times.see(arguments.closing)


def _sites(arguments: FrameArguments, table: Columns, times: Times, xy: Floats | None, geographic: bool) -> Sites:
    index = {site: k for k, site in enumerate(table.ids)}
    columns: dict[str, Any] = {key: table.reals(key) for key in ("reward", "penalty") if key in table}
    columns |= {key: table.loads(key) for key in ("demand", "pickup")}
    columns |= {key: table.moments(key, times, missing) for key, missing in (("ready", 0.0), ("due", math.inf)) if key in table}
    if "service" in table:
        columns["service"] = table.spans("service", times)
    if "required" in table:
        columns["required"] = table.flags("required")
    return Sites.of(
        table.ids, depot=table.depot, coordinates=xy, windows=windows_of(arguments.windows, index, times),
        skills=table.skills() if "skills" in table else None, shipments=shipments_of(arguments.shipments, index),
        groups=groups_of(arguments.groups, index), attributes=table.attributes(), geographic=geographic, **columns,
    )  # fmt: skip


def _moves(arguments: FrameArguments, table: Columns, times: Times, xy: Floats | None, geographic: bool) -> Moves | str:
    """Moves with distances of their own, or the name of a metric."""
    travel, unit = arguments.travel, arguments.distance_unit
    if isinstance(travel, str) and (travel in METRICS or not Path(travel).suffix):
        if travel not in METRICS:
            expected = f"a matrix, the file of a table, or one of {', '.join(METRICS)}"
            raise InputError(f"travel by {travel!r} is unknown{did_you_mean(travel, METRICS)}", "unknown-name", expected=expected)
        angles = travel in GEOGRAPHIC
        if xy is None:
            message = f"travel by {travel} needs coordinates"
            raise InputError(message, "missing", expected=f"columns {'lat and lon' if angles else 'x and y'}")
        if angles != geographic:
            expected = "columns lat and lon" if angles else "travel='haversine', or columns x and y"
            raise InputError(f"travel by {travel} does not fit the coordinates", "contradiction", expected=expected)
        return travel
    if travel is not None:
        nodes = tuple(str(v) for v in table["node"].tolist()) if "node" in table else table.ids
        return moves_of(travel, arguments.durations, table.ids, nodes, times, arguments.weight, unit)
    if xy is None:
        message = "there are neither coordinates nor distances"
        raise InputError(message, "missing", expected="columns x and y, lat and lon, or travel=matrix")
    if geographic:
        warn_of_swapped(xy)
        return "haversine" if unit == "km" else f"haversine-{unit}"
    return "euclidean"


def _travel(arguments: FrameArguments, sites: Sites, moves: Moves | str, times: Times, xy: Floats | None) -> tuple[Travel, Any]:
    """Distances and durations at the speed of all vehicles, and the moves that are forbidden, None for none."""
    closing = None if arguments.closing is None else _closing(arguments.closing, sites.ids, times)
    if hasattr(arguments.variances, "tocsr"):
        raise InputError("variances belong to moves, not to roads", "unsupported", expected="a full matrix", found="a sparse one")
    variances = None if arguments.variances is None else matrix_of(arguments.variances, sites.ids, "variance", None)
    own: dict[str, Any] = {"convention": arguments.convention, "closing": closing, "variances": variances}
    forbidden = None
    if isinstance(moves, Moves):
        forbidden = moves.forbidden
        if len(sites) > 1 and sites.required.any() and forbidden is not None and forbidden.sum() == len(sites) * (len(sites) - 1):
            message = "all distances between sites are infinite, so that no move can be made"
            raise InputError(message, "contradiction", expected="inf for some moves")
        ways = Travel(EXPLICIT, matrix=moves.distances, duration_matrix=moves.durations, **own)
    else:
        durations = None if arguments.durations is None else matrix_of(arguments.durations, sites.ids, "duration", times)
        ways = Travel(moves, coordinates=xy, duration_matrix=durations, **own)
    return ways.at_speed(1.0 if arguments.speed is None else _speed(arguments.speed, ways, times)), forbidden


def _need_units(arguments: FrameArguments, sites: Sites, moves: Moves | str, fleet: Any) -> None:
    """Raise InputError where times of sites or vehicles would be compared with distances, or with durations of another unit."""
    if not (sites.ready.any() or np.isfinite(sites.due).any() or sites.service.any() or arguments.max_duration != math.inf):
        return
    if _is_service(arguments.travel, moves) and arguments.time_unit is None:
        raise InputError("durations of the routing service are in seconds, and the unit of the other times is not said", "missing",
                         expected="time_unit='s', min, h or d")  # fmt: skip
    if not (isinstance(moves, str) and moves in GEOGRAPHIC and arguments.durations is None):
        return
    rows = [] if fleet is None or hasattr(fleet, "columns") else list(fleet)
    own = "speed" in getattr(fleet, "columns", ()) or any(isinstance(row, Mapping) and "speed" in row for row in rows)
    speed = arguments.speed
    if own and speed is not None:
        message = "speeds are given twice"
        raise InputError(message, "duplicate", expected="speed, or the column speed of the fleet", found=f"speed={speed:g} and a column")
    if speed is None and not own:
        raise InputError("distances on the globe are lengths, and there are times of sites or vehicles beside them", "missing",
                         expected="speed=50 (an hour), or durations=matrix")  # fmt: skip
    if arguments.time_unit is None:
        message = "a speed is a distance in an hour, and the unit of times is not said"
        raise InputError(message, "missing", expected="time_unit='min', or s, h, d")


def _is_service(travel: Any, moves: Moves | str) -> bool:
    """True if the moves are those of a routing service's table, or of its file."""
    return (isinstance(travel, str | PathLike) and not isinstance(moves, str)) or is_table(travel)


def _speed(speed: float, travel: Travel, times: Times) -> float:
    """Units of distance in a unit of time; a speed on the globe is one in an hour."""
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0 < speed < math.inf:
        raise InputError("speed must be positive and finite", "out-of-range", found=str(speed))
    clock = times.clock
    if travel.metric not in GEOGRAPHIC or travel.duration_matrix is not None or clock is None:
        return float(speed)
    pace = float(speed) * clock.seconds / 3600.0
    if not 0 < pace < math.inf:
        raise InputError("speed is too small or too large to compute with", "out-of-range", found=str(speed))
    return pace


def _equal(arguments: FrameArguments, sites: Sites, times: Times) -> tuple[VehicleType, ...]:
    """Vehicles that are all alike, one type per depot."""
    longest = times.span(arguments.max_duration, "max_duration")
    count = None if arguments.vehicles is None else whole_of(arguments.vehicles, "the number of vehicles")
    capacity, *further = loads_of(arguments.capacity, "capacity")
    limits = {key: number_of(getattr(arguments, key), key) for key in ("max_distance", "fixed_cost", "unit_cost")}
    return equal_fleet(sites, count=count, capacity=capacity, further_capacity=tuple(further), max_duration=longest, **limits)


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
    raise InputError(f"sites have {sites.dimensions} loads, and capacity is given for the first alone", "missing", expected=expected)


def _closing(values: Any, ids: tuple[str, ...], times: Times) -> Floats:
    """Latest times at which moves may begin, shape (sites, sites)."""
    if hasattr(values, "columns"):
        values = in_order(values, ids, "closing")
    try:
        return times.moments(values, "closing times")
    except (TypeError, ValueError) as error:
        raise InputError("closing times must be numbers", found=str(error)) from None
