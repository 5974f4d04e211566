"""Vehicles that differ, several depots and prizes in VRPLIB files, as PyVRP reads and writes them.

A quantity of vehicles is a header (the same for all) or a section with one row per vehicle: ``CAPACITY``, ``VEHICLES_MAX_DISTANCE``,
``VEHICLES_MAX_DURATION``, ``VEHICLES_FIXED_COST``, ``VEHICLES_UNIT_DISTANCE_COST``. ``VEHICLES_DEPOT_SECTION`` tells the depot of each,
``PRIZE_SECTION`` what a visit is worth: a customer with a prize may be left out, and then it is missed. ``BACKHAUL_SECTION`` is what is
picked up; in files of ``TYPE: VRPB`` after all deliveries of a route, of which there is at least one.
``VEHICLES_RELOAD_DEPOT_SECTION`` and ``VEHICLES_ALLOWED_CLIENTS_SECTION`` have the nodes of each vehicle behind its number,
``MUTUALLY_EXCLUSIVE_GROUP_SECTION`` those of each group.

The mixed fleets of Pessoa, Sadykov and Uchoa have a header ``VEHICLE_KINDS`` and one line below each of ``CAPACITIES, FIXED_COSTS,
VARIABLE_COSTS`` and ``NUMBER_OF_VEHICLES``, with one number per kind.

Source: documentation of PyVRP, "supported VRPLIB fields"; Pessoa, Sadykov and Uchoa (2018), European Journal of Operational Research
270(2).
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...errors import Code, InputError
from ...number_arrays import Floats
from ...text import an, numbers, plain, whole
from ..sites import Group
from ..vehicle_type import VehicleType
from ._rows import refuse
from ._tsplib import Lines, Specification, node_column, node_list, node_table

MAX_RELOADS = "VEHICLES_MAX_RELOADS"
QUANTITIES = {
    "CAPACITY": ("capacity", math.inf), "VEHICLES_MAX_DISTANCE": ("max_distance", math.inf),
    "VEHICLES_MAX_DURATION": ("max_duration", math.inf), "VEHICLES_FIXED_COST": ("fixed_cost", 0.0),
    "VEHICLES_UNIT_DISTANCE_COST": ("unit_cost", 1.0), MAX_RELOADS: ("max_reloads", math.inf),
}  # fmt: skip
DEPOTS, PRIZES, BACKHAULS = "VEHICLES_DEPOT_SECTION", "PRIZE_SECTION", "BACKHAUL_SECTION"
RELOADS, ALLOWED, GROUPS = "VEHICLES_RELOAD_DEPOT_SECTION", "VEHICLES_ALLOWED_CLIENTS_SECTION", "MUTUALLY_EXCLUSIVE_GROUP_SECTION"
KINDS = "VEHICLE_KINDS"
BY_KIND = {"CAPACITIES": "capacity", "FIXED_COSTS": "fixed_cost", "VARIABLE_COSTS": "unit_cost", "NUMBER_OF_VEHICLES": "count"}
RICH_HEADERS = frozenset({*QUANTITIES, KINDS}) - {"CAPACITY"}
RICH_SECTIONS = frozenset({DEPOTS, PRIZES, BACKHAULS, RELOADS, ALLOWED, GROUPS, *BY_KIND, *(f"{key}_SECTION" for key in QUANTITIES)})


def is_rich(spec: Specification, depots: list[int]) -> bool:
    """True if vehicles differ, or have limits and costs that other files cannot express."""
    return len(depots) > 1 or bool(spec.sections.keys() & RICH_SECTIONS - {PRIZES, BACKHAULS} or spec.headers.keys() & RICH_HEADERS)


def depots_of(spec: Specification, n: int) -> list[int]:
    """Nodes of the depots, from 0, in the file's order."""
    nodes, lines = node_list(spec, "DEPOT_SECTION", n)
    if not nodes:
        raise InputError("there is no depot", "missing", line=spec.sections["DEPOT_SECTION"].line, expected="at least one")
    if n <= len(nodes):
        message = "there is no customer"
        raise InputError(message, "missing", line=lines[-1], expected=f"DIMENSION of at least {len(nodes) + 1}", found=str(n))
    return [node - 1 for node in nodes]


