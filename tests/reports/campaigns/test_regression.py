import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from campaign_cases import outcome, planned
from file_cases import check_refused

from waybound import UsageError, results
from waybound.reports.campaigns.one_run import Outcome
from waybound.reports.campaigns.regression import regression, regression_table
from waybound.reports.campaigns.results_file import ResultsFile

INSTANCES, SEEDS = "abcdef", (1, 2, 3)


@pytest.fixture
def made(tmp_path: Path) -> Callable[..., pd.DataFrame]:
    """Results of six instances by three seeds, of outcomes that ``of(instance, seed)`` makes."""
    count = itertools.count()

    def make(of: Callable[[str, int], Outcome], instances: str = INSTANCES, seeds: Any = SEEDS, **setting: Any) -> pd.DataFrame:
        path = tmp_path / f"{next(count)}.sqlite"
        with ResultsFile(path) as file:
            for name, seed in itertools.product(instances, seeds):
                file.add(planned(name, seed=seed, **setting), of(name, seed))
        return results(path)

    return make


def worse(before: pd.DataFrame, after: pd.DataFrame) -> dict[str, str]:
    """The measures that are worse, and where."""
    return {change.measure: change.where for change in regression(before, after).changes if change.worse}


def noisy(seed: int, factor: float = 1.0) -> Callable[[str, int], Outcome]:
    draw = np.random.default_rng(seed)
    return lambda name, seed: outcome(factor * (100.0 + draw.normal()), seconds=5.0 + 0.1 * draw.normal(), verified_bound=90.0)


def test_the_same_is_not_worse_and_neither_is_noise(made: Any) -> None:
    before = made(noisy(1))
    assert worse(before, before) == {}
    for seed in range(2, 6):
        assert worse(before, made(noisy(seed))) == {}


def test_answers_that_are_worse_are_told_in_either_sense_and_better_ones_are_not(made: Any) -> None:
    assert "objective" in worse(made(noisy(1)), made(noisy(2, 1.05)))
    assert worse(made(noisy(1)), made(noisy(2, 0.95))) == {}
    up = [made(lambda name, seed, factor=factor: outcome(factor * seed, sense="max")) for factor in (1.0, 0.9)]
    assert "objective" in worse(*up) and worse(*reversed(up)) == {}


def test_one_instance_that_is_worse_with_every_seed_is_found_among_many(made: Any) -> None:
    flat = made(lambda name, seed: outcome(100.0))
    assert worse(flat, made(lambda name, seed: outcome(110.0 if name == "c" else 100.0))) == {"objective": "c"}


def test_lost_answers_lost_proofs_worse_bounds_and_slower_searches_are_told(made: Any) -> None:
    def proved(name: str, seed: int) -> Outcome:
        return outcome(10.0, status="optimal", bound_kind="verified", verified_bound=10.0, seconds=5.0)

    before = made(proved)
    assert worse(before, made(lambda name, seed: outcome(None, status="unknown") if name == "b" else proved(name, seed)))["answers"] == "b"
    assert "optima" in worse(before, made(lambda name, seed: outcome(10.0, verified_bound=10.0, seconds=5.0)))
    assert "bound" in worse(before, made(lambda name, seed: outcome(10.0, verified_bound=9.0, seconds=5.0)))
    assert set(
        worse(before, made(lambda name, seed: outcome(10.0, status="optimal", bound_kind="verified", verified_bound=10.0, seconds=9.0)))
    ) == {"seconds"}


def test_answers_that_fail_a_check_afterwards_are_lost(made: Any) -> None:
    before = made(lambda name, seed: outcome(10.0))
    assert "answers" in worse(before, made(lambda name, seed: outcome(9.0, faults=1, checked=0)))


def test_times_of_different_machines_are_not_judged(made: Any) -> None:
    before = made(lambda name, seed: outcome(seconds=1.0))
    after = made(lambda name, seed: Outcome(outcome(seconds=99.0).row, {}, {}, {"name": "there"}))
    told = regression(before, after)
    assert not told.worse and any("different machines" in note for note in told.notes)


def test_a_single_pair_counts_beyond_the_tolerance(made: Any) -> None:
    before = made(lambda name, seed: outcome(100.0), "a", (1,))
    assert worse(before, made(lambda name, seed: outcome(100.01), "a", (1,))) == {}
    assert "objective" in worse(before, made(lambda name, seed: outcome(101.0), "a", (1,)))


def test_what_cannot_be_compared_is_refused_or_told(made: Any) -> None:
    before = made(lambda name, seed: outcome())
    check_refused(UsageError, "no run in common", regression, before, made(lambda name, seed: outcome(), "xyz"))
    check_refused(UsageError, "limits differ", regression, before, made(lambda name, seed: outcome(), time_limit=1.0))
    in_levels = made(lambda name, seed: outcome(levels="{}"))
    assert regression(in_levels, in_levels).notes == ("objectives in order of priority are compared by their first level alone",)
    told = regression(before, made(lambda name, seed: outcome(), "ab"))
    assert told.notes == ("12 runs are in the first file alone, and are not compared",)


def test_the_table_and_the_json_tell_the_same(made: Any) -> None:
    told = regression(made(noisy(1)), made(noisy(2, 1.05)))
    table, data = regression_table(told), told.to_json()
    assert data["worse"] is True and len(table.rows) == len(data["changes"]) == 4
    assert [row[6] for row in table.rows] == ["worse" if change["worse"] else "-" for change in data["changes"]]
