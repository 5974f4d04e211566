import math
from decimal import ROUND_DOWN, Decimal, getcontext

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.travel import CONVENTIONS, Travel, convention_named

POINTS = [[0, 0], [3, 4], [1, 1], [7, 0.5]]


def between(metric: str, a: tuple[float, float], b: tuple[float, float], convention: str = "") -> float:
    return float(Travel(metric, coordinates=[a, b], convention=convention).distance(0, 1))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("metric", "b", "expected"),
    [
        ("euclidean", (1, 1), math.sqrt(2)),
        ("manhattan", (1.5, 2), 3.5),
        ("EUC_2D", (1, 1), 1.0),
        ("EUC_2D", (1.5, 2), 3.0),  # 2.5 goes up, not to the even 2
        ("EUC_2D", (2.5, 6), 7.0),  # 6.5
        ("MAN_2D", (0.2, 0.3), 1.0),
        ("CEIL_2D", (1, 1), 2.0),
        ("CEIL_2D", (3, 4), 5.0),
        ("ATT", (10, 0), 4.0),  # sqrt(10) = 3.16: TSPLIB's pseudo-Euclidean distance rounds up
        ("ATT", (1, 3), 1.0),
    ],
)
def test_a_metric_of_tsplib_rounds_as_the_standard_says(metric: str, b: tuple[float, float], expected: float) -> None:
    assert between(metric, (0.0, 0.0), b) == expected


def test_geographical_distance_equals_the_formula_of_tsplib() -> None:
    # ulysses: nodes 1 and 2; worked out by hand from section 2.4 of TSPLIB 95.
    assert between("GEO", (38.24, 20.42), (39.57, 26.15)) == 509.0
    assert between("GEO", (38.24, 20.42), (38.24, 20.42)) == 1.0  # the formula adds 1 before truncation


def test_geographical_minutes_are_minutes_on_both_hemispheres() -> None:
    # 1 degree 30 minutes along a meridian, north and south.
    radius, pi = 6378.388, 3.141592
    expected = math.floor(radius * math.acos(math.cos(pi * 1.5 / 180)) + 1)
    assert between("GEO", (0.0, 0.0), (1.30, 0.0)) == expected
    assert between("GEO", (0.0, 0.0), (-1.30, 0.0)) == expected


@pytest.mark.parametrize(
    ("convention", "expected"),
    [("exact", math.sqrt(2)), ("trunc1", 1.4), ("dimacs", 1.4), ("trunc2", 1.41), ("round", 1.0), ("ceil", 2.0)],
)
def test_every_convention_rounds_as_its_name_says(convention: str, expected: float) -> None:
    assert between("euclidean", (0, 0), (1, 1), convention) == expected


def test_a_decimal_that_binary_falls_short_of_is_not_truncated_below_itself() -> None:
    # 0.29 * 100 = 28.999999999999996 in doubles.
    assert between("manhattan", (0, 0), (0.29, 0), "trunc2") == 0.29
    assert between("euclidean", (0, 0), (3, 4), "ceil") == 5.0


@given(st.integers(0, 3000), st.integers(0, 3000))
def test_truncation_of_whole_coordinates_agrees_with_decimal_arithmetic(dx: int, dy: int) -> None:
    getcontext().prec = 50
    true = Decimal(dx * dx + dy * dy).sqrt().quantize(Decimal("0.1"), rounding=ROUND_DOWN)
    assert between("euclidean", (0, 0), (dx, dy), "trunc1") == float(true)


@given(st.integers(0, 3000), st.integers(0, 3000))
def test_rounding_of_whole_coordinates_agrees_with_integer_arithmetic(dx: int, dy: int) -> None:
    square = dx * dx + dy * dy
    root = math.isqrt(square)
    assert between("EUC_2D", (0, 0), (dx, dy)) == root + (square > root * root + root)  # d > root + 1/2
    assert between("euclidean", (0, 0), (dx, dy), "ceil") == root + (square > root * root)


@given(st.lists(st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)), min_size=2, max_size=6), st.sampled_from(CONVENTIONS[1:]))
def test_distances_are_symmetric_with_zero_diagonal(points: list[tuple[float, float]], convention: str) -> None:
    d = Travel("euclidean", coordinates=points, convention=convention).distances  # type: ignore[arg-type]
    assert np.array_equal(d, d.T)
    assert not d.diagonal().any()
    assert (d >= 0).all()


def test_single_moves_equal_the_matrix() -> None:
    travel = Travel("EUC_2D", coordinates=POINTS)  # type: ignore[arg-type]
    for i in range(4):
        for j in range(4):
            assert travel.distance(i, j) == travel.distances[i, j]


def test_the_default_is_file_where_the_metric_prescribes_a_rounding() -> None:
    assert Travel("EUC_2D", coordinates=POINTS).convention == "file"  # type: ignore[arg-type]
    assert Travel("EXPLICIT", matrix=np.ones((2, 2))).convention == "file"
    assert Travel("euclidean", coordinates=POINTS).convention == "exact"  # type: ignore[arg-type]


def test_file_is_refused_where_nothing_is_prescribed() -> None:
    with pytest.raises(UsageError, match="use exact"):
        Travel("euclidean", coordinates=POINTS, convention="file")  # type: ignore[arg-type]


