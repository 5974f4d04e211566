import math
from typing import Any

import numpy as np
import pytest
import selection_problems
from random_sensing import random_graph
from sata_cases import selections

from waybound import BottleneckSATA, Evidence, Problem, Selection
from waybound.formulations.verified_bounds import verified_bound


def decided(problem: Any, rng: np.random.Generator) -> Any:
    some = rng.choice(problem.num_elements, int(rng.integers(1, problem.num_elements + 1)), replace=False)
    return problem.restricted([({"chosen": int(e)}, bool(rng.random() < 0.5)) for e in some])


def best_of(problem: Problem, answers: list[Selection]) -> float:
    judged = [problem.evaluate(answer) for answer in answers]
    return max((made.values[0] for made in judged if made.feasible), default=-math.inf)


def holds(problem: Problem, evidence: Evidence, best: float) -> float:
    bound = verified_bound(problem, evidence)
    assert bound >= best * (1.0 - 1e-12), evidence.kind
    return bound


@pytest.mark.share(5)
@pytest.mark.parametrize("constraint", selection_problems.CONSTRAINTS)
@pytest.mark.parametrize("function", ["coverage", "facility-location", "dense"])
@pytest.mark.parametrize("seed", range(12))
def test_prices_and_gains_hold_for_decided_elements(function: str, constraint: str, seed: int) -> None:
    rng = np.random.default_rng([seed, *function.encode(), *constraint.encode()])
    whole = selection_problems.random_problem(rng, function, constraint, 7)
    sets = [Selection(s) for s in selection_problems.feasible_sets(whole)]
    items, n = whole.function.as_item_weights().num_items, whole.num_elements
    for _ in range(5):
        problem = decided(whole, rng)
        best = best_of(problem, sets)
        for _ in range(3):
            prices = (rng.exponential(size=items) * float(rng.choice([0.1, 1.0, 5.0]))).tolist()
            data = {"prices": prices}
            if constraint == "rows":
                data["multipliers"] = rng.random(len(whole.constraint.rows(n).limit)).tolist()
            holds(problem, Evidence("item-prices", "", 0.0, data), best)
            prefix = rng.choice(n, int(rng.integers(0, n + 1)), replace=False).tolist()
            holds(problem, Evidence("marginal-gains", "", 0.0, {"prefix": prefix}), best)
        if len(problem.taken) + len(problem.dropped) == n and math.isfinite(best):
            exact = holds(problem, Evidence("marginal-gains", "", 0.0, {"prefix": problem.taken.tolist()}), best)
            assert exact == pytest.approx(best), "nothing is left to choose"


@pytest.mark.share(4)
@pytest.mark.parametrize("seed", range(40))
def test_weights_of_targets_hold_for_decided_actions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(seed, robots=4, targets=3, most_actions=3)
    whole, every = BottleneckSATA(graph), list(selections(graph))
    for _ in range(6):
        problem = decided(whole, rng)
        best = best_of(problem, every)
        for _ in range(4):
            weights = rng.exponential(size=graph.num_targets)
            holds(
                problem, Evidence("target-weights", "", 0.0, {"targets": list(range(graph.num_targets)), "weights": weights.tolist()}), best
            )


@pytest.mark.parametrize("constraint", selection_problems.CONSTRAINTS)
def test_decisions_that_leave_no_answer_are_seen(constraint: str) -> None:
    whole = selection_problems.random_problem(np.random.default_rng(4), "facility-location", constraint, 7)
    prices = Evidence("item-prices", "", 0.0, {"prices": [0.0] * whole.function.as_item_weights().num_items})
    gains = Evidence("marginal-gains", "", 0.0, {"prefix": []})
    every = whole.restricted([({"chosen": e}, True) for e in range(whole.num_elements)])
    both = whole.restricted([({"chosen": 0}, True), ({"chosen": 0}, False)])
    allowed = whole.evaluate(Selection(tuple(range(whole.num_elements)))).feasible
    for evidence in (prices, gains):
        assert verified_bound(both, evidence) == -math.inf
        assert (verified_bound(every, evidence) == -math.inf) is (not allowed and whole.constraint.rows(whole.num_elements) is not None)
