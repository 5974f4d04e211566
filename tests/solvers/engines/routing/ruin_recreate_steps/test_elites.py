from dataclasses import replace

import numpy as np
from small_routing import small

import waybound as wb
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.routing.sites import Group
from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import arrays
from waybound.solvers.engines.routing.ruin_recreate_steps.elites import Elites


def elites(problem: wb.RoutingProblem, seed: int = 0) -> Elites:
    return Elites(arrays(problem, with_slope(problem, integer_routing(problem)), 60, 1), seed)


def answer(*routes: list[int]) -> Routes:
    return Routes.of([Route(tuple(one), 0) for one in routes])


def test_an_answer_made_of_two_has_each_customer_once_and_no_more_routes() -> None:
    problem, rng = wb.generate("random", customers=30, capacity=40), np.random.default_rng(0)
    kept = elites(problem)
    for number in range(4):
        kept.add(number, answer(*(part.tolist() for part in np.array_split(rng.permutation(problem.customers), 6))))
    for _ in range(100):
        made = kept.make()
        first = kept.answers[kept.parent][1]
        visits = [c for one in made for c in one.visits]
        assert len(set(visits)) == len(visits) and len(made) <= len(first)
        whole = {one.visits for _, other in kept.answers for one in other}
        assert any(one.visits in whole for one in made)
        assert kept.held.put(made)


def test_an_answer_made_of_two_visits_one_of_each_group() -> None:
    problem = wb.generate("random", customers=12, capacity=40)
    groups = tuple(Group(tuple(members), True) for members in problem.customers.reshape(4, 3).tolist())
    none = np.zeros(len(problem.sites), dtype=bool)
    kept = elites(replace(problem, sites=replace(problem.sites, groups=groups, required=none)))
    for number, offset in enumerate((0, 1, 2)):
        first, second = groups[:2], groups[2:]
        kept.add(number, answer([one.sites[offset] for one in first], [one.sites[offset] for one in second]))
    for _ in range(30):
        visits = {c for one in kept.make() for c in one.visits}
        assert all(len(visits.intersection(group.sites)) <= 1 for group in groups)


def test_a_better_answer_stands_for_the_one_it_comes_of_and_no_value_twice() -> None:
    kept = elites(small("capacity", 0, "round"))
    for value in (5, 9, 7):
        kept.add(value, answer([1]))
    kept.parent = 2
    kept.add(6, answer([2]))
    assert [value for value, _ in kept.answers] == [5, 9, 6]
    kept.add(5, answer([2]))
    assert [value for value, _ in kept.answers] == [5, 9, 6]
    kept.add(8, answer([2]))
    assert [value for value, _ in kept.answers] == [5, 8, 6]
    kept.add(10, answer([2]))
    assert [value for value, _ in kept.answers] == [5, 8, 6]


def test_the_same_seed_makes_the_same_answers() -> None:
    problem = wb.generate("random", customers=12, capacity=40)
    made = []
    for seed in (1, 1, 2):
        kept = elites(problem, seed)
        kept.add(1, answer([*range(1, 7)], [*range(7, 13)]))
        kept.add(2, answer([*range(1, 13, 2)], [*range(2, 13, 2)]))
        made.append([kept.make() for _ in range(5)])
    assert made[0] == made[1] != made[2]
