"""The flow form of a path of the least mean."""

from __future__ import annotations

import numpy as np
import pytest
from uncertain_graphs import CROSSED, WORKED, all_paths, graph_of, named, random_graph

import waybound as wb
from waybound.formulations.certificate import verified_bound
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.instances.errors import InputError, UnsupportedError
from waybound.solvers.linear_programs import LinearPrograms


def test_the_rows_of_a_small_graph():
    made = UncertainPath(graph_of(CROSSED), 0.5).compile("path-flow")
    p = made.program
    assert [p.variable_name(k) for k in range(2)] == ["x[S,a]", "x[S,b]"]
    rows = {p.row_name(i): (p.row_lower[i], p.row_upper[i]) for i in range(p.num_rows)}
    assert (rows["balance[S]"], rows["balance[G]"], rows["balance[a]"]) == ((1, 1), (-1, -1), (0, 0))
    assert rows["leave[a]"] == (-np.inf, 1)


def test_its_optimum_is_the_least_mean_and_its_duals_prove_it():
    for seed in range(4):
        problem = UncertainPath(random_graph(np.random.default_rng(seed), 6, whole=seed % 2 == 0), 0.5)
        least = min(mean for mean, _ in all_paths(problem.graph).values())
        made = problem.compile("path-flow", relax=True)
        linear = LinearPrograms()
        assert verified_bound(problem, made.dual_evidence(linear.duals(made.program))) == pytest.approx(least, abs=1e-9)
        found = wb.solve(problem, "highs", bound_time=0)
        assert found.objective == pytest.approx(least)


def test_answers_go_there_and_back():
    problem = UncertainPath(graph_of(WORKED), 0.5)
    made = problem.compile()
    for path in all_paths(problem.graph):
        assert made.decode(made.encode(path)) == path
        assert made.program.residual(made.encode(path)) == 0.0
    with pytest.raises(InputError, match="an edge that does not exist"):
        made.encode((0, 4))
    with pytest.raises(InputError, match="fractional"):
        made.decode(np.full(10, 0.5))
    with pytest.raises(InputError, match="the flow ends at S"):
        made.decode(np.zeros(10))


def test_circles_beside_the_path_are_left_out():
    problem = UncertainPath(graph_of([*WORKED, ("C", "B", 0, 0)]), 0.5)
    made = problem.compile()
    edges = problem.graph.edges_of_pairs(*(np.array([problem.graph.vertex_numbers[n] for n in names]) for names in ("SABC", "AGCB")))
    assert named(problem.graph, made.decode(np.bincount(edges, minlength=11).astype(float))) == "S-A-G"


def test_it_is_for_means_alone():
    with pytest.raises(UnsupportedError, match="it lacks risk-aversion"):
        UncertainPath(graph_of(WORKED), 0.1).compile("path-flow")
