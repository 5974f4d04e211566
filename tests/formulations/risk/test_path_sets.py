import math
from statistics import NormalDist

import numpy as np
import pytest
from coded import coded
from scipy.special import ndtr

from waybound.formulations.risk.path_sets import (
    PathSet,
    cheaper_probability,
    cheapest_path_probabilities,
    cheapest_set_probabilities,
)
from waybound.instances.errors import InputError, UsageError

A, B, C, D = (1.5, 36), (0.75, 0.01), (0, 4), (0.4, 0.01)


def closed_form(a: PathSet, b: PathSet) -> float | None:
    """The probability by a formula, where one is known: one path against one; paths alike; one against two or three of equal means
    (orthants of two and three dimensions: Sheppard 1899)."""
    (m, v), (n, w) = ((s.means + s.first_mean, s.variances + s.first_variance) for s in (a, b))
    if len(m) == 1 == len(n):
        apart, spread = float(n[0] - m[0]), math.sqrt(v[0] + w[0])
        return NormalDist().cdf(apart / spread) if spread > 0 else float(apart > 0) + 0.5 * float(apart == 0)
    means, variances = np.append(m, n), np.append(v, w)
    if (means != means[0]).any() or variances.min() == 0:
        return None
    if (variances == variances[0]).all():
        return len(m) / len(means)
    if len(n) == 1:
        other = closed_form(b, a)
        return None if other is None else 1.0 - other
    if len(m) > 1 or len(n) > 3:
        return None
    angles = [math.asin(v[0] / math.sqrt((v[0] + w[j]) * (v[0] + w[k]))) for j in range(len(n)) for k in range(j)]
    return 0.25 + angles[0] / (2.0 * math.pi) if len(n) == 2 else 0.125 + sum(angles) / (4.0 * math.pi)


def probability(a, b, **options):
    return cheaper_probability(PathSet.of(a), PathSet.of(b), **options)


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ([(10, 4)], [(12, 5)], 0.747507),
        ([(5, 2)] * 3, [(5, 2)] * 2, 0.6),
        ([(0, 1)], [(0, 1)] * 2, 1 / 3),
        ([(0, 1)], [(0, 3)] * 2, 0.290215),
        ([(0, 4)], [(0, 1)] * 2, 0.397584),
        ([(0, 1)], [(0, 1), (0, 2), (0, 3)], 0.210525),
        *[
            ([(10, 1)], [(11, 1)] * k, value)
            for k, value in zip((1, 2, 3, 4, 5, 6, 8), (0.760250, 0.633702, 0.552031, 0.493699, 0.449365, 0.414216, 0.361434), strict=True)
        ],
        ([(0, 1)], [(2, 100)], 0.578872),
        ([(0, 1)], [(1, 0.01)], 0.840141),
        ([(2, 100)], [(1, 0.01)], 0.460174),
        ([A, B], [C], 0.56956),
        ([C], [D], 0.57916),
        ([D], [A, B], 0.56899),
        ([(10.1, 1.1)], [(10, 1)], 0.4725),
        ([(12, 9)], [(10, 1)], 0.2635),
        ([(10, 1)], [(10.2, 1)], 0.5562),
        ([(10, 1)], [(10.2, 1), (10.3, 1.2)], 0.3998),
        ([(2.5, 2), (2, 4)], [(3.5, 3), (3, 5)], 0.649879),
    ],
)  # fmt: skip
def test_reference_values(a, b, expected):
    digits = len(str(expected).partition(".")[2]) if expected != 1 / 3 else 6
    assert probability(a, b) == pytest.approx(expected, abs=0.5001 * 10 ** -min(digits, 6))
    assert probability(a, b) + probability(b, a) == pytest.approx(1.0, abs=1e-12)
    known = closed_form(PathSet.of(a), PathSet.of(b))
    assert known is None or known == pytest.approx(probability(a, b), abs=1e-10)


