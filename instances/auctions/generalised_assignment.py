"""Agents of limited capacity, jobs, and what each pair costs or earns and consumes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label
from .assignment import LARGEST

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

PROBLEMS = ("generalised-assignment",)
"""What may be asked of such data."""

OBJECTIVES = ("cost", "profit")
"""What values mean: costs of jobs that all have to be done, or profits of those that are."""


@dataclass(frozen=True, eq=False)
class GeneralisedAssignmentInstance:
    """What each agent can do, at which cost or profit, and what it takes of its capacity.

    Parameters
    ----------
    values : array of shape (agents, jobs)
        Cost or profit of each pair; infinite (of a cost) or minus infinite (of a profit) where it is forbidden.
    consumption : array of shape (agents, jobs) or (jobs,)
        What a job takes of an agent's capacity, at least 0; one row is that of every agent. What is forbidden consumes nothing.
    capacity : array of shape (agents,) or float
        In the unit of the consumption, at least 0.
    objective : str
        ``cost``: all jobs are done, at the least cost. ``profit``: any jobs are, for the most profit.
    agent_names, job_names : tuple of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If an array has the wrong shape or holds what it must not; names agent and job.

    Notes
    -----
    Source: Ross and Soland (1975), A branch and bound algorithm for the generalized assignment problem;
    docs/formulations/generalised-assignment.md#model.
    """

    kind: ClassVar[str] = "generalised-assignment"
    values: Floats
    consumption: Floats
    capacity: Floats
    objective: str = OBJECTIVES[0]
    agent_names: tuple[str, ...] | None = None
    job_names: tuple[str, ...] | None = None
    name: str = "generalised-assignment"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    @classmethod
    def from_frame(
        cls, pairs: pd.DataFrame, capacity: Any, objective: str = OBJECTIVES[0], **further: Any
    ) -> GeneralisedAssignmentInstance:
        """From pandas: columns agent, job, consumption and cost or profit, one row a pair, those that are missing being forbidden; and a
        series or mapping of each agent's capacity."""
        titles = {str(title) for title in pairs.columns}
        wanted = {"agent", "job", "consumption", objective}
        if titles != wanted:
            raise InputError("the frame has other columns", expected=", ".join(sorted(wanted)), found=", ".join(sorted(titles)))
        of = dict(capacity.items())
        names = tuple(map(str, of)), tuple(dict.fromkeys(pairs["job"].astype(str)))
        return cls.from_pairs(
            *names, pairs["agent"].astype(str), pairs["job"].astype(str), arrays.reals(objective, pairs[objective]),
            arrays.reals("consumption", pairs["consumption"]), list(of.values()), objective, **further,
        )  # fmt: skip

    @classmethod
    def from_pairs(
        cls, agents: tuple[str, ...], jobs: tuple[str, ...], agent: Any, job: Any, values: Floats, consumption: Floats, capacity: ArrayLike,
        objective: str = OBJECTIVES[0], **further: Any,
    ) -> GeneralisedAssignmentInstance:  # fmt: skip
        """From lists of one entry a pair, by name, in any order; what is not listed is forbidden."""
        numbers = [{name: k for k, name in enumerate(own)} for own in (agents, jobs)]
        none = -math.inf if objective == "profit" else math.inf
        made, used = np.full((len(agents), len(jobs)), none), np.zeros((len(agents), len(jobs)))
        listed = np.zeros(made.shape, dtype=bool)
        for who, what, value, part in zip(agent, job, values.tolist(), consumption.tolist(), strict=True):
            if who not in numbers[0]:
                raise InputError(f"agent {who} has no capacity", expected="one of each agent")
            at = numbers[0][who], numbers[1][what]
            if listed[at]:
                raise InputError(f"the pair of agent {who} and job {what} stands twice")
            listed[at], made[at], used[at] = True, value, part
        names = {"agent_names": agents, "job_names": jobs}
        return cls(made, used, arrays.reals("capacity", capacity), objective, **{**names, **further})

    def __post_init__(self) -> None:
        if self.objective not in OBJECTIVES:
            raise InputError(f"unknown objective {self.objective!r}", expected=" or ".join(OBJECTIVES))
        values = _matrix("values", self.values)
        m, n = values.shape
        for what, count in (("agents", m), ("jobs", n)):
            if not count:
                raise InputError(f"there are no {what}", expected="one at least")
        object.__setattr__(self, "agent_names", arrays.names("agent", self.agent_names, m))
        object.__setattr__(self, "job_names", arrays.names("job", self.job_names, n))
        object.__setattr__(self, "name", label(self.name))
        none = -math.inf if self.objective == "profit" else math.inf
        used = _matrix("consumption", np.atleast_2d(self.consumption) if np.ndim(self.consumption) == 1 else self.consumption)
        used = np.broadcast_to(used, (m, n)) if used.shape == (1, n) else used
        if used.shape != (m, n):
            raise InputError(
                "consumption needs one number a pair of agent and job", expected=f"shape {(m, n)}", found=f"shape {used.shape}"
            )
        self._refuse(~((np.abs(values) <= LARGEST) | (values == none)), values, self.objective, f"a number of at most {LARGEST:g}")
        used = np.where(values == none, 0.0, used)
        self._refuse(~((used >= 0) & (used <= LARGEST)), used, "consumption", f"from 0 to {LARGEST:g}")
        given = arrays.reals("capacity", np.atleast_1d(np.asarray(self.capacity)))
        capacity = np.repeat(given, m) if len(given) == 1 else given
        if capacity.shape != (m,):
            raise InputError("there must be one capacity an agent", expected=str(m), found=str(len(given)))
        wrong = ~((capacity >= 0) & (capacity <= LARGEST))
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(f"the capacity of agent {self.agent_name(k)} must be from 0 to {LARGEST:g}", found=str(capacity[k]))
        for key, made in (("values", values), ("consumption", used), ("capacity", capacity)):
            object.__setattr__(self, key, arrays.frozen(np.array(made)))

    def _refuse(self, wrong: NDArray[np.bool_], numbers: Floats, what: str, expected: str) -> None:
        if wrong.any():
            i, j = np.argwhere(wrong)[0].tolist()
            pair = f"agent {self.agent_name(i)} and job {self.job_name(j)}"
            raise InputError(f"the {what} of {pair} must be {expected}", found=str(numbers[i, j]))

    # -- lookups -----------------------------------------------------------------------------------------------------

    @property
    def num_agents(self) -> int:
        return len(self.capacity)

    @property
    def num_jobs(self) -> int:
        return int(self.values.shape[1])

    @property
    def listed(self) -> NDArray[np.bool_]:
        """Which pairs are not forbidden."""
        return np.isfinite(self.values)

    def agent_name(self, agent: int) -> str:
        return str(agent + 1) if self.agent_names is None else self.agent_names[agent]

    def job_name(self, job: int) -> str:
        return str(job + 1) if self.job_names is None else self.job_names[job]

    def digest(self) -> str:
        """Hash of everything that values depend on; names are not part of it."""
        return digest("generalised-assignment", self.objective, self.values, self.consumption, self.capacity)

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        there = self.listed
        values, used = self.values[there], self.consumption[there]
        return {
            "agents": self.num_agents, "jobs": self.num_jobs, "forbidden": int((~there).sum()), "objective": self.objective,
            "values": [float(values.min()), float(values.max())] if len(values) else [],
            "consumption": [float(used.min()), float(used.max())] if len(used) else [],
            "capacity": [float(self.capacity.min()), float(self.capacity.max())], "capacity_of_all": math.fsum(self.capacity),
        }  # fmt: skip

    def __repr__(self) -> str:
        return f"<GeneralisedAssignmentInstance {self.name}: {self.num_agents} agents, {self.num_jobs} jobs, {self.objective}>"


def _matrix(what: str, given: Any) -> Floats:
    try:
        made = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must be numbers, one row an agent and one column a job, all rows of one length") from None
    if made.ndim != 2:
        raise InputError(f"{what} must be a matrix, one row an agent and one column a job", found=f"shape {made.shape}")
    return made
