from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from file_cases import Differences, Read, Refusal, faults, strangers, unwritable, with_line_of

from waybound.instances.routing.formats.mtsp import read, recognises, write
from waybound.instances.routing.instance import VehicleType

GOOD = "four EUC_2D 2\n1 0 0\n2 1 1\n3 3 4.5\n4 0 -2\n"
with_line = partial(with_line_of, GOOD)


def test_the_first_city_is_the_depot_and_distances_are_not_rounded(read_text_as: Read) -> None:
    made = read_text_as(GOOD, "four-m2.txt")
    assert (made.name, made.format, made.problem, made.problems) == (
        "four-m2", "mtsp", "min-makespan-vrp", ("min-makespan-vrp", "min-cost-vrp"),
    )  # fmt: skip
    assert made.fleet == (VehicleType(2),)
    assert made.sites.ids == ("1", "2", "3", "4")
    assert (made.sites.depots.tolist(), made.sites.required.tolist()) == ([0], [False, True, True, True])
    assert (made.travel.metric, made.travel.convention) == ("EUC_2D", "exact")
    assert made.travel.distance(0, 1) == np.sqrt(2.0)
    assert made.notes == ("distances are not rounded, as is the custom of these files; EUC_2D by the rules of TSPLIB is --convention file",)


def test_latitude_and_longitude_are_turned_for_maps(read_text_as: Read) -> None:
    made = read_text_as(GOOD.replace("EUC_2D", "GEO"))
    assert made.sites.coordinates.tolist() == [[0, 0], [1, 1], [4.5, 3], [-2, 0]]
    assert made.travel.coordinates.tolist()[2] == [3, 4.5]


test_a_fault_is_refused_with_its_line = faults(
    (with_line(1, "four EUC_2D 0"), 1, "number of salesmen must be a whole number", "1 or more", "'0'"),
    (with_line(1, "four EUC_2D 2.5"), 1, "number of salesmen must be a whole number", "1 or more", "'2.5'"),
    (with_line(1, "four EXPLICIT 2"), 1, "type 'EXPLICIT' is not supported", "EUC_2D, MAN_2D, CEIL_2D, ATT, GEO", "'EXPLICIT'"),
    (with_line(3, "3 1 1"), 3, "cities must be numbered 1, 2, 3, ...", "2", "3"),
    (with_line(3, "1 1 1"), 3, "cities must be numbered 1, 2, 3, ...", "2", "1"),
    (with_line(3, "2 1"), 3, "city has a wrong length", "id, x, y", "2 values"),
    (with_line(3, "2 1 -inf"), 3, "city holds something that is no finite number", "a number", "'-inf'"),
    ("four EUC_2D 2\n1 0 0\n", 2, "ends early", "a depot and at least one city", "1 cities"),
    (GOOD.replace("EUC_2D", "GEO").replace("2 1 1", "2 91 1"), 3, "latitude or longitude out of range",
     "within 90 and 180 degrees", "[91.  1.]"),
)  # fmt: skip


def test_a_first_line_that_is_too_short_is_refused_where_the_format_is_named(refusal: Refusal) -> None:
    assert refusal(with_line(1, "four 2"), format="mtsp").code == "wrong-shape"


def test_what_is_read_is_written_again(read_text_as: Read, differences: Differences) -> None:
    made = read_text_as(GOOD, "four.txt")
    assert write(made) == GOOD
    assert differences(made, read(write(made), Path("four.txt"))) == []
    assert recognises(write(replace(made, name="four  of us")))


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    GOOD,
    (lambda i: replace(i, fleet=(VehicleType(2, capacity=4),)), "no place for capacity"),
    (lambda i: replace(i, fleet=(VehicleType(),)), "needs a number of salesmen"),
    (lambda i: replace(i, travel=i.travel.with_convention("file")), "EUC_2D file, not one of"),
    (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abcd"))), "numbered 1, 2, 3"),
)


test_other_texts_are_not_recognised = strangers(
    recognises, "four EUC_2D 2\n", "four five 2\n1 2 3\n", "four EUC_2D x\n1 2 3\n", "1 2 3\n1 2 3\n", ""
)
