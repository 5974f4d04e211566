"""Bound ``branch-price-cut``: of sums over routes by one tree, of the largest of all routes by trees for limits of it."""

from collections.abc import Callable

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features
from ....formulations.routing.objective import PEAKS
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .branch_price_cut import CUSTOMERS, KERNELS, SHARED, branch_price_cut_bound, opening_answer
from .largest_limits import LimitSearch
from .set_partition import lacks_route_costs


def holds_peaks(problem: RoutingProblem) -> bool:
    """Whether a largest of all routes is in the first level of the objective."""
    return any(term.name in PEAKS for _, term in problem.objective.levels()[0].terms)


def lacks_one_peak(problem: RoutingProblem) -> frozenset[str]:
    """Features that keep the first level from being a single maximum that limits of routes can take the place of: other terms, or a risk
    that hangs on the same limit."""
    ((weight, term), *others) = problem.objective.levels()[0].terms
    if others or term.name not in PEAKS or weight < 0:
        return unknown_features(problem) | {f"objective:{t.name}" for _, t in problem.objective.levels()[0].terms}
    risks = problem.features() & {"route-risk", "team-risk"} if term.name == "makespan" else frozenset[str]()
    return unknown_features(problem) | risks


def lacks_routes(problem: RoutingProblem) -> frozenset[str]:
    """Objectives that no choice among routes has, and features that the checker does not know."""
    return lacks_one_peak(problem) if holds_peaks(problem) else lacks_route_costs(problem)


def largest_route_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None,
    answer: Routes | None = None, on_answer: Callable[[Routes, float], None] = lambda answer, value: None,
) -> Evidence | None:  # fmt: skip
    """Evidence on the largest of all routes: a branching tree whose first statement is a limit, or one without an answer; None where
    that proves no more than the farthest round trip.

    Source: docs/branch-price-cut.md#the-largest-of-all-routes.
    """
    if stop.reached() or not 0 < len(problem.customers) <= CUSTOMERS:
        return None
    seed, stop = 1 if linear is None else linear.seed, stop.within(SHARED * stop.seconds_left)
    if target is None:
        answer, target = opening_answer(problem, stop, seed, on_answer)
    search = LimitSearch(problem, stop, seed, answer=answer, value=target, on_answer=on_answer)
    search.run()
    return None if search.proof is None else search.evidence()


@bound_method("branch-price-cut", of_family("routing", lacks_routes), order=1, aims=True, starts=True, kernels=KERNELS)
def choice_of_routes_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None,
    answer: Routes | None = None, on_answer: Callable[[Routes, float], None] = lambda answer, value: None,
) -> Evidence | None:  # fmt: skip
    """Evidence of either kind, as the first level of the objective asks for."""
    method = largest_route_bound if holds_peaks(problem) else branch_price_cut_bound
    return method(problem, stop, linear, target, answer, on_answer)