def test_closed_forms_are_given_where_they_hold_and_nowhere_else():
    assert closed_form(PathSet.of([(1, 1)]), PathSet.of([(2, 1), (3, 1)])) is None
    assert closed_form(PathSet.of([(0, 1)] * 2), PathSet.of([(0, 1), (0, 2)])) is None
    assert closed_form(PathSet.of([(0, 1), (0, 2)]), PathSet.of([(0, 5)])) == pytest.approx(
        1.0 - closed_form(PathSet.of([(0, 5)]), PathSet.of([(0, 1), (0, 2)]))
    )
    assert [closed_form(PathSet.of([(a, 0)]), PathSet.of([(1, 0)])) for a in (0, 1, 2)] == [1.0, 0.5, 0.0]


def test_the_worked_example_of_the_source():
    through_a, through_b = [(150, 15)], [(152, 10), (151, 12), (153, 8), (154, 7)]
    assert probability(through_a, through_b) == pytest.approx(0.418525, abs=1e-6)
    for removed, expected in ((0, 0.294252), (1, 0.296206), (2, 0.298473)):
        direct, *others = [(mean, variance - removed) for mean, variance in through_b]
        assert probability([direct], others) == pytest.approx(expected, abs=1e-6)
    wrong = [[(mean, deviation**2) for mean, deviation in side] for side in (through_a, through_b)]  # the column read as deviations
    assert probability(*wrong) == pytest.approx(0.3297, abs=1e-4)


def test_the_distribution_of_the_least_of_a_set_is_that_of_the_figure():
    """f(x, A) of Skeele (2016), Fig. 5.2, as the probability to undercut a cost that is known."""
    twenty = (20, 25)
    rows = {
        (twenty,): (0.02275, 0.158655, 0.5, 0.841345),
        (twenty,) * 2: (0.044983, 0.292139, 0.75, 0.974829),
        (twenty,) * 3: (0.066709, 0.404445, 0.875, 0.996006),
        (twenty, (15, 25)): (0.177796, 0.579328, 0.920672, 0.996391),
        (twenty, (30, 25)): (0.022781, 0.159791, 0.511375, 0.866516),
        (twenty, (20, 4)): (0.02275, 0.16388, 0.75, 0.999015),
        (twenty, (20, 100)): (0.177796, 0.418242, 0.75, 0.951049),
    }
    for paths, values in rows.items():
        probabilities = [probability(list(paths), [(x, 0)]) for x in (10, 15, 20, 25)]
        assert probabilities == pytest.approx(values, abs=6e-7)


def test_observed_first_edges_decide():
    through_b = PathSet.of([(102, 9), (101, 11), (103, 7), (104, 6)], (50, 0))
    for observed, expected in ((73, 0.632815), (75, 0.416547), (77, 0.220332)):
        assert cheaper_probability(PathSet.of([(75, 8)], (observed, 0)), through_b) == pytest.approx(expected, abs=1e-6)


def test_no_successor_needs_to_win_half_and_pairs_need_not_be_transitive():
    cyclic = [PathSet.of([A, B]), PathSet.of([C]), PathSet.of([D])]
    assert cheapest_set_probabilities(cyclic) == pytest.approx([0.3674, 0.3929, 0.2397], abs=5e-5)
    assert all(cheaper_probability(a, b) > 0.5 for a, b in zip(cyclic, [*cyclic[1:], cyclic[0]], strict=True))
    assert cheapest_set_probabilities([PathSet.of([(3, 2)])] * 3) == pytest.approx([1 / 3] * 3)
    assert cheapest_set_probabilities([PathSet.of([x]) for x in ((0, 1), (2, 100), (1, 0.01))]) == pytest.approx(
        [0.4958, 0.4178, 0.0864], abs=5e-5
    )


def test_narrow_costs_are_not_missed():
    a, b = [(1.5, 36), (0.75, 1e-4)], [(0.7, 4)]
    exact = 1.0 - _by_fine_steps(b, a, 600_000)
    assert probability(a, b) == pytest.approx(exact, abs=1e-6)
    assert probability([(1.0, 1e-12)], [(1.0, 1.0)]) == pytest.approx(0.5, abs=1e-9)


def _by_fine_steps(a, b, steps=120_000):
    """P(the least of a is below the least of b), by the midpoint rule."""
    x = np.linspace(-60.0, 60.0, steps + 1)
    survivals = [np.prod([ndtr(-(x - m) / math.sqrt(v)) for m, v in side], axis=0) for side in (a, b)]
    middle = np.prod([ndtr(-((x[:-1] + x[1:]) / 2 - m) / math.sqrt(v)) for m, v in b], axis=0)
    return float((middle * -np.diff(survivals[0])).sum())


