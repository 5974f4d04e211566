"""The facility-location form: what it writes, level by level."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from sata_cases import TWO_ROBOTS
from selection_problems import cover_30

from waybound import Cardinality, DenseFacilityLocation, SubmodularSelection
from waybound.solvers.backend import BACKENDS, Control, Options


def test_facility_location_from_text_to_text(tmp_path: Path) -> None:
    """Target t is served at level 2, by either of two actions, or at 5; u at 1 or at 3."""
    assert written(TWO_ROBOTS, "facility-location", tmp_path) == expected(
        """
        facility-location, exact
        max 2 u[t,1] + 3 u[t,2] + u[u,1] + 2 u[u,2]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        level[t,1]: - x[right] - x[stay] + u[t,1] - u[t,2] <= 0
        level[t,2]: - x[left] + u[t,2] <= 0
        level[u,1]: - x[stay] + u[u,1] - u[u,2] <= 0
        level[u,2]: - x[right] + u[u,2] <= 0
        x[left], x[right], x[stay] binary
        0 <= u[t,1], u[t,2], u[u,1], u[u,2] <= 1
        """
    )


def test_levels_are_the_different_weights_of_an_item():
    weights = np.array([[3.0, 0.0], [1.0, 2.0], [3.0, 2.0]])
    program = SubmodularSelection(DenseFacilityLocation(weights), Cardinality(1)).compile("facility-location").program
    assert program.cost[3:].tolist() == [1.0, 2.0, 2.0]
    dense = program.matrix.toarray()[1:]
    assert dense.tolist() == [[0, -1, 0, 1, -1, 0], [-1, 0, -1, 0, 1, 0], [0, -1, -1, 0, 0, 1]]


def test_coverage_has_one_row_an_item():
    problem = cover_30(6)
    program = problem.compile("facility-location").program
    covered = len(np.unique(problem.function.indices))
    assert program.num_rows == 1 + covered
    assert BACKENDS["highs"]().run(program, Options(), Control()).objective == pytest.approx(142.0)
