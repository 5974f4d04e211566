import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from file_cases import Differences, Read, faults, strangers, unwritable, with_line_of
from file_texts import LI_LIM as GOOD

from waybound import Shipment, VehicleType
from waybound.instances.routing.formats.li_lim import read, recognises, write

with_line = partial(with_line_of, GOOD)


def test_pairs_are_shipments(read_text_as: Read) -> None:
    made = read_text_as(GOOD, "lc9.txt")
    assert (made.name, made.format, made.problem, made.problems) == ("lc9", "li-lim", "pdptw", ("pdptw", "min-cost-vrp"))
    assert made.fleet == (VehicleType(25, 200.0),)
    assert made.sites.ids == ("0", "1", "2", "3", "4")
    assert made.sites.shipments == (Shipment(2, 4, (10.0,)), Shipment(3, 1, (10.0,)))
    assert not made.sites.demand.any() and not made.sites.pickup.any()
    assert made.sites.ready.tolist() == [0, 0, 65, 0, 15]
    assert made.sites.service.tolist() == [0, 90, 90, 90, 90]
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")


@pytest.mark.parametrize(
    "change",
    [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.rstrip("\n"), lambda t: t.replace("\t", "  "),
     lambda t: t.replace("200\t1\n", "200\t0\n")],
)  # fmt: skip
def test_line_ends_marks_blanks_and_a_speed_of_0_do_not_matter(change: Callable[[str], str], read_text_as: Read) -> None:
    assert len(read_text_as(change(GOOD)).sites.shipments) == 2


test_a_fault_is_refused_with_its_line = faults(
    (with_line(1, "0 200 1"), 1, "number of vehicles must be a whole number", "1 or more", "'0'"),
    (with_line(1, "2 0 1"), 1, "capacity must be positive", "more than 0", "0"),
    (with_line(1, "2 200 2"), 1, "speed is not supported", "0 or 1", "2"),
    (with_line(2, "0 40 50 0 0 1236 5 0 0"), 2, "the depot has a demand, a service time or a partner", "0", "[0. 5. 0. 0.]"),
    (with_line(3, "2 45 68 -10 0 967 90 3 0"), 3, "numbers must run 0, 1, 2, ...", None, "2.0"),
    (with_line(3, "1 45 68 -10 0 967 90 3"), 3, "customer table has a wrong length", None, "8 values"),
    (with_line(3, "1 45 68 -10 0 967 -9 3 0"), 3, "service time is negative", "0 or more", "-9.0"),
    (with_line(3, "1 45 68 -10 99 96 9 3 0"), 3, "time window closes before it opens", "ready time <= due date", "[99. 96.]"),
    (with_line(3, "1 45 68 -10 0 967 90 0 0"), 3, "a customer needs one partner", "one of two", "[0. 0.]"),
    (with_line(3, "1 45 68 -10 0 967 90 3 3"), 3, "a customer needs one partner", "one of two", "[3. 3.]"),
    (with_line(3, "1 45 68 -10 0 967 90 5 0"), 3, "partner does not exist", "1 to 4", "[5. 0.]"),
    (with_line(3, "1 45 68 -10 0 967 90 2.5 0"), 3, "partner does not exist", "1 to 4", "[2.5 0. ]"),
    (with_line(3, "1 45 68 -10 0 967 90 -3 0"), 3, "partner does not exist", "1 to 4", "[-3.  0.]"),
    (with_line(3, "1 45 68 -10 0 967 90 2 0"), 3, "partner names another one", "a pair that names each other", "2"),
    (with_line(3, "1 45 68 -10 0 967 90 0 3"), 3, "partner names another one", "a pair that names each other", "3"),
    (with_line(3, "1 45 68 -11 0 967 90 3 0"), 3, "a delivery is not as much as its pickup", "the same, negative", "-11.0"),
    (with_line(5, "3 42 68 0 0 782 90 0 1"), 5, "demand of a pickup must be positive", "more than 0", "0.0"),
    (with_line(5, "3 42 68 inf 0 782 90 0 1"), 5, "customer table holds something that is no finite number", "a number", "'inf'"),
    (with_line(4, "2 42 3000 10 65 146 90 0 4"), 4, "no vehicle can reach customer 2", "at most 146", None),
    (GOOD[: GOOD.index("4\t40")], 4, "partner does not exist", "1 to 3", "[0. 4.]"),
    ("25 200 1\n0 40 50 0 0 1236 0 0 0\n", 2, "ends early", "a depot and at least one pair", "1 rows"),
)  # fmt: skip


def test_what_is_read_is_written_again(read_text_as: Read, differences: Differences) -> None:
    made = read_text_as(GOOD)
    assert write(made) == GOOD
    again = read(write(made), Path("file.txt"))
    assert differences(made, again) == []
    assert again.sites.shipments == made.sites.shipments


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    GOOD,
    (lambda i: replace(i, fleet=(VehicleType(2),)), "needs a number of vehicles, a capacity"),
    (lambda i: replace(i, fleet=(VehicleType(2, 200, max_duration=9),)), "no place for max-duration"),
    (lambda i: replace(i, sites=replace(i.sites, shipments=i.sites.shipments[:1])), "every customer must be one end of one shipment"),
    (lambda i: replace(i, sites=replace(i.sites, due=i.sites.due + math.inf)), "a due date for every site"),
    (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abcde"))), "numbered 0, 1, 2"),
    (lambda i: replace(i, travel=i.travel.with_convention("trunc1")), "not Euclidean and exact"),
)


test_other_texts_are_not_recognised = strangers(recognises, "25 200 1\n", "25 200\n0 1 2 3 4 5 6 7 8\n", "25 200 1\n0 1 2 3 4 5 6 7\n", "")
