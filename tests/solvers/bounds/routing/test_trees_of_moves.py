"""Small routing problems whose optima, or whose lack of answers, are proved by trees of moves."""

from __future__ import annotations

import json
import math

import pytest
from draws import ALL, draws
from hypothesis import given, settings
from oracles import small_problems
from small_routing import small
from truth.routing import best_values

from waybound.formulations.certificate import certify, check_certificate, verified_bound
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.branching_tree import branching_tree_bound

PROVED = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-distance", "travel", "elapsed-fixed-start", "limited-fleet",
    "fixed-cost", "open-routes",
)  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", PROVED)
@pytest.mark.parametrize("seed", range(6 if ALL else 2))
def test_optima_of_small_problems_are_proved(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    best = best_values(problem)
    evidence = branching_tree_bound(problem, Stop(30.0))
    assert evidence is not None
    made = certify(problem, None, [evidence])
    again = check_certificate(problem, json.loads(json.dumps(made.to_json(with_evidence=True), allow_nan=False)), None)
    if best is None:
        assert again.infeasible
    else:
        assert again.bound == pytest.approx(best[0], rel=1e-9)


@settings(max_examples=draws(60), deadline=None)
@given(problem=small_problems(most=4))
def test_trees_never_prove_more_than_the_optimum(problem: RoutingProblem) -> None:
    if BOUNDS["branching-tree"].missing(problem):
        return
    evidence, best = branching_tree_bound(problem, Stop(10.0)), best_values(problem)
    if evidence is not None:
        bound = verified_bound(problem, evidence)
        assert bound <= (math.inf if best is None else best[0] + 1e-9 * abs(best[0]))
