"""The linear forms of a selection and the product form: what they write, row by row."""

from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from selection_problems import cover_30

from waybound import Cardinality, DenseFacilityLocation, SubmodularSelection, UsageError
from waybound.solvers.backend import BACKENDS, Control, Options

ROBOTS = """
    # problem: winner-takes-all
    robot,action,target,weight
    r,left,t,5
    r,right,t,2
    r,right,u,3
    s,stay,t,2
    s,stay,u,1
"""


def test_facility_location_from_text_to_text(tmp_path: Path) -> None:
    """Target t is served at level 2, by either of two actions, or at 5; u at 1 or at 3."""
    assert written(ROBOTS, "facility-location", tmp_path) == expected("""
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
    """)


def test_levels_are_the_different_weights_of_an_item():
    weights = np.array([[3.0, 0.0], [1.0, 2.0], [3.0, 2.0]])
    program = SubmodularSelection(DenseFacilityLocation(weights), Cardinality(1)).compile("facility-location").program
    assert program.cost[3:].tolist() == [1.0, 2.0, 2.0]
    dense = program.matrix.toarray()[1:]
    assert dense.tolist() == [[0, -1, 0, 1, -1, 0], [-1, 0, -1, 0, 1, 0], [0, -1, -1, 0, 0, 1]]


def test_coverage_has_one_row_an_item():
    problem = cover_30(6)
    program = problem.compile("facility-location").program
    assert program.num_rows == 1 + len(np.unique(problem.function.indices))
    assert BACKENDS["highs"]().run(program, Options(), Control()).objective == pytest.approx(142.0)


def test_strong_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """All three actions that see t share one row of it."""
    assert written(ROBOTS, "strong-linearisation", tmp_path) == expected("""
        strong-linearisation, exact
        max 5 z[left,t] + 2 z[right,t] + 3 z[right,u] + 2 z[stay,t] + z[stay,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        item[t]: z[left,t] + z[right,t] + z[stay,t] <= 1
        item[u]: z[right,u] + z[stay,u] <= 1
        link[left,t]: - x[left] + z[left,t] <= 0
        link[right,t]: - x[right] + z[right,t] <= 0
        link[right,u]: - x[right] + z[right,u] <= 0
        link[stay,t]: - x[stay] + z[stay,t] <= 0
        link[stay,u]: - x[stay] + z[stay,u] <= 0
        x[left], x[right], x[stay] binary
        0 <= z[left,t], z[right,t], z[right,u], z[stay,t], z[stay,u] <= 1
    """)


def test_weak_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """Both actions of r that see t draw on the one credit y[r,t], each in full: that is what makes the relaxation weak."""
    assert written(ROBOTS, "weak-linearisation", tmp_path) == expected("""
        weak-linearisation, exact
        max 5 z[left,t] + 2 z[right,t] + 3 z[right,u] + 2 z[stay,t] + z[stay,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        link[left,t]: - x[left] + z[left,t] <= 0
        link[right,t]: - x[right] + z[right,t] <= 0
        link[right,u]: - x[right] + z[right,u] <= 0
        link[stay,t]: - x[stay] + z[stay,t] <= 0
        link[stay,u]: - x[stay] + z[stay,u] <= 0
        credit[left,t]: - y[r,t] + z[left,t] <= 0
        credit[right,t]: - y[r,t] + z[right,t] <= 0
        credit[right,u]: - y[r,u] + z[right,u] <= 0
        credit[stay,t]: - y[s,t] + z[stay,t] <= 0
        credit[stay,u]: - y[s,u] + z[stay,u] <= 0
        item[t]: y[r,t] + y[s,t] <= 1
        item[u]: y[r,u] + y[s,u] <= 1
        x[left], x[right], x[stay] binary
        0 <= y[r,t], y[r,u], y[s,t], y[s,u], z[left,t], z[right,t], z[right,u], z[stay,t], z[stay,u] <= 1
    """)


def test_product_from_text_to_text(tmp_path: Path) -> None:
    assert written(ROBOTS, "product", tmp_path) == expected("""
        product, exact
        max 5 x[left] y[r,t] + 2 x[right] y[r,t] + 3 x[right] y[r,u] + 2 x[stay] y[s,t] + x[stay] y[s,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        item[t]: y[r,t] + y[s,t] <= 1
        item[u]: y[r,u] + y[s,u] <= 1
        x[left], x[right], x[stay], y[r,t], y[r,u], y[s,t], y[s,u] binary
    """)


def test_the_product_form_has_no_linear_relaxation():
    with pytest.raises(UsageError, match="not linear"):
        cover_30(3).compile("product", relax=True)
