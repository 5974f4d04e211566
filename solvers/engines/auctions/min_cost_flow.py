"""Engine ``min-cost-flow``: assignments as flows, OR-Tools' network code, with prices that prove them."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness, Link
from ....formulations.stop import Stop
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult

if TYPE_CHECKING:
    from ....formulations.auctions.bin_assignment import BinAssignment

BITS = 38
"""Of the range of the costs in whole numbers: the solver multiplies them by the number of nodes."""


@BACKENDS.register("min-cost-flow")
class MinCostFlowEngine(Engine):
    """One unit from the source over each robot and bin that are paired, by cost scaling (Goldberg and Tarjan 1990).

    It counts in whole numbers: whole costs as they are, others in as fine steps as it can take, which it says. It holds Python's lock,
    so it runs in a process of its own.
    """

    name = "min-cost-flow"
    package = "ortools"
    modules = ("ortools",)
    summary = "optimal assignments as flows of least cost in whole numbers (OR-Tools), with prices that prove it"
    interrupts = "runs in a process of its own, which is ended"
    needs_process = True
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 30
    family = "bin-assignment"
    features = frozenset({"objective:sum"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from ortools.graph.python import min_cost_flow

        from .assignment_steps.recovered_prices import recovered_prices

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        asked = cast("BinAssignment", problem)
        reason = next(asked.infeasibility_reasons(), None)
        if reason is not None and reason.evidence is not None:
            return RawResult("infeasible", message=reason.message, evidence=(reason.evidence,))
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        cost, exact, told = _counted(asked)
        n, m, supply = asked.num_robots, asked.num_bins, asked.pairs
        robots, bins = np.arange(n), n + np.arange(m)
        source, sink = n + m, n + m + 1
        tails = np.concatenate([asked.robots, np.full(n, source), bins])
        heads = np.concatenate([n + asked.bins, robots, np.full(m, sink)])
        costs = np.concatenate([cost, np.zeros(n + m, np.int64)])
        flow = min_cost_flow.SimpleMinCostFlow()
        arcs = flow.add_arcs_with_capacity_and_unit_cost(tails, heads, np.ones(len(tails), np.int64), costs)
        flow.set_nodes_supplies(np.array([source, sink]), np.array([supply, -supply]))
        status = flow.solve()
        if status != flow.OPTIMAL:
            return RawResult("error", message=f"the flow ended with status {status}")
        used = np.nonzero(flow.flows(arcs[: len(cost)]) > 0)[0]
        taken = np.full(n, -1, dtype=np.int64)
        taken[asked.robots[used]] = asked.bins[used]
        answer = tuple(taken.tolist())
        value = asked.evaluate(answer).values[0]
        evidence = recovered_prices(asked, answer, "prices of the assignment, by shortest paths", stop)
        holds = Exactness.EXACT if exact else Exactness.RESTRICTION
        links = () if exact else (Link("whole-costs", Exactness.RESTRICTION, told),)
        return RawResult("optimal", answer=answer, objective=value, bound=value, evidence=(evidence,), holds=holds, links=links)


def _counted(problem: BinAssignment) -> tuple[np.ndarray, bool, str]:
    """Costs in whole steps from 0, whether they are exact, and the steps in words."""
    from .assignment_steps.auction import whole_costs
    from .assignment_steps.sides import Side

    n, m = problem.num_robots, problem.num_bins
    whole = Side(problem.indptr.astype(np.int64), problem.bins, problem.cost, m, True, np.arange(n), np.arange(m))
    counted, unit, exact = whole_costs(whole, BITS)
    return counted // (m + 1), exact, f"costs counted in steps of {(m + 1) / unit:.3g}"
