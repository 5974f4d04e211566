"""Walks with memory, guarded against repetition where it matters."""

from __future__ import annotations

import math

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.evidence import CHECKERS
from waybound.formulations.risk.checking import guarded_walks as module
from waybound.formulations.risk.checking.following_moves import following_moves
from waybound.formulations.risk.checking.guarded_walks import Remembered, least_left
from waybound.instances.errors import InputError

check = CHECKERS["guarded-walks"]


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_guarded_the_bound_is_below_all_paths_and_with_all_guarded_it_is_their_best(seed):
    rng = np.random.default_rng(seed)
    for objective in ("risk", "hazard"):
        problem = cases.random_map(rng, muddy=True, objective=objective)
        best = cases.best(problem)
        for most in (None, 0.05, 10.0):
            few = check(problem, {"guarded": rng.choice(9, 3).tolist(), "most": most})
            every = check(problem, {"guarded": list(range(9)), "most": most})
            assert few <= every + 1e-12 <= best + 2e-12
        assert check(problem, {"guarded": list(range(9)), "most": None}) == pytest.approx(best)


@pytest.mark.parametrize(
    ("make", "guarded", "bound"), [(cases.loop, [], 5), (cases.loop, [1], 12), (cases.refusal, [1], 6), (cases.mud_costs, [], 5)]
)
def test_examples(make, guarded, bound):
    assert check(make(), {"guarded": guarded, "most": None}) == pytest.approx(bound)
    assert check(make(), {"guarded": guarded, "most": 4.0}) == pytest.approx(4.0)


def test_no_way_is_proof_that_there_is_none():
    from waybound.formulations.risk.risky_path import RiskyPath
    from waybound.instances.risk.elements import LocaleRisk

    assert check(RiskyPath(cases.graph([(0, 1)], [LocaleRisk([0, 0, 0])], states=3, goals=(2,))), {"guarded": [], "most": None}) == math.inf


def test_too_many_walks_and_rewards_prove_nothing(monkeypatch):
    assert check(cases.two_ways(), {"guarded": [], "most": None}) == math.inf
    monkeypatch.setattr(module, "MOST_WALKS", 2)
    assert check(cases.mud_costs(), {"guarded": [], "most": None}) == -math.inf


@pytest.mark.parametrize("data", [{"guarded": [99], "most": None}, {"guarded": [], "most": float("nan")}])
def test_what_is_malformed_is_refused(data):
    with pytest.raises(InputError):
        check(cases.ring(), data)


def test_what_is_left_and_what_is_remembered():
    problem = cases.ring(objective="hazard")
    left = least_left(problem, following_moves(problem.graph))
    assert left == pytest.approx(problem.moves.from_moves(problem.graph.goals)[:-1], rel=1e-9)
    mud = Remembered(cases.mud_costs())
    assert mud.step(mud.begin, 0, 1) == ((1,), 0.0) and mud.step((1,), 5, 6)[1] == pytest.approx(9.0)
