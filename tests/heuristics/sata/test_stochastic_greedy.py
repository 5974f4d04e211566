import math

import numpy as np
from hypothesis import given, strategies as st
from selection_problems import KINDS, cover_30, cover_tight, only_evidence, optimum, random_problem, run, value

from waybound.formulations.verified_bounds import verified_bound


@given(st.integers(0, 10**6), st.sampled_from(KINDS))
def test_every_answer_is_full_and_carries_a_bound(seed: int, kind: str) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, "cardinality")
    outcome = run("stochastic-greedy", problem, seed=seed)
    if len(outcome.answer) < min(problem.constraint.limit, problem.num_elements):  # type: ignore[union-attr]
        # What is left gains nothing but the rounding of a user's function, which may make it negative.
        assert kind == "user"
        left = set(range(problem.num_elements)) - set(outcome.answer)
        assert all(problem.function.value(tuple(sorted({*outcome.answer, e}))) <= value(problem, outcome) * (1 + 1e-12) for e in left)
    assert verified_bound(problem, only_evidence(outcome)) >= optimum(problem) * (1 - 1e-12)


def test_the_mean_over_seeds_keeps_the_guarantee() -> None:
    for problem, best in ((cover_tight(), 80.0), (cover_30(4), 105.0)):
        outcomes = [run("stochastic-greedy", problem, seed=seed, eps=0.3) for seed in range(200)]
        guarantee = outcomes[0].guarantee
        assert guarantee is not None and "in expectation" in guarantee.statement
        values = np.array([value(problem, o) for o in outcomes])
        assert values.mean() + 4 * values.std() / math.sqrt(len(values)) >= best / guarantee.ratio
        assert len({o.answer for o in outcomes}) > 1


def test_the_same_seed_gives_the_same_answer() -> None:
    first, again = (run("stochastic-greedy", cover_30(6), seed=7) for _ in range(2))
    assert first.answer == again.answer


def test_evaluations_depend_on_eps_and_not_on_the_number_of_picks() -> None:
    for k in (3, 6, 10):
        outcome = run("stochastic-greedy", cover_30(k), eps=0.5)
        sample = math.ceil(30 / k * math.log(2))
        assert outcome.statistics["sample"] == sample
        assert outcome.statistics["evaluations"] == k * sample < outcome.statistics["plain_evaluations"]


def test_samples_as_large_as_what_is_left_make_it_greedy() -> None:
    outcome = run("stochastic-greedy", cover_30(2), eps=0.1)
    assert outcome.statistics["sample"] >= 30
    assert outcome.answer == run("greedy", cover_30(2)).answer


def test_the_smallest_eps_draws_everything() -> None:
    assert run("stochastic-greedy", cover_tight(), eps=5e-324).statistics["sample"] > 1000
