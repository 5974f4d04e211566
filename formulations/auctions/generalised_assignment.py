"""Jobs to agents of limited capacity, at the least cost or the most profit: the generalised assignment problem."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.auctions.generalised_assignment import OBJECTIVES, GeneralisedAssignmentInstance
from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.number_arrays import Flags
from ..evaluation import Evaluation, judge
from ..evidence import CHECKERS, Evidence, Reason
from ..problem import PROBLEMS, Problem, refuse_settings
from ..tolerance import allowance, room

if TYPE_CHECKING:
    import pandas as pd

AgentOfJob = tuple[int, ...]
"""Agent of each job, -1 for none."""


class GeneralisedAssignment(Problem):
    """Give jobs to agents within their capacities: all of them at the least cost, or any of them for the most profit.

    An answer is a tuple of one agent a job, -1 for none.

    Parameters
    ----------
    instance : GeneralisedAssignmentInstance
        Says whether values are costs or profits.

    Raises
    ------
    UsageError
        For another instance.

    Notes
    -----
    Source: Ross and Soland (1975); docs/formulations/generalised-assignment.md#model.
    """

    family: ClassVar[str] = "generalised-assignment"

    def __init__(self, instance: GeneralisedAssignmentInstance) -> None:
        if not isinstance(instance, GeneralisedAssignmentInstance):
            raise UsageError(
                f"a generalised assignment is made of a GeneralisedAssignmentInstance, not of {type(instance).__name__}", "malformed"
            )
        self.instance, self.objective = instance, instance.objective
        self.name, self.problem, self.notes = instance.name, "generalised-assignment", instance.notes
        self.num_agents, self.num_jobs = instance.num_agents, instance.num_jobs

    @classmethod
    def from_arrays(
        cls, values: Any, consumption: Any, capacity: Any, objective: str = OBJECTIVES[0], **further: Any
    ) -> "GeneralisedAssignment":
        """A problem on arrays.

        Parameters
        ----------
        values, consumption, capacity, objective, **further
            As of ``GeneralisedAssignmentInstance``.
        """
        return cls(GeneralisedAssignmentInstance(values, consumption, capacity, objective, **further))

    @cached_property
    def fitting(self) -> Flags:
        """Which pairs are allowed, and fit an agent that has nothing else to do; shape (agents, jobs)."""
        data = self.instance
        most = np.array([room(row, b) for row, b in zip(data.consumption, data.capacity.tolist(), strict=True)])
        return np.asarray(data.listed & (data.consumption <= most[:, None]))

    @property
    def senses(self) -> tuple[str, ...]:
        return ("min",) if self.objective == "cost" else ("max",)

    def digest(self) -> str:
        return digest("generalised-assignment", self.instance.digest())

    def features(self) -> frozenset[str]:
        return frozenset({f"objective:{self.objective}"})

    @property
    def size(self) -> int:
        return self.num_jobs

    def linear_entries(self) -> int:
        return 2 * int(self.fitting.sum())

    def facts(self) -> dict[str, Any]:
        aim = {"cost": "cost of all jobs", "profit": "profit of the jobs that are done"}[self.objective]
        return {"objective": aim, "generalised_assignment": self.instance.facts()}

    def loads(self, answer: AgentOfJob) -> list[float]:
        """The consumption of each agent's jobs."""
        agent, used = np.array(answer, dtype=np.int64), self.instance.consumption
        return [math.fsum(used[i, np.nonzero(agent == i)[0]]) for i in range(self.num_agents)]

    def evaluate(self, answer: Any) -> Evaluation:
        """Add up costs or profits; test that all pairs are allowed, capacities suffice, and, where costs count, every job is done."""
        m, n, data = self.num_agents, self.num_jobs, self.instance
        if not isinstance(answer, tuple) or len(answer) != n or not all(type(i) is int and -1 <= i < m for i in answer):
            raise InputError(
                "an answer is a tuple of one agent a job, as numbers from 0, -1 for none", expected=f"{n} numbers", found=str(answer)[:80]
            )
        agent = np.array(answer, dtype=np.int64)
        done = np.nonzero(agent >= 0)[0]
        values = data.values[agent[done], done]
        loads = np.array(self.loads(answer))

        def forbidden(k: int) -> str:
            return f"agent {data.agent_name(answer[done[k]])} may not do job {data.job_name(int(done[k]))}"

        def overloaded(i: int) -> str:
            return f"the jobs of agent {data.agent_name(i)} take {loads[i]:.10g}, its capacity is {data.capacity[i]:.10g}"

        parts = [
            judge("allowed", np.where(np.isfinite(values), 0.0, 1.0), forbidden),
            judge("capacity", loads - data.capacity, overloaded, allowance(data.capacity, loads)),
        ]
        if self.objective == "cost":
            parts.append(judge("done", np.where(agent < 0, 1.0, 0.0), lambda j: f"job {data.job_name(j)} is given to no agent"))
        worth = np.where(np.isfinite(values), values, 0.0)
        total, size = math.fsum(worth), math.fsum(np.abs(worth))
        quantities = {"jobs_done": float(len(done)), "largest_load": float(loads.max()), "load": math.fsum(loads)}
        violations = tuple(v for _, broken in parts for v in broken)
        return Evaluation((total,), tuple(check for check, _ in parts), violations, quantities, (size,))

    def answer_at_hand(self) -> AgentOfJob | None:
        """No job for anybody, where that is an answer."""
        return (-1,) * self.num_jobs if self.objective == "profit" else None

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """A job that fits no agent, or jobs that need more than all capacities together, as they are or as shares of their agents'
        capacities."""
        if self.objective == "profit":
            return
        capacity = self.instance.capacity
        for weights in (np.ones(self.num_agents), 1.0 / np.where(capacity > 0, capacity, math.inf)):
            evidence = Evidence("capacity-need", "what all jobs need at least", math.inf, {"weights": weights.tolist()})
            if CHECKERS[evidence.kind](self, evidence.data) == math.inf:
                message = self.why_none(evidence.kind, evidence.data)
                yield Reason("capacity", message.split(":")[0], message, evidence)
                return

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        lost = np.nonzero(~self.fitting.any(axis=0))[0]
        if len(lost):
            return f"job {self.instance.job_name(int(lost[0]))}: it fits no agent"
        return "capacity: all agents together have less than the jobs need, each with the agent that it takes the least of"

    def answer_to_json(self, answer: AgentOfJob) -> dict[str, Any]:
        data = self.instance
        return {
            "kind": "generalised-assignment",
            "agent_of_job": {data.job_name(j): data.agent_name(i) for j, i in enumerate(answer) if i >= 0},
        }

    def answer_from_json(self, data: Any) -> AgentOfJob:
        pairs = data.get("agent_of_job") if isinstance(data, Mapping) and data.get("kind") == "generalised-assignment" else None
        if not isinstance(pairs, Mapping):
            raise InputError(
                "not an answer to a generalised assignment problem",
                expected='{"kind": "generalised-assignment", "agent_of_job": {JOB: AGENT}}',
            )
        return self.answer_of(pairs)

    def answer_of(self, given: Any) -> AgentOfJob:
        """A tuple or array of one agent a job as numbers from 0, -1 for none, or a mapping of jobs' names to agents'."""
        if isinstance(given, np.ndarray) and given.ndim == 1 and given.dtype.kind in "iu":
            return tuple(given.tolist())
        if not isinstance(given, Mapping):
            if not isinstance(given, tuple):
                raise UsageError(
                    "an assignment is a tuple of one agent a job, -1 for none, or a mapping of jobs' names to agents' names", "malformed"
                )
            return given
        agents = {self.instance.agent_name(i): i for i in range(self.num_agents)}
        jobs = {self.instance.job_name(j): j for j in range(self.num_jobs)}
        agent_of_job = [-1] * self.num_jobs
        for job, agent in given.items():
            for what, name, known in (("job", job, jobs), ("agent", agent, agents)):
                if not isinstance(name, str) or name not in known:
                    raise InputError(f"the answer names an unknown {what} {str(name)[:80]!r}", "unknown-name")
            agent_of_job[jobs[job]] = agents[agent]
        return tuple(agent_of_job)

    def check_start(self, answer: Any) -> None:
        m = self.num_agents
        if not isinstance(answer, tuple) or len(answer) != self.num_jobs or not all(type(i) is int and -1 <= i < m for i in answer):
            raise UsageError(f"the start is no assignment of {self.num_jobs} jobs to {m} agents", "foreign")

    def answer_to_frame(self, answer: AgentOfJob) -> "pd.DataFrame":
        """One row per job that is done: job, agent, cost or profit, consumption."""
        import pandas as pd

        data = self.instance
        rows = [
            (data.job_name(j), data.agent_name(i), float(data.values[i, j]), float(data.consumption[i, j]))
            for j, i in enumerate(answer)
            if i >= 0
        ]
        return pd.DataFrame(rows, columns=["job", "agent", self.objective, "consumption"])

    def to_instance(self) -> GeneralisedAssignmentInstance:
        return self.instance

    def __repr__(self) -> str:
        return f"<GeneralisedAssignment {self.name}: {self.num_jobs} jobs, {self.num_agents} agents, {self.objective}>"


@PROBLEMS.register("generalised-assignment")
def make(instance: Any, name: str, settings: dict[str, Any]) -> GeneralisedAssignment:
    """The problem of an instance; no settings."""
    if not isinstance(instance, GeneralisedAssignmentInstance):
        raise UsageError(f"{instance.name} holds no agents with capacities, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings)
    return GeneralisedAssignment(instance)
