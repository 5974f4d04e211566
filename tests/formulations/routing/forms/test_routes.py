from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from file_cases import check_refused
from oracles import SQUARE_4, routing
from small_routing import varied
from truth.routing import RoutingTruth

from waybound import InputError, LatestReturn, LongestRoute, Route
from waybound.formulations.routing.forms._routes import ArcIndex, levels, routes_of, used
from waybound.formulations.routing.objective import Composable, Makespan, Objective, Penalties, Reward, TotalCost, TotalDuration, Vehicles
from waybound.formulations.routing.preparation import Preparation, Resource, prepare

NAMES = list("oabcd")


def prepared(**more: Any) -> Preparation:
    return prepare(routing(xy=SQUARE_4, **more))


def arcs(prep: Preparation, *moves: tuple[int, int]) -> Any:
    """Positions of moves between nodes; 5 is the return."""
    tail, head = (np.array([m[k] for m in moves]) for k in (0, 1))
    return ArcIndex(prep).find(tail, head)


def test_arcs_become_routes_whatever_their_order() -> None:
    prep = prepared()
    found = routes_of(prep, arcs(prep, (2, 5), (0, 3), (4, 5), (3, 1), (0, 2), (1, 4)), NAMES)
    assert sorted(r.visits for r in found) == [(2,), (3, 1, 4)]


@pytest.mark.parametrize(
    ("moves", "words"),
    [
        ([(0, 1), (1, 2), (1, 3)], "site a is left twice"),
        ([(0, 1), (1, 2)], "a route ends at site b, away from the depot"),
        ([(0, 1), (1, 5), (2, 3), (3, 2)], "cycle without the depot; found b, c"),
    ],
)
def test_arcs_that_are_no_routes_are_refused(moves: list[tuple[int, int]], words: str) -> None:
    prep = prepared()
    with pytest.raises(InputError, match=words):
        routes_of(prep, arcs(prep, *moves), NAMES)


def test_points_are_read_as_0_and_1_within_what_solvers_leave() -> None:
    assert used(np.array([1e-6, 1 - 1e-6, 0.0, 1.0])).tolist() == [False, True, False, True]
    check_refused(InputError, r"an arc 0\.5 away from 0 and 1", used, np.array([0.0, 0.5]))
    check_refused(InputError, "an arc nan away", used, np.array([0.0, np.nan]))


def test_moves_that_no_route_can_make_are_not_found() -> None:
    """At most 7 far, nobody goes on from one corner to the opposite one."""
    prep = prepared(max_distance=10.0)
    index = ArcIndex(prep)
    assert (index.find(np.array([0, 1, 0]), np.array([1, 5, 5])) >= 0).tolist() == [True, True, False]
    assert all(
        (prep.tail[k], prep.head[k]) == (i, j) for k, i, j in zip(index.find(prep.tail, prep.head), prep.tail, prep.head, strict=True)
    )
    check_refused(InputError, "no feasible route goes from c to d", index.arcs_of, np.array([0, 3, 4, 5]), NAMES)
    check_refused(InputError, "visits site o, which is no customer", index.nodes_of, Route((1, 0)), NAMES)
    check_refused(InputError, "visits site 9, which is no customer", index.nodes_of, Route((9,)), NAMES)


def test_levels_are_sums_raised_to_what_a_node_asks_for() -> None:
    clock = Resource("time", np.array([3.0, 4.0, 2.0]), np.array([1.0, 6.0, 0.0, 0.0]), np.full(4, 99.0), waits=True)
    nodes, along = np.arange(4), np.arange(3)
    assert levels(clock, nodes, along).tolist() == [1.0, 6.0, 10.0, 12.0]
    assert levels(clock, nodes, along, 5.0).tolist() == [5.0, 8.0, 12.0, 14.0]


LEVELS: tuple[Composable, ...] = (
    TotalCost() - Reward(), Makespan(), LongestRoute(), LatestReturn(), TotalDuration(), Vehicles(), Penalties(),
)  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("first", [0, 2, 4])
@pytest.mark.parametrize("feature", ["overtime", "penalties", "committed-vehicles", "duration-cost", "shifts"])
def test_an_answer_has_the_judges_value_at_every_level(feature: str, first: int) -> None:
    ordered = (*LEVELS[first:], *LEVELS[:first])
    seed = 3 if feature == "overtime" else 1
    problem = replace(varied(feature, seed, 3), objective=Objective(tuple(level for goal in ordered for level in goal.levels())))
    truth = RoutingTruth(problem)
    assert truth.samples
    for form in problem.forms():
        made = problem.compile(form)
        assert (made.program.sense, *(level.sense for level in made.program.further)) == problem.senses
        assert made.encode is not None
        for answer in truth.samples[:3]:
            x = made.encode(answer)
            found = [made.program.first_level().value(x), *(level.value(x) for level in made.program.further)]
            # Set partitioning holds the best of several orders of stops.
            assert found == pytest.approx(problem.evaluate(made.decode(x)).values), form


def test_only_the_levels_after_the_first_are_further() -> None:
    problem = replace(varied("shifts", 1, 3), objective=Objective.of(Makespan().then(Vehicles())))
    alone = replace(problem, objective=Objective.of(Makespan()))
    for form in problem.forms():
        program, single = problem.compile(form).program, alone.compile(form).program
        assert len(program.further) == 1
        assert single.further == ()
        if form == "three-index":
            assert np.array_equal(program.cost, single.cost)
            assert [rows.name for rows in program.rows] == [rows.name for rows in single.rows]
