"""Small mixed-integer programs for trees: their optima come from exact arithmetic."""

import math

import numpy as np
from programs import program

from waybound.formulations.arrays.problem import ArrayProblem


def random_program(seed: int) -> ArrayProblem:
    """Of either sense, some variables whole, often infeasible, with free and one-sided rows, costs with and without a grain."""
    rng = np.random.default_rng(seed)
    m, n = int(rng.integers(1, 5)), int(rng.integers(1, 6))
    matrix = rng.integers(-4, 5, (m, n)).astype(float)
    inside = rng.integers(-2, 3, n).astype(float)
    low, high = matrix @ inside - rng.integers(0, 4, m), matrix @ inside + rng.integers(0, 4, m)
    if rng.random() < 0.3:
        low += rng.integers(0, 4, m) / 4.0
        high = low + 0.25
    low[rng.random(m) < 0.3], high[rng.random(m) < 0.3] = -math.inf, math.inf
    cost = rng.integers(-5, 6, n) + (rng.integers(0, 100, n) / 100.0 if rng.random() < 0.5 else 0.0)
    whole = np.nonzero(rng.random(n) < 0.8)[0].tolist()
    lower, upper = inside - rng.integers(0, 3, n), inside + rng.integers(0, 3, n)
    sense, offset = str(rng.choice(["min", "max"])), float(rng.integers(-3, 4))
    return ArrayProblem(program(cost, matrix, low, high, lower, upper, integer=whole, sense=sense, offset=offset))


def knapsack() -> ArrayProblem:
    """max 5 x + 4 y + 3 z over 2 x + 3 y + z <= 7, 4 x + y + 2 z <= 11, 3 x + 4 y + 2 z <= 9.5, whole: 14 at (1, 0, 3)."""
    rows = [[2, 3, 1], [4, 1, 2], [3, 4, 2]]
    return ArrayProblem(program([5, 4, 3], rows, -math.inf, [7, 11, 9.5], 0.0, 9.0, integer=[0, 1, 2], sense="max"))


def without_answer() -> ArrayProblem:
    """x + y = 1.5 and the like: a relaxation that has points, none of them whole."""
    return ArrayProblem(program([1, 1, 1], [[2, 2, 2]], [3], [3], 0.0, 1.0, integer=[0, 1, 2]))


def hard(seed: int = 3, rows: int = 40, columns: int = 60) -> ArrayProblem:
    """A multi-dimensional knapsack that no tree of some seconds closes."""
    rng = np.random.default_rng(seed)
    matrix = rng.integers(1, 100, (rows, columns)).astype(float)
    cost = matrix.sum(axis=0) / rows + rng.integers(0, 50, columns)
    return ArrayProblem(program(cost, matrix, -math.inf, matrix.sum(axis=1) / 2.0, 0.0, 1.0, integer=range(columns), sense="max"))
