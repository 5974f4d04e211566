"""Tables of routes, of sites that stay unserved, and of what a routing problem holds."""

import math
from dataclasses import replace
from functools import partial
from typing import Any

from ....formulations.routing.judge import schedule
from ....formulations.routing.overrun import joint_overrun, route_overrun
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import unreachable
from ....formulations.routing.routes import Routes
from ....instances.clock import Clock, moment_told
from ....instances.printable import printable
from ....instances.routing.features import RISKS
from ....instances.routing.geography import Middle
from .. import TABLES, Tables
from ..answers import frame_table
from ..facts import plain_text
from ..table import Column, Row, Table, short

SHOWN_UNSERVED = 10
"""Unserved sites that are shown unless all are asked for."""

SHOWN_ID = 60
"""Characters of a site's id that are shown among others."""


def answer_tables(problem: RoutingProblem, answer: Routes | None) -> list[Table]:
    """The routes, their visits where more is known of the sites than is computed with, and the sites that they leave out, if any."""
    tables = [] if answer is None else [routes_table(problem, answer)]
    if answer is not None and problem.sites.attributes:
        tables.append(visits_table(problem, answer))
    reasons = unserved_sites(problem, answer)
    return [*tables, *([unserved_table(reasons)] if reasons else [])]


def routes_table(problem: RoutingProblem, answer: Routes) -> Table:
    """One row per route: vehicle, visits, load, distance, duration, the probability of an overrun where that is limited, and the sites in
    order."""
    ids, risky = problem.sites.ids, bool(problem.features() & RISKS)
    overruns: list[float] = []
    rows, visits, load, distance, duration = [], 0, 0.0, 0.0, 0.0
    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        plan = schedule(problem, route)
        vehicle = problem.fleet[route.vehicle]
        limited = vehicle.risk is not None or problem.team_risk is not None
        overruns.append(route_overrun(vehicle, plan) if risky and limited else 0.0)
        figures = [short(value) for value in (plan.total_load, plan.total_distance, plan.duration)]
        figures += [f"{overruns[-1]:.3g}"] if risky else []
        rows.append((name, str(len(route)), *figures, " ".join(printable(ids[i], SHOWN_ID) for i in route.visits)))
        visits, load, distance = visits + len(route), load + plan.total_load, distance + plan.total_distance
        duration = max(duration, plan.duration)
    numbers = ("visits", "load", "distance", "duration", *(["overrun"] if risky else []))
    columns = (Column("vehicle"), *(Column(number, right=True) for number in numbers), Column("sites in order", wide=True))
    joint = [f"{joint_overrun(overruns):.3g}"] if risky else []
    total = ("all", str(visits), short(load), short(distance), f"max {short(duration)}", *joint, "")
    return Table("Routes", columns, tuple(rows), total)


def visits_table(problem: RoutingProblem, answer: Routes) -> Table:
    """The first visits: vehicle, site, when service begins, and what else is known of the site."""
    frame = problem.answer_to_frame(answer)
    kept = list(frame.columns[-len(problem.sites.attributes) :])
    return replace(frame_table(frame[["vehicle", "site", "begin", *kept]]), title="Visits")


def unserved_sites(problem: RoutingProblem, answer: Routes | None) -> dict[str, str]:
    """Sites that the answer does not visit (without an answer, all that are unreachable), each with the reason."""
    if answer is None:
        return {problem.sites.ids[i]: why for i, why in unreachable(problem).items()}
    return {one.where: one.reason for one in problem.left_out(answer)}


def unserved_table(reasons: dict[str, str]) -> Table:
    """One row per site that stays unserved."""
    return Table("Unserved sites", (Column("site"), Column("reason", wide=True)), tuple(reasons.items()), most=SHOWN_UNSERVED)


# -- what a problem holds --------------------------------------------------------------------------------------------------


def _sites(sites: dict[str, Any]) -> list[Row]:
    text = f"{sites['customers']} customers, depot {', '.join(sites['depots'])}"
    if sites["optional"]:
        text += f"; {sites['optional']} customers are optional"
    if count := sites["unreachable"]:
        text += f"; {count} {'customer' if count == 1 else 'customers'} cannot be reached by any vehicle (see waybound explain)"
    return [("sites", text)]


def _spread(name: str, values: dict[str, float]) -> list[Row]:
    return [(name, "total {total:g}, {least:g} to {largest:g} a customer".format(**values))] if values["largest"] > 0 else []


def _windows(windows: dict[str, Any]) -> list[Row]:
    moment = partial(moment_told, Clock(**windows["clock"]) if "clock" in windows else None)
    latest = "" if windows["latest"] is None else f", the last closes at {moment(windows['latest'])}"
    opening = [f"{moment(a)} to {moment(b)}" for a, b in windows["depot"] if a != 0 or math.isfinite(b)]
    rows = [("windows", f"{windows['sites']} customers{latest}")] if windows["sites"] else []
    return [*rows, *([("depot open", ", ".join(opening))] if opening else [])]


def _travel(travel: dict[str, Any]) -> list[Row]:
    own = ", durations of their own" if travel["own_durations"] else ""
    closing = f", {travel['closing_moves']} moves close" if "closing_moves" in travel else ""
    closing += f", {travel['forbidden_moves']} moves are forbidden" if "forbidden_moves" in travel else ""
    spread = f", uncertain durations of variance up to {travel['largest_variance']:g}" if "largest_variance" in travel else ""
    return [("travel", f"{travel['metric']}{own}" + ("" if travel["coordinates"] else ", no coordinates") + closing + spread)]


def _fleet(fleet: list[dict[str, Any]]) -> list[Row]:
    rows, starts = [], {v["start"] for v in fleet}
    for v in fleet:
        count = "any number of vehicles" if v["count"] is None else f"at most {v['count']}"
        words = {"capacity": "capacity", "max_duration": "duration up to", "max_distance": "distance up to"}
        limits = [f"{words[key]} {v[key]:g}" for key in words if math.isfinite(v[key])]
        if v["energy"] is not None:
            limits.append("energy {capacity:g} at rate {rate:g} ({charge})".format(**v["energy"]))
            limits += [f"{v['energy']['initial']:g} at departure"] if "initial" in v["energy"] else []
            limits += [f"recharging at {plain_text(v['energy']['stations'])}"] if "stations" in v["energy"] else []
        limits += [f"fixed cost {v['fixed_cost']:g}"] if v["fixed_cost"] else []
        limits += [f"unit cost {v['unit_cost']:g}"] if v["unit_cost"] != 1 else []
        limits += [f"from {v['start']} to {v['end']}"] if v["start"] != v["end"] or len(starts) > 1 else []
        limits += [f"{name.replace('_', ' ')} {plain_text(value)}" for name, value in v.items() if name not in USUAL]
        rows.append(("fleet", f"{v['name']}: " + ", ".join([count, *limits])))
    return rows


USUAL = ("name", "count", "capacity", "start", "end", "max_duration", "max_distance", "energy", "fixed_cost", "unit_cost")
"""Fields of a vehicle type told in words of their own or not at all; all others are told by name where they are not the usual ones."""


def _least(routes: int) -> list[Row]:
    return [("", f"at least {routes} routes")] if routes else []


TABLES.add(
    "routing",
    Tables(
        {
            "sites": _sites, "demand": partial(_spread, "demand"), "service": partial(_spread, "service"), "windows": _windows,
            "around": lambda place: [("place", f"{Middle(**place)}, all within {place['within']:.3g} km of it")],
            "travel": _travel, "fleet": _fleet, "min_vehicles": _least,
        },
        answer_tables,
    ),
)  # fmt: skip
