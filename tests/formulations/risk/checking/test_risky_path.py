import math

import numpy as np
import pytest
import risky_cases as cases

from waybound import InputError, RiskyPath
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.risk.checking import risky_path as module
from waybound.formulations.risk.checking.risky_path import Remembered, following_moves, least_left
from waybound.formulations.risk.moves import hazard_of
from waybound.instances.risk.elements import LocaleRisk

check_potentials, check_walks, check_paths = (CHECKERS[kind] for kind in ("move-potentials", "guarded-walks", "all-paths"))


@pytest.mark.parametrize("seed", range(3))
def test_all_pairs_with_the_hazard_of_the_second_move(seed):
    problem = cases.random_map(np.random.default_rng(seed))
    graph = problem.graph
    moves = list(zip(graph.tail.tolist(), graph.head.tolist(), strict=True))
    expected = {(-1, b): moves[b] for b in range(len(moves)) if moves[b][0] == 0}
    for a, (i, j) in enumerate(moves):
        for b, (k, z) in enumerate(moves):
            if j == k and z != i and 0 not in (j, z):
                expected[a, b] = i, j, z
    pairs = following_moves(graph)
    assert set(zip(pairs.earlier.tolist(), pairs.later.tolist(), strict=True)) == set(expected)
    for a, b, hazard in zip(pairs.earlier.tolist(), pairs.later.tolist(), pairs.hazard.tolist(), strict=True):
        last = [column[-1] for column in problem.risks(expected[a, b]).values()]
        assert hazard == pytest.approx(hazard_of(last))
    assert pairs.start_hazard == pytest.approx(hazard_of([column[0] for column in problem.risks((0,)).values()]))


def test_a_choice_of_elements_and_too_many_pairs(monkeypatch):
    problem = cases.mud()
    assert following_moves(problem.graph, ()).hazard.sum() == 0.0
    assert math.isfinite(following_moves(problem.graph).hazard.sum())
    monkeypatch.setattr(module, "MOST_PAIRS", 1)
    assert following_moves(problem.graph) is None


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
                bound = check_potentials(problem, {"potentials": potentials, **prices})
                assert bound <= best * (1 + 1e-12) if problem.sense == "min" else bound >= best * (1 - 1e-12)


def test_least_hazards_prove_the_least_risk_and_bound_the_ratio():
    assert check_potentials(cases.ring(), cases.ring().moves.evidence(0.0).data) == pytest.approx(0.393469, abs=5e-7)
    two = cases.two_ways()
    assert check_potentials(two, two.moves.evidence(0.0).data) == pytest.approx(27.2727, abs=5e-5)
    last = cases.two_ways(discount=0.0)
    assert check_potentials(last, last.moves.evidence(0.0).data) == pytest.approx(2 / 0.11)


def test_prices_of_states_prove_what_walks_do_not():
    problem = cases.loop()
    prices = np.zeros(5)
    prices[1] = 3.5
    potentials = problem.moves.priced(prices)
    assert check_potentials(problem, {"potentials": potentials.tolist(), "prices": prices.tolist()}) == pytest.approx(8.5)


