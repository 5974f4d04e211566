"""Neighbouring levels are close enough, and powers of two map levels onto levels."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from waybound.solvers.engines.sata.local_max_min.level_grid import LevelGrid


@given(st.floats(1e-6, 1.0), st.integers(-600, 600))
def test_neighbours_are_at_most_a_factor_1_plus_eps_apart(eps, j):
    grid = LevelGrid(eps)
    low, high = grid.level(j), grid.level(j + 1)
    assert low < high <= low * (1 + eps) * (1 + 4e-15)


@given(st.floats(1e-3, 1.0), st.integers(-300, 300), st.integers(-300, 300))
def test_a_power_of_two_moves_levels_onto_levels(eps, j, power):
    grid = LevelGrid(eps)
    assert grid.level(j + power * grid.parts) == math.ldexp(grid.level(j), power)


@given(st.floats(1e-3, 1.0), st.floats(1e-30, 1e30))
def test_a_level_lies_between_the_numbers_next_to_its_own(eps, level):
    grid = LevelGrid(eps)
    j = math.floor(grid.number(level))
    assert grid.level(j - 1) < level < grid.level(j + 2)
