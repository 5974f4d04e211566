"""Potentials of moves prove no more than is true, whatever they are."""

from __future__ import annotations

import math

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.evidence import CHECKERS
from waybound.instances.errors import InputError

check = CHECKERS["move-potentials"]


def problems(seed):
    rng = np.random.default_rng(seed)
    yield cases.random_map(rng)
    yield cases.random_map(rng, muddy=True, objective="hazard")
    for discount in (1.0, 0.5, 0.0):
        yield cases.random_map(rng, muddy=True, rewards=rng.integers(0, 4, 9) + np.eye(9)[8], discount=discount)


@pytest.mark.parametrize("seed", range(4))
def test_no_evidence_proves_more_than_the_optimum(seed):
    rng = np.random.default_rng(seed)
    for problem in problems(seed):
        best, true = cases.best(problem), problem.moves.evidence(0.0).data["potentials"]
        wild = [
            [p if p is None else p * rng.uniform(0, 3) for p in true],
            rng.uniform(-1, 3, len(true)).tolist(),
            [None] * len(true),
            [0.0] * len(true),
        ]
        for potentials in (true, *wild):
            for prices in ({}, {"prices": rng.uniform(0, 0.2, 9).tolist()}):
                bound = check(problem, {"potentials": potentials, **prices})
                assert bound <= best * (1 + 1e-12) if problem.sense == "min" else bound >= best * (1 - 1e-12)


def test_least_hazards_prove_the_least_risk_and_bound_the_ratio():
    assert check(cases.ring(), cases.ring().moves.evidence(0.0).data) == pytest.approx(0.393469, abs=5e-7)
    two = cases.two_ways()
    assert check(two, two.moves.evidence(0.0).data) == pytest.approx(27.2727, abs=5e-5)
    last = cases.two_ways(discount=0.0)
    assert check(last, last.moves.evidence(0.0).data) == pytest.approx(2 / 0.11)


def test_prices_of_states_prove_what_walks_do_not():
    problem = cases.loop()
    prices = np.zeros(5)
    prices[1] = 3.5
    potentials = problem.moves.priced(prices)
    assert check(problem, {"potentials": potentials.tolist(), "prices": prices.tolist()}) == pytest.approx(8.5)


def test_claimed_infinity_that_is_none_proves_nothing():
    problem = cases.ring()
    assert check(problem, {"potentials": [None] * len(problem.graph.tail)}) in (-math.inf, 0.0)


@pytest.mark.parametrize(
    "data", [{"potentials": [0.0]}, {"potentials": [float("nan")] * 20}, {"potentials": [0.0] * 16, "prices": [-1.0] * 8}, {}]
)
def test_what_is_malformed_is_refused(data):
    with pytest.raises((InputError, KeyError)):
        check(cases.ring(), data)


def test_other_families_are_refused():
    import waybound as wb

    with pytest.raises(InputError, match="evidence for risky paths"):
        check(wb.read("demo-c25"), {"potentials": []})
