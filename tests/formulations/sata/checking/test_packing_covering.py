import math
from fractions import Fraction

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import given, settings, strategies as st
from sata_cases import best_value

from waybound import BottleneckSATA, InputError, MaxMinLP
from waybound.formulations.evidence import CHECKERS
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import BACKENDS, Control, Options

KIND = "packing-covering-duals"
ANY = st.one_of(st.floats(-10, 10), st.sampled_from([0.0, 1e-300, 1e300, 5e-324, -1e9]))


def random_problem(rng: np.random.Generator, sense: str) -> MaxMinLP:
    n, rows, targets = (int(v) for v in rng.integers(1, 6, 3))
    a = rng.uniform(0.1, 3, (rows, n)) * (rng.random((rows, n)) < 0.7)
    c = rng.uniform(0.1, 3, (targets, n)) * (rng.random((targets, n)) < 0.7)
    if sense == "max":
        a[0, a.sum(axis=0) == 0] = 1.0  # else it is unbounded
    else:
        c[c.sum(axis=1) == 0, 0] = 1.0  # else nothing covers the row
    if not a.any():
        a[0, 0] = 1.0
    return MaxMinLP(a, c, sense=sense)


@settings(max_examples=draws(300), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["max", "min"]), st.data())
def test_any_prices_prove_a_bound_that_holds(seed, sense, data):
    problem = random_problem(np.random.default_rng(seed), sense)
    y = data.draw(st.lists(ANY, min_size=problem.covering.rows, max_size=problem.covering.rows))
    z = data.draw(st.lists(ANY, min_size=problem.packing.rows, max_size=problem.packing.rows))
    bound, best = CHECKERS[KIND](problem, {"covering": y, "packing": z}), best_value(problem)
    slack = 1e-7 * max(1.0, abs(best))
    assert bound >= best - slack if sense == "max" else bound <= best + slack


@settings(max_examples=draws(100), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["max", "min"]))
def test_optimal_prices_prove_the_optimum(seed, sense):
    problem = random_problem(np.random.default_rng(seed), sense)
    made = problem.compile()
    evidence = made.dual_evidence(BACKENDS["highs"]().run(made.program, Options(), Control()).row_duals)
    best = best_value(problem)
    if best > 1e-9 or sense == "max":  # that nothing is needed is proved by no price
        assert CHECKERS[KIND](problem, evidence.data) == pytest.approx(best, abs=1e-7)


def test_prices_are_scaled_to_the_best_bound_that_they_prove():
    problem = MaxMinLP(np.eye(2), [[1.0, 0.0], [0.0, 2.0]])
    # y = (2, 1), z = (7, 7): C'y = (2, 2), so t = 2/7 and the bound is 2/7 * 14 / 3.
    assert CHECKERS[KIND](problem, {"covering": [2, 1], "packing": [7, 7]}) == pytest.approx(4 / 3)
    assert CHECKERS[KIND](problem, {"covering": [2, 1], "packing": [2, 2]}) == pytest.approx(4 / 3)
    smallest = MaxMinLP([[1.0, 2.0]], [[1.0, 0.0], [0.0, 1.0]], sense="min")
    assert CHECKERS[KIND](smallest, {"covering": [1, 2], "packing": [5]}) == pytest.approx(3.0)


def test_the_rounding_never_favours_the_bound():
    rng = np.random.default_rng(0)
    for _ in range(200):
        problem = random_problem(rng, "max")
        y, z = rng.random(problem.covering.rows), rng.random(problem.packing.rows)
        a, c = problem.packing.scipy.toarray(), problem.covering.scipy.toarray()
        rates = []
        for v in range(problem.num_variables):
            worth = sum(Fraction(float(c[j, v])) * Fraction(float(y[j])) for j in range(len(c)))
            price = sum(Fraction(float(a[i, v])) * Fraction(float(z[i])) for i in range(len(a)))
            if worth:
                rates.append(worth / price)
        exact = max(rates, default=Fraction(0)) * sum(map(Fraction, z.tolist())) / sum(map(Fraction, y.tolist()))
        found = CHECKERS[KIND](problem, {"covering": y.tolist(), "packing": z.tolist()})
        assert Fraction(found) >= exact
        assert found <= float(exact) * (1 + 1e-13) + 1e-300


def test_a_variable_that_covers_for_nothing_leaves_no_bound():
    problem = MaxMinLP(np.eye(2), np.eye(2))
    assert CHECKERS[KIND](problem, {"covering": [1, 1], "packing": [1, 0]}) == math.inf
    turned = MaxMinLP(np.eye(2), np.eye(2), sense="min")
    assert CHECKERS[KIND](turned, {"covering": [1, 1], "packing": [1, 0]}) == 0.0


def test_prices_that_are_all_zero_prove_nothing():
    for sense, nothing in (("max", math.inf), ("min", -math.inf)):
        problem = MaxMinLP(np.eye(2), np.eye(2), sense=sense)
        for y, z in (([0, 0], [1, 1]), ([1, 1], [0, 0]), ([-1, -2], [1, 1])):
            assert CHECKERS[KIND](problem, {"covering": y, "packing": z}) == nothing


def test_a_row_that_nothing_covers_proves_zero():
    problem = MaxMinLP([[1.0]], [[1.0], [0.0]])
    assert 0.0 <= CHECKERS[KIND](problem, {"covering": [0, 1], "packing": [0]}) <= 1e-300


def test_a_value_too_small_for_a_double_is_not_proved_to_be_zero():
    assert CHECKERS[KIND](MaxMinLP([[1e300]], [[1e-100]]), {"covering": [1], "packing": [1]}) > 0.0


def test_tiny_products_are_not_lost():
    # C'y and A'z both vanish in floats; their true ratio is 1e10.
    problem = MaxMinLP([[1e-320]], [[1e-310]])
    assert CHECKERS[KIND](problem, {"covering": [1e-320], "packing": [1.0]}) >= 1e10 * (1 - 1e-6)


@pytest.mark.parametrize(
    "data",
    [
        {}, {"covering": [1, 1]}, {"covering": [1], "packing": [1, 1]}, {"covering": [1, 1], "packing": [1, math.nan]},
        {"covering": [1, math.inf], "packing": [1, 1]}, {"covering": "11", "packing": [1, 1]}, {"covering": [1, True], "packing": [1, 1]},
    ],
)  # fmt: skip
def test_malformed_prices_are_refused(data):
    with pytest.raises(InputError):
        CHECKERS[KIND](MaxMinLP(np.eye(2), np.eye(2)), data)


def test_prices_are_no_evidence_for_other_problems():
    with pytest.raises(InputError, check=coded("foreign")):
        CHECKERS[KIND](BottleneckSATA(graph_of_edges([0], [0], [0])), {"covering": [1], "packing": [1]})
