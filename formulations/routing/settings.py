"""The parts of a routing problem that an instance and ``--set`` values stand for."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...instances.errors import InputError, UsageError
from ...instances.formats import FORMATS
from ...instances.routing.instance import RoutingInstance
from ...instances.routing.travel import convention_named
from ...instances.suggestions import did_you_mean
from .objective import Objective, default_objective, pointless

KNOWN = ("vehicles", "vehicles-exactly", "capacity", "customers", "risk", "team-risk", "objective")


def parts_of(instance: RoutingInstance, problem: str | None, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of ``RoutingProblem`` for an instance, read as ``problem``, with ``settings`` of ``KNOWN`` and ``convention``.

    Raises UsageError for a problem that the data do not allow, and a setting that is unknown, out of range or means nothing here.
    """
    name = problem or instance.problem
    if name not in instance.problems:
        allowed = ", ".join(instance.problems)
        raise UsageError(f"{instance.name} ({instance.format}) cannot be read as {name}; it allows {allowed}")
    rest = dict(settings)
    convention = rest.pop("convention", None)
    customers = rest.pop("customers", None)
    if customers is not None:
        instance = instance.with_customers(_whole("customers", customers))
    travel = instance.travel
    fleet, least, notes = instance.fleet, instance.min_vehicles, instance.notes
    if convention is not None:
        known = convention_named(convention)
        travel = travel.with_convention(known)
        fleet = tuple(v if v.travel is None else replace(v, travel=v.travel.with_convention(known)) for v in fleet)
    if "capacity" in rest:
        fleet = tuple(replace(v, capacity=_positive("capacity", rest["capacity"])) for v in fleet)
        del rest["capacity"]
    risks = {key: _positive(key, rest.pop(key)) for key in ("risk", "team-risk") if key in rest}
    if risks and not any(t.uncertain for t in (travel, *(v.travel for v in fleet if v.travel is not None))):
        raise UsageError(f"durations of {instance.name} are certain, so that a risk limits nothing; its travel needs variances")
    if "risk" in risks:
        fleet = tuple(replace(v, risk=risks["risk"]) for v in fleet)
    if {"vehicles", "vehicles-exactly"} <= rest.keys():
        raise UsageError("set either vehicles or vehicles-exactly, not both")
    for key in ("vehicles", "vehicles-exactly"):
        if key in rest:
            value = rest.pop(key)
            if len(fleet) > 1:
                raise UsageError(f"{key} can only be set for a fleet of one type; {instance.name} has {len(fleet)}")
            count = None if key == "vehicles" and value in ("unlimited", None) else _whole(key, value)
            fleet = (replace(fleet[0], count=count),)
            least = 0 if key == "vehicles" or count is None else count
            notes = ()
    asked = rest.pop("objective", None)
    if rest:
        read = FORMATS[instance.format].settings if instance.format in FORMATS.names() else ()
        keys = tuple(dict.fromkeys((*KNOWN, *read)))
        known = f"{', '.join(keys)}{did_you_mean(min(rest), keys)}"
        raise UsageError(f"unknown setting {', '.join(sorted(rest))}; routing problems take {known}", "unknown-name")
    return {
        "sites": instance.sites, "travel": travel, "fleet": fleet, "objective": _objective(instance, name, asked),
        "min_vehicles": least, "name": instance.name,
        "problem": name, "notes": notes, "team_risk": risks.get("team-risk", instance.team_risk),
        "forbidden": instance.forbidden, "clock": instance.clock,
    }  # fmt: skip


def _objective(instance: RoutingInstance, name: str, asked: Any) -> Objective:
    """The objective that is asked for, or that of the file, or the usual one of the problem."""
    sites, usual = instance.sites, default_objective(name, instance.sites)
    if asked is not None:
        objective = Objective.of(asked)
        for term, values in (("reward", sites.reward), ("penalties", sites.penalty)):
            if f"objective:{term}" in objective.features() and not values.any():
                raise UsageError(f"objective {str(objective)!r}: no site of {instance.name} has any {term}, so that it would count nothing")
        return objective
    if instance.objective and (name == instance.problem or usual == Objective()):
        return Objective.named(instance.objective)
    if not instance.min_vehicles and pointless(sites) == len(sites.customers):
        raise InputError(
            "all sites may be left out, and nothing tells what a visit is worth, so that none would be visited",
            "missing",
            expected="a reward or a penalty, or the objective total-cost by name",
        )
    return usual


def _whole(name: str, value: Any) -> int:
    try:
        number = int(str(value))
    except ValueError:
        raise UsageError(f"{name} must be a whole number, not {value!r}", "malformed") from None
    if number < 1:
        raise UsageError(f"{name} must be at least 1, not {number}", "out-of-range")
    return number


def _positive(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be a number, not {value!r}", "malformed") from None
    if not number > 0:
        raise UsageError(f"{name} must be positive, not {value!r}", "out-of-range")
    return number
