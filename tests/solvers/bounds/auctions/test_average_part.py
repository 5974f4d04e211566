"""Average parts bound balanced partitions, and nothing else."""

from __future__ import annotations

import pytest
from task_problems import line, parts

import waybound as wb
from waybound.solvers.bounds import BOUNDS


def test_it_is_for_balanced_partitions_alone_and_proves_an_even_one():
    assert BOUNDS["average-part"].missing(line([0], [1])) == {"task-allocation problems"}
    bound = wb.bound(parts([0, 0, 0, 0], weights=[3, 2, 4, 1], edges="none"), bound_time=60.0)
    assert bound.bound == pytest.approx(5.0, rel=1e-12)
