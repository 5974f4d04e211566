"""Branch, price and cut as an engine: the best routes, and a tree that proves them."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from ....formulations.programs.exactness import Exactness
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...bounds.routing import branch_price_cut
from ...bounds.routing.arcs import ARC_TERMS, LIMITS, arc_costs

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

@BACKENDS.register("branch-price-cut")
class BranchPriceCut(Engine):
    """A first answer by ruin and recreate, then branch, price and cut, which betters and proves it.

    Options: ``columns``, the most routes at hand, ``labels``, the most labels of one search, and ``memory``, how many neighbours are
    remembered at a customer to begin with.
    """

    name = "branch-price-cut"
    package = "waybound"
    modules = ("numba", "highspy")
    summary = "branch, price and cut over routes, with a proof at every leaf"
    family: ClassVar[str] = "routing"
    options = MappingProxyType({"columns": branch_price_cut.MOST_COLUMNS, "labels": branch_price_cut.LABELS, "memory": branch_price_cut.MEMORY})
    order = 90
    honours = frozenset({"gap"})
    one_thread = True
    bounds_itself = True
    features = (
        LIMITS
        | {f"objective:{term}" for term in ARC_TERMS}
        | {"service-times", "separate-durations", "fixed-cost", "limited-fleet", "min-vehicles", "open-routes", "multiple-depots", "forbidden-moves"}
        | {"objective:weights"}
    )

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking:
            return lacking
        many = {f"more than {branch_price_cut.CUSTOMERS} customers"} if len(problem.customers) > branch_price_cut.CUSTOMERS else set()  # type: ignore[attr-defined]
        return frozenset(many)

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        return self._search(problem, self.converted(options), control, stop)  # type: ignore[arg-type]

    def _search(self, problem: RoutingProblem, options: Options, control: Control, stop: Stop) -> RawResult:
        if not len(problem.customers):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        answer = options.start
        if answer is None:
            answer = branch_price_cut.first_answer(problem, branch_price_cut.OPENING * stop.seconds_left, options.seed, stop, compiled=False)
        value = None
        if answer is not None:
            judged = problem.evaluate(answer)
            value = judged.values[0] if judged.feasible else None
            answer = answer if judged.feasible else None
            control.publish(answer, value)
        arcs = arc_costs(problem, stop)
        if arcs is None:
            return RawResult("unknown" if answer is None else "feasible", "time", answer, value)
        tree = branch_price_cut.Tree(problem, arcs, value, stop, options.seed, answer=answer, most=options.extra, on_answer=control.publish)
        tree.grow()
        evidence = tree.evidence("routes")
        bound, answer = tree.bound, tree.answer
        found = () if evidence is None else (evidence,)
        statistics = {"nodes": len(tree.nodes), **tree.counts()}
        if answer is None:
            status = "infeasible" if bound == float("inf") else "unknown"
        else:
            value = problem.evaluate(answer).values[0]
            status = "optimal" if tree.reached(bound) else "feasible"
        limit = "none" if status in ("optimal", "infeasible") else "interrupt" if control.stopped else "time"
        return RawResult(
            status, limit, answer, value, bound if found else None, statistics=statistics, evidence=found, holds=Exactness.EXACT
        )
