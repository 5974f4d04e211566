"""Branch, price and cut as an engine: the best routes, and a tree that proves them."""

import math
from types import MappingProxyType
from typing import Any, ClassVar

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness
from ....formulations.routing.objective import PEAKS
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ....instances.errors import InputError, UsageError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...bounds.routing.arcs import ARC_TERMS, LIMITS
from ...bounds.routing.branch_price_cut import CUSTOMERS, OPENING, Tree
from ...bounds.routing.choice_of_routes import holds_peaks, lacks_one_peak
from ...bounds.routing.column_generation import LABELS, MEMORY, MOST_COLUMNS
from ...bounds.routing.enumerated_routes import ROUTES
from ...bounds.routing.first_answer import first_answer
from ...bounds.routing.largest_limits import LimitSearch
from ...bounds.routing.memory_shares import least_limit
from ...bounds.routing.set_partition import set_partition
from ...bounds.routing.stabilisation import KINDS

LEAST = {"columns": 1, "labels": 2, "memory": 0, "enumeration": 0}
"""Smallest values of its options."""

ROOT = 0.9
"""Share of the time for the root: nothing else is waiting for it."""

UNPROVED = "all cases were searched to their end, and what was verified of some leaves a gap"

NOTHING = "no answer was found that visits every required site"


@BACKENDS.register("branch-price-cut")
class BranchPriceCut(Engine):
    """A first answer by ruin and recreate, then branch, price and cut, which betters and proves it.

    Options: ``columns``, the most routes at hand, ``labels``, the most labels of one search, ``memory``, how many neighbours are
    remembered at a customer to begin with, ``enumeration``, the most routes that are listed (0 for none), and ``stabilisation`` of the
    prices: ``smoothing``, ``trust-region`` or ``none``. Labels, routes
    and the tree share what ``memory_limit`` leaves.
    """

    name = "branch-price-cut"
    package = "waybound"
    modules = ("numba", "highspy")
    summary = "branch, price and cut over routes, with a proof at every leaf"
    family: ClassVar[str] = "routing"
    options = MappingProxyType(
        {"columns": MOST_COLUMNS, "labels": LABELS, "memory": MEMORY, "enumeration": ROUTES, "stabilisation": KINDS[0]}
    )
    order = 90
    honours = frozenset({"gap"})
    one_thread = True
    bounds_itself = True
    features = (
        LIMITS
        | {f"objective:{term}" for term in (*ARC_TERMS, *PEAKS, "reward", "penalties", "weights")}
        | {"service-times", "separate-durations", "fixed-cost", "limited-fleet", "min-vehicles", "open-routes", "forbidden-moves"}
        | {"heterogeneous-fleet", "multiple-depots", "unit-cost", "optional-sites", "rewards", "penalties", "groups", "skills"}
        | {"several-loads", "pickups"}
    )

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking:
            return lacking
        many = len(problem.customers) > CUSTOMERS  # type: ignore[attr-defined]
        mixed = lacks_one_peak(problem) if holds_peaks(problem) else frozenset[str]()  # type: ignore[arg-type]
        return mixed | ({f"more than {CUSTOMERS} customers"} if many else set())

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
        most = {"memory_limit": options.memory_limit, **options.extra}
        if holds_peaks(problem):
            return self._bisect(problem, options, most, control, stop, answer, value, statistics)
        partition = set_partition(problem, stop)
        if partition is None:
            return RawResult("unknown" if answer is None else "feasible", "time", answer, value, statistics=statistics, message=NOTHING)

        def tell(bound: float) -> None:
            control.count(len(tree.nodes), **tree.counts())
            control.publish(bound=tree.sign * bound if math.isfinite(bound) else None)

        tree = Tree(
            problem, partition, value, stop, options.seed, answer=answer, most=most, on_answer=control.publish, on_step=tell,
            gap=options.gap, share=ROOT,
        )  # fmt: skip
        tree.grow()
        evidence = tree.evidence("routes")
        bound, answer = tree.bound, tree.answer
        found = () if evidence is None else (evidence,)
        statistics |= {"nodes": len(tree.nodes), **tree.counts()}
        limit = "gap" if tree.reached(bound) else stop.reached() or tree.columns.limit
        return _concluded(problem, answer, tree.sign * bound, found, limit, tree.columns.given_up, statistics)

    def _bisect(
        self, problem: RoutingProblem, options: Options, most: dict[str, Any], control: Control, stop: Stop, answer: Routes | None,
        value: float | None, statistics: dict[str, Any],
    ) -> RawResult:  # fmt: skip
        """The largest of all routes, by limits of each."""

        def tell() -> None:
            control.count(search.nodes, **search.counts())
            control.publish(bound=search.bound if math.isfinite(search.bound) else None)

        search = LimitSearch(
            problem, stop, options.seed, answer=answer, value=value, most=most, gap=options.gap, on_answer=control.publish,
            on_step=tell,
        )  # fmt: skip
        search.run()
        statistics |= {"nodes": search.nodes, "limits_tried": search.tried, **search.counts()}
        limit = "gap" if search.done else stop.reached() or search.limit
        return _concluded(problem, search.answer, search.bound, (search.evidence(),), limit, search.given_up, statistics)


def _concluded(
    problem: RoutingProblem, answer: Routes | None, bound: float, found: tuple[Evidence, ...], limit: str, weaker: int,
    statistics: dict[str, Any],
) -> RawResult:  # fmt: skip
    """The end of a search, whose ``limit`` counts where the bound does not meet the answer."""
    sign, value = 1.0 if problem.sense == "min" else -1.0, None
    message = f"labels were too many: cuts or memories were given up {weaker} time{'s' if weaker > 1 else ''}" if weaker else ""
    if answer is None:
        status = "infeasible" if sign * bound == math.inf else "unknown"
        message = "no choice of routes visits all sites within the limits" if status == "infeasible" else NOTHING
    else:
        judged = problem.evaluate(answer)
        value = judged.values[0]
        reached = sign * bound >= sign * value or same(bound, value, judged.size, judged.precision)
        status = "optimal" if reached else "feasible"
    closed = status in ("optimal", "infeasible")
    if not closed and not limit:
        message = message or UNPROVED
    return RawResult(
        status, "none" if closed else limit or "none", answer, value, bound if found else None, statistics=statistics, message=message,
        evidence=found, holds=Exactness.EXACT,
    )  # fmt: skip


def _judged(problem: RoutingProblem, answer: Routes) -> tuple[Routes | None, float | None]:
    """An answer and its value, if it is one of the problem."""
    try:
        judged = problem.evaluate(answer)
    except InputError:
        return None, None
    return (answer, judged.values[0]) if judged.feasible else (None, None)
