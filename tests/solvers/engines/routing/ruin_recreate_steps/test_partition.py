import itertools
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

import waybound as wb
from waybound.formulations.routing.objective import Reward, TotalCost
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.routing.sites import Group
from waybound.solvers.backend import Control
from waybound.solvers.engines.routing.routing_integers import searched_integers
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k, partition
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import arrays
from waybound.solvers.engines.routing.ruin_recreate_steps.partition import Pool


def pool(problem: wb.RoutingProblem) -> Pool:
    return Pool(arrays(problem, searched_integers(problem)[0], 60, 1), 0)


def answer(routes: Iterable[Iterable[int]]) -> Routes:
    return Routes.of(Route(tuple(one), 0) for one in routes)


def learn(kept: Pool, routes: Iterable[Iterable[int]]) -> int:
    """Come through an answer; its value."""
    assert kept.held.put(answer(routes))
    kept.looked = -2  # routes that were put in carry no step
    kept.collect()
    return int(kept.held.sums[k.OBJECTIVE])


def best_of(kept: Pool) -> int:
    """The least value of answers that serve everybody with routes of the pool, by looking at all of them."""
    everybody, least = frozenset(kept.held.customers.tolist()), np.iinfo(np.int64).max
    for many in range(1, 1 + len(everybody)):
        for keys in itertools.combinations(kept.routes, many):
            visits = [c for _, members in keys for c in members]
            if len(visits) == len(everybody) and frozenset(visits) == everybody:
                least = min(least, sum(kept.routes[key][0] for key in keys))
    return int(least)


@pytest.mark.parametrize("seed", range(8))
def test_the_best_answer_that_the_routes_make_up_is_found(seed: int) -> None:
    problem, rng = wb.generate("random", customers=7, capacity=1000, seed=seed), np.random.default_rng(seed)
    kept = pool(problem)
    for _ in range(6):
        parts = np.array_split(rng.permutation(problem.customers), rng.integers(2, 5))
        value = learn(kept, [part.tolist() for part in parts])
    least = best_of(kept)
    found = kept.better(10.0, Control())
    assert kept.whole
    assert (found is None) == (value == least)
    if found is not None:
        assert kept.held.put(found)
        assert kept.held.sums[k.OBJECTIVE] == least


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("required", [True, False])
def test_one_of_each_group_is_on_the_routes_that_are_chosen(seed: int, required: bool) -> None:
    """All choices of routes that the pool holds are looked at; sites of a group have different prizes."""
    problem, rng = wb.generate("random", customers=9, capacity=1000, seed=seed), np.random.default_rng(seed)
    groups = tuple(Group(tuple(members), required) for members in problem.customers.reshape(3, 3).tolist())
    prizes = np.zeros(len(problem.sites))
    prizes[problem.customers] = rng.integers(0, 60, 9)
    sites = replace(problem.sites, groups=groups, required=np.zeros(len(problem.sites), dtype=bool), reward=prizes)
    kept = pool(replace(problem, sites=sites, objective=TotalCost() - Reward()))
    values = []
    for _ in range(8):
        visited = [int(rng.choice(group.sites)) for group in groups if required or rng.random() < 0.8]
        parts = np.array_split(rng.permutation(visited), min(len(visited), rng.integers(1, 3)) or 1)
        values.append(learn(kept, [part.tolist() for part in parts if len(part)]))
    every, least = kept.held.customers.tolist(), min(values)
    for many in range(4):
        for keys in itertools.combinations(kept.routes, many):
            visits = [c for key in keys for c in kept.routes[key][1]]
            of = [int(kept.held.site[c, k.GROUP]) for c in visits]
            if len(set(of)) == len(of) and (not required or len(of) == 3):
                cost = sum(kept.routes[key][0] - sum(int(kept.forgone[c]) for c in kept.routes[key][1]) for key in keys)
                least = min(least, cost + sum(int(kept.held.site[c, k.LOST]) for c in every if c not in visits))
    for _ in range(3):
        found = kept.better(10.0, Control())
        if found is None:
            break
        assert kept.held.put(found)
    assert kept.held.sums[k.OBJECTIVE] == least


def test_of_one_set_of_visits_the_cheapest_order_is_kept() -> None:
    kept = pool(wb.generate("random", customers=4, capacity=1000, seed=1))
    first, second = (learn(kept, [order]) for order in ([1, 2, 3, 4], [1, 3, 2, 4]))
    ((cost, visits),) = kept.routes.values()
    assert cost == min(first, second) - int(kept.held.types[:, k.HOME].sum())
    assert visits == ((1, 2, 3, 4) if first <= second else (1, 3, 2, 4))


def test_no_more_vehicles_drive_than_there_are() -> None:
    """Single routes would be shorter than those at hand, but for the vehicles."""
    problem = wb.generate("random", customers=4, capacity=1000, seed=2)
    kept = pool(replace(problem, fleet=(replace(problem.fleet[0], count=2),)))
    value = learn(kept, [[1, 2], [3, 4]])
    for visits in ((1,), (2,), (3,), (4,)):
        kept.add(Route(visits, 0), 1)
    assert value > 4
    found = kept.better(10.0, Control())
    assert found is None or len(found) <= 2


def test_the_oldest_routes_make_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(partition, "KEPT", 2)
    kept = pool(small("capacity", 0, "round"))
    for c in kept.held.customers.tolist()[:3]:
        kept.add(Route((c,), 0), 1)
    kept.collect()
    assert [visits for _, visits in kept.routes.values()] == [(c,) for c in kept.held.customers.tolist()[1:3]]


def test_nobody_on_a_route_and_no_routes_kept_is_no_better_answer() -> None:
    assert pool(small("capacity", 0, "round")).better(10.0, Control()) is None


def test_a_large_answer_is_looked_at_part_by_part() -> None:
    problem = wb.generate("random", customers=240, capacity=40, seed=3)
    kept = pool(problem)
    learn(kept, [part.tolist() for part in np.array_split(problem.customers, 60)])
    assert kept.better(10.0, Control()) is None and not kept.whole
    region = kept.region([Route(one, 0) for _, one in kept.routes.values()])
    assert 0 < sum(len(one.visits) for one in region) <= partition.VISITS
