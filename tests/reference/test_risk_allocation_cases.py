"""Allocations with known optima whose cost is one of the risks themselves, not of decisions: programs over cones, and over choices."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse as sp
from programs import program

from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import Program
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.backends.cvxpy import CVXPY, solvers_found
from waybound.solvers.backends.highs import Highs

CONE_SOLVERS = [
    pytest.param(name, marks=pytest.mark.skipif(name not in solvers_found(), reason="it is not installed")) for name in ("CLARABEL", "ECOS")
]
TOTAL = 0.12


def shared(weights: list[float], sense: str, kind: str, rows: list[list[float]], offset: list[float]) -> Program:
    """Shares e of the total, add up to 1 at most, and beside each a number t in a cone with it: the sum of weight times t."""
    n = len(weights)
    made = program([*[0.0] * n, *weights], [[1.0] * n + [0.0] * n], -math.inf, 1.0, [*[0.0] * n, *[-math.inf] * n], math.inf, sense=sense)
    e, t = (np.eye(2 * n)[part] for part in (slice(n), slice(n, 2 * n)))
    image = sp.csr_matrix(np.concatenate([[a * e[k] + b * t[k] for a, b in rows] for k in range(n)]))
    cones = Cones("cost", kind, 3, image.indptr, image.indices, image.data, np.tile(offset, n))
    return Program(made.name, sense, made.variables, made.rows, cones=(cones,))


def solved(made: Program, solver: str) -> RawResult:
    result = CVXPY(solver).run(made, Options(), Control())
    assert result.status == "optimal" and result.answer is not None
    return result


@pytest.mark.parametrize("solver", CONE_SOLVERS)
def test_costs_that_fall_with_the_risk_share_it_as_the_roots_of_their_weights(solver: str) -> None:
    # t e >= 1 is |(t - e, 2)| <= t + e.
    found = solved(shared([1.0, 4.0, 9.0], "min", "second-order", [[1, 1], [-1, 1], [0, 0]], [0.0, 0.0, 2.0]), solver)
    assert found.objective is not None and found.objective / TOTAL == pytest.approx(300.0, rel=1e-6)
    assert TOTAL * found.answer[:3] == pytest.approx([0.02, 0.04, 0.06], abs=1e-5)
    uniform = sum(weight / (TOTAL / 3.0) for weight in (1.0, 4.0, 9.0))
    assert uniform == pytest.approx(350.0)


@pytest.mark.parametrize("solver", CONE_SOLVERS)
def test_rewards_that_grow_with_the_logarithm_of_the_risk_share_it_as_their_weights(solver: str) -> None:
    # exp(t) <= e.
    found = solved(shared([1.0, 2.0, 3.0], "max", "exponential", [[0, 1], [0, 0], [1, 0]], [0.0, 1.0, 0.0]), solver)
    assert TOTAL * found.answer[:3] == pytest.approx([0.02, 0.04, 0.06], abs=1e-5)
    assert found.objective == pytest.approx(math.log(1 / 6) + 2 * math.log(1 / 3) + 3 * math.log(1 / 2), abs=1e-6)


@pytest.mark.parametrize(("total", "boole", "independent"), [(0.15, 13, 13), (0.195, 13, 16), (0.2, 16, 16)])
def test_choices_of_two_tasks_with_risks_added_up_or_multiplied_out(total: float, boole: int, independent: int) -> None:
    risk, reward = np.array([0.0, 0.05, 0.1] * 2), [0.0, 5.0, 8.0] * 2
    one = np.kron(np.eye(2), np.ones(3))
    for weight, limit, best in ((risk, total, boole), (-np.log1p(-risk), -math.log1p(-total), independent)):
        made = program(reward, [*one, weight], [1, 1, -math.inf], [1, 1, limit], 0, 1, integer=range(6), sense="max")
        found = Highs().run(made, Options(), Control())
        assert (found.status, found.objective) == ("optimal", pytest.approx(best))
        assert best < 16 or 1.0 - np.prod(1.0 - risk * found.answer) == pytest.approx(0.19)