def fleet_of(spec: Specification, n: int, depots: list[int], longest: float, named: Callable[[], int | None]) -> tuple[VehicleType, ...]:
    """Types of vehicles, one for those that are alike; ``longest`` is the DISTANCE of the file, ``named`` gives the fleet of its name."""
    if KINDS in spec.headers or spec.sections.keys() & BY_KIND.keys():
        return _kinds(spec, depots, longest)
    sections = [name for name in (DEPOTS, RELOADS, ALLOWED, *(f"{key}_SECTION" for key in QUANTITIES)) if name in spec.sections]
    if "VEHICLES" in spec.headers:
        count = spec.whole("VEHICLES")
    elif sections:
        count = sum(row.split() != ["-1"] for _, row in spec.sections[sections[0]].rows)
    else:
        count = named() or n - len(depots)
    if len(depots) > 1 and DEPOTS not in spec.sections:
        message, line = f"there are {len(depots)} depots, and nothing says where vehicles start", spec.section("DEPOT_SECTION").line
        raise InputError(message, "missing", line=line, expected=f"{DEPOTS}, one row a vehicle")
    homes = np.full(count, depots[0])
    if DEPOTS in spec.sections:
        table, lines = node_table(spec, DEPOTS, count, ("depot",))
        known = np.isin(table[:, 0] - 1, depots)
        refuse(~known, lines, f"{DEPOTS} names a node that is no depot", table[:, 0], ", ".join(str(d + 1) for d in depots), "unknown-name")
        homes = (table[:, 0] - 1).astype(np.int64)
    columns = {name: _quantity(spec, key, count, default) for key, (name, default) in QUANTITIES.items()}
    columns["max_duration"] = np.minimum(columns["max_duration"], longest)
    words = set(_allowed(spec, n, depots, count).values())
    skills = [frozenset(word for word, vehicles in words if k in vehicles) for k in range(count)]
    alike: dict[tuple[Any, ...], int] = {}
    for row in zip(homes.tolist(), _reloads(spec, n, depots, count), skills, *(c.tolist() for c in columns.values()), strict=True):
        alike[row] = alike.get(row, 0) + 1
    fleet = []
    for k, ((home, reloads, skill, *values), many) in enumerate(alike.items(), start=1):
        own: dict[str, Any] = dict(zip(columns, values, strict=True))
        most = own.pop("max_reloads")
        own |= {"reloads": reloads, "skills": skill, "max_reloads": int(most) if reloads and most < math.inf else None}
        name = "vehicle" if len(alike) == 1 else f"type {k}"
        fleet.append(VehicleType(many, start=int(home), end=int(home), name=name, **own))
    return tuple(fleet)


def _kinds(spec: Specification, depots: list[int], longest: float) -> tuple[VehicleType, ...]:
    """Types of vehicles as the file numbers them."""
    count = spec.whole(KINDS)
    other = next((key for key in (*spec.headers, *spec.sections) if key.startswith(("VEHICLES", "CAPACITY"))), None)
    if other is not None or len(depots) > 1:
        raise InputError(f"{KINDS} has one depot and no {other or DEPOTS} beside it", "contradiction", line=spec.line(KINDS))
    columns: dict[str, list[float]] = {}
    for name, what in BY_KIND.items():
        rows = spec.section(name).rows
        line = rows[0][0] if rows else spec.section(name).line
        values = [value for at, row in rows for value in numbers(row, at, name)]
        if len(values) != count:
            raise InputError(f"{name} has a wrong length", "wrong-shape", line=line, expected=f"{count} ({KINDS})", found=str(len(values)))
        refuse(np.array(values) < 0, [line] * count, f"{name} holds a negative value", values, "0 or more")
        columns[what] = values
    line = spec.section("NUMBER_OF_VEHICLES").rows[0][0]
    counts = [whole(plain(value), line, "NUMBER_OF_VEHICLES", least=1) for value in columns.pop("count")]
    home = {"start": depots[0], "end": depots[0], "max_duration": longest}
    return tuple(
        VehicleType(many, **home, name=f"type {k + 1}", **{what: values[k] for what, values in columns.items()})  # type: ignore[arg-type]
        for k, many in enumerate(counts)
    )


def _quantity(spec: Specification, key: str, count: int, default: float) -> Floats:
    """One value per vehicle."""
    section = f"{key}_SECTION"
    lines: Sequence[int] | Lines
    if section in spec.sections:
        if key in spec.headers:
            raise InputError(f"{key} stands beside a {section}", "contradiction", line=spec.line(key), expected="one of them")
        table, lines = node_table(spec, section, count, ("value",))
        values = table[:, 0]
        refuse(values < 0, lines, f"{section} holds a negative value", values, "0 or more")
    elif key in spec.headers:
        values, lines = np.full(count, spec.number(key)), [spec.line(key)] * count
        if (values < 0).any():
            raise spec.fault(key, "is negative", "0 or more")
    else:
        return np.full(count, default)
    if key == MAX_RELOADS:
        for value, line in zip(values.tolist(), lines, strict=True):
            whole(plain(value), int(line), key, least=0)
    return values


