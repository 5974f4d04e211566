"""What every form says of its size before it is built, against what is built."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import orchard_cases
import risky_cases
import task_problems
from bin_assignments import worked
from explorations import random_map
from joint_assignments import random_joint
from knapsack_assignments import random_assignment
from programs import program
from risk_problems import around_a_box, problem as risks
from selection_problems import random_problem
from small_routing import FEATURES, WHOLE_FAMILY, plane, small, varied

import waybound as wb
from waybound import BalancedPartition, Problem, TaskAllocation
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.forms import FORMS

LEAST = 0.9
"""Of what is built: no estimate is smaller. Vehicles times moves are all but exact where there are many."""

MOST = 5.0
"""Of what is built, and a few more where next to nothing is."""

TOO_FEW = 40.0

LOOSE = {"set-partitioning": 12.0}
"""Routes are counted as if each set of sites had one; limits leave few."""


def problems() -> Iterator[Problem]:
    """Of every family, small."""
    rng = np.random.default_rng(5)
    yield from (small(feature, 1, "round") for feature in FEATURES)
    yield from (varied(feature, seed, 4) for feature in WHOLE_FAMILY for seed in range(3))
    yield from (plane(1, 12, 25.0, 3), plane(2, 15, 20.0), wb.generate("solomon", seed=2, customers=25))
    for objective in ("mini-sum", "mini-max", "mini-ave"):
        yield TaskAllocation(task_problems.drawn(rng), objective)
    for objective in ("min-max", "min-difference"):
        yield from (BalancedPartition(task_problems.drawn(rng), objective, edges) for edges in ("none", "clique"))
    yield from (worked("A", objective=objective) for objective in ("sum", "bottleneck"))
    yield from (random_joint(rng), random_assignment(rng), random_map(rng), risks(), around_a_box())
    yield from (wb.generate("risk-allocation", seed=seed) for seed in range(2))
    for objective in ("makespan", "completion"):
        yield orchard_cases.retrievals(((0, 2), (1, 2), (0, 6)), (0, 0, 3), ((0, 0), (0, 6)), objective)
    yield from (risky_cases.loop(), risky_cases.ring(objective="hazard"))
    yield from (random_problem(rng, function, "partition") for function in ("coverage", "facility-location"))
    yield from (wb.generate("sata", seed=1), wb.generate("sensing-ring", seed=1))
    yield ArrayProblem(program([3, 2], [[2, 3]], -np.inf, 10.5, 0, 1, integer=[0, 1], quadratic=[[0, 1], [1, 0]], sense="max"))
    yield ArrayProblem(program([3, 2], [[2, 3]], -np.inf, 10.5, 0, 1, integer=[0, 1]))


def measured(made: Any) -> tuple[float, float, float]:
    entries = len(made.data) + sum(len(block.data) for block in made.cones) + sum(len(graph.column) for graph in made.circuits)
    return made.num_variables, made.num_rows, entries


def test_no_form_is_larger_than_it_says_nor_much_smaller() -> None:
    met: set[str] = set()
    for problem in problems():
        for name in problem.forms():
            estimate = FORMS[name].size(problem)
            assert estimate is not None, name
            met.add(name)
            told = (estimate.columns, estimate.rows, estimate.entries)
            for said, is_so in zip(told, measured(problem.compile(name).program), strict=True):
                assert LEAST * is_so <= said <= LOOSE.get(name, MOST) * is_so + TOO_FEW, (name, problem, told)
    assert met == set(FORMS), f"none was asked of {sorted(set(FORMS) - met)}"
