"""Generalised assignments in CSV: one row per pair of agent and job, and one per capacity; documented in ``docs/formats.md``."""

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import check_kind, check_name, name_of, settings_of, table_of, titles_of, written
from ...text import number, plain, shown
from ..generalised_assignment import OBJECTIVES, PROBLEMS, GeneralisedAssignmentInstance

COLUMNS = ("agent", "job", *OBJECTIVES, "consumption", "capacity")
KEYS = ("name",)


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds the titles ``agent``, ``job``, ``consumption`` and ``capacity``."""
    return {"agent", "job", "consumption", "capacity"} <= titles_of(text)


def read(text: str, path: Path) -> GeneralisedAssignmentInstance:
    """The instance; see ``Format.read``. Agents are numbered as their capacities stand, jobs as they first appear."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, COLUMNS, "pairs")
    objectives = [key for key in OBJECTIVES if key in table.titles]
    if len(objectives) != 1 or not {"agent", "job", "consumption", "capacity"} <= set(table.titles):
        expected = "agent, job, cost or profit, consumption, capacity"
        raise InputError("has other titles", line=start + 1, expected=expected, found=", ".join(table.titles))
    objective = objectives[0]
    agent, job, value, used, most = ((table.column(t) or []) for t in ("agent", "job", objective, "consumption", "capacity"))
    capacity: dict[str, float] = {}
    pairs: dict[tuple[str, str], int] = {}
    numbers: list[tuple[float, float]] = []
    for k, line in enumerate(table.at):
        check_name("agent", agent[k], line)
        check_name("job", job[k], line, optional=bool(most[k]))
        if bool(job[k]) == bool(most[k]):
            raise InputError(
                "a row is that of a capacity or of a job", "contradiction", line=line, expected="a job, or a capacity and no job"
            )
        if not job[k]:
            if agent[k] in capacity:
                raise InputError(f"agent {shown(agent[k])} has two capacities", "duplicate", line=line)
            if value[k] or used[k]:
                raise InputError(
                    "a capacity stands alone", "contradiction", line=line, expected=f"empty cells under {objective} and consumption"
                )
            capacity[agent[k]] = number(most[k], line, "capacity")
        else:
            if (agent[k], job[k]) in pairs:
                raise InputError(f"the pair stands twice, first in line {pairs[agent[k], job[k]]}", "duplicate", line=line)
            pairs[agent[k], job[k]] = line
            numbers.append((number(value[k], line, objective), number(used[k], line, "consumption")))
    lacking = next((line for (who, _), line in pairs.items() if who not in capacity), None)
    if lacking is not None:
        raise InputError(
            "the agent has no capacity", "missing", line=lacking, expected="a row of the agent, without a job, with a capacity"
        )
    if not pairs:
        raise InputError("holds no pairs of agents and jobs", "missing", expected="one row each")
    (agents, jobs), (values, consumption) = zip(*pairs, strict=True), np.array(numbers).T
    return GeneralisedAssignmentInstance.from_pairs(
        tuple(capacity), tuple(dict.fromkeys(jobs)), agents, jobs, values, consumption, list(capacity.values()), objective,
        name=name_of(settings, path), format="agent-jobs",
    )  # fmt: skip


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, GeneralisedAssignmentInstance, "agents with capacities", "agent-jobs")
    there = instance.listed
    if not there.any(axis=0).all():
        raise UsageError(f"{instance.name} cannot be written as agent-jobs: a job has no agent; use json", "unsupported")
    rows = [[instance.agent_name(i), "", "", "", plain(b)] for i, b in enumerate(instance.capacity.tolist())]
    order = sorted(np.argwhere(there).tolist(), key=lambda pair: pair[1])  # so that jobs appear in the order of their numbers
    for i, j in order:
        rows.append([instance.agent_name(i), instance.job_name(j), plain(instance.values[i, j]), plain(instance.consumption[i, j]), ""])
    return written([("name", instance.name)], ("agent", "job", instance.objective, "consumption", "capacity"), rows)


FORMATS.enter(
    Format(
        "agent-jobs", "agents' capacities, and jobs' costs or profits and consumption from CSV, one row each", recognises, read, write,
        (".csv",), PROBLEMS[0], PROBLEMS, sense="min or max", answer="agent of each job", solutions=(".json",),
        kinds=("generalised-assignment",),
    )
)  # fmt: skip