def skills_of(spec: Specification, n: int, depots: list[int]) -> dict[int, list[str]]:
    """A word for each customer that not every vehicle may serve: customers of the same vehicles share one."""
    return {site: [word] for site, (word, _) in _allowed(spec, n, depots).items()}


def _allowed(spec: Specification, n: int, depots: list[int], count: int | None = None) -> dict[int, tuple[str, frozenset[int]]]:
    """The word of each such customer, and the indices of the vehicles that have it."""
    if ALLOWED not in spec.sections:
        return {}
    rows, _ = _node_rows(spec, ALLOWED, n, count, depots)
    allowed = [set(nodes) for nodes in rows]
    words: dict[frozenset[int], str] = {}
    limited = {}
    for site in (k for k in range(n) if k not in depots):
        vehicles = frozenset(k for k, nodes in enumerate(allowed) if site in nodes)
        if len(vehicles) < len(rows):
            limited[site] = words.setdefault(vehicles, f"as node {site + 1}"), vehicles
    return limited


def _reloads(spec: Specification, n: int, depots: list[int], count: int) -> list[tuple[int, ...]]:
    """Depots where each vehicle may reload."""
    if RELOADS not in spec.sections:
        return [()] * count
    rows, lines = _node_rows(spec, RELOADS, n, count)
    for nodes, line in zip(rows, lines, strict=True):
        strange = next((node for node in nodes if node not in depots), None)
        if strange is not None:
            expected = ", ".join(str(d + 1) for d in depots)
            message = f"{RELOADS} names a node that is no depot"
            raise InputError(message, "unknown-name", line=line, expected=expected, found=str(strange + 1))
    return [tuple(nodes) for nodes in rows]


def groups_of(spec: Specification, n: int, depots: list[int], prizes: Floats | None) -> list[Group]:
    """Groups of alternatives, of which exactly one is visited; those of a single customer are left out."""
    if GROUPS not in spec.sections:
        return []
    rows, lines = _node_rows(spec, GROUPS, n, excluded=depots)
    groups = [(nodes, line) for nodes, line in zip(rows, lines, strict=True) if len(nodes) > 1]
    seen: dict[int, int] = {}
    for nodes, line in groups:
        for node in nodes:
            if node in seen:
                message = f"site {node + 1} is in two groups, the other in line {seen[node]}"
                raise InputError(message, "duplicate", line=line, expected="one group a site")
            if prizes is not None and prizes[node]:
                message = f"site {node + 1} of a group has a prize of its own"
                raise InputError(message, "contradiction", line=line, expected="0", found=plain(prizes[node]))
            seen[node] = line
    return [Group(tuple(nodes)) for nodes, _ in groups]


def _node_rows(
    spec: Specification, section: str, n: int, count: int | None = None, excluded: Sequence[int] = ()
) -> tuple[list[list[int]], list[int]]:
    """Nodes that each row lists behind its number, counted from 0, and its line; rows are numbered from 1 in any order."""
    rows = [(line, row) for line, row in spec.section(section).rows if row.split() != ["-1"]]
    if count is not None and len(rows) != count:
        line = spec.section(section).line
        raise InputError(f"{section} has a wrong number of rows", "wrong-shape", line=line, expected=str(count), found=str(len(rows)))
    listed: dict[int, tuple[list[int], int]] = {}
    barred = set(excluded)
    for line, row in rows:
        number, *nodes = (whole(word, line, section, least=1) for word in row.split())
        if number in listed or number > len(rows):
            expected = f"each of 1 to {len(rows)} once"
            message = f"{section} has a row of a wrong number"
            raise InputError(message, "duplicate" if number in listed else "unknown-name", line=line, expected=expected, found=str(number))
        twice = len(set(nodes)) < len(nodes)
        for node in nodes:
            if node > n or node - 1 in barred or (twice and nodes.count(node) > 1):
                fault: tuple[str, Code] = ("that does not exist", "unknown-name") if node > n else ("that is a depot", "contradiction")
                why, code = fault if node > n or node - 1 in barred else ("twice in a row", "duplicate")
                raise InputError(f"{section} names a node {why}", code, line=line, found=str(node))
        listed[number] = [node - 1 for node in nodes], line
    ordered = [listed[k] for k in sorted(listed)]
    return [nodes for nodes, _ in ordered], [line for _, line in ordered]


def at_customers(spec: Specification, section: str, what: str, n: int, depots: list[int]) -> Floats | None:
    """One value per site, 0 at depots, of a section such as ``PRIZES``, whose numbers are called ``what``; None without the section."""
    if section not in spec.sections:
        return None
    values, lines = node_column(spec, section, n, what)
    refuse(np.isin(np.arange(n), depots) & (values != 0), lines, f"a depot has {an(what)}", values, "0", "contradiction")
    return values
