"""The search among paths that are shortest under weights."""

from __future__ import annotations

import numpy as np
import pytest
from uncertain_graphs import WORKED, all_paths, graph_of, named, random_graph

from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.engines.risk.path_search.supported_paths import shortest_path, supported_paths


@pytest.mark.parametrize("whole", [False, True])
def test_its_best_is_that_of_all_paths(whole):
    rng = np.random.default_rng(11)
    for _ in range(60):
        problem = UncertainPath(random_graph(rng, int(rng.integers(2, 8)), whole=whole), float(rng.uniform(1e-9, 0.5)))
        made = supported_paths(problem, NEVER)
        best = min(problem.value(*moments) for moments in all_paths(problem.graph).values())
        assert made.complete
        assert problem.evaluate(made.best.path).feasible
        assert problem.evaluate(made.best.path).values[0] == pytest.approx(best, rel=1e-12, abs=1e-12)


def test_the_answer_changes_with_the_risk():
    g = graph_of(WORKED)
    found = {risk: named(g, supported_paths(UncertainPath(g, risk), NEVER).best.path) for risk in (0.5, 0.05, 1e-6, 1e-12)}
    assert found == {0.5: "S-A-G", 0.05: "S-A-G", 1e-6: "S-B-C-D-G", 1e-12: "S-B-C-D-E-G"}


def test_edges_of_no_cost_are_edges():
    g = graph_of([("S", "a", 0, 0), ("a", "G", 0, 0), ("S", "G", 1, 0)])
    assert named(g, shortest_path(g, (1.0, 0.0)).path) == "S-a-G"
    assert supported_paths(UncertainPath(g, 0.1), NEVER).best.least == 0.0


def test_cut_short_it_says_so_and_what_it_has_holds():
    problem = UncertainPath(graph_of(WORKED), 1e-6)
    stop = Stop()
    stop.ask()
    made = supported_paths(problem, stop)
    assert not made.complete
    assert problem.evaluate(made.best.path).feasible
