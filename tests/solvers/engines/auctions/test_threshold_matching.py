"""Engine ``threshold-matching``."""

from __future__ import annotations

import pytest
from bin_assignments import BOTTLENECKS, worked

import waybound as wb
from waybound.instances.errors import UnsupportedError


@pytest.mark.parametrize("name", BOTTLENECKS)
def test_worked_bottlenecks_are_optimal_by_what_meets_all_cheaper_pairs(name: str) -> None:
    found = wb.solve(worked(name, objective="bottleneck"))
    assert (found.solver, found.objective, found.bound) == ("threshold-matching", BOTTLENECKS[name], BOTTLENECKS[name])
    assert found.bound_kind == "verified" and found.status == "optimal"


def test_sums_are_refused_by_name() -> None:
    with pytest.raises(UnsupportedError, match="it does not handle objective:sum"):
        wb.solve(worked("O"), "threshold-matching")
