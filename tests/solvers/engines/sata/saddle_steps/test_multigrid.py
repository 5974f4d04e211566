from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags, identity, kron

from waybound.solvers.engines.sata.saddle_steps.multigrid import COARSEST, Multigrid


def laplacian(side: int, anisotropy: float = 1.0, shift: float = 1e-6) -> csr_matrix:
    line = diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(side, side))
    return (anisotropy * kron(line, identity(side)) + kron(identity(side), line) + shift * identity(side * side)).tocsr()


def cycle_of(matrix: csr_matrix) -> Multigrid:
    matrix.sort_indices()
    return Multigrid(matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32), matrix.data, matrix.diagonal())


def iterations(matrix: csr_matrix, cycle: Multigrid) -> int:
    """Flexible conjugate gradients until a millionth of the residual is left."""
    rest = np.random.default_rng(0).normal(size=matrix.shape[0])
    end, image = 1e-6 * np.linalg.norm(rest), cycle(rest)
    way, slope, count = image, rest @ image, 0
    while np.linalg.norm(rest) > end:
        product = matrix @ way
        before, rest = rest, rest - slope / (way @ product) * product
        image, count = cycle(rest), count + 1
        way, slope = image + (rest - before) @ image / slope * way, rest @ image
    return count


def test_a_small_matrix_is_factorised():
    matrix = laplacian(15)
    given = np.random.default_rng(0).normal(size=225)
    assert matrix @ cycle_of(matrix)(given) == pytest.approx(given)


@pytest.mark.parametrize("anisotropy", [1.0, 1e-3])
def test_iterations_hardly_grow_with_the_grid(anisotropy):
    counts = [iterations(laplacian(side, anisotropy), cycle_of(laplacian(side, anisotropy))) for side in (40, 160)]
    assert counts[1] <= counts[0] + 12 and counts[1] < 40


def test_levels_shrink_and_sum_what_they_join():
    cycle = cycle_of(laplacian(100))
    sizes = [len(level.inverse) for level in cycle.levels]
    assert sizes[-1] <= COARSEST and all(2 * b <= a for a, b in pairwise(sizes))
    for fine, coarse in pairwise(cycle.levels):
        assert fine.times(np.ones(len(fine.inverse))).sum() == pytest.approx(coarse.times(np.ones(len(coarse.inverse))).sum())


def test_a_level_keeps_the_matrix_in_halves_of_its_rows():
    matrix = laplacian(30, anisotropy=0.3)
    level, vector = cycle_of(matrix).levels[0], np.random.default_rng(1).normal(size=900)
    assert level.times(vector) == pytest.approx(matrix @ vector, rel=1e-5, abs=1e-5)
    for row in range(900):
        left, right = level.columns[level.starts[row] : level.middle[row]], level.columns[level.middle[row] : level.starts[row + 1] - 1]
        assert (left < row).all() and (right > row).all() and level.columns[level.starts[row + 1] - 1] == row


def test_a_matrix_in_which_nothing_can_be_joined_is_only_smoothed():
    diagonal = np.random.default_rng(0).uniform(1.0, 2.0, COARSEST + 100)
    cycle = cycle_of(csr_matrix(diags(diagonal)))
    assert len(cycle.levels) == 1
    assert cycle(diagonal) == pytest.approx(np.ones(len(diagonal)))
