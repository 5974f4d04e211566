"""Shares of a search: that they hold all routes, that nothing stored goes astray, and that faults and wishes reach all of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from divisible_routing import FEATURES, made

import waybound as wb
from waybound.formulations.stop import Stop
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.engines.routing import ruin_recreate, side_by_side
from waybound.solvers.engines.routing.portfolio import Portfolio
from waybound.solvers.engines.routing.pyvrp import PyVRP
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k
from waybound.solvers.engines.routing.side_by_side import following, join, shares


@pytest.fixture(autouse=True)
def two_routes_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(side_by_side, "LEAST", 2)


def begun(problem: wb.RoutingProblem, seed: int = 1) -> Any:
    """A search on two threads, after some ruins."""
    engine, options = RuinRecreate(), Options(threads=2, seed=seed)
    search = ruin_recreate._Search(problem, options, dict(engine.options), Control(), Stop(60.0), engine.seconds_at)
    search.take_at_hand()
    search.own[:] = search.best
    anneal(search, search.held, search.own, 400)
    return search


def anneal(search: Any, held: Any, best: Any, steps: int) -> None:
    search.kernels.anneal(search.stop.flag, *held.parts, best, search.sizes, steps, 3.0, held.flags)


def stored(held: Any) -> list[Any]:
    """All that tells the routes at hand and their cost."""
    visited = held.node[:, k.ROUTE] >= 0
    return [
        held.sums.tolist(),
        held.types.tolist(),
        held.route.tolist(),
        held.node[visited].tolist(),
        sorted(held.absent[: held.sums[k.ABSENT]]),
    ]


@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("many", [2, 3])
def test_parts_hold_all_and_what_is_put_back_is_what_was_there(feature: str, many: int) -> None:
    search = begun(made(feature))
    held, before = search.held, stored(search.held)
    for one in range(5):
        parts = shares(held, search.beside.places, many, np.random.default_rng(one))
        assert len(parts) == many
        assert sorted(c for part in parts for c in part.held.customers) == sorted(held.customers)
        assert sorted(r for part in parts for r in part.slots) == list(range(len(held.route)))
        assert sum(part.held.sums[k.OBJECTIVE] for part in parts) == held.sums[k.OBJECTIVE]
        assert (join(held, parts) == following(held)).all() and stored(held) == before


@pytest.mark.parametrize("feature", FEATURES)
def test_what_parts_become_costs_together_what_it_costs_as_a_whole(feature: str) -> None:
    problem = made(feature)
    search = begun(problem)
    held, other = search.held, begun(problem).held
    for one in range(4):
        parts = shares(held, search.beside.places, 2, np.random.default_rng(one))
        before, steps = held.sums[k.OBJECTIVE], held.sums[k.STEPS]
        for part in parts:
            anneal(search, part.held, part.best, 300)
        best = join(held, parts)
        assert best[0] <= before and held.sums[k.STEPS] == steps + 600
        for answer in (following(held), best):
            assert other.put(held.routes(answer[1:])) and other.sums[k.OBJECTIVE] == answer[0]


def at_look(monkeypatch: pytest.MonkeyPatch, number: int, what: Callable[[], None]) -> None:
    """Have something happen on the thread that keeps routes for so many a time."""
    count, collect = itertools.count(1), side_by_side.collect

    def counting(*given: Any) -> None:
        if next(count) == number:
            what()
        collect(*given)

    for name, value in (("collect", counting), ("LEAST", 1)):
        monkeypatch.setattr(side_by_side, name, value)
    monkeypatch.setattr(ruin_recreate, "AMPLE", 10**9)


@pytest.mark.parametrize("feature", FEATURES)
def test_two_threads_end_with_a_feasible_answer_when_they_are_asked_to(feature: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, control = made(feature), Control()
    at_look(monkeypatch, 60, control.stop)
    found = RuinRecreate().run(problem, Options(threads=2, time_limit=60.0), control)
    judged = problem.evaluate(found.answer)
    assert judged.feasible and found.limit == "interrupt" and (len(judged.values) > 1 or found.objective == judged.values[0])


def test_a_thread_that_fails_leaves_the_best_answer_before(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise MemoryError

    at_look(monkeypatch, 12, fail)
    problem = made("reward")
    monkeypatch.setattr(PyVRP, "search", lambda *_: RawResult("unknown", "time"))
    found = Portfolio().run(problem, Options(threads=2, time_limit=3.0), Control())
    assert "ruin-recreate failed: out of memory" in found.message
    assert found.status == "feasible" and problem.evaluate(found.answer).feasible


@pytest.mark.parametrize(("threads", "searches"), [(2, 2), (4, 4)])
def test_where_there_is_time_for_several_anneals_they_run_side_by_side_and_share_their_answers(
    threads: int, searches: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ruin_recreate, "AMPLE", 1)
    teams: list[Any] = []
    inner = ruin_recreate._Search.run

    def run(search: Any) -> Any:
        teams.append(search)
        return inner(search)

    monkeypatch.setattr(ruin_recreate._Search, "run", run)
    problem = made()
    found = RuinRecreate().run(problem, Options(threads=threads, time_limit=1.0), Control())
    assert problem.evaluate(found.answer).feasible and len(teams) == 1 + searches
    first = teams[0]
    assert all(one.elites.answers is first.elites.answers and one.pool.routes is first.pool.routes for one in teams)
    assert len(first.elites.answers) >= searches and len({one.options.seed for one in teams[1:]}) == searches
    assert min(one.best[0] for one in teams) >= 0 and found.statistics["iterations"] == sum(
        int(one.held.sums[k.STEPS]) for one in teams[1:]
    )


def test_few_routes_are_not_shared_out() -> None:
    problem = wb.generate("random", customers=30, capacity=1000)
    search = begun(problem)
    assert search.threads == 1
    found = RuinRecreate().run(problem, Options(threads=2, time_limit=0.3), Control())
    assert problem.evaluate(found.answer).feasible


def test_limits_of_work_make_the_same_routes_on_any_number_of_threads() -> None:
    problem = made()
    answers = [RuinRecreate().run(problem, Options(threads=threads, iterations=3000), Control()).answer for threads in (1, 2, 3)]
    assert answers[0] == answers[1] == answers[2]
