import numpy as np
import pytest

from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.engines.routing import extents
from waybound.solvers.engines.routing.extents import distances_of, largest_distance, largest_duration
from waybound.solvers.engines.routing.integer_scales import scale_of

PLANE = [
    ("euclidean", "exact"), ("euclidean", "trunc1"), ("euclidean", "trunc2"), ("euclidean", "round"), ("EUC_2D", ""), ("CEIL_2D", ""),
    ("ATT", ""), ("MAN_2D", ""), ("manhattan", "exact"), ("manhattan", "ceil"),
]  # fmt: skip


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extents, "MANY", 10)


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize(("metric", "convention"), PLANE)
@pytest.mark.parametrize("pace", [1.0, 2.0])
def test_of_sites_in_the_plane_they_are_exact(metric: str, convention: str, pace: float) -> None:
    xy = np.random.default_rng(1).integers(-50, 90, (60, 2)).astype(float)
    travel = Travel(metric, xy, convention=convention, pace=pace)
    assert largest_distance(travel) == travel.distances.max()
    assert largest_duration(travel) == travel.durations.max()
    for few, every in zip(distances_of(travel), (travel.distances, travel.durations), strict=True):
        assert scale_of(few) == scale_of(every)


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize("metric", ["GEO", "haversine", "haversine-m"])
def test_on_a_globe_none_of_all_is_larger(metric: str) -> None:
    xy = np.random.default_rng(2).uniform(-60, 60, (60, 2))
    travel = Travel(metric, xy)
    assert travel.distances.max() <= largest_distance(travel) <= 2.01 * travel.distances.max()
    assert scale_of(distances_of(travel)[0]).exact == scale_of(travel.distances).exact


@pytest.mark.usefixtures("few")
def test_sites_in_a_line_in_one_place_or_on_a_circle_have_a_largest_distance_too(monkeypatch: pytest.MonkeyPatch) -> None:
    along = np.arange(40.0)
    line, place = np.column_stack([along, 2.0 * along]), np.ones((40, 2))
    assert largest_distance(Travel("euclidean", line)) == np.hypot(39, 78)
    assert largest_distance(Travel("euclidean", place)) == 0.0
    monkeypatch.setattr(extents, "CORNERS", 20)
    circle = Travel("euclidean", 100.0 * np.column_stack([np.cos(along), np.sin(along)]))
    assert circle.distances.max() <= largest_distance(circle) <= 1.5 * circle.distances.max()


@pytest.mark.usefixtures("few")
def test_coordinates_that_are_not_whole_make_no_whole_distances_of_blocks() -> None:
    xy = np.random.default_rng(3).integers(0, 90, (40, 2)) + 0.5
    assert not scale_of(distances_of(Travel("manhattan", xy))[0]).exact


@pytest.mark.usefixtures("few")
def test_matrices_are_looked_at_as_they_are() -> None:
    matrix = np.random.default_rng(4).uniform(0, 9, (30, 30))
    travel = Travel(EXPLICIT, None, matrix, 2.0 * matrix, convention="exact")
    np.fill_diagonal(matrix, 0.0)
    assert largest_distance(travel) == matrix.max() and largest_duration(travel) == 2.0 * matrix.max()
    xy = np.random.default_rng(5).uniform(0, 9, (30, 2))
    assert largest_duration(Travel("euclidean", xy, duration_matrix=matrix)) == matrix.max()
