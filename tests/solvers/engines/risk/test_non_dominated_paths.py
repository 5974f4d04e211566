"""Engine ``non-dominated-paths``."""

from __future__ import annotations

import pytest
from uncertain_graphs import WORKED, graph_of, named

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.instances.errors import UnsupportedError
from waybound.instances.generating import generate
from waybound.solvers.backend import BACKENDS, Control, Options


def test_its_optimum_is_verified_by_potentials():
    found = wb.solve(UncertainPath(graph_of(WORKED), 0.05), "non-dominated-paths")
    assert (found.status, found.bound_kind) == ("optimal", "verified")
    assert named(found.problem.graph, found.answer) == "S-A-G"


def test_without_bounds_it_is_its_own_word():
    found = wb.solve(UncertainPath(graph_of(WORKED), 0.05), "non-dominated-paths", bound_time=0)
    assert (found.status, found.bound_kind) == ("optimal", "claimed")


def test_asked_to_stop_it_hands_over_what_it_has():
    control = Control()
    control.stop()
    raw = BACKENDS["non-dominated-paths"]().run(UncertainPath(generate("prm-graph", 1)), Options(), control)
    assert (raw.status, raw.limit, raw.bound) == ("feasible", "interrupt", None)


def test_other_families_are_refused():
    with pytest.raises(UnsupportedError):
        BACKENDS["non-dominated-paths"]().run(wb.read("demo-tiny"), Options(), Control())
