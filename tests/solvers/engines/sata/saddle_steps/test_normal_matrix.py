import math
from dataclasses import replace

import numpy as np
import pytest
from random_sensing import random_graph
from scipy.sparse import csr_matrix

from waybound.reports.benchmarks.saddle import FAMILIES
from waybound.solvers.engines.sata.saddle_steps.normal_matrix import FIRST_TRIAL, NormalMatrix, Preconditioners


def dense(graph) -> np.ndarray:
    """C of shape (targets, actions)."""
    return csr_matrix((graph.weights, graph.indices, graph.indptr), shape=(graph.num_actions, graph.num_targets)).toarray().T


def drawn(graph, seed=0):
    rng = np.random.default_rng(seed)
    prices = rng.uniform(0.1, 1.0, graph.num_targets)
    return rng.uniform(0.1, 10.0, graph.num_actions), prices / prices.sum(), 10.0 ** rng.uniform(-8, -2, graph.num_targets)


def by_definition(graph, scaling, prices, products) -> np.ndarray:
    k = np.diag(scaling)
    for robot in range(graph.num_robots):
        d = np.where(graph.robot_of_action == robot, scaling, 0.0)
        if d.sum():
            k -= np.outer(d, d) / d.sum()
    c = prices[:, None] * dense(graph)
    return c @ k @ c.T + np.diag(products)


@pytest.mark.parametrize("seed", range(3))
def test_it_is_what_its_definition_says(seed, make_game):
    graph = random_graph(seed, robots=20, targets=12)
    matrix = NormalMatrix.of(make_game(graph))
    assert matrix is not None
    given = drawn(graph, seed)
    system = matrix.system(*given)
    made = csr_matrix((system._values, matrix.columns, matrix.starts)).toarray()
    assert made == pytest.approx(by_definition(graph, *given), rel=1e-9, abs=1e-12)
    x, y = np.random.default_rng(seed).normal(size=graph.num_actions), given[1]
    assert matrix.covers(x) == pytest.approx(dense(graph) @ x)
    assert matrix.worths(y) == pytest.approx(dense(graph).T @ y)


@pytest.mark.parametrize("kind", [0, 1])
@pytest.mark.parametrize("family", ["torus", "expander"])
def test_both_preconditioners_solve_the_equations(kind, family, make_game):
    graph = FAMILIES[family](900)
    game = make_game(graph)
    matrix = NormalMatrix.of(game)
    assert matrix is not None
    scaling, prices, products = drawn(graph)
    matrix.preconditioners.chosen = kind
    system = matrix.system(scaling, prices, products)
    given = np.random.default_rng(1).normal(size=graph.num_targets)
    u = system.solve(given, 1e-9, game.limits)
    assert u is not None and abs(prices @ u) < 1e-6 * np.abs(prices * u).sum()
    rest = given - csr_matrix((system._values, matrix.columns, matrix.starts)) @ u
    rest -= (rest @ prices) / (prices @ prices) * prices  # lambda is free
    assert np.abs(rest).max() < 1e-8


def test_multigrid_is_chosen_where_the_diagonal_takes_many_iterations(make_game):
    graph = FAMILIES["torus"](10_000)
    graph = replace(graph, weights=np.ones(graph.num_edges))
    game = make_game(graph)
    matrix = NormalMatrix.of(game)
    assert matrix is not None
    n, m = graph.num_actions, graph.num_targets
    for _ in range(3):  # nearly a graph Laplacian
        system = matrix.system(np.ones(n), np.ones(m), np.full(m, 1e-6))
        assert system.solve(np.random.default_rng(0).normal(size=m), 1e-4, game.limits) is not None
    assert matrix.preconditioners.chosen == 1 and system.iterations < FIRST_TRIAL


def test_a_preconditioner_is_kept_unless_the_other_was_charged_less():
    choice = Preconditioners()
    choice.note(0, FIRST_TRIAL, 10.0, True)
    assert choice.next() == (0, math.inf)
    choice.note(0, FIRST_TRIAL + 1, 10.0, True)
    assert choice.next() == (1, 10.0)
    choice.note(1, 5, 12.0, False)
    assert choice.next() == (0, math.inf)
    choice.note(0, 4 * FIRST_TRIAL, 40.0, True)
    choice.note(1, 5, 12.0, True)
    assert choice.next() == (1, math.inf)
