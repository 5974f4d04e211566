import math
from typing import Any

import numpy as np
import pytest
from coded import coded
from selection_problems import KINDS, cover_30, cover_tight, greedy_by_hand, random_problem

from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.sata.greedy_steps.picking import check_threshold, pick
from waybound.instances.errors import UsageError


@pytest.mark.parametrize("constraint", ["cardinality", "partition"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(6))
def test_every_evaluation_picks_the_same(seed: int, kind: str, constraint: str) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, 9, whole=seed % 2 == 0)
    plain, lazy = (pick(problem, NEVER, evaluation=how) for how in ("plain", "lazy"))
    assert (lazy.elements, lazy.gains) == (plain.elements, plain.gains)
    assert lazy.evaluations <= plain.evaluations == plain.plain_evaluations == lazy.plain_evaluations
    if kind in ("coverage", "facility-location"):
        kept = pick(problem, NEVER, evaluation="incremental")
        assert kept.elements == plain.elements and kept.gains == pytest.approx(plain.gains, abs=1e-12)
    assert pick(problem, NEVER).elements == plain.elements


def test_picks_gains_and_evaluations_are_those_of_the_reference() -> None:
    """The heap leaves out five of the 76 that the source's rule evaluates: old gains equal to the best new one, of later elements."""
    problem = cover_30(6)
    for how, lazily, evaluations, spared in (("plain", False, 165, 0), ("lazy", True, 71, 5)):
        found = pick(problem, NEVER, evaluation=how)
        assert found.elements == [9, 8, 15, 2, 3, 26] and found.gains == [31, 27, 26, 21, 16, 12]
        assert greedy_by_hand(problem.value, 30, 6, lazy=lazily) == (found.elements, found.evaluations + spared)
        assert (found.evaluations, found.evaluation, found.ended) == (evaluations, how, "full")


def test_auto_keeps_gains_of_thin_data_up_to_date_and_evaluates_matrices_lazily() -> None:
    rng = np.random.default_rng(0)
    assert pick(cover_30(3), NEVER).evaluation == "incremental"
    assert pick(random_problem(rng, "dense", "cardinality"), NEVER).evaluation == "lazy"
    assert pick(random_problem(rng, "user", "cardinality"), NEVER).evaluation == "lazy"


@pytest.mark.parametrize("how", ["plain", "lazy", "incremental"])
def test_a_threshold_and_a_base_mean_the_same_to_all(how: str) -> None:
    problem = cover_30(6)
    short = pick(problem, NEVER, evaluation=how, eps=20.0)
    assert (short.elements, short.ended) == ([9, 8, 15, 2], "eps")
    assert pick(problem, NEVER, evaluation=how, eps=21.0).elements == [9, 8, 15, 2]  # a gain of just as much is one
    later = pick(problem, NEVER, evaluation=how, base=[9, 8, 15])
    assert (later.elements, later.gains) == ([2, 3, 26], [21, 16, 12])


@pytest.mark.parametrize("how", ["plain", "lazy", "incremental"])
def test_who_is_asked_to_stop_returns_a_prefix(how: str) -> None:
    stop = Stop()
    stop.ask()
    found = pick(cover_30(6), stop, evaluation=how)
    assert found.ended == "stopped" and found.elements == [9, 8, 15, 2, 3, 26][: len(found.elements)] and len(found.elements) < 6


@pytest.mark.parametrize("wrong", [-1e-9, math.nan, math.inf, True, "1", None])
def test_thresholds_that_are_none_are_refused(wrong: Any) -> None:
    with pytest.raises(UsageError, check=coded("out-of-range")):
        check_threshold(wrong)


def test_what_cannot_be_evaluated_so_is_refused() -> None:
    check_threshold(0)
    with pytest.raises(UsageError, match="evaluation must be one of auto, plain, lazy, incremental"):
        pick(cover_tight(), NEVER, evaluation="eager")
    with pytest.raises(UsageError, check=coded("contradiction")):
        pick(random_problem(np.random.default_rng(0), "dense", "cardinality"), NEVER, evaluation="incremental")
