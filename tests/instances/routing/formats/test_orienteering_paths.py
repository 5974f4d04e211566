from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from file_cases import Change, Differences, Read, Refusal, check_fault, faults, strangers, unwritable, with_line_of

from waybound import Travel, VehicleType
from waybound.instances.formats import FORMATS
from waybound.instances.routing.formats.orienteering_paths import recognises_chao, recognises_tsiligirides, write_chao, write_tsiligirides

CHAO = "n 4\nm 2\ntmax 2.5\n10.5\t14.4\t0\n18\t15.9\t10\n18.3\t13.3\t12\n11.2\t14.1\t0\n"
TSILIGIRIDES = "15\t1\n10.5\t14.4\t0\n11.2\t14.1\t0\n18\t15.9\t10\n18.3\t13.3\t15\n"
chao, tsiligirides = partial(with_line_of, CHAO), partial(with_line_of, TSILIGIRIDES)


def test_paths_lead_from_the_first_point_to_the_last(read_text_as: Read) -> None:
    made = read_text_as(CHAO, "p9.txt")
    assert (made.name, made.format, made.problem, made.problems) == ("p9", "chao", "team-orienteering", ("team-orienteering",))
    assert made.fleet == (VehicleType(2, start=0, end=3, max_duration=2.5),)
    assert made.sites.depots.tolist() == [0, 3]
    assert made.sites.reward.tolist() == [0, 10, 12, 0]
    assert not made.sites.required.any()


def test_paths_lead_from_the_first_point_to_the_second(read_text_as: Read) -> None:
    made = read_text_as(TSILIGIRIDES)
    problems = ("orienteering", "team-orienteering")
    assert (made.name, made.format, made.problem, made.problems) == ("file", "tsiligirides", "orienteering", problems)
    assert made.fleet == (VehicleType(1, start=0, end=1, max_duration=15.0),)
    assert made.sites.ids == ("0", "1", "2", "3")
    assert made.sites.depots.tolist() == [0, 1]
    assert made.sites.customers.tolist() == [2, 3]
    assert made.sites.reward.tolist() == [0, 0, 10, 15]
    assert not made.sites.required.any()
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")


def test_one_path_may_be_asked_as_orienteering(read_text_as: Read) -> None:
    assert read_text_as(chao(2, "m 1")).problems == ("team-orienteering", "orienteering")


def test_several_paths_make_a_team(read_text_as: Read) -> None:
    made = read_text_as(tsiligirides(1, "15 3"))
    assert (made.fleet[0].count, made.problem, made.problems) == (3, "team-orienteering", ("team-orienteering",))


def test_points_that_no_path_reaches_are_read(read_text_as: Read) -> None:
    assert read_text_as(chao(3, "tmax 0")).fleet[0].max_duration == 0


@pytest.mark.parametrize(
    "change", [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.rstrip("\n"), lambda t: t.replace("\t", "  ")]
)
def test_line_ends_marks_and_blanks_do_not_matter(change: Change, read_text_as: Read) -> None:
    assert read_text_as(change(TSILIGIRIDES)).sites.reward.tolist() == [0, 0, 10, 15]


