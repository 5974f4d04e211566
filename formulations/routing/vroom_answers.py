"""Answers as VROOM's JSON: the output of ``vroom``, and answers written in its place."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ...instances.document import array, integer, kind_of
from ...instances.errors import InputError, UsageError
from ...instances.printable import printable
from .judge import schedule
from .routes import Route, Routes

if TYPE_CHECKING:
    from .problem import RoutingProblem

_NUMBERS = re.compile(r"vehicle((?: [0-9]{1,18})+)\Z")
PREFIXES = {"job": "", "pickup": "pickup ", "delivery": "delivery "}
"""Prefix of a site's id before its number, by the type of a step."""


def is_vroom_output(data: Mapping[str, Any]) -> bool:
    """Whether a document is VROOM's output: a code with routes or an error, or routes of steps."""
    routes = data.get("routes")
    if "kind" in data or "answer" in data:
        return False
    if "code" in data:
        return isinstance(routes, list) or "error" in data
    return isinstance(routes, list) and any(isinstance(route, dict) and "steps" in route for route in routes)


def routes_from_vroom(problem: RoutingProblem, data: Mapping[str, Any]) -> Routes:
    """The routes of VROOM's output; raises InputError if it is broken, tells of an error, or names an unknown task or vehicle.

    Jobs are sites with their number as id, shipments have sites ``pickup 3`` and ``delivery 3``, and vehicles the types that
    are named for their numbers; where there is one type alone, it drives all routes.
    """
    code = integer(data.get("code", 0), "code", 0)
    if code:
        said = data.get("error", "")
        raise InputError(
            f"VROOM found no answer: error {code}", "missing", found=printable(said if isinstance(said, str) else kind_of(said), 80)
        )
    index = problem.sites.index() if _numbered(problem) else {str(k): k for k in problem.customers.tolist()}
    types = _types(problem)
    routes = []
    for k, route in enumerate(array(data.get("routes"), "routes")):
        path = f"routes[{k}]"
        if not isinstance(route, dict) or not {"vehicle", "steps"} <= route.keys():
            raise InputError(f"{path} must be an object with the keys vehicle and steps", found=kind_of(route))
        number = integer(route["vehicle"], f"{path}.vehicle", 0)
        if types and number not in types:
            raise InputError(
                f"{path}.vehicle names no vehicle", "unknown-name", expected=", ".join(map(str, sorted(types)[:20])), found=str(number)
            )
        steps = [_step(step, f"{path}.steps[{s}]", index) for s, step in enumerate(array(route["steps"], f"{path}.steps"))]
        if types or len(problem.fleet) == 1:
            kind = types.get(number, 0)
        else:
            kind = _named(problem, route.get("description"), f"{path}.description")
        routes.append(Route(tuple(site for site in steps if site is not None), kind))
    return Routes(tuple(routes))


def _types(problem: RoutingProblem) -> dict[int, int]:
    """Type of each vehicle number; empty where types do not have one number for each of their vehicles, so that names tell them."""
    types: dict[int, int] = {}
    for kind, vehicle in enumerate(problem.fleet):
        numbers = _numbers(problem, kind)
        if vehicle.count is None or vehicle.count > len(numbers) or types.keys() & set(numbers):
            return {}
        types |= dict.fromkeys(numbers, kind)
    return types


def _named(problem: RoutingProblem, description: Any, path: str) -> int:
    """Type of the vehicle that is described so."""
    names = {v.name: k for k, v in enumerate(problem.fleet)}
    text = description if isinstance(description, str) else ""
    short = text if text in names else text.rpartition(" ")[0]
    if short not in names:
        raise InputError(f"{path} names no vehicle", "unknown-name", expected=", ".join(names), found=printable(text, 60) or "nothing")
    return names[short]


def _numbered(problem: RoutingProblem) -> bool:
    """Whether sites are named as VROOM's tasks: by a number, or one behind pickup or delivery."""
    ids = problem.sites.ids
    return all(_TASK.fullmatch(ids[k]) for k in problem.customers.tolist())


_TASK = re.compile(r"(?:(?:pickup|delivery) )?[0-9]{1,18}")


def _numbers(problem: RoutingProblem, kind: int) -> list[int]:
    """The ids of the vehicles of a type, from its name."""
    match = _NUMBERS.match(problem.fleet[kind].name)
    return [int(each) for each in match[1].split()] if match else []


def _step(step: Any, path: str, index: Mapping[str, int]) -> int | None:
    """The site of a step, None for where a vehicle starts and ends."""
    if not isinstance(step, dict) or not isinstance(step.get("type"), str):
        raise InputError(f"{path} must be an object with a type", found=kind_of(step))
    what = step["type"]
    if what in ("start", "end"):
        return None
    if what not in PREFIXES:
        raise InputError(
            f"{path}.type is not supported", "unsupported", expected=", ".join(("start", "end", *PREFIXES)), found=kind_of(what)
        )
    if "id" not in step:
        raise InputError(f"{path} lacks the key 'id'", "missing")
    site = f"{PREFIXES[what]}{integer(step['id'], f'{path}.id', 0)}"
    if site not in index:
        raise InputError(f"{path} names a task that does not exist", "unknown-name", expected="an id of the instance", found=site)
    return index[site]


def vroom_output(problem: RoutingProblem, answer: Routes) -> dict[str, Any]:
    """``answer`` as VROOM prints its own: times, loads and costs recomputed from the data.

    Sites that are not called by numbers get their place in the file, counted from 0, as number, and their name as description; so do
    vehicles.
    """
    sites, ids = problem.sites, problem.sites.ids
    tasks = {}
    numbered = _numbered(problem)
    for k in problem.customers.tolist():
        what, _, number = ids[k].rpartition(" ")
        tasks[k] = {"type": what or "job", "id": int(number)} if numbered else {"type": "job", "id": k, "description": ids[k]}
        if sites.geographic and sites.coordinates is not None:
            tasks[k]["location"] = sites.coordinates[k].tolist()
    numbered_types = _types(problem)
    used = [0] * len(problem.fleet)
    routes: list[dict[str, Any]] = []
    names = problem.vehicle_names(answer)
    for name, route in zip(names, answer, strict=True):
        if not route.visits:
            continue
        vehicle, plan = problem.fleet[route.vehicle], schedule(problem, route)
        numbers = _numbers(problem, route.vehicle) if numbered_types else []
        used[route.vehicle] += 1
        at = used[route.vehicle]
        if numbers and at > len(numbers):
            raise UsageError(f"{at} routes use {vehicle.name}, of which there are {len(numbers)}")
        visits = [
            {
                **tasks[site],
                "arrival": plan.arrival[k],
                "waiting_time": plan.begin[k] - plan.arrival[k],
                "service": sites.service[site],
                "distance": plan.distance[k],
            }
            for k, site in enumerate(route.visits)
        ]
        ends = {"type": "start", "arrival": plan.departure}, {"type": "end", "arrival": plan.finish, "distance": plan.total_distance}
        routes.append(
            {
                "vehicle": numbers[at - 1] if numbers else len(routes) + 1,
                **({} if numbers else {"description": name}),
                "cost": plan.cost(vehicle),
                "waiting_time": plan.waiting,
                "steps": [ends[0], *visits, ends[1]],
            }
        )
    visited = {site for route in answer for site in route.visits}
    unassigned = [tasks[k] for k in tasks if k not in visited]
    summary = {"cost": math.fsum(route["cost"] for route in routes), "routes": len(routes), "unassigned": len(unassigned)}
    return {"code": 0, "summary": summary, "unassigned": unassigned, "routes": routes}