def test_random_sets_agree_with_fine_steps():
    rng = np.random.default_rng(4)
    for _ in range(5):
        a, b = (np.column_stack([rng.normal(0, 3, k), rng.uniform(0.2, 9, k)]).tolist() for k in rng.integers(1, 9, 2))
        assert probability(a, b) == pytest.approx(_by_fine_steps(a, b), abs=1e-6)


def test_what_always_holds():
    rng = np.random.default_rng(7)
    for _ in range(40):
        a, b = (np.column_stack([rng.normal(0, 3, k), rng.uniform(0.0, 9, k) * (rng.random(k) < 0.8)]) for k in rng.integers(1, 12, 2))
        p = probability(a, b)
        assert p + probability(b, a) == pytest.approx(1.0, abs=1e-9)
        assert probability(a + np.array([5, 0]), b + np.array([5, 0])) == pytest.approx(p, abs=1e-9)
        assert probability(a * [2, 4], b * [2, 4]) == pytest.approx(p, abs=1e-9)
        assert probability(np.vstack([a, [rng.normal(0, 3), rng.uniform(0, 9)]]), b) >= p - 1e-9


def test_known_costs_are_atoms_and_ties_are_shared():
    assert probability([(1, 0)], [(1, 0)]) == 0.5
    assert probability([(1, 0)], [(2, 0)]) == 1.0
    assert probability([(1, 0), (5, 1)], [(1, 0), (5, 1)]) == pytest.approx(0.5)
    assert probability([(0, 1), (0.5, 0)], [(0.5, 0)]) == pytest.approx(ndtr(0.5) + 0.5 * ndtr(-0.5))
    assert probability([(0, 1), (0.2, 0)], [(0.5, 0)]) == pytest.approx(1.0)
    assert cheapest_path_probabilities(np.array([0.0, 1.0, 1.0]), np.array([1.0, 0.0, 0.0])) == pytest.approx(
        [ndtr(1.0), ndtr(-1.0) / 2, ndtr(-1.0) / 2]
    )


def _sampled(sets, shared, samples, seed):
    rng = np.random.default_rng(seed)
    least = []
    for s in sets:
        first = rng.normal(s.first_mean, math.sqrt(s.first_variance), (samples, 1 if shared else len(s.means)))
        least.append((first + rng.normal(s.means, np.sqrt(s.variances), (samples, len(s.means)))).min(axis=1))
    won = np.argmin(least, axis=0)
    return np.bincount(won, minlength=len(sets)) / samples


@pytest.mark.parametrize("first_edges", ["separate", "shared"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_first_edges_agree_with_sampling(first_edges, seed):
    rng = np.random.default_rng(seed)
    sets = [
        PathSet(rng.normal(0, 2, k), rng.uniform(0.1, 4, k) * (rng.random(k) < 0.8), rng.normal(), rng.uniform(0, 6)) for k in (3, 1, 4)
    ]
    sets.append(PathSet.of([(0.3, 0.0), (0.5, 1.0)], (0.2, 0.0)))  # observed, and a path that is known to the end
    probabilities = cheapest_set_probabilities(sets, first_edges)
    assert probabilities.sum() == pytest.approx(1.0)
    sampled = _sampled(sets, first_edges == "shared", 200_000, seed)
    assert (np.abs(probabilities - sampled) <= 4.0 * np.sqrt(probabilities * (1 - probabilities) / 200_000) + 1e-9).all()


def test_a_narrow_path_beyond_a_shared_first_edge_is_not_missed():
    first, other = (0.0, 4.0), PathSet.of([(0.3, 2.0)])
    narrow, known = (cheaper_probability(PathSet.of([(0.0, v), (0.1, 1.0)], first), other, "shared") for v in (1e-12, 0.0))
    assert narrow == pytest.approx(known, abs=1e-6)


def test_sets_that_are_none_are_refused():
    for pairs in ([], [(1, -1)], [(math.nan, 1)]):
        with pytest.raises(InputError, check=coded("out-of-range")):
            PathSet.of(pairs)
    with pytest.raises(UsageError, match="first_edges must be one of separate, shared"):
        probability([(0, 1)], [(0, 1)], first_edges="both")
