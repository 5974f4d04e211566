import itertools
import math

import numpy as np
import pytest
from coded import check_coded
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, KINDS, cover_30, feasible_sets, random_constraint, random_function, run

import waybound as wb
from waybound import Cardinality, Coverage, InputError, SubmodularSelection, UsageError, UserFunction, check_submodular


def csqmi(p: float, hit_occupied: float, hit_free: float, readings: int) -> UserFunction:
    """Cauchy-Schwarz quadratic mutual information of a binary cell and some conditionally independent readings of it, in nats.

    ``-ln [ (sum p(m, o) p(m) p(o))^2 / (sum p(m, o)^2 sum p(m)^2 p(o)^2) ]``, by enumerating the readings.
    """
    prior = np.array([1 - p, p])
    hit = np.array([hit_free, hit_occupied])

    def information(count: int) -> float:
        joint = [prior * np.prod([hit if o else 1 - hit for o in outcome], axis=0) for outcome in itertools.product((0, 1), repeat=count)]
        of_outcome = np.array([j.sum() for j in joint])
        cross = sum(float((j * prior).sum()) * po for j, po in zip(joint, of_outcome, strict=True))
        return -math.log(cross**2 / (sum(float((j**2).sum()) for j in joint) * float((prior**2).sum()) * float((of_outcome**2).sum())))

    table = np.array([0.0] + [information(k) for k in range(1, readings + 1)])
    return UserFunction(lambda masks: table[masks.sum(axis=1)], readings, monotone=True, submodular=True, label="CSQMI")


def test_csqmi_has_growing_returns() -> None:
    """docs/selection.md#is-it-submodular: 0.148647 after one reading, 0.353162 after two."""
    problem = SubmodularSelection(csqmi(0.25, 0.99, 0.40, 2), Cardinality(2))
    report = check_submodular(problem)
    assert not report and not report.submodular and report.monotone and report.exhaustive
    (violation,) = report.violations
    assert violation.a == () and len(violation.b) == 1 and violation.element not in violation.b
    assert violation.gain_a == pytest.approx(0.148647, abs=5e-7)
    assert violation.gain_a + violation.gain_b == pytest.approx(0.353162, abs=5e-7)
    assert "adds 0.148647 to {}, but 0.204516 to {" in str(report)
    outcome = run("greedy", problem)
    assert outcome.guarantee is None and outcome.evidence == () and "not submodular" in outcome.message
    solved = wb.solve(problem, heuristic="greedy", bound_time=60.0)
    assert solved.certificate.bound is None and solved.certificate.guarantee is None


def test_csqmi_may_even_fall() -> None:
    """docs/selection.md#errata: 0.027481 after one reading, 0.027235 after two."""
    report = check_submodular(SubmodularSelection(csqmi(0.1, 0.9, 0.01, 2), Cardinality(2)))
    assert report.submodular and not report.monotone
    (violation,) = report.violations
    assert violation.property == "monotone"
    assert violation.gain_b == pytest.approx(0.027235 - 0.027481, abs=1e-6)
    assert "not monotone: element" in str(report)


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.integers(1, 40))
def test_coverage_facility_location_and_roots_of_sums_pass(seed: int, kind: str, n: int) -> None:
    report = check_submodular(random_function(np.random.default_rng(seed), kind, n), samples=150, seed=seed)
    assert report, str(report)
    assert "no violation in" in str(report)


@given(st.integers(0, 10**6), st.integers(1, 5))
def test_small_ground_sets_are_decided(seed: int, n: int) -> None:
    """Any table of values: exhaustive reports agree with the definition, over all A within B."""
    rng = np.random.default_rng(seed)
    weight = 1 << np.arange(n)
    sizes = np.array([bin(s).count("1") for s in range(2**n)])
    table = np.sqrt(sizes) + rng.normal(size=2**n) * rng.choice([0.0, 0.05, 1.0])
    table[0] = 0.0
    report = check_submodular(lambda masks: table[masks @ weight], n, samples=10**6)
    assert report.exhaustive
    submodular = monotone = True
    for b, e in itertools.product(range(2**n), range(n)):
        if b >> e & 1:
            continue
        gain = table[b | 1 << e] - table[b]
        monotone &= gain >= -1e-9
        submodular &= all(gain <= table[a | 1 << e] - table[a] + 1e-9 for a in range(2**n) if a & b == a)
    assert (report.submodular, report.monotone) == (submodular, monotone)


