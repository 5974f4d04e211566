from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound import Group, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.checking.told_visits import says_more, told_visits
from waybound.instances.routing.travel import EXPLICIT, Travel


def line(*groups: Group) -> RoutingProblem:
    """A depot, a customer who is required, and five who are not."""
    sites = Sites.of("oabcdef", required=[False, True, *[False] * 5], groups=groups)
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=1.0 - np.eye(7)), (VehicleType(), VehicleType(capacity=3.0)))


def told(problem: RoutingProblem, *statements: dict[str, Any]) -> tuple[str, str]:
    part = problem.restricted([(statement, True) for statement in statements])
    return tuple("".join(s for s, known in zip("abcdef", flags, strict=True) if known) for flags in told_visits(part))  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("statement", "visited"),
    [
        ({"routes": 1}, "a"), ({"visited": "b"}, "ab"), ({"visited": "b", "by": [1]}, "ab"), ({"visited": "a"}, "a"),
        ({"arc": ["b", "c"]}, "abc"), ({"arc": ["o", "c"]}, "ac"), ({"arc": ["c", "a"]}, "ac"), ({"moves": {"b": ["c", "d"]}}, "ab"),
        ({"moves": {"b": ["d"], "c": ["d"]}}, "ad"), ({"moves": {"b": ["d"], "d": ["c"]}}, "ad"),
        ({"moves": {"b": ["d"], "c": ["e"]}}, "a"), ({"moves": {"o": ["b", "c"]}}, "a"), ({"moves": {"b": ["o"], "o": ["b"]}}, "ab"),
    ],
)  # fmt: skip
def test_whose_moves_are_needed_is_visited(statement: dict[str, Any], visited: str) -> None:
    assert told(line(), statement) == (visited, "")


def test_his_alternatives_are_not() -> None:
    problem = line(Group((2, 3), required=False), Group((4,)), Group((5, 6)))
    assert told(problem) == ("ad", "")
    assert told(problem, {"visited": "b"}) == ("abd", "c")
    assert told(problem, {"arc": ["c", "f"]}) == ("acdf", "be")
    both = told(problem, {"visited": "b"}, {"visited": "c"})
    assert set(both[0]) & set(both[1])  # no answer visits both


def test_a_set_of_moves_says_more_unless_all_who_come_to_somebody_make_one() -> None:
    problem = line()

    def more(*decisions: tuple[dict[str, Any], bool]) -> list[bool]:
        part = problem.restricted(decisions)
        return [says_more(part, moves, told_visits(part)[0]) for moves in part.needed]

    assert more(({"visited": "b"}, True)) == [False]
    assert more(({"arc": ["b", "c"]}, True)) == [True]  # a single one
    into = {"moves": {tail: ["b"] for tail in "oacd"}}
    assert more((into, True)) == [True]
    assert more((into, True), ({"moves": {"e": ["b"], "f": ["b"]}}, False)) == [False]
    out = {"moves": {"a": list("obcdef"), "b": ["c"]}}
    assert more((out, True)) == [False]  # as a is required
    optional = replace(problem, sites=replace(problem.sites, required=np.zeros(7, dtype=bool)))
    part = optional.restricted([(out, True)])
    assert says_more(part, part.needed[0], told_visits(part)[0])
