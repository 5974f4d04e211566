"""Routes: what is kept, and what makes two answers the same."""

from __future__ import annotations

from waybound.formulations.routing.routes import Route, Routes


def test_vehicles_that_stay_at_home_have_no_route() -> None:
    made = Routes.of([[1, 2], [], Route((), 1), Route((3,), 1)])
    assert list(made) == [Route((1, 2)), Route((3,), 1)]
    assert len(made) == 2 and [len(r) for r in made] == [2, 1]


def test_sites_become_plain_numbers() -> None:
    import numpy as np

    (route,) = Routes.of([np.array([4, 2], dtype=np.int32)])
    assert route.visits == (4, 2) and {type(i) for i in route.visits} == {int}


def test_the_order_of_routes_does_not_matter_and_that_of_visits_does() -> None:
    one = Routes.of([Route((3, 1)), Route((2,), 1), Route((4,))])
    same = Routes.of([Route((4,)), Route((3, 1)), Route((2,), 1)])
    assert one != same and one.canonical() == same.canonical()
    assert [r.visits for r in one.canonical()] == [(3, 1), (4,), (2,)]
    assert Routes.of([[1, 3]]).canonical() != Routes.of([[3, 1]]).canonical()
    assert Routes.of([Route((1,), 0)]).canonical() != Routes.of([Route((1,), 1)]).canonical()