@given(st.integers(0, 10**6), st.integers(2, 12), st.sampled_from([None, *CONSTRAINTS]))
def test_a_violation_is_what_it_says(seed: int, n: int, constraint: str | None) -> None:
    rng = np.random.default_rng(seed)
    table = rng.normal(size=2**n)

    def f(masks):  # type: ignore[no-untyped-def]
        return table[masks @ (1 << np.arange(n))]

    rule = None if constraint is None else random_constraint(rng, constraint, n)
    report = check_submodular(f, n, samples=200, seed=seed, constraint=rule)
    for violation in report.violations:
        a, b, e = set(violation.a), set(violation.b), violation.element
        assert a <= b and e not in b

        def gain(s: set[int]) -> float:
            return float(table[sum(1 << k for k in {*s, e})] - table[sum(1 << k for k in s)])  # noqa: B023

        assert gain(b) == pytest.approx(violation.gain_b) and gain(a) == pytest.approx(violation.gain_a)
        assert violation.gain_b > violation.gain_a if violation.property == "submodular" else violation.gain_b < 0
        if rule is not None and n <= 8:
            allowed = set(feasible_sets(SubmodularSelection(UserFunction(lambda m: m.sum(axis=1), n), rule)))
            assert tuple(sorted({*b, e})) in allowed


def test_a_violation_beyond_the_constraint_is_not_looked_for() -> None:
    """Returns grow from the third element on only."""
    table = np.array([0.0, 2.0, 3.0, 10.0, 20.0])

    def f(masks):  # type: ignore[no-untyped-def]
        return table[masks.sum(axis=1)]

    assert not check_submodular(f, 4)
    assert check_submodular(f, 4, constraint=Cardinality(2))


def test_large_ground_sets_are_sampled_in_bounded_memory() -> None:
    largest = 0

    def roots(masks):  # type: ignore[no-untyped-def]
        nonlocal largest
        largest = max(largest, masks.nbytes)
        return np.sqrt(masks.sum(axis=1))

    report = check_submodular(roots, 50_000, samples=100)
    assert report and report.samples == 100 and not report.exhaustive
    assert largest <= 1 << 24


def test_the_seed_decides_what_is_drawn() -> None:
    def bumpy(masks):  # type: ignore[no-untyped-def]
        return np.sin(masks @ np.arange(1.0, 31.0)) * masks.any(axis=1)

    first, again, other = (check_submodular(bumpy, 30, samples=50, seed=seed) for seed in (1, 1, 2))
    assert first == again != other


def test_degenerate_ground_sets() -> None:
    assert check_submodular(Coverage.from_sets([], [])).exhaustive
    assert check_submodular(lambda masks: masks.sum(axis=1), 1)
    assert not check_submodular(lambda masks: -1.0 * masks.sum(axis=1), 1).monotone
    assert check_submodular(lambda masks: masks.sum(axis=1), 1, constraint=Cardinality(1)).samples > 0


def test_it_is_offered_by_the_face() -> None:
    assert wb.check_submodular(cover_30(3))


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        ((lambda m: m.sum(axis=1),), {}, "elements must say"),
        ((lambda m: m.sum(axis=1), 0), {}, "elements must say"),
        ((3, 4), {}, "takes a problem, a set function or a callable"),
        ((cover_30(3), 29), {}, "has 30 elements, not 29"),
        ((cover_30(3),), {"samples": 0}, "samples must be"),
        ((cover_30(3),), {"seed": -1}, "seed must be"),
    ],
)
def test_bad_arguments_are_refused(arguments: tuple[object, ...], options: dict[str, int], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        check_submodular(*arguments, **options)  # type: ignore[arg-type]


def test_bad_values_are_refused() -> None:
    check_coded(InputError, "wrong-shape", check_submodular, lambda masks: masks, 3)
    check_coded(InputError, "out-of-range", check_submodular, lambda masks: np.full(len(masks), math.nan), 3)
    with pytest.raises(InputError, match="costs must have one entry an element"):
        check_submodular(cover_30(3), constraint=random_constraint(np.random.default_rng(1), "knapsack", 5))
