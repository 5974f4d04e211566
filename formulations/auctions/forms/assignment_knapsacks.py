"""Form ``assignment-knapsacks``: one binary per pair of agent and job, a knapsack row an agent."""

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..generalised_assignment import AgentOfJob, GeneralisedAssignment


def build(problem: GeneralisedAssignment) -> Compiled:
    """Agent i does job j (x_ij), over the pairs that fit::

        min  sum c_ij x_ij  (or  max  sum v_ij x_ij),   x binary
        job[j]        sum_i x_ij = 1     (<= 1 for profits)
        capacity[i]   sum_j a_ij x_ij <= b_i

    Duals of ``job`` are prices of the jobs. Source: Ross and Soland (1975).
    """
    instance, m, n = problem.instance, problem.num_agents, problem.num_jobs
    agents, jobs = np.nonzero(problem.fitting)
    column = np.arange(len(agents))
    names = [instance.agent_name(i) for i in range(m)], [instance.job_name(j) for j in range(n)]
    x = Variables("x", (agents, jobs), names, np.zeros(len(column)), np.ones(len(column)), instance.values[agents, jobs], integer=True)
    job = rows("job", n, [(jobs, column, 1.0)], float(problem.objective == "cost"), 1.0, (np.arange(n),), (names[1],))
    used = instance.consumption[agents, jobs]
    heavy = used > 0.0
    capacity = rows(
        "capacity", m, [(agents[heavy], column[heavy], used[heavy])], upper=instance.capacity, keys=(np.arange(m),), labels=(names[0],)
    )

    def decode(vector: Floats) -> AgentOfJob:
        chosen = np.nonzero(vector[: len(column)] > 0.5)[0]
        agent_of_job = np.full(n, -1)
        agent_of_job[jobs[chosen]] = agents[chosen]
        return tuple(agent_of_job.tolist())

    def encode(answer: Any) -> Floats:
        chosen = np.asarray(np.array(answer)[jobs] == agents)
        if int(chosen.sum()) != sum(i >= 0 for i in answer):
            raise InputError("the assignment has a pair that is not allowed", "unsupported")
        return chosen.astype(np.float64)

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        value = float(duals[:n].sum() + duals[n : n + m] @ instance.capacity)
        return Evidence("job-prices", "LP duals of assignment-knapsacks", value, {"prices": duals[:n].tolist()})

    return Compiled(Program("assignment-knapsacks", problem.sense, (x,), (job, capacity)), problem, decode, encode, dual_evidence)


def _size(problem: GeneralisedAssignment) -> ProgramSize:
    pairs = float(problem.num_agents) * problem.num_jobs
    return ProgramSize(pairs, problem.num_agents + problem.num_jobs, 2.0 * pairs)


FORMS.enter(
    Form("assignment-knapsacks", "generalised-assignment", frozenset({"objective:cost", "objective:profit"}), build, size=_size),
)
