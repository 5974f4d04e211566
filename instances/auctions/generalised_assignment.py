"""Agents of limited capacity, jobs, and what each pair costs or earns and consumes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import number_arrays as arrays
from ..declared import CountOf, Declared, NameOf, Names, extent
from ..document import json_numbers, matrix
from ..errors import InputError
from ..number_arrays import Flags, Floats
from ..parts import LARGEST, Axis, Choice, Numbers

if TYPE_CHECKING:
    import pandas as pd


PROBLEMS = ("generalised-assignment",)
"""Problems that such data allow."""

OBJECTIVES = ("cost", "profit")
"""Meanings of the values: costs of jobs that must all be done, or profits of the jobs that are done."""


@dataclass(frozen=True, eq=False, repr=False)
class GeneralisedAssignmentInstance(Declared):
    """Costs or profits of jobs that agents do, and the shares of their capacities that the jobs take.

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

    kind = "generalised-assignment"
    problem_names = PROBLEMS
    content = "generalised assignments"
    axes = (Axis("agent", named_last=True), Axis("job"))
    keys = ("agents", "jobs", *OBJECTIVES, "consumption")
    hashed = ("objective", "values", "consumption", "capacity")
    values: Annotated[Floats, Numbers("agent", "job", low=-LARGEST, stored=False)]
    consumption: Annotated[Floats, Numbers("agent", "job", spread=True, what="consumption")]
    capacity: Annotated[Floats, Numbers("agent", spread=True, what="capacity")]
    objective: Annotated[str, Choice(*OBJECTIVES, stored=False)] = OBJECTIVES[0]
    agent_names: Names = None
    job_names: Names = None
    num_agents, num_jobs = CountOf("agent"), CountOf("job")
    agent_name, job_name = NameOf("agent"), NameOf("job")

    @classmethod
    def from_frame(
        cls, pairs: pd.DataFrame, capacity: Any, objective: str = OBJECTIVES[0], **further: Any
    ) -> GeneralisedAssignmentInstance:
        """An instance from pandas.

        Parameters
        ----------
        pairs : DataFrame
            One row per pair with the columns agent, job, consumption and cost or profit; missing pairs are forbidden.
        capacity : Series or mapping
            The capacity of each agent.
        objective, **further
            As of the class.
        """
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
        """An instance from lists of one entry per pair, by name, in any order; what is not listed is forbidden.

        Parameters
        ----------
        agents, jobs : tuple of str
            All names.
        agent, job : sequence of str, one a pair
            The names of each pair.
        values, consumption : array of shape (pairs,)
            Cost or profit of each pair, and what it takes of the agent's capacity.
        capacity : array of shape (agents,) or float
            In the unit of the consumption.
        objective, **further
            As of the class.
        """
        numbers = [{name: k for k, name in enumerate(own)} for own in (agents, jobs)]
        table, used = np.full((len(agents), len(jobs)), forbidden_value(objective)), np.zeros((len(agents), len(jobs)))
        listed = np.zeros(table.shape, dtype=bool)
        for who, what, value, part in zip(agent, job, values.tolist(), consumption.tolist(), strict=True):
            if who not in numbers[0]:
                raise InputError(f"agent {who} has no capacity", "missing", expected="one of each agent")
            at = numbers[0][who], numbers[1][what]
            if listed[at]:
                raise InputError(f"the pair of agent {who} and job {what} stands twice", "duplicate")
            listed[at], table[at], used[at] = True, value, part
        names = {"agent_names": agents, "job_names": jobs}
        return cls(table, used, arrays.reals("capacity", capacity), objective, **{**names, **further})

    def arrange(self) -> None:
        self.put(consumption=arrays.frozen(np.where(self.values == self.forbidden, 0.0, self.consumption)))

    def noun_of(self, key: str, what: str) -> str:
        return super().noun_of(key, self.objective if key == "values" else what)

    def absent_of(self, key: str, absent: float | None) -> float | None:
        return self.forbidden if key == "values" else absent

    @property
    def forbidden(self) -> float:
        """The value of pairs that are not allowed."""
        return forbidden_value(self.objective)

    @property
    def listed(self) -> Flags:
        """Mask of the pairs that are allowed, shape (agents, jobs)."""
        return np.isfinite(self.values)

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        there = self.listed
        values, used = self.values[there], self.consumption[there]
        return {
            **self.sizes(), "forbidden": int((~there).sum()), "objective": self.objective, "values": extent(values),
            "consumption": extent(used), "capacity": extent(self.capacity), "capacity_of_all": math.fsum(self.capacity),
        }  # fmt: skip

    def summary(self) -> Iterable[str]:
        return (*super().summary(), self.objective)

    def write_own(self) -> dict[str, Any]:
        return {self.objective: json_numbers(self.values)}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        if (OBJECTIVES[0] in data) == (OBJECTIVES[1] in data):
            raise InputError("pairs have either costs or profits", "contradiction", expected="the key 'cost' or the key 'profit'")
        objective = next(key for key in OBJECTIVES if key in data)
        values = matrix(data[objective], objective, counts["agent"], counts["job"], null=forbidden_value(objective))
        return {"objective": objective, "values": values}


def forbidden_value(objective: str) -> float:
    """The value of a forbidden pair, which is worse than any other."""
    return -math.inf if objective == "profit" else math.inf
