from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from file_cases import Differences, Read, faults, strangers, unwritable, with_line_of
from file_texts import TOPTW as GOOD

from waybound.formulations.problem import problem_from_instance
from waybound.instances.routing.formats.toptw import read, recognises, write
from waybound.instances.routing.instance import VehicleType

with_line = partial(with_line_of, GOOD)


def test_the_depot_limits_tours_whose_number_is_left_open(read_text_as: Read) -> None:
    made = read_text_as(GOOD, "pr99.txt")
    assert (made.name, made.format, made.problem, made.problems) == (
        "pr99", "toptw", "team-orienteering", ("team-orienteering", "orienteering"),
    )  # fmt: skip
    assert made.fleet == (VehicleType(1),)
    assert (made.sites.ids, made.sites.depots.tolist()) == (("0", "1", "2"), [0])
    assert made.sites.reward.tolist() == [0, 12, 8]
    assert made.sites.service.tolist() == [0, 2, 7]
    assert (made.sites.ready.tolist(), made.sites.due.tolist()) == ([0, 354, 234], [1000, 509, 401])
    assert not made.sites.demand.any() and not made.sites.required.any()
    assert made.notes == (
        "the file leaves the number of tours open, and one is meant: set vehicles=4 for four",
        "published values are for distances rounded down to two decimals: --convention trunc2",
    )
    problem: Any = problem_from_instance(made, convention="trunc2", vehicles=4)
    assert (problem.vehicle_limit, problem.convention, str(problem.objective)) == (4, "trunc2", "reward")


def test_files_made_of_solomons_are_rounded_to_one_decimal_by_custom(read_text_as: Read) -> None:
    assert read_text_as(GOOD, "c101.txt").notes[1] == "published values are for distances rounded down to one decimal: --convention trunc1"


test_a_fault_is_refused_with_its_line = faults(
    (with_line(1, "5 3 3 4"), 5, "ends early", "point 3", "the end of the file"),
    (with_line(1, "5 3 1 4"), 5, "goes on after its end", "the end of the file", None),
    (with_line(1, "5 3 2000000000 4"), 5, "ends early", "point 3", "the end of the file"),
    (with_line(1, "5 3 0 4"), 1, "number of points must be a whole number", "1 or more", "'0'"),
    (with_line(3, "0 -10 19 0 5 0 0 0 1000"), 3, "the depot has a profit or a service time", "0", "[0. 5.]"),
    (with_line(4, "1 -29.730 64.136 2 -12 4 1 15 354 509"), 4, "profit is negative", "0 or more", "-12.0"),
    (with_line(4, "1 -29.730 64.136 -2 12 4 1 15 354 509"), 4, "service time is negative", "0 or more", "-2.0"),
    (with_line(4, "1 -29.730 64.136 2 12 4 1 15 554 509"), 4, "window closes before it opens", "ready time <= due date", "[554. 509.]"),
    (with_line(4, "1 -29.730 64.136 2 12 4 1 15 354"), 4, "row of a point has a wrong length", None, "9 values"),
    (with_line(4, "2 -29.730 64.136 2 12 4 1 15 354 509"), 4, "number of a point is out of order", "1", "2"),
    (with_line(4, "1 x 64.136 2 12 4 1 15 354 509"), 4, "point holds something that is no finite number", "a number", "'x'"),
)  # fmt: skip


def test_what_is_read_is_written_again(differences: Differences) -> None:
    made = read(GOOD, Path("pr99.txt"))
    assert differences(made, read(write(made), Path("pr99.txt"))) == []


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    GOOD,
    (lambda i: replace(i, fleet=(VehicleType(2),)), "does not say how many tours there are"),
    (lambda i: replace(i, fleet=(VehicleType(1, max_duration=4),)), "no place for max-duration"),
    (lambda i: replace(i, problem="vrptw", problems=("vrptw",)), "is no orienteering problem"),
    (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abc"))), "numbered 0, 1, 2"),
    (lambda i: replace(i, travel=i.travel.with_convention("trunc1")), "not Euclidean and exact"),
)


test_other_texts_are_not_recognised = strangers(
    recognises, "5 3 2 4\n500 200\n1 1 1 0 0 0 0 0 9\n", "5 3 2 4\n500 200\n0 1 1 0 0 0 0\n", "5 3 2 4\n500\n", ""
)
