"""Facility location on the data of submodlib's tutorial "Basic Usage": at least as good as what submodlib finds, with a verified bound.

Source: ``tutorials/Basic Usage.ipynb`` of submodlib, which draws 500 points around ten centres and lets ``FacilityLocationFunction``
choose ten of them by naive and by lazy greedy, 5 lines each beside the data.
"""

import numpy as np
import pytest

import waybound as wb

submodlib = pytest.importorskip("submodlib", reason="submodlib has no wheel for this Python")
datasets = pytest.importorskip("sklearn.datasets", reason="comes with submodlib")

BUDGET = 10


@pytest.fixture(scope="module")
def likeness() -> np.ndarray:
    """Similarities exp(-distance / largest distance) of 200 of the tutorial's points."""
    points, _ = datasets.make_blobs(n_samples=200, centers=10, n_features=2, cluster_std=4, center_box=(0, 100), random_state=4)
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    return np.exp(-distances / distances.max())


def test_facility_location(likeness: np.ndarray) -> None:
    theirs = submodlib.FacilityLocationFunction(n=len(likeness), mode="dense", sijs=likeness, separate_rep=False)
    chosen = [k for k, _ in theirs.maximize(budget=BUDGET, optimizer="LazyGreedy")]
    ours = wb.solve(wb.SubmodularSelection(wb.DenseFacilityLocation(likeness), wb.Cardinality(BUDGET)), heuristic="lazy-greedy")
    assert ours.objective >= likeness[:, chosen].max(axis=1).sum() - 1e-4  # submodlib counts in single precision
    assert ours.bound_kind == "verified"
    assert ours.objective <= ours.bound <= 1.05 * ours.objective  # 63 % is all that the theorem says


def test_coverage() -> None:
    """Sets of submodlib's documentation of ``SetCoverFunction``'s kind: which three cover most, exactly."""
    rng = np.random.default_rng(4)
    sets = [set(rng.choice(60, 12, replace=False).tolist()) for _ in range(25)]
    theirs = submodlib.SetCoverFunction(n=len(sets), cover_set=sets, num_concepts=60)
    chosen = [k for k, _ in theirs.maximize(budget=3, optimizer="NaiveGreedy")]
    ours = wb.solve(wb.SubmodularSelection(wb.Coverage.from_sets(sets, item_weights=[1.0] * 60), wb.Cardinality(3)), "highs")
    assert ours.objective >= len(set().union(*(sets[k] for k in chosen)))
    assert ours.objective <= ours.certificate.bound
