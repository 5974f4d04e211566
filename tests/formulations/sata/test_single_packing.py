from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from truth.local_algorithm import optimum, random_graph

from waybound.formulations.certificate import verified_bound
from waybound.formulations.evidence import Evidence
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.sata.max_min_lp import MaxMinLP
from waybound.formulations.sata.single_packing import as_row_prices, as_sensing
from waybound.instances.errors import UnsupportedError


def scaled_problem(rng: np.random.Generator) -> tuple[MaxMinLP, BottleneckSATA, np.ndarray]:
    """A bottleneck problem, and the same with every column scaled."""
    graph = random_graph(rng)
    a = np.zeros((graph.num_robots, graph.num_actions))
    c = np.zeros((graph.num_targets, graph.num_actions))
    a[graph.robot_of_action, np.arange(graph.num_actions)] = 1.0
    c[graph.indices, graph.action_of_edge] = graph.weights
    scale = rng.uniform(0.2, 5.0, graph.num_actions)
    return MaxMinLP(a * scale, c * scale), BottleneckSATA(graph, fractional=True), scale


@given(st.integers(0, 10**6))
def test_values_and_feasibility_carry_over(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem, robots, _ = scaled_problem(rng)
    graph, scale = as_sensing(problem)
    seeing = np.diff(graph.indptr) > 0
    shares = rng.dirichlet(np.ones(graph.num_actions)) * seeing
    x = shares / scale
    assert problem.evaluate(x).values[0] == pytest.approx(robots.evaluate(shares).values[0], abs=1e-12)
    assert problem.evaluate(x).feasible == BottleneckSATA(graph, fractional=True).evaluate(shares).feasible
    assert optimum(graph) == pytest.approx(optimum(robots.graph), abs=1e-8)


@given(st.integers(0, 10**6))
def test_evidence_for_the_robots_proves_the_same_for_the_program(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem, _, _ = scaled_problem(rng)
    graph, _ = as_sensing(problem)
    targets = rng.permutation(graph.num_targets)[: int(rng.integers(1, graph.num_targets + 1))]
    evidence = Evidence("target-weights", "test", 0.0, {"targets": targets.tolist(), "weights": rng.uniform(0.1, 1, len(targets)).tolist()})
    bound = verified_bound(BottleneckSATA(graph, fractional=True), evidence)
    assert verified_bound(problem, as_row_prices(graph, evidence)) == pytest.approx(bound, rel=1e-9)
    assert bound >= optimum(graph) * (1 - 1e-9)


def test_variables_that_cover_nothing_may_stand_in_any_packing_rows_and_are_zero() -> None:
    problem = MaxMinLP([[2, 1, 0, 0], [0, 1, 4, 0]], [[1, 0, 0, 0], [0, 0, 2, 0]])
    assert problem.features() == {"packing-covering"}
    graph, scale = as_sensing(problem)
    assert scale.tolist() == [2.0, np.inf, 4.0, np.inf]
    assert (np.ones(4) / scale).tolist() == [0.5, 0.0, 0.25, 0.0]
    assert graph.indptr.tolist() == [0, 1, 1, 2, 2]
    assert graph.weights.tolist() == [0.5, 0.5]


def test_other_programs_are_refused_by_what_they_have() -> None:
    with pytest.raises(UnsupportedError, match="several-packing-rows"):
        as_sensing(MaxMinLP([[1.0], [1.0]], [[1.0]]))
    with pytest.raises(UnsupportedError, match="min-max"):
        as_sensing(MaxMinLP([[1.0]], [[1.0]], sense="min"))