test_a_fault_is_refused_with_its_line = faults(
    (chao(1, "n 5"), 7, "wrong number of rows: point", "5", "4"),
    (chao(1, "n 3"), 7, "wrong number of rows: point", "3", "4"),
    (chao(1, "n 2000000000"), 7, "wrong number of rows: point", "2000000000", "4"),
    (chao(1, "n 2"), 1, "number of points must be a whole number", "3 or more", "'2'"),
    (chao(1, "N 4.5"), 1, "number of points must be a whole number", "3 or more", "'4.5'"),
    (chao(2, "m 0"), 2, "number of paths must be a whole number", "1 or more", "'0'"),
    (chao(2, "k 2"), 2, "m is missing", "m and its value", "'k 2'"),
    (chao(3, "tmax -1"), 3, "tmax is negative", "0 or more", "-1"),
    (chao(3, "tmax inf"), 3, "tmax must be a finite number", "a number", "'inf'"),
    (chao(6, "18 15.9"), 6, "point has a wrong length", "x, y, score", "2 values"),
    (chao(6, "18 15.9 -1"), 6, "score is negative", "0 or more", "-1.0"),
    ("n 4\nm 2\n", 2, "ends early", "tmax and its value", "the end of the file"),
    (tsiligirides(1, "-1 1"), 1, "Tmax is negative", "0 or more", "-1"),
    (tsiligirides(1, "15 0"), 1, "number of paths must be a whole number", "1 or more", "'0'"),
    (tsiligirides(1, "15 1.5"), 1, "number of paths must be a whole number", "1 or more", "'1.5'"),
    (tsiligirides(4, "18 15.9 -10"), 4, "score is negative", "0 or more", "-10.0"),
    (tsiligirides(4, "18 15.9"), 4, "point has a wrong length", "x, y, score", "2 values"),
    (tsiligirides(4, "18 15.9 10 1"), 4, "point has a wrong length", "x, y, score", "4 values"),
    (tsiligirides(4, "18 nan 10"), 4, "point holds something that is no finite number", "a number", "'nan'"),
    (tsiligirides(4, "18 1_0 10"), 4, "point holds something that is no finite number", "a number", "'1_0'"),
    ("15 1\n0 0 0\n1 1 0\n", 3, "ends early", "a start, an end and a point between", "2 points"),
    (tsiligirides(4, "1e200 0 3"), None, "coordinate of site 2 is too large", "at most 1e+150", "1e+200"),
)  # fmt: skip


def test_names_of_published_files_stand_for_a_number_of_points(refusal: Refusal) -> None:
    message = "the name set_64_1_15 stands for another number of points; rename it if this is meant"
    check_fault(refusal(TSILIGIRIDES, "set_64_1_15.txt"), message, 5, "64", "4")


@pytest.mark.parametrize(("text", "name"), [(CHAO, "chao"), (TSILIGIRIDES, "tsiligirides")])
def test_what_is_read_is_written_again(text: str, name: str, read_text_as: Read, differences: Differences) -> None:
    entry, made = FORMATS[name], read_text_as(text)
    assert entry.write is not None and entry.write(made) == text
    assert differences(made, entry.read(entry.write(made), Path("file.txt"))) == []


test_what_chao_cannot_express_is_refused = unwritable(
    write_chao,
    CHAO,
    (lambda i: replace(i, fleet=(replace(i.fleet[0], start=3),)), "from the first to the last"),
    (lambda i: replace(i, fleet=(VehicleType(2, start=0, end=3),)), "a number of paths and their limit"),
    (lambda i: replace(i, objective=("reward", "vehicles")), "no place for objective"),
)


test_what_tsiligirides_cannot_express_is_refused = unwritable(
    write_tsiligirides,
    TSILIGIRIDES,
    (lambda i: replace(i, fleet=(replace(i.fleet[0], max_distance=9.0),)), "no place for max-distance"),
    (lambda i: replace(i, fleet=(replace(i.fleet[0], count=None),)), "a number of paths and their limit"),
    (lambda i: replace(i, fleet=(replace(i.fleet[0], end=0),)), "from the first to the second"),
    (lambda i: replace(i, problem="min-cost-vrp", problems=("min-cost-vrp",)), "no orienteering problem but min-cost-vrp"),
    (lambda i: replace(i, sites=replace(i.sites, required=~i.sites.depot)), "sites that must be visited"),
    (lambda i: replace(i, travel=i.travel.with_convention("trunc1")), "euclidean trunc1, not Euclidean and exact"),
    (lambda i: replace(i, travel=Travel("EUC_2D", i.travel.coordinates)), "EUC_2D file, not Euclidean and exact"),
    (lambda i: replace(i, sites=replace(i.sites, ids=tuple("abcd"))), "numbered 0, 1, 2"),
)


test_other_texts_are_not_recognised_as_chao = strangers(recognises_chao, "n 4\n", "a 4\nb 3\ntmax 5\n", "4 2\n0 0 0\n", "")


test_other_texts_are_not_recognised_as_tsiligirides = strangers(
    recognises_tsiligirides, "15 1\n1 2\n", "15 1 2\n1 2 3\n", "x y\n1 2 3\n", "15 1\n", "", "id,x,y\n1,2,3\n"
)