def test_an_alias_and_an_unknown_convention() -> None:
    assert convention_named("dimacs") == "trunc1"
    with pytest.raises(UsageError, match="choose from file, exact"):
        convention_named("half-even")


def test_another_convention_leaves_the_data_alone() -> None:
    travel = Travel("EUC_2D", coordinates=POINTS)  # type: ignore[arg-type]
    assert travel.with_convention("exact").distance(0, 2) == math.sqrt(2)
    assert travel.distance(0, 2) == 1.0


def test_durations_are_distances_unless_given_and_are_never_rounded() -> None:
    times = [[0, 2.7], [3.3, 0]]
    travel = Travel("EUC_2D", coordinates=[[0, 0], [1, 1]], duration_matrix=times)  # type: ignore[arg-type]
    assert travel.duration(0, 1) == 2.7
    assert travel.distance(0, 1) == 1.0
    assert travel.durations[1, 0] == 3.3
    plain = Travel("EUC_2D", coordinates=POINTS)  # type: ignore[arg-type]
    assert plain.durations is plain.distances


def test_a_subset_keeps_order_and_both_matrices() -> None:
    matrix = np.arange(16.0).reshape(4, 4)
    travel = Travel("EXPLICIT", matrix=matrix, duration_matrix=matrix * 2).subset([2, 0])
    assert travel.distance(0, 1) == 8.0
    assert travel.duration(1, 0) == 4.0
    assert Travel("euclidean", coordinates=POINTS).subset([3, 1]).coordinates.tolist() == [[7, 0.5], [3, 4]]  # type: ignore[arg-type, union-attr]


def test_arrays_cannot_be_changed_from_outside() -> None:
    matrix = np.ones((2, 2))
    travel = Travel("EXPLICIT", matrix=matrix)
    matrix[0, 1] = 9
    assert travel.distance(0, 1) == 1.0
    with pytest.raises(ValueError, match="read-only"):
        travel.distances[0, 1] = 5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"metric": "EXPLICIT"}, "needs a matrix"),
        ({"metric": "EUC_2D"}, "needs coordinates"),
        ({"metric": "EUC_3D", "coordinates": POINTS}, "unknown metric 'EUC_3D'"),
        ({"metric": "EUC_2D", "coordinates": [[0, 0, 0]]}, "shape"),
        ({"metric": "EUC_2D", "coordinates": [[0, 0], [math.nan, 1]]}, "coordinate of site 1 is not finite"),
        ({"metric": "EXPLICIT", "matrix": [[0, 1]]}, "must be square"),
        ({"metric": "EXPLICIT", "matrix": [[0, -1], [1, 0]]}, "in row 1, column 2 must be finite and not negative"),
        ({"metric": "EXPLICIT", "matrix": [[0, 1], [math.inf, 0]]}, "in row 2, column 1"),
        ({"metric": "EXPLICIT", "matrix": [[0, math.nan], [1, 0]]}, "must be finite"),
        ({"metric": "EUC_2D", "coordinates": POINTS, "duration_matrix": [[0]]}, "another size"),
    ],
)
def test_what_does_not_fit_is_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Travel(**arguments)  # type: ignore[arg-type]


def test_the_diagonal_of_a_matrix_counts_for_nothing() -> None:
    travel = Travel("EXPLICIT", matrix=[[9999, 1], [1, math.nan]])  # type: ignore[arg-type]
    assert travel.distances.tolist() == [[0, 1], [1, 0]]


@given(st.floats(0.1, 50.0), st.sampled_from(("exact", "round", "trunc1")))
def test_a_pace_makes_durations_of_distances_as_they_are_rounded(pace: float, convention: str) -> None:
    travel, plain = (Travel("euclidean", coordinates=POINTS, convention=convention, pace=p) for p in (pace, 1.0))
    assert np.array_equal(travel.distances, plain.distances)
    assert np.allclose(travel.durations, pace * plain.distances) and travel.durations[0, 1] == travel.duration(0, 1)
    assert travel.own_durations == (pace != 1.0) and not plain.own_durations
    assert np.allclose(plain.at_speed(1.0 / pace).durations, travel.durations)
    assert (travel.least_duration(0, [1, 2, 3]) <= travel.duration(0, [1, 2, 3]) + 1e-9).all()


@pytest.mark.parametrize("pace", [0.0, -1.0, math.inf, math.nan])
def test_a_pace_is_positive_and_finite(pace: float) -> None:
    with pytest.raises(InputError, check=coded("out-of-range")):
        Travel("euclidean", coordinates=POINTS, pace=pace)


def test_a_hundred_thousand_sites_have_a_speed_without_any_matrix() -> None:
    n = 100_000
    travel = Travel("haversine", coordinates=np.column_stack([np.linspace(0, 10, n), np.linspace(40, 45, n)])).at_speed(50.0)
    every = np.arange(n - 1)
    assert travel.duration(every, every + 1).sum() == pytest.approx(travel.distance(every, every + 1).sum() / 50.0)
    assert "distances" not in travel.__dict__ and travel.matrix is None and travel.duration_matrix is None
