"""The bound of least hazards."""

from __future__ import annotations

import pytest
import risky_cases as cases

import waybound as wb
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds import BOUNDS

BOUND = BOUNDS["move-potentials"]


def test_it_is_the_optimum_where_the_walk_is_a_path_and_below_it_elsewhere():
    for problem, value in ((cases.ring(), 0.393469), (cases.loop(), 5.0), (cases.mud_costs(), 4.0), (cases.two_ways(), 27.272727)):
        assert BOUND.compute(problem, NEVER, None).value == pytest.approx(value, abs=5e-7)


def test_it_takes_this_family_alone_and_stops():
    assert BOUND.missing(wb.read("demo-c25")) == {"routing problems"}
    assert BOUND.compute(cases.ring(), Stop(0.0), None) is None
