import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.instances.generating import generate
from waybound.instances.sata.sensing_graph import SensingGraph
from waybound.solvers.engines.sata.local_max_min import search
from waybound.solvers.engines.sata.local_max_min.cleaning import CleanGraph, clean
from waybound.solvers.engines.sata.local_max_min.search import LevelGrid, SecantSearch, step_search


def generated(kind: str, robots: int, spread: float = 0.0) -> CleanGraph:
    graph = generate(f"sensing-{kind}", seed=robots, robots=robots)
    assert isinstance(graph, SensingGraph)
    return clean(replace(graph, weights=graph.weights * np.exp(np.random.default_rng(1).uniform(-spread, spread, graph.num_edges))))


@pytest.mark.parametrize("kind", ["regular", "ring", "geometric"])
@pytest.mark.parametrize("spread", [0.0, 4.0])
@pytest.mark.parametrize("h", [1, 2, 4])
def test_a_guess_where_levels_lie_changes_the_work_and_not_the_result(
    kind: str, spread: float, h: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    graph = generated(kind, 3000, spread)
    guessed = SecantSearch(graph, h, 0.1).run()
    monkeypatch.setattr(search.SecantSearch, "_guess", lambda self, low, high: None)
    plain = SecantSearch(graph, h, 0.1).run()
    monkeypatch.setattr(search, "_LINEAR", 7)
    coarse = SecantSearch(graph, h, 0.1).run()
    assert guessed.tobytes() == plain.tobytes() == coarse.tobytes()
    assert np.isfinite(guessed).all()


def test_finer_levels_only_move_results_within_the_coarser_precision() -> None:
    graph = generated("regular", 1500, 1.0)
    fine, coarse = SecantSearch(graph, 3, 1e-6).run(), SecantSearch(graph, 3, 0.2).run()
    assert (coarse <= fine * (1 + 1e-6)).all()
    assert (fine <= coarse * 1.2).all()


def test_finer_steps_approach_the_same_levels_from_below() -> None:
    graph = generated("regular", 800)
    exact = SecantSearch(graph, 2, 1e-6).run()
    for step in (0.5, 0.05, 0.001):
        levels, relative = step_search(graph, 2, step)
        assert (levels <= exact * (1 + 2e-6)).all()
        assert (exact <= levels + step * (1 + 1e-9)).all()
        assert (exact <= levels * (1 + relative) * (1 + 1e-9)).all()


def test_a_huge_step_ends_at_half_the_ceiling_which_is_always_valid() -> None:
    graph = generated("regular", 300)
    levels, relative = step_search(graph, 3, 1e6)
    exact = SecantSearch(graph, 3, 1e-6).run()
    assert (levels <= exact * (1 + 1e-9)).all()
    assert (exact <= 2 * levels).all()
    assert relative <= 1.0


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
