"""Engine ``supported-paths``."""

from __future__ import annotations

import numpy as np
import pytest
from uncertain_graphs import WORKED, graph_of, named, random_graph

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import BACKENDS, Control, Options


def test_it_proves_its_optimum():
    found = wb.solve(UncertainPath(graph_of(WORKED), 1e-6))
    assert (found.solver, found.status, found.bound_kind) == ("supported-paths", "optimal", "verified")
    assert found.gap == pytest.approx(0.0, abs=1e-9)
    assert named(found.problem.graph, found.answer) == "S-B-C-D-G"
    assert found.certificate.bound == pytest.approx(found.objective)


def test_both_engines_agree():
    rng = np.random.default_rng(9)
    for _ in range(5):
        problem = UncertainPath(random_graph(rng, 25, 0.2), float(rng.uniform(1e-6, 0.5)))
        values = [wb.solve(problem, solver, bound_time=0).objective for solver in ("supported-paths", "non-dominated-paths")]
        assert values[0] == pytest.approx(values[1], rel=1e-12)


def test_asked_to_stop_it_hands_over_what_it_has():
    control = Control()
    control.stop()
    raw = BACKENDS["supported-paths"]().run(UncertainPath(graph_of(WORKED), 1e-6), Options(), control)
    assert (raw.status, raw.limit, raw.bound) == ("feasible", "interrupt", None)
    assert raw.evidence


def test_other_families_are_refused():
    with pytest.raises(UnsupportedError, match="routing problems"):
        BACKENDS["supported-paths"]().run(wb.read("demo-tiny"), Options(), Control())
