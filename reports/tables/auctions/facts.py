"""Facts of assignments, tasks and jobs as rows of a table."""

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _assignment(g: dict[str, Any]) -> list[Row]:
    forbidden = f", {g['forbidden']} forbidden" if g["forbidden"] else ", all of them"
    (few, many), (least, most) = g["bins_a_robot"], g["robots_a_bin"]
    whole = ", all whole" if g["whole_costs"] else ""
    rows = [
        ("robots", f"{g['robots']}, each for {few} to {many} bins"),
        ("bins", f"{g['bins']}, each for {least} to {most} robots"),
        ("pairs", f"{g['pairs']}{forbidden}"),
    ]
    if g["costs"]:
        rows.append(("costs", f"{g['costs'][0]:.6g} to {g['costs'][1]:.6g}{whole}"))
    if g["not_yet_full"]:
        rows.append(("waiting", f"{g['not_yet_full']} bins are not yet full"))
    return [*rows, ("positions", "of robots and bins" if g["positions"] else "none")]


def _generalised_assignment(g: dict[str, Any]) -> list[Row]:
    def between(key: str) -> str:
        return f"{g[key][0]:.6g} to {g[key][1]:.6g}" if g[key] else "none"

    forbidden = f", {g['forbidden']} pairs forbidden" if g["forbidden"] else ""
    return [
        ("agents", f"{g['agents']}, capacities {between('capacity')}, {g['capacity_of_all']:.6g} together"),
        ("jobs", f"{g['jobs']}{forbidden}"),
        ("profits" if g["objective"] == "profit" else "costs", between("values")),
        ("consumption", between("consumption")),
    ]


def _joint_assignment(g: dict[str, Any]) -> list[Row]:
    late = f", {g['not_yet_full']} of them not yet full" if g["not_yet_full"] else ""
    robots = f"{g['robots']}, {g['bringing']} of them have something to bring"
    return [("robots", robots), ("bins", f"{g['bins']}{late}"), ("requests", str(g["requests"]))]


def _orchard(g: dict[str, Any]) -> list[Row]:
    away = f", {g['robots_away']} of them in the field" if g["robots_away"] else ""
    return [
        ("orchard", f"{g['rows']} lanes of {g['columns']} cells"),
        ("robots", f"{g['robots']}{away}"),
        ("bins", f"{g['bins']}, {g['bins'] - g['bins_standing']} of them to be brought; {g['work']} steps to fill all"),
    ]


def _exploration(g: dict[str, Any]) -> list[Row]:
    return [
        ("rooms", f"{g['rooms']}, {g['doors']} doors, {g['heard_at_base']} rooms are heard at the base"),
        ("robots", f"{g['robots']}, {g['steps']} steps each, {g['silence']} of them in a row without contact"),
        ("first gains", f"exploring {g['exploring']:.6g}, mapping {g['mapping']:.6g}, searching {g['searching']:.6g}"),
    ]


def _team(g: dict[str, Any]) -> list[Row]:
    (nearest, farthest), weights = g["distances"], g["weights"]
    return [
        ("robots", str(g["robots"])),
        ("tasks", f"{g['tasks']}, of weight {weights:.6g} together" if weights else str(g["tasks"])),
        ("distances", f"{g['metric']}, {nearest:.6g} to {farthest:.6g}"),
    ]


TABLES.add("bin-assignment", Tables({"assignment": _assignment}))
TABLES.add("generalised-assignment", Tables({"generalised_assignment": _generalised_assignment}))
TABLES.add("joint-assignment", Tables({"joint_assignment": _joint_assignment}))
TABLES.add("orchard-day", Tables({"orchard": _orchard}))
TABLES.add("room-exploration", Tables({"exploration": _exploration}))
TABLES.add("task-allocation", Tables({"team": _team}))
TABLES.add("balanced-partition", Tables({"team": _team}))