def test_claimed_infinity_that_is_none_proves_nothing():
    problem = cases.ring()
    assert check_potentials(problem, {"potentials": [None] * len(problem.graph.tail)}) in (-math.inf, 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_guarded_the_bound_is_below_all_paths_and_with_all_guarded_it_is_their_best(seed):
    rng = np.random.default_rng(seed)
    for objective in ("risk", "hazard"):
        problem = cases.random_map(rng, muddy=True, objective=objective)
        best = cases.best(problem)
        for most in (None, 0.05, 10.0):
            few = check_walks(problem, {"guarded": rng.choice(9, 3).tolist(), "most": most})
            every = check_walks(problem, {"guarded": list(range(9)), "most": most})
            assert few <= every + 1e-12 <= best + 2e-12
        assert check_walks(problem, {"guarded": list(range(9)), "most": None}) == pytest.approx(best)


@pytest.mark.parametrize(
    ("make", "guarded", "bound"), [(cases.loop, [], 5), (cases.loop, [1], 12), (cases.refusal, [1], 6), (cases.mud_costs, [], 5)]
)
def test_examples(make, guarded, bound):
    assert check_walks(make(), {"guarded": guarded, "most": None}) == pytest.approx(bound)
    assert check_walks(make(), {"guarded": guarded, "most": 4.0}) == pytest.approx(4.0)


def test_no_way_is_proof_that_there_is_none():
    assert (
        check_walks(RiskyPath(cases.graph([(0, 1)], [LocaleRisk([0, 0, 0])], states=3, goals=(2,))), {"guarded": [], "most": None})
        == math.inf
    )


def test_too_many_walks_and_rewards_prove_nothing(monkeypatch):
    assert check_walks(cases.two_ways(), {"guarded": [], "most": None}) == math.inf
    monkeypatch.setattr(module, "MOST_WALKS", 2)
    assert check_walks(cases.mud_costs(), {"guarded": [], "most": None}) == -math.inf


def test_what_is_left_and_what_is_remembered():
    problem = cases.ring(objective="hazard")
    left = least_left(problem, following_moves(problem.graph))
    assert left == pytest.approx(problem.moves.from_moves(problem.graph.goals)[:-1], rel=1e-9)
    mud = Remembered(cases.mud_costs())
    assert mud.step(mud.begin, 0, 1) == ((1,), 0.0) and mud.step((1,), 5, 6)[1] == pytest.approx(9.0)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("discount", [1.0, 0.5, 0.0])
def test_the_optimum_is_proved_and_any_target_proves_something_true(seed, discount):
    rng = np.random.default_rng(seed)
    problem = cases.random_map(rng, muddy=True, rewards=rng.integers(0, 4, 9) + np.eye(9)[8], discount=discount)
    best = cases.best(problem)
    assert check_paths(problem, {"target": None}) == pytest.approx(best) == check_paths(problem, {"target": best})
    assert check_paths(problem, {"target": best / 2}) == pytest.approx(best)
    assert check_paths(problem, {"target": 2 * best}) == pytest.approx(2 * best)


def test_ends_are_goals_where_there_are_any():
    problem = cases.two_ways(goals=(1,), objective="reward-per-risk")
    assert check_paths(problem, {"target": None}) == pytest.approx(10.0)


@pytest.mark.parametrize("discount", [0.0, 1e-10])
@pytest.mark.parametrize("small", [1e-9, 5e-7])
def test_small_rewards_count_beside_large_ones(small, discount):
    arcs = [(0, 1), (1, 2), (2, 3)]
    rewards = np.array([0.0, 1e17, 0.0, small])
    problem = RiskyPath(
        cases.graph(arcs, [LocaleRisk(np.full(4, 0.1))], goals=(3,), rewards=rewards, discount=discount, objective="reward-per-risk")
    )
    (value,) = problem.evaluate((0, 1, 2, 3)).values
    assert value <= check_paths(problem, {"target": 0.0}) <= value * (1.0 + 1e-12)
    assert value <= check_paths(problem, {"target": value / 2}) <= value * (1.0 + 1e-12)


def test_too_many_paths_and_least_risks_prove_nothing(monkeypatch):
    assert check_paths(cases.ring(), {"target": None}) == -math.inf
    monkeypatch.setattr(module, "MOST_PATHS", 2)
    assert check_paths(cases.two_ways(), {"target": None}) == math.inf


@pytest.mark.parametrize(
    ("check", "data", "message"),
    [
        (check_potentials, {"potentials": [0.0]}, "one potential a move"),
        (check_potentials, {"potentials": [math.nan] * 20}, "one potential a move"),
        (check_potentials, {"potentials": [0.0] * 16, "prices": [-1.0] * 8}, "potential|prices must be finite"),
        (check_potentials, {}, "potentials"),
        (check_walks, {"guarded": [99], "most": None}, "a state that does not exist"),
        (check_walks, {"guarded": [], "most": math.nan}, "most must be a number"),
        *((check_paths, {"target": target}, "target must be a number") for target in ("a", True, math.nan)),
    ],
)
def test_what_is_malformed_is_refused(check, data, message):
    with pytest.raises((InputError, KeyError), match=message):
        check(cases.ring(), data)
