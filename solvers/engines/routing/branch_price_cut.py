"""Branch, price and cut as an engine: the best routes, and a tree that proves them."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from ....formulations.programs.exactness import Exactness
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ....instances.errors import InputError, UsageError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...bounds.routing.arcs import ARC_TERMS, LIMITS
from ...bounds.routing.branch_price_cut import CUSTOMERS, OPENING, Tree
from ...bounds.routing.column_generation import LABELS, MEMORY, MOST_COLUMNS
from ...bounds.routing.first_answer import first_answer
from ...bounds.routing.memory_shares import least_limit
from ...bounds.routing.set_partition import set_partition
from ...bounds.routing.stabilisation import KINDS

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

LEAST = {"columns": 1, "labels": 2, "memory": 0}
"""Smallest values of its options."""

ROOT = 0.9
"""Share of the time for the root: nothing else is waiting for it."""

UNPROVED = "all cases were searched to their end, and what was verified of some leaves a gap"

NOTHING = "no answer was found that visits every required site"


@BACKENDS.register("branch-price-cut")
class BranchPriceCut(Engine):
    """A first answer by ruin and recreate, then branch, price and cut, which betters and proves it.

    Options: ``columns``, the most routes at hand, ``labels``, the most labels of one search, ``memory``, how many neighbours are
    remembered at a customer to begin with, and ``stabilisation`` of the prices: ``smoothing``, ``trust-region`` or ``none``. Labels, routes
    and the tree share what ``memory_limit`` leaves.
    """

    name = "branch-price-cut"
    package = "waybound"
    modules = ("numba", "highspy")
    summary = "branch, price and cut over routes, with a proof at every leaf"
    family: ClassVar[str] = "routing"
    options = MappingProxyType({"columns": MOST_COLUMNS, "labels": LABELS, "memory": MEMORY, "stabilisation": KINDS[0]})
    order = 90
    honours = frozenset({"gap"})
    one_thread = True
    bounds_itself = True
    features = (
        LIMITS
        | {f"objective:{term}" for term in (*ARC_TERMS, "reward", "penalties", "weights")}
        | {"service-times", "separate-durations", "fixed-cost", "limited-fleet", "min-vehicles", "open-routes", "forbidden-moves"}
        | {"heterogeneous-fleet", "multiple-depots", "unit-cost", "optional-sites", "rewards", "penalties", "groups", "skills"}
    )

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking:
            return lacking
        many = len(problem.customers) > CUSTOMERS  # type: ignore[attr-defined]
        return frozenset({f"more than {CUSTOMERS} customers"} if many else ())

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        return self._search(problem, self.converted(options), control, stop)  # type: ignore[arg-type]

    def _search(self, problem: RoutingProblem, options: Options, control: Control, stop: Stop) -> RawResult:
        for name, least in LEAST.items():
            if options.extra.get(name, least) < least:
                raise UsageError(f"{self.name}: option {name} must be at least {least}, not {options.extra[name]}", "out-of-range")
        kind = options.extra.get("stabilisation", KINDS[0])
        if kind not in KINDS:
            raise UsageError(f"{self.name}: option stabilisation must be one of {', '.join(KINDS)}, not {kind!r}", "unknown-name")
        least = least_limit(len(problem.customers) + 1, len(problem.fleet))
        if options.memory_limit is not None and options.memory_limit < least:
            message = f"{self.name}: the memory limit must be at least {least} MB for this problem, not {options.memory_limit:g}"
            raise UsageError(message, "out-of-range")
        if not len(problem.customers):
            none = problem.evaluate(Routes(())).values[0]
            return RawResult("optimal", answer=Routes(()), objective=none, bound=none, message="there are no customers")
        statistics: dict[str, Any] = {}
        answer = value = None
        if options.start is not None:
            answer, value = _judged(problem, options.start)
            statistics["start"] = "refused" if answer is None else "used"
        if answer is None:
            first = first_answer(problem, OPENING * stop.seconds_left, options.seed, stop, compiled=False)
            answer, value = (None, None) if first is None else _judged(problem, first)
        if answer is not None:
            control.publish(answer, value)
        partition = set_partition(problem, stop)
        if partition is None:
            return RawResult("unknown" if answer is None else "feasible", "time", answer, value, statistics=statistics, message=NOTHING)

        def tell(bound: float) -> None:
            control.count(len(tree.nodes), **tree.counts())
            control.publish(bound=tree.sign * bound if math.isfinite(bound) else None)

        most = {"memory_limit": options.memory_limit, **options.extra}
        tree = Tree(
            problem, partition, value, stop, options.seed, answer=answer, most=most, on_answer=control.publish, on_step=tell,
            gap=options.gap, share=ROOT,
        )  # fmt: skip
        tree.grow()
        evidence = tree.evidence("routes")
        bound, answer = tree.bound, tree.answer
        found = () if evidence is None else (evidence,)
        statistics |= {"nodes": len(tree.nodes), **tree.counts()}
        weaker = tree.columns.given_up
        message = f"labels were too many: cuts or memories were given up {weaker} time{'s' if weaker > 1 else ''}" if weaker else ""
        if answer is None:
            status = "infeasible" if bound == math.inf else "unknown"
            message = "no choice of routes visits all sites within the limits" if status == "infeasible" else NOTHING
        else:
            judged = problem.evaluate(answer)
            value = judged.values[0]
            reached = bound >= tree.sign * value or same(bound, tree.sign * value, judged.size, judged.precision)
            status = "optimal" if reached else "feasible"
        closed = status in ("optimal", "infeasible")
        limit = "none" if closed else "gap" if tree.reached(bound) else stop.reached() or tree.columns.limit or "none"
        if limit == "none" and not closed:
            message = message or UNPROVED
        return RawResult(
            status, limit, answer, value, tree.sign * bound if found else None, statistics=statistics, message=message, evidence=found,
            holds=Exactness.EXACT,
        )  # fmt: skip


def _judged(problem: RoutingProblem, answer: Routes) -> tuple[Routes | None, float | None]:
    """An answer and its value, if it is one of the problem."""
    try:
        judged = problem.evaluate(answer)
    except InputError:
        return None, None
    return (answer, judged.values[0]) if judged.feasible else (None, None)
