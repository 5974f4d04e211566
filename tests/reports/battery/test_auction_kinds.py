from collections.abc import Callable
from typing import Any

import numpy as np

from waybound.reports.battery.auction_kinds import AUCTIONS, errands, rooms_in_contact, shared_capacities, standing_bins
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth


def drawn(kind: Callable[..., Any], count: int = 40) -> list[Any]:
    return [kind(np.random.default_rng([9, turn])) for turn in range(count)]


def test_all_of_them_take_their_turns() -> None:
    assert set(AUCTIONS) <= set(KINDS.values())


def test_costs_and_profits_are_drawn_and_too_little_room() -> None:
    made = drawn(shared_capacities)
    assert {problem.objective for problem in made} == {"cost", "profit"}
    assert {truth(problem).status for problem in made} == {"optimal", "infeasible"}


def test_errands_are_drawn_with_requests_and_without_and_robots_that_bring_nothing() -> None:
    made = [problem.instance for problem in drawn(errands)]
    assert {given.num_requests for given in made} == {0, 1, 2}
    assert any(np.isinf(given.to_request).all(axis=1).any() for given in made if given.num_requests)
    assert any(np.isinf(given.filled).any() for given in made)


def test_days_have_all_bins_standing_and_robots_in_the_field() -> None:
    made = drawn(standing_bins)
    assert all(day.jobs.standing.all() for day in made) and any(day.jobs.away.any() for day in made)
    assert {day.objective for day in made} == {"makespan", "completion"}
    assert any((day.jobs.after >= 0).any() for day in made)


def test_rooms_are_drawn_that_nobody_can_explore_in_contact() -> None:
    made = drawn(rooms_in_contact)
    assert {truth(problem).status for problem in made} == {"optimal", "infeasible"}
    assert any(problem.instance.num_robots > 1 for problem in made)
