"""The bound by potentials, for answers of whoever."""

from __future__ import annotations

import pytest
from uncertain_graphs import WORKED, graph_of

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.solvers.bounds import BOUNDS


def test_it_bounds_heuristics():
    problem = UncertainPath(graph_of(WORKED), 1e-6)
    best = wb.solve(problem).objective
    found = wb.solve(problem, heuristic="least-mean")
    assert found.objective > best
    assert found.bound == pytest.approx(best)
    assert (found.bound_kind, found.status) == ("verified", "feasible")


def test_the_bound_alone():
    assert wb.bound(UncertainPath(graph_of(WORKED), 0.5)).bound == pytest.approx(150.0)


def test_it_is_for_this_family():
    assert BOUNDS["path-potentials"].missing(wb.read("demo-tiny")) == {"routing problems"}
