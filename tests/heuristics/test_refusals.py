"""Options out of range, and problems that a method cannot take, are refused by name."""

import math

import numpy as np
import pytest
from bin_assignments import worked
from oracles import SQUARE_4, routing
from orchard_cases import retrievals
from sata_cases import CASES
from selection_problems import context, cover_30, cover_tight, random_problem
from task_problems import line, parts
from uncertain_graphs import WORKED, graph_of

from waybound import Coverage, Knapsack, Makespan, Reward, SubmodularSelection, UncertainPath, UsageError, WinnerTakesAllSATA
from waybound.heuristics.heuristic import HEURISTICS

ONE = SubmodularSelection(Coverage.from_sets([[0]], [1.0]), Knapsack([1.0], 1.0))
ROBOTS = WinnerTakesAllSATA(CASES["S10"].graph)
NO_ORDERS = [[0, 1], [0, 1, 1], [0, 1, 3], [1, 2, 3], "1,2", "1,2,2", "a,b,c", 7, [0.0, 1.0, 2.0], [True, False, 2], {0, 1, 2}]
PAIRS, TASKS, ROUTES = worked("O"), line([0], [1]), routing(xy=SQUARE_4)
EARNING = routing(xy=SQUARE_4, count=1, max_distance=12.0, sites={"required": False, "reward": 1.0}, objective=Reward())
EVENLY = routing(xy=SQUARE_4, count=2, max_duration=14.0, objective=Makespan())

OPTIONS = {
    ("auction", "mode"): (PAIRS, "mode must be one of deferred, immediate, not 'english'", ["english"]),
    ("bertsekas", "epsilon"): (PAIRS, "epsilon must be a number above 0", [0, -1.0, math.nan, "small"]),
    ("bertsekas", "factor"): (PAIRS, "factor must be a number above 1", [1.0]),
    ("bertsekas", "scaling"): (PAIRS, "scaling must be true or false", [3]),
    ("consensus-bundle", "communication"): (TASKS, "communication must be complete, ring, line, star", ["pigeons"]),
    ("consensus-bundle", "most"): (TASKS, "most must be", [0, "two"]),
    ("distributed-sampling", "initial"): (parts([0, 1]), "initial must be nearest or first", ["random"]),
    ("distributed-sampling", "most_moves"): (parts([0, 1]), "most_moves must be", [-1]),
    ("greedy-orienteering", "by"): (EARNING, "density, reward", ["luck"]),
    ("insertion", "alpha1"): (ROUTES, "alpha1 must be", [1.5, "all"]),
    ("insertion", "lamda"): (ROUTES, "lamda must be", [math.nan]),
    ("insertion", "mu"): (ROUTES, "mu must be", [-1, math.inf]),
    ("insertion", "seeds"): (ROUTES, "seeds must be", ["nearest"]),
    ("list-schedule", "order"): (retrievals(((0, 1),), (0,)), "order must be one of nearest, longest", ["best"]),
    ("pure-greedy", "distance_weight"): (EVENLY, "distance_weight must be", [-1, math.nan, math.inf, "much"]),
    ("rags", "rule"): (UncertainPath(graph_of(WORKED), 0.05), "rule must be one of best, scan", ["worst"]),
    ("savings", "shape"): (ROUTES, "shape must be", [0, -1, math.nan, math.inf, "wide"]),
    ("greedy", "eps"): (cover_tight(), "eps must be", [-1.0, math.nan, math.inf, "small", True]),
    ("lazy-greedy", "eps"): (cover_tight(), "eps must be", [-1.0, math.nan, math.inf, "small", True]),
    ("lazy-greedy", "base"): (cover_30(6), "base must be a list of", [[0, 0], [30], [-1], "0", "1,1", 3, [0.5], [True], b"12"]),
    ("stochastic-greedy", "eps"): (
        cover_tight(), r"eps must lie between 0 and 1 - 1/e = 0\.6321", [0.0, -0.1, 0.64, 1.0, math.nan, "small", True],
    ),
    ("continuous-greedy", "steps"): (cover_tight(), "steps must be a whole number from 1", [0, -1, 1.5, True, "many", 10**7]),
    ("knapsack-greedy", "enumerate"): (ONE, "enumerate must be 0, 1, 2 or 3", [-1, 4, 1.0, True, "all"]),
    ("sequential-greedy", "order"): (ROBOTS, "order must be a permutation of all 3 robots", NO_ORDERS),
    ("lp-rounding", "ties"): (cover_30(6), "ties must be last, first or random", ["middle"]),
}  # fmt: skip


@pytest.mark.parametrize(("name", "option", "wrong"), [(*key, value) for key, (_, _, values) in OPTIONS.items() for value in values])
def test_an_option_out_of_range_is_refused(name: str, option: str, wrong: object) -> None:
    problem, words, _ = OPTIONS[name, option]
    with pytest.raises(UsageError, match=words):
        HEURISTICS[name].run(problem, context(1), **{option: wrong})


@pytest.mark.parametrize(
    ("name", "problem", "lacking"),
    [
        ("greedy", ONE, "constraint:knapsack"),
        ("knapsack-greedy", cover_tight(), "constraint:cardinality"),
        ("sequential-greedy", cover_tight(), "constraint:cardinality"),
        ("stochastic-greedy", random_problem(np.random.default_rng(1), "coverage", "partition"), "constraint:partition"),
        ("continuous-greedy", random_problem(np.random.default_rng(1), "user", "cardinality"), "function:user"),
        ("lp-rounding", random_problem(np.random.default_rng(1), "user", "knapsack"), "function:user"),
    ],
)
def test_a_problem_that_a_method_cannot_take_is_refused(name: str, problem: SubmodularSelection, lacking: str) -> None:
    assert HEURISTICS[name].missing(problem) == {lacking}
