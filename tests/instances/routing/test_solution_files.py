import pytest
from file_cases import check_fault, check_refused, error_of

from waybound import Sites, UsageError
from waybound.instances.routing.solution_files import SolutionFile, routes_from_text, sol_text, tour_text


def places(*depots: int) -> Sites:
    return Sites.of("abcdef", depot=[k in depots for k in range(6)])


FIRST = places(0)


@pytest.mark.parametrize(
    "text",
    [
        "Route #1: 1 2\nRoute #2: 3 4 5\nCost 12.5\n",
        "route 1 : 1 2 \r\nROUTE #2:3,4,5\r\ncost: 12.5\r\nComment nobody",
        "Instance name : six\nAuthors : nobody\nDate : today\nReference : none\nSolution\nRoute 1 : 1 2\nRoute 2 : 3 4 5\nCost 12.5",
        "Route #1: 0 1 2 0\nRoute #2: 0 3 4 5 0\n\nRoute #3:\nCost 12.5\nTime 0.3",
    ],
)
def test_routes_and_cost_are_read_in_every_common_spelling(text: str) -> None:
    assert routes_from_text(text, FIRST) == SolutionFile(((1, 2), (3, 4, 5)), 12.5)


def test_customers_are_counted_in_the_order_of_the_file_without_depots() -> None:
    assert routes_from_text("Route #1: 1 2 3 4\n", places(1, 3)) == SolutionFile(((0, 2, 4, 5),), None)


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
def test_a_fault_of_a_sol_file_is_refused_with_its_line(text: str, message: str, line: int) -> None:
    check_fault(error_of(routes_from_text, text, FIRST), message, line)


SEQUENCE = (
    "NAME : six\nTYPE : OP\nDIMENSION : 6\nCOST_LIMIT : 9\nROUTE_NODES : 3\nROUTE_SCORE : 7.5\nROUTE_COST : 8\n"
    "NODE_SEQUENCE_SECTION\n3\n1\n5\n-1\nDEPOT_SECTION\n1\n-1\nEOF\n"
)


def test_a_sequence_of_oplib_is_turned_until_the_depot_comes_first_and_claims_a_score() -> None:
    assert routes_from_text(SEQUENCE, FIRST) == SolutionFile(((4, 2),), 7.5)
    assert routes_from_text("NODE_SEQUENCE_SECTION\n1\n-1\n", FIRST) == SolutionFile((), None)


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("DIMENSION : 6", "DIMENSION : 7", "DIMENSION is another number; expected 6; found '7'", 3),
        ("ROUTE_NODES : 3", "ROUTE_NODES : 4", "ROUTE_NODES is another number; expected 3; found '4'", 5),
        ("ROUTE_SCORE : 7.5", "ROUTE_SCORE : nan", "ROUTE_SCORE must be a finite number", 6),
        ("ROUTE_SCORE", "ROUTE_PRIZE", "line is not understood; expected a header, NODE_SEQUENCE_SECTION or DEPOT_SECTION", 6),
        ("\n5\n", "\n7\n", "sequence names a node that does not exist; expected 1 to 6; found 7", 11),
        ("\n5\n", "\n0\n", "node must be a whole number; expected 1 or more", 11),
        ("\n5\n", "\n1\n", "a tour must visit the depot once; expected 1; found 2 visits", 16),
        ("\n5\n-1\n", "\n5\n-1 4\n", "sequence names a node that does not exist; expected a section or EOF; found 4", 12),
        ("\n1\n-1\nEOF", "\n2\n-1\nEOF", "DEPOT_SECTION names another node; expected 1", 16),
        ("\n1\n-1\nEOF\n", "\n1\n", "DEPOT_SECTION ends early; expected -1", 14),
        ("DEPOT_SECTION", "NODE_SEQUENCE_SECTION", "NODE_SEQUENCE_SECTION stands twice", 13),
    ],
)  # fmt: skip
def test_a_fault_of_a_sequence_is_refused_with_its_line(old: str, new: str, message: str, line: int) -> None:
    assert SEQUENCE.count(old) == 1
    check_fault(error_of(routes_from_text, SEQUENCE.replace(old, new), FIRST), message, line)


TOUR = "NAME : six\nTYPE : TOUR\nDIMENSION : 6\nTOUR_SECTION\n3\n4\n1\n6\n5 2\n-1\nEOF\n"


def test_a_tour_is_turned_until_the_depot_comes_first() -> None:
    assert routes_from_text(TOUR, FIRST) == SolutionFile(((5, 4, 1, 2, 3),), None)
    assert routes_from_text(TOUR, places(4)) == SolutionFile(((1, 2, 3, 0, 5),), None)


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
def test_a_fault_of_a_tour_file_is_refused_with_its_line(old: str, new: str, message: str, line: int) -> None:
    assert old in TOUR
    check_fault(error_of(routes_from_text, TOUR.replace(old, new, 1), FIRST), message, line)


@pytest.mark.parametrize("depot", [0, 3, 5])
def test_what_is_written_reads_back_the_same(depot: int) -> None:
    sites = places(depot)
    customers = sites.customers.tolist()
    routes = [tuple(customers[3:]), (), tuple(customers[:3])]
    assert routes_from_text(sol_text(sites, routes, 0.1), sites) == SolutionFile((routes[0], routes[2]), 0.1)
    assert routes_from_text(tour_text(sites, [customers[::-1]], 7), sites) == SolutionFile((tuple(customers[::-1]),), None)


def test_the_text_of_both_forms() -> None:
    assert sol_text(FIRST, [(5, 1), (2,)], 12.0) == "Route #1: 5 1\nRoute #2: 2\nCost 12\n"
    assert tour_text(FIRST, [(5, 1)], name="six") == "NAME : six\nTYPE : TOUR\nDIMENSION : 3\nTOUR_SECTION\n1\n6\n2\n-1\nEOF\n"


def test_several_routes_are_no_tour() -> None:
    check_refused(UsageError, r"six: 2 routes from 1 depots are no tour; write a .sol file", tour_text, FIRST, [(1,), (2,)], name="six")
