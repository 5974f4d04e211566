"""What apricot's own tests publish for facility location and coverage: the same data, at least its values, with a verified bound.

Source: jmschrei/apricot, its tests of facility location and of maximum coverage: gains of its greedy rankings of
the 1,797 handwritten digits of scikit-learn, and of 300 drawn sets; 3 lines each there beside the data, 1 here.
"""

import numpy as np
import pytest

import waybound as wb

datasets = pytest.importorskip("sklearn.datasets", reason="holds the digits")

BUDGET = 100

PUBLISHED = {"corr": 1502.7138, "cosine": 1616.2940}
"""Sums of the hundred gains, of four decimals each."""

COVERED = 822
"""The same of coverage, by naive greedy; ties settle how good a greedy choice is."""


def likeness(kind: str) -> np.ndarray:
    """Squared correlations, or squared cosines, of the digits' pixels."""
    pixels = datasets.load_digits().data
    pixels = pixels - (pixels.mean(axis=1, keepdims=True) if kind == "corr" else 0.0)
    pixels /= np.linalg.norm(pixels, axis=1, keepdims=True)
    return (pixels @ pixels.T) ** 2


@pytest.mark.parametrize("kind", PUBLISHED)
def test_facility_location(kind: str) -> None:
    solution = wb.solve(wb.SubmodularSelection(wb.DenseFacilityLocation(likeness(kind)), wb.Cardinality(BUDGET)), heuristic="lazy-greedy")
    assert solution.objective >= PUBLISHED[kind] - 0.005 and solution.bound_kind == "verified"
    assert solution.objective <= solution.bound <= 1.05 * solution.objective  # 63 % is all that the theorem says


@pytest.mark.slow
def test_coverage() -> None:
    np.random.seed(0)  # noqa: NPY002 - the published draw
    held = np.random.choice(2, size=(300, 1000), p=[0.99, 0.01])  # noqa: NPY002
    sets = [set(np.nonzero(row)[0].tolist()) for row in held]
    problem = wb.SubmodularSelection(wb.Coverage.from_sets(sets, item_weights=[1.0] * 1000), wb.Cardinality(BUDGET))
    greedy = wb.solve(problem, heuristic="lazy-greedy")
    solution = wb.solve(problem, "highs", start=greedy, time_limit=20.0, bound_time=5.0)
    assert solution.objective >= COVERED and solution.objective <= solution.certificate.bound <= 1.1 * solution.objective
