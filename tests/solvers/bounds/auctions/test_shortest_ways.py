"""Shortest ways are looked at for every task allocation, and for nothing else."""

from __future__ import annotations

import pytest
from task_problems import line, parts

import waybound as wb
from waybound.solvers.bounds import BOUNDS


def test_it_is_for_task_allocation_alone_and_proves_an_optimum_where_one_task_is_far():
    assert not BOUNDS["shortest-ways"].missing(line([0], [1], "mini-ave"))
    assert BOUNDS["shortest-ways"].missing(parts([0, 1])) == {"balanced-partition problems"}
    bound = wb.bound(line([0, 0], [9, -2], "mini-max"), bound_time=60.0)
    assert bound.bound == pytest.approx(9.0, rel=1e-12) and bound.bound_source == "shortest ways to all tasks"
