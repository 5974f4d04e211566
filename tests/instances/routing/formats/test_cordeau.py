import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from coded import coded
from file_cases import Differences, Read, Refusal, check_refused, faults, strangers, unwritable, with_line_of
from file_texts import MDVRP

from waybound import InputError, UsageError, VehicleType
from waybound.instances.reading import read_instance
from waybound.instances.routing.formats._rows import Rows
from waybound.instances.routing.formats.cordeau import Table, read, recognises, write

VRPTW = """\
4 3 2 1
500 200
0 -10.442 19.999 0 0 0 0 0 1000
1 -29.730 64.136 2 12 1 1 1 354 509
2 -30.664 5.463 7 8 1 1 1 234 401
"""
with_line = partial(with_line_of, MDVRP)


def test_several_depots_have_vehicles_each_and_limits_of_their_own(read_text_as: Read) -> None:
    made = read_text_as(MDVRP, "p99.txt")
    assert (made.name, made.format, made.problem, made.problems) == ("p99", "cordeau", "mdvrp", ("mdvrp", "min-cost-vrp"))
    assert made.fleet == (
        VehicleType(3, 80.0, start=3, end=3, max_duration=310.0, name="vehicle at 4"),
        VehicleType(3, 90.0, start=4, end=4, name="vehicle at 5"),
    )
    assert made.sites.ids == ("1", "2", "3", "4", "5")
    assert made.sites.depots.tolist() == [3, 4]
    assert made.sites.demand.tolist() == [7, 30, 16, 0, 0]
    assert made.sites.service.tolist() == [0, 5, 0, 0, 0]
    assert all(math.isinf(v) for v in made.sites.due)
    assert made.notes == ("3 vehicles at each of 2 depots",)


def test_windows_stand_behind_the_list(read_text_as: Read) -> None:
    made = read_text_as(VRPTW, format="cordeau")
    assert (made.problem, made.problems, made.notes) == ("vrptw", ("vrptw", "min-cost-vrp"), ())
    assert made.fleet == (VehicleType(3, 200.0, max_duration=500.0),)
    assert (made.sites.ids, made.sites.depots.tolist()) == (("0", "1", "2"), [0])
    assert (made.sites.ready.tolist(), made.sites.due.tolist()) == ([0, 354, 234], [1000, 509, 401])


def test_one_depot_without_windows_is_a_cvrp(read_text_as: Read) -> None:
    made = read_text_as("0 2 1 1\n0 5\n0 0 0 0 0 0 0\n1 3 4 0 2 1 1 1\n")
    assert (made.format, made.problem, made.fleet) == ("cordeau", "cvrp", (VehicleType(2, 5.0),))


def test_several_depots_with_windows(read_text_as: Read, differences: Differences) -> None:
    lines = MDVRP.replace("2 3 3 2", "6 3 3 2", 1).rstrip("\n").split("\n")
    made = read_text_as("\n".join([*lines[:3], *(f"{line} 0 {900 + k}" for k, line in enumerate(lines[3:]))]))
    assert (made.problem, made.sites.due.tolist()) == ("mdvrp", [900, 901, 902, 903, 904])
    assert differences(made, read(write(made), Path("file.txt"))) == []


@pytest.mark.parametrize("change", [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.rstrip("\n")])
def test_line_ends_and_marks_do_not_matter(change: Callable[[str], str], read_text_as: Read) -> None:
    assert read_text_as(change(MDVRP)).sites.demand.tolist() == [7, 30, 16, 0, 0]


test_a_fault_is_refused_with_its_line = faults(
    (with_line(1, "1 3 3 2"), 1, "type 1 (PVRP) is not supported", "0 (VRP), 2 (MDVRP), 4 (VRPTW), 6 (MDVRPTW)", None),
    (with_line(1, "3 3 3 2"), 1, "type 3 (SDVRP) is not supported", "0 (VRP), 2 (MDVRP), 4 (VRPTW), 6 (MDVRPTW)", None),
    (with_line(1, "0 3 3 2"), 1, "type 0 (VRP) has one depot", "1", "2"),
    (with_line(1, "2 0 3 2"), 1, "m must be a whole number", "1 or more", "'0'"),
    (with_line(1, "2 3 4 2"), 8, "ends early", "depot 6", "the end of the file"),
    (with_line(1, "2 3 0 2"), 1, "n must be a whole number", "1 or more", "'0'"),
    (with_line(1, "2 3 2000000000 2"), 8, "", None, None),
    (with_line(1, "2 3 3 3"), 4, "line of limits has a wrong length", "longest duration and capacity", "9 values"),
    (with_line(1, "2 3 3 2000000000"), 1, "there are too many depots", "at most 1000", "2000000000"),
    (with_line(2, "-1 80"), 2, "longest duration is negative", "0 (none) or more", "'-1'"),
    (with_line(2, "0 0"), 2, "capacity must be positive", "more than 0", "'0'"),
    (with_line(3, "0"), 3, "line of limits has a wrong length", "longest duration and capacity", "1 values"),
    (with_line(5, "3 49 49 5 30 1 2 1 2"), 5, "number of a customer is out of order", "2", "3"),
    (with_line(5, "2 49 49 5 30 1 3 1 2"), 5, "row of a customer has a wrong length", None, "9 values"),
    (with_line(5, "2 49 49 5 30 1 2.5 1 2"), 5, "row of a customer has a wrong length", None, "9 values"),
    (with_line(5, "2 49 49 5 30 1 1 2"), 5, "customers that some depots alone may serve", "f 1, list 1 2", "f 1, list 2"),
    (with_line(5, "2 49 49 5 30 2 2 1 2"), 5, "visited more than once, are not supported", "f 1, list 1 2", "f 2, list 1 2"),
    (with_line(5, "2 49 49 5 -30 1 2 1 2"), 5, "demand is negative", "0 or more", "-30.0"),
    (with_line(5, "2 49 49 -5 30 1 2 1 2"), 5, "service time is negative", "0 or more", "-5.0"),
    (with_line(5, "2 49 49 5 1e999 1 2 1 2"), 5, "customer holds something that is no finite number", "a number", "'1e999'"),
    (with_line(8, "5 60 50 0 4 0 0"), 8, "the depot has a demand or a service time", "0", "[0. 4.]"),
    (MDVRP + "6 60 50 0 0 0 0\n", 9, "goes on after its end", "the end of the file", "'6 60 50 0 0 0 0'"),
    (MDVRP[: MDVRP.index(" 5 60")], 7, "ends early", "depot 5", "the end of the file"),
    (with_line(3, "10 90").replace("310 80", "10 80"), 4, "no vehicle can reach customer 1", "at most 10", None),
)  # fmt: skip


