"""Engine ``min-cost-flow``: assignments as flows, OR-Tools' network code, with prices that prove them."""

import numpy as np

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.programs.exactness import Exactness, Link
from ....formulations.stop import Stop
from ...backend import BACKENDS, Control, Options, RawResult
from ._bin_engine import BinEngine

BITS = 38
"""Bits of the range of costs in whole numbers: the solver multiplies them by the number of nodes."""


@BACKENDS.register("min-cost-flow")
class MinCostFlowEngine(BinEngine):
    """One unit from the source over each robot and bin that are paired, by cost scaling (Goldberg and Tarjan 1990).

    It counts in whole numbers: whole costs as they are, others in the finest steps that it can take, and says so. It holds Python's lock,
    so it runs in a process of its own.
    """

    name = "min-cost-flow"
    package = "ortools"
    summary = "optimal assignments as flows of least cost in whole numbers (OR-Tools), with prices that prove it"
    interrupts = "runs in a process of its own, which is ended"
    needs_process = True
    order = 30
    features = frozenset({"objective:sum"})

    def assign(self, problem: BinAssignment, stop: Stop, options: Options, control: Control) -> RawResult:
        from ortools.graph.python import min_cost_flow

        from .assignment_steps.recovered_prices import recovered_prices

        cost, exact, steps = _counted(problem)
        n, m, supply = problem.num_robots, problem.num_bins, problem.pairs
        robots, bins = np.arange(n), n + np.arange(m)
        source, sink = n + m, n + m + 1
        tails = np.concatenate([problem.robots, np.full(n, source), bins])
        heads = np.concatenate([n + problem.bins, robots, np.full(m, sink)])
        costs = np.concatenate([cost, np.zeros(n + m, np.int64)])
        flow = min_cost_flow.SimpleMinCostFlow()
        arcs = flow.add_arcs_with_capacity_and_unit_cost(tails, heads, np.ones(len(tails), np.int64), costs)
        flow.set_nodes_supplies(np.array([source, sink]), np.array([supply, -supply]))
        status = flow.solve()
        if status != flow.OPTIMAL:
            return RawResult("error", message=f"the flow ended with status {status}")
        used = np.nonzero(flow.flows(arcs[: len(cost)]) > 0)[0]
        taken = np.full(n, -1, dtype=np.int64)
        taken[problem.robots[used]] = problem.bins[used]
        answer = tuple(taken.tolist())
        value = problem.evaluate(answer).values[0]
        evidence = recovered_prices(problem, answer, "prices of the assignment, by shortest paths", stop)
        holds = Exactness.EXACT if exact else Exactness.RESTRICTION
        links = () if exact else (Link("whole-costs", Exactness.RESTRICTION, steps),)
        return RawResult("optimal", answer=answer, objective=value, bound=value, evidence=(evidence,), holds=holds, links=links)


def _counted(problem: BinAssignment) -> tuple[np.ndarray, bool, str]:
    """Costs in whole steps from 0, whether they are exact, and the steps in words."""
    from .assignment_steps.auction import whole_costs
    from .assignment_steps.sides import Side

    n, m = problem.num_robots, problem.num_bins
    whole = Side(problem.indptr.astype(np.int64), problem.bins, problem.cost, m, True, np.arange(n), np.arange(m))
    counted, unit, exact = whole_costs(whole, BITS)
    return counted // (m + 1), exact, f"costs counted in steps of {(m + 1) / unit:.3g}"
