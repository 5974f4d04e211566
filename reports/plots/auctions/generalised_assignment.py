"""Pictures of generalised assignments: how much of each agent's capacity its jobs take."""

from typing import Any

import numpy as np

from ....formulations.auctions.generalised_assignment import AgentOfJob, GeneralisedAssignment
from ..drawing import ALARM, COLOURS, INK, chart_axes, plot_of

NAMED = 25
"""Agents up to which each is named, and so are their jobs where there is room."""

LEAST = 0.04
"""Share of the largest capacity or load below which a part has no room for a name."""


@plot_of("generalised-assignment")
def plot_generalised_assignment(ax: Any, problem: GeneralisedAssignment, answer: AgentOfJob) -> str:
    """A column for each agent, with a part for each of its jobs, below a line at its capacity."""
    data, agents = problem.instance, np.arange(problem.num_agents)
    loads = np.array(problem.loads(answer))
    top = max(float(loads.max(initial=0.0)), float(data.capacity.max(initial=0.0)))
    ax.bar(agents, loads, width=0.8, color=COLOURS[4], zorder=2)
    filled = np.zeros(problem.num_agents)
    for job, agent in enumerate(answer):
        if agent < 0:
            continue
        part = float(data.consumption[agent, job])
        ax.plot([agent - 0.4, agent + 0.4], [filled[agent]] * 2, color="white", linewidth=0.8, zorder=3)
        if problem.num_agents <= NAMED and part >= LEAST * top:
            ax.text(agent, filled[agent] + part / 2.0, data.job_name(job), fontsize=7.5, color=INK, ha="center", va="center", zorder=4)
        filled[agent] += part
    ax.hlines(data.capacity, agents - 0.45, agents + 0.45, color=ALARM, linewidth=1.4, zorder=4)
    if problem.num_agents <= NAMED:
        ax.set_xticks(agents, [data.agent_name(k) for k in agents.tolist()], fontsize=8)
    else:
        ax.set_xticks([])
    ax.set_xlabel("agent", fontsize=9, color="#555555")
    ax.set_ylabel("consumption", fontsize=9, color="#555555")
    ax.set_ylim(0.0, 1.05 * top if top > 0 else 1.0)
    chart_axes(ax)
    done = sum(agent >= 0 for agent in answer)
    return f"{done} of {problem.num_jobs} jobs by agent, capacities in red"