def test_windows_that_close_before_they_open_are_refused(refusal: Refusal) -> None:
    error = refusal(with_line_of(VRPTW, 4, "1 -29.730 64.136 2 12 1 1 1 654 509"), format="cordeau")
    assert "time window closes before it opens" in str(error)
    assert error.line == 4


def test_a_claim_of_more_depots_than_anyone_has_is_too_large(refusal: Refusal) -> None:
    assert refusal(with_line(1, "2 3 3 2000000000")).code == "too-large"


@pytest.mark.parametrize("text", [MDVRP, VRPTW])
def test_what_is_read_is_written_again(text: str, differences: Differences) -> None:
    made = read(text, Path("file.txt"))
    assert differences(made, read(write(made), Path("file.txt"))) == []


test_what_the_format_cannot_express_is_refused = unwritable(
    write, MDVRP,
    (lambda i: replace(i, fleet=i.fleet[:1]), "the same number of vehicles at each depot"),
    (lambda i: replace(i, fleet=(i.fleet[0], replace(i.fleet[1], count=2))), "the same number of vehicles at each depot"),
    (lambda i: replace(i, fleet=(i.fleet[0], replace(i.fleet[1], capacity=math.inf))), "each vehicle needs a capacity"),
    (lambda i: replace(i, fleet=(i.fleet[0], replace(i.fleet[1], fixed_cost=3))), "no place for fixed-cost"),
    (lambda i: replace(i, problem="min-cost-vrp"), "several depots make it an mdvrp, not a min-cost-vrp"),
    (lambda i: replace(i, travel=i.travel.with_convention("round")), "not Euclidean and exact"),
    (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abcde"))), "sites must be numbered in order"),
)  # fmt: skip


def test_a_file_that_may_be_another_is_settled_by_its_problem(tmp_path: Path) -> None:
    path = tmp_path / "c101.txt"
    path.write_text(VRPTW)
    with pytest.raises(
        UsageError, match=r"choose with --format, or --problem, from cordeau \(mdvrp, cvrp, vrptw, min-cost-vrp\); toptw \("
    ) as caught:
        read_instance(path)
    assert caught.value.exit_code == 2
    assert read_instance(path, problem="vrptw").format == "cordeau"
    assert read_instance(path, problem="team-orienteering").format == "toptw"
    check_refused(UsageError, "more than one format", read_instance, path, problem="tsp")


test_other_texts_are_not_recognised = strangers(
    recognises,
    "5 3 1 4\n500 200\n0 1 1 0 0 0 0 0 1000\n",
    "2 3 1 1\n5 2\n0 1 1 0 0 0 0\n",
    "8 3 1 1\n5 2\n",
    "2 3 1\n5 2\n",
    "2 3 1 1\n",
    "",
)


# -- rows with a list of combinations of visits -------------------------------------------------------------------------


def test_windows_of_a_row_stand_behind_a_list_of_any_length() -> None:
    table = Table()
    table.read(Rows.of("1 5 6 7 8 2 3 1 2 4 9 10\n2 5 6 7 8 1 0 9 10\n"), "site", 1, 2, windows=True)
    assert table.columns.tolist() == [[1, 5, 6, 7, 8, 9, 10], [2, 5, 6, 7, 8, 9, 10]]
    assert (table.frequency, table.combinations, table.at) == ([2, 1], [[1, 2, 4], []], [1, 2])


def test_without_windows_a_site_is_always_open() -> None:
    table = Table()
    table.read(Rows.of("4 5 6 7 8 1 1 1"), "site", 4, 1, windows=False)
    assert table.columns.tolist() == [[4, 5, 6, 7, 8, 0, math.inf]]
    table.check("demand")


@pytest.mark.parametrize(
    "row", ["1 5 6 7 8 1", "1 5 6 7 8 1 2 1", "1 5 6 7 8 1 -1", "1 5 6 7 8 1 0.5", "1 5 6 7 8 1 1 1 9", "1 5 6 7 8 1 1e300 1"]
)
def test_a_row_that_is_as_long_as_it_says_alone_is_read(row: str) -> None:
    with pytest.raises(InputError, check=coded("wrong-shape")):
        Table().read(Rows.of(row), "site", 1, 1, windows=False)


def test_a_table_without_rows_keeps_its_columns() -> None:
    assert Table().columns.shape == (0, 7)
