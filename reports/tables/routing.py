"""Tables that people read, as plain rows: routes of an answer, sites it leaves out, facts of an instance, solvers, heuristics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.rendering import number
from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ...instances.printable import printable
from .assignments import assignment_facts, assignment_rows

if TYPE_CHECKING:
    from ...solving.listing import HeuristicInfo, SolverInfo


@dataclass(frozen=True)
class Column:
    """Heading of a column; numbers stand to the right, and ``wide`` columns take the room that is left."""

    name: str
    right: bool = False
    wide: bool = False


@dataclass(frozen=True)
class Table:
    """A titled table of texts, made printable; every row has one entry a column. ``total`` is a last row set apart.

    Only ``wide`` columns show texts of any length.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    total: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        def cleaned(row: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(printable(c, len(c) if column.wide else SHOWN_CELL) for c, column in zip(row, self.columns, strict=True))

        object.__setattr__(self, "title", printable(self.title))
        object.__setattr__(self, "rows", tuple(cleaned(row) for row in self.rows))
        object.__setattr__(self, "total", cleaned(self.total) if self.total else ())


SHOWN_ID = 60
"""Characters of a site's id that are shown among others."""

SHOWN_CELL = 200
"""Characters of an entry that are shown, where its column is not wide."""

SHOWN_ROWS = 20
"""Rows of an answer that are shown; a solution file holds them all."""


def answer_table(problem: Problem, answer: Any) -> Table:
    """The first rows of an answer that is no set of routes, as its frame has them."""
    frame = problem.answer_to_frame(answer)
    numeric = [frame[title].dtype.kind in "iuf" for title in frame.columns]
    columns = tuple(Column(str(title), right=right) for title, right in zip(frame.columns, numeric, strict=True))
    rows = [
        tuple(_short(float(v)) if right else str(v) for v, right in zip(row, numeric, strict=True))
        for row in frame.head(SHOWN_ROWS).itertuples(index=False)
    ]
    left = len(frame) - len(rows)
    if left > 0:
        rows.append((f"and {left} more", *[""] * (len(columns) - 1)))
    return Table("Answer", columns, tuple(rows))


def routes_table(problem: RoutingProblem, answer: Routes) -> Table:
    """One row a route: vehicle, number of visits, load, distance, duration, and the sites in order."""
    from ...formulations.routing.judge import schedule

    ids = problem.sites.ids
    rows, visits, load, distance, duration = [], 0, 0.0, 0.0, 0.0
    for k, route in enumerate(answer):
        plan = schedule(problem, route)
        name = problem.vehicle_name(k, route.vehicle)
        rows.append(
            (
                name,
                str(len(route)),
                _short(plan.total_load),
                _short(plan.total_distance),
                _short(plan.duration),
                " ".join(printable(ids[i], SHOWN_ID) for i in route.visits),
            )
        )
        visits, load, distance = visits + len(route), load + plan.total_load, distance + plan.total_distance
        duration = max(duration, plan.duration)
    columns = (
        Column("vehicle"), Column("visits", right=True), Column("load", right=True), Column("distance", right=True),
        Column("duration", right=True), Column("sites in order", wide=True),
    )  # fmt: skip
    total = ("all", str(visits), _short(load), _short(distance), f"max {_short(duration)}", "")
    return Table("Routes", columns, tuple(rows), total)


def unserved_sites(problem: RoutingProblem, answer: Routes | None) -> dict[str, str]:
    """Sites that the answer does not visit (all that are unreachable without one), each with the reason."""
    from ...formulations.routing.reachability import unreachable

    ids = problem.sites.ids
    if answer is None:
        return {ids[i]: why for i, why in unreachable(problem).items()}
    visited = {i for route in answer for i in route.visits}
    left = [int(i) for i in problem.customers if int(i) not in visited]
    reasons = unreachable(problem) if left else {}  # which takes long where there are thousands
    return {ids[i]: reasons.get(i, "optional, and left out of this answer") for i in left}


def unserved_table(reasons: dict[str, str]) -> Table:
    """One row a site that stays unserved."""
    return Table("Unserved sites", (Column("site"), Column("reason", wide=True)), tuple(reasons.items()))


def facts(problem: Problem) -> dict[str, Any]:
    """What a problem holds, as plain JSON values."""
    data: dict[str, Any] = {
        "name": problem.name,
        "problem": problem.problem,
        "family": problem.family,
        "senses": list(problem.senses),
        "convention": problem.convention,
        "instance_hash": problem.digest(),
        "features": sorted(problem.features()),
        "forms": problem.forms(),
        "notes": list(problem.notes),
    }
    if isinstance(problem, RoutingProblem):
        data.update(_routing_facts(problem))
    return {**data, **assignment_facts(problem)}


def _routing_facts(p: RoutingProblem) -> dict[str, Any]:
    s, at = p.sites, p.customers
    windows = (s.ready[at] > 0) | np.isfinite(s.due[at])
    due = s.due[at][np.isfinite(s.due[at])]
    return {
        "objective": str(p.objective),
        "sites": {
            "depots": [s.ids[i] for i in s.depots],
            "customers": len(at),
            "optional": int((~s.required[at]).sum()),
            "unreachable": len(unserved_sites(p, None)),
        },
        "demand": _spread(s.demand[at]),
        "service": _spread(s.service[at]),
        "windows": {
            "sites": int(windows.sum()),
            "earliest": float(s.ready[at].min(initial=math.inf)),
            "latest": float(due.max()) if len(due) else None,
            "depot": [[float(s.ready[i]), float(s.due[i])] for i in s.depots],
        },
        "travel": {
            "metric": p.travel.metric,
            "coordinates": s.coordinates is not None,
            "own_durations": p.travel.duration_matrix is not None,
        },
        "fleet": [
            {
                "name": v.name,
                "count": v.count,
                "capacity": v.capacity,
                "start": s.ids[v.start],
                "end": s.ids[v.end],
                "max_duration": v.max_duration,
                "max_distance": v.max_distance,
                "fixed_cost": v.fixed_cost,
                "unit_cost": v.unit_cost,
                "energy": None if v.energy is None else {"capacity": v.energy.capacity, "rate": v.energy.rate, "charge": v.energy.charge},
            }
            for v in p.fleet
        ],
        "min_vehicles": p.min_vehicles,
    }


def _spread(values: np.ndarray[Any, Any]) -> dict[str, float]:
    if not len(values):
        return {"total": 0.0, "least": 0.0, "largest": 0.0}
    return {"total": float(math.fsum(values)), "least": float(values.min()), "largest": float(values.max())}


def facts_table(data: dict[str, Any]) -> Table:
    """The facts of a problem, one a row."""
    rows = [
        ("problem", f"{data['problem']}, {' then '.join(data['senses'])}" + (f" {data['objective']}" if "objective" in data else "")),
        ("convention", data["convention"]),
    ]
    if "sites" in data:
        rows += _routing_rows(data)
    rows += assignment_rows(data)
    rows += [("features", ", ".join(data["features"])), ("forms", ", ".join(data["forms"]) or "none"), ("hash", data["instance_hash"])]
    rows += [("note", note) for note in data["notes"]]
    return Table(data["name"], (Column(""), Column("", wide=True)), tuple(rows))


def _routing_rows(data: dict[str, Any]) -> list[tuple[str, str]]:
    sites, windows, travel = data["sites"], data["windows"], data["travel"]
    text = f"{sites['customers']} customers, depot {', '.join(sites['depots'])}"
    if sites["optional"]:
        text += f"; {sites['optional']} customers are optional"
    if sites["unreachable"]:
        text += f"; {sites['unreachable']} customers cannot be reached by any vehicle (see waybound explain)"
    rows = [("sites", text)]
    if data["demand"]["largest"] > 0:
        rows.append(("demand", "total {total:g}, {least:g} to {largest:g} a customer".format(**data["demand"])))
    if data["service"]["largest"] > 0:
        rows.append(("service", "total {total:g}, {least:g} to {largest:g} a customer".format(**data["service"])))
    if windows["sites"]:
        latest = "" if windows["latest"] is None else f", the last closes at {windows['latest']:g}"
        rows.append(("windows", f"{windows['sites']} customers{latest}"))
    opening = [w for w in windows["depot"] if w[0] != 0 or math.isfinite(w[1])]
    if opening:
        rows.append(("depot open", ", ".join(f"{a:g} to {b:g}" for a, b in opening)))
    own = ", durations of their own" if travel["own_durations"] else ""
    rows.append(("travel", f"{travel['metric']}{own}" + ("" if travel["coordinates"] else ", no coordinates")))
    for v in data["fleet"]:
        count = "any number of vehicles" if v["count"] is None else f"at most {v['count']}"
        words = {"capacity": "capacity", "max_duration": "duration up to", "max_distance": "distance up to"}
        limits = [f"{words[key]} {v[key]:g}" for key in words if math.isfinite(v[key])]
        if v["energy"] is not None:
            limits.append("energy {capacity:g} at rate {rate:g} ({charge})".format(**v["energy"]))
        rows.append(("fleet", f"{v['name']}: " + ", ".join([count, *limits])))
    if data["min_vehicles"]:
        rows.append(("", f"at least {data['min_vehicles']} routes"))
    return rows


def solvers_table(infos: Sequence[SolverInfo], *, asked: bool) -> Table:
    """Solvers; with ``asked``, whether each takes the problem asked about."""
    rows = []
    for info in infos:
        if not info.installed:
            state = f"not installed: {info.install}"
        elif not asked:
            state = info.version
        else:
            state = f"lacks {', '.join(info.missing)}" if info.missing else f"takes it ({info.version})"
        rows.append((info.name, state, info.takes, info.summary))
    columns = (Column("solver"), Column("takes it" if asked else "version"), Column("kinds"), Column("summary", wide=True))
    return Table("Solvers", columns, tuple(rows))


def heuristics_table(infos: Sequence[HeuristicInfo], *, asked: bool) -> Table:
    """Heuristics with what they guarantee; with ``asked``, whether each takes the problem asked about."""
    columns = [Column("heuristic"), Column("guarantee"), Column("options"), Column("summary", wide=True)]
    rows = [[i.name, i.guarantee, ", ".join(i.parameters) or "-", i.summary] for i in infos]
    if asked:
        columns.insert(1, Column("takes it"))
        for row, info in zip(rows, infos, strict=True):
            row.insert(1, f"lacks {', '.join(info.missing)}" if info.missing else "takes it")
    return Table("Heuristics", tuple(columns), tuple(tuple(row) for row in rows))


def _short(value: float) -> str:
    """A quantity with at most three decimals: tables are for reading, files hold the digits."""
    return number(round(value, 3))
