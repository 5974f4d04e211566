"""Heuristic ``rags``."""

from __future__ import annotations

import pytest
from uncertain_graphs import WORKED, graph_of, named

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.instances.errors import UsageError


def test_it_takes_the_route_of_the_source_which_no_risk_asks_for():
    problem = UncertainPath(graph_of(WORKED), 0.05)
    found = wb.solve(problem, heuristic="rags")
    assert named(problem.graph, found.answer) == "S-B-C-G"
    assert found.objective > found.bound
    assert found.certificate.guarantee is None


@pytest.mark.parametrize("options", [{"comparison": "joint"}, {"rule": "scan"}, {"dominance": "strict"}, {"first_edges": "shared"}])
def test_its_options_are_taken(options):
    assert wb.solve(UncertainPath(graph_of(WORKED), 0.05), heuristic="rags", **options).certificate.feasible


def test_unknown_options_are_refused():
    with pytest.raises(UsageError, match="rule must be one of best, scan"):
        wb.solve(UncertainPath(graph_of(WORKED), 0.05), heuristic="rags", rule="worst")
