"""Solution files: .sol, .tour and JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.instance import RoutingInstance, Sites, VehicleType
from waybound.instances.routing.solution_files import SolutionFile, read_solution_file, write_solution_file
from waybound.instances.routing.travel import Travel


def instance(depot: list[int]) -> RoutingInstance:
    xy = [[k, 0] for k in range(6)]
    sites = Sites.of("abcdef", depot=[k in depot for k in range(6)], coordinates=xy)
    fleet = tuple(VehicleType(start=d, end=d, name=f"from {d}") for d in depot)
    return RoutingInstance("six", "test", sites, Travel("euclidean", coordinates=xy), fleet)  # type: ignore[arg-type]


FIRST = instance([0])


def load(text: str, tmp_path: Path, of: RoutingInstance | None = FIRST) -> Any:
    path = tmp_path / "file.any"
    path.write_text(text, newline="")
    return read_solution_file(path, of)


@pytest.mark.parametrize(
    "text",
    [
        "Route #1: 1 2\nRoute #2: 3 4 5\nCost 12.5\n",
        "route 1 : 1 2 \r\nROUTE #2:3,4,5\r\ncost: 12.5\r\nComment nobody",
        "Instance name : six\nAuthors : nobody\nDate : today\nReference : none\nSolution\nRoute 1 : 1 2\nRoute 2 : 3 4 5\nCost 12.5",
        "Route #1: 0 1 2 0\nRoute #2: 0 3 4 5 0\n\nRoute #3:\nCost 12.5\nTime 0.3",
    ],
)
def test_routes_and_cost_are_read_in_every_common_spelling(text: str, tmp_path: Path) -> None:
    assert load(text, tmp_path) == SolutionFile(((1, 2), (3, 4, 5)), 12.5)


def test_customers_are_counted_in_the_order_of_the_file_without_depots(tmp_path: Path) -> None:
    assert load("Route #1: 1 2 3 4\n", tmp_path, instance([1, 3])) == SolutionFile(((0, 2, 4, 5),), None)


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("Route #1: 1 6\n", "route names a customer that does not exist; expected 1 to 5; found 6", 1),
        ("Route #1: 1 0 2\n", "customer that does not exist", 1),
        ("Route #1: 1 x\n", "customer must be a whole number", 1),
        ("Route #1: 1 2.5\n", "customer must be a whole number", 1),
        ("Route #1: 1 2\nRoote #2: 3\n", "line is not understood", 2),
        ("Route #1: 1 2\nCost many\n", "Cost must be a finite number", 2),
        ("Route #1: 1 2\nCost nan\n", "Cost must be a finite number", 2),
        ("Route #1: 1 2\nCost 1\nCost 2\n", "Cost stands twice", 3),
        ("once upon a time", "is no solution file", 1),
    ],
)
def test_a_fault_of_a_sol_file_is_refused_with_its_line(text: str, message: str, line: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"file.any") as caught:
        load(text, tmp_path)
    assert message in str(caught.value)
    assert caught.value.line == line


TOUR = "NAME : six\nTYPE : TOUR\nDIMENSION : 6\nTOUR_SECTION\n3\n4\n1\n6\n5 2\n-1\nEOF\n"


def test_a_tour_is_turned_until_the_depot_comes_first(tmp_path: Path) -> None:
    assert load(TOUR, tmp_path) == SolutionFile(((5, 4, 1, 2, 3),), None)
    assert load(TOUR, tmp_path, instance([4])) == SolutionFile(((1, 2, 3, 0, 5),), None)


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("-1\nEOF\n", "", "TOUR_SECTION ends early", 9),
        ("6\n5 2", "7\n5 2", "tour names a node that does not exist", 8),
        ("6\n5 2", "0\n5 2", "node must be a whole number", 8),
        ("1\n6\n", "6\n", "a tour must visit the depot once; expected 1; found 0 visits", 10),
        ("1\n6\n", "1\n1\n6\n", "found 2 visits", 12),
        ("-1\n", "-1\n3\n-1\n", "a second tour is not supported", 11),
        ("NAME : six", "Hello", "line is not understood", 1),
    ],
)
def test_a_fault_of_a_tour_file_is_refused_with_its_line(old: str, new: str, message: str, line: int, tmp_path: Path) -> None:
    assert old in TOUR
    with pytest.raises(InputError) as caught:
        load(TOUR.replace(old, new, 1), tmp_path)
    assert message in str(caught.value)
    assert caught.value.line == line


def test_json_is_handed_on_as_it_is(tmp_path: Path) -> None:
    answer = {"kind": "routes", "routes": [{"visits": ["b"]}]}
    assert load(json.dumps(answer), tmp_path, None) == answer
    assert load(json.dumps({"schema": 1, "answer": answer}), tmp_path)["answer"] == answer


@pytest.mark.parametrize("text", ['{"a": 1}', '{"waybound": 1, "kind": "routing"}', "{", '{"kind": NaN}'])
def test_other_json_is_refused(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="JSON"):
        load(text, tmp_path)


def test_routes_without_an_instance_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds routes"):
        load("Route #1: 1\n", tmp_path, None)


@pytest.mark.parametrize("depot", [[0], [3], [5]])
def test_what_is_written_reads_back_the_same(depot: list[int], tmp_path: Path) -> None:
    made = instance(depot)
    customers = made.sites.customers.tolist()
    routes = [tuple(customers[3:]), (), tuple(customers[:3])]
    write_solution_file(tmp_path / "a.sol", made, routes, 0.1)
    assert read_solution_file(tmp_path / "a.sol", made) == SolutionFile((routes[0], routes[2]), 0.1)
    write_solution_file(tmp_path / "a.tour", made, [customers[::-1]], 7)
    assert read_solution_file(tmp_path / "a.tour", made) == SolutionFile((tuple(customers[::-1]),), None)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.sol", "a.tour"]


def test_the_text_of_both_forms(tmp_path: Path) -> None:
    write_solution_file(tmp_path / "a.sol", FIRST, [(5, 1), (2,)], 12.0)
    assert (tmp_path / "a.sol").read_text() == "Route #1: 5 1\nRoute #2: 2\nCost 12\n"
    write_solution_file(tmp_path / "a.tour", FIRST, [(5, 1)])
    assert (tmp_path / "a.tour").read_text() == "NAME : six\nTYPE : TOUR\nDIMENSION : 3\nTOUR_SECTION\n1\n6\n2\n-1\nEOF\n"


def test_several_routes_are_no_tour_and_an_unknown_suffix_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"2 routes from 1 depots are no tour; write a .sol file"):
        write_solution_file(tmp_path / "a.tour", FIRST, [(1,), (2,)])
    with pytest.raises(UsageError, match=r"use one of .sol, .tour"):
        write_solution_file(tmp_path / "a.xml", FIRST, [(1,)])
    assert list(tmp_path.iterdir()) == []
