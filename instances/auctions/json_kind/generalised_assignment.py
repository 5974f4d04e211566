"""Generalised assignments in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...document import array, fields, integer, json_numbers, reals, string, strings
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..generalised_assignment import OBJECTIVES, PROBLEMS, GeneralisedAssignmentInstance

KEYS = ("name", "problem", "agents", "jobs", *OBJECTIVES, "consumption", "notes")
AGENT_KEYS = ("count", "name", "capacity")
JOB_KEYS = ("count", "name")


def encode(instance: GeneralisedAssignmentInstance) -> dict[str, Any]:
    """The keys of an instance."""
    agents: dict[str, Any] = {"count": instance.num_agents, "capacity": json_numbers(instance.capacity)}
    jobs: dict[str, Any] = {"count": instance.num_jobs}
    for part, names in ((agents, instance.agent_names), (jobs, instance.job_names)):
        if names is not None:
            part["name"] = list(names)
    data = {
        "name": instance.name, "problem": instance.problem, "agents": agents, "jobs": jobs,
        instance.objective: json_numbers(np.where(instance.listed, instance.values, math.inf)),
        "consumption": json_numbers(instance.consumption),
    }  # fmt: skip
    return {**data, "notes": list(instance.notes)} if instance.notes else data


def decode(data: dict[str, Any]) -> GeneralisedAssignmentInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "agents", "jobs", "consumption"))
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of generalised assignments", expected=", ".join(PROBLEMS), found=problem)
    if (OBJECTIVES[0] in data) == (OBJECTIVES[1] in data):
        raise InputError("pairs have either costs or profits", expected="the key 'cost' or the key 'profit'")
    objective = next(key for key in OBJECTIVES if key in data)
    agents, jobs = fields(data["agents"], "agents", AGENT_KEYS, ("count", "capacity")), fields(data["jobs"], "jobs", JOB_KEYS, ("count",))
    m, n = integer(agents["count"], "agents.count", 1), integer(jobs["count"], "jobs.count", 1)
    none = -math.inf if objective == "profit" else math.inf
    values = [reals(row, f"{objective}[{k}]", n, null=none) for k, row in enumerate(array(data[objective], objective, m))]
    used = [reals(row, f"consumption[{k}]", n) for k, row in enumerate(array(data["consumption"], "consumption", m))]
    return GeneralisedAssignmentInstance(
        np.array(values), np.array(used), reals(agents["capacity"], "agents.capacity", m), objective,
        strings(agents["name"], "agents.name") if "name" in agents else None,
        strings(jobs["name"], "jobs.name") if "name" in jobs else None, name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


KINDS.add("generalised-assignment", Kind("generalised-assignment", encode, decode))
