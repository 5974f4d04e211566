import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import Differences, Read, Refusal, check_fault, check_refused, refused, tsplib, unwritable
from file_texts import OP, VRPSPD

from waybound import InputError, Shipment, UsageError, VehicleType
from waybound.instances.generating import generate
from waybound.instances.routing.formats._tsplib_writer import write
from waybound.instances.routing.formats.vrplib import read, recognises

CVRP = tsplib(
    "NAME : small", "COMMENT : (nobody, No of trucks: 2)", "TYPE : CVRP", "DIMENSION : 4", "EDGE_WEIGHT_TYPE : EUC_2D", "CAPACITY : 10",
    NODE_COORD_SECTION="1 0 0|2 3 4|3 1.5 2|4 -3 4.5", DEMAND_SECTION="1 0|2 5|3 7|4 2", DEPOT_SECTION=" 1| -1",
) + "EOF\n"  # fmt: skip
VRPTW = (
    CVRP.replace("TYPE : CVRP", "TYPE : VRPTW")
    .replace("CAPACITY : 10", "CAPACITY : 10\nVEHICLES : 3")
    .replace(
        "DEPOT_SECTION", "TIME_WINDOW_SECTION\n1 0 50\n2 5 20\n3 0 30\n4 10 10\nSERVICE_TIME_SECTION\n1 0\n2 2\n3 3\n4 4\nDEPOT_SECTION"
    )
)
TSP = """\
NAME: t4
TYPE: TSP
DIMENSION: 4
EDGE_WEIGHT_TYPE: EXPLICIT
EDGE_WEIGHT_FORMAT: {layout}
EDGE_WEIGHT_SECTION
{numbers}
EOF
"""
MATRIX = np.array([[0, 1, 2, 3], [1, 0, 4, 5], [2, 4, 0, 6], [3, 5, 6, 0]])


def cvrp(old: str, new: str, text: str = CVRP) -> str:
    assert old in text
    return text.replace(old, new, 1)


def test_everything_in_a_cvrp_file_is_read(read_text_as: Read) -> None:
    made = read_text_as(CVRP)
    assert (made.name, made.format, made.problem, made.problems) == ("small", "vrplib", "cvrp", ("cvrp", "min-cost-vrp"))
    assert made.fleet == (VehicleType(None, 10.0),)
    assert made.sites.ids == ("1", "2", "3", "4")
    assert made.sites.demand.tolist() == [0, 5, 7, 2]
    assert made.sites.coordinates.tolist() == [[0, 0], [3, 4], [1.5, 2], [-3, 4.5]]
    assert (made.travel.metric, made.travel.convention) == ("EUC_2D", "file")
    assert made.travel.distances[0].tolist() == [0, 5, 3, 5]  # 2.5 goes up; 5.41 goes down
    assert made.notes == ()


def test_everything_in_a_vrptw_file_is_read(read_text_as: Read) -> None:
    made = read_text_as(VRPTW)
    assert made.problem == "vrptw"
    assert made.fleet[0].count == 3
    assert made.sites.ready.tolist() == [0, 5, 0, 10]
    assert made.sites.due.tolist() == [50, 20, 30, 10]
    assert made.sites.service.tolist() == [0, 2, 3, 4]


def test_a_limit_of_duration_counts_service(read_text_as: Read) -> None:
    made = read_text_as(cvrp("CAPACITY : 10", "CAPACITY : 10\nDISTANCE : 30\nSERVICE_TIME : 10"))
    assert made.fleet[0].max_duration == 30
    assert made.sites.service.tolist() == [0, 10, 10, 10]
    assert any("service included" in note for note in made.notes)


def test_nodes_may_come_in_any_order_and_the_depot_anywhere(read_text_as: Read) -> None:
    text = cvrp("1 0 0\n2 3 4\n", "2 3 4\n1 0 0\n")
    text = cvrp(" 1\n -1", " 2 -1", text)
    text = cvrp("1 0\n2 5\n", "1 5\n2 0\n", text)
    made = read_text_as(text)
    assert made.sites.ids == ("1", "2", "3", "4")
    assert made.sites.coordinates.tolist()[:2] == [[0, 0], [3, 4]]
    assert made.sites.depots.tolist() == [1]
    assert (made.fleet[0].start, made.fleet[0].end) == (1, 1)


def test_everything_in_an_op_file_is_read(read_text_as: Read) -> None:
    made = read_text_as(OP)
    assert (made.name, made.problem, made.problems) == ("three", "orienteering", ("orienteering", "team-orienteering"))
    assert made.fleet == (VehicleType(1, start=1, end=1, max_distance=9.0),)
    assert made.sites.reward.tolist() == [1, 7, 5]
    assert not made.sites.required.any()
    assert (made.travel.metric, made.travel.convention) == ("EUC_2D", "file")


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("COST_LIMIT : 9", "COST_LIMIT : -9", "COST_LIMIT is negative; expected 0 or more; found -9", 5),
        ("COST_LIMIT : 9", "COST_LIMIT : x", "COST_LIMIT must be a finite number", 5),
        ("COST_LIMIT : 9\n", "", "header COST_LIMIT is missing", 17),
        ("TSPSOL : 12", "CAPACITY : 12", "header 'CAPACITY' is not supported in a file of TYPE OP", 4),
        ("TYPE : OP", "TYPE : CVRP", "header 'TSPSOL' is not supported in a file of TYPE CVRP", 4),
        ("TYPE : OP", "TYPE : TSP", "header 'TSPSOL' is not supported in a file of TYPE TSP", 4),
        ("2 7\n", "2 -7\n", "score is negative; expected 0 or more; found -7.0", 13),
        ("2 7\n", "2 7 8\n", "row of NODE_SCORE_SECTION has a wrong length", 13),
        ("2 7\n", "", "NODE_SCORE_SECTION has a wrong number of rows", 13),
        ("NODE_SCORE_SECTION", "DEMAND_SECTION", "DEMAND_SECTION is not supported in a file of TYPE OP", 11),
        ("NODE_SCORE_SECTION", "NODE_SEQUENCE_SECTION", "is a solution file, not an instance", 11),
        ("\n2\n-1\nEOF", "\n4\n-1\nEOF", "DEPOT_SECTION names a node that does not exist", 16),
    ],
)  # fmt: skip
def test_a_fault_of_an_op_is_refused_with_its_line(old: str, new: str, message: str, line: int, refusal: Refusal) -> None:
    check_fault(refusal(cvrp(old, new, OP)), message, line)


def test_everything_in_a_file_with_simultaneous_pickups_and_deliveries_is_read(read_text_as: Read) -> None:
    made = read_text_as(VRPSPD)
    assert (made.name, made.problem, made.problems) == ("both", "cvrp", ("cvrp", "min-cost-vrp"))
    assert made.fleet == (VehicleType(2, 10.0),)
    assert made.sites.demand.tolist() == [0, 7, 8]
    assert made.sites.pickup.tolist() == [0, 3, 2]
    assert made.sites.service.tolist() == [0, 0, 5]
    assert all(math.isinf(v) for v in made.sites.due)
    assert (made.travel.metric, made.travel.convention) == ("euclidean", "exact")
    assert made.travel.distance(0, 1) == math.sqrt(2)
    assert made.notes == ("published values of simultaneous pickups and deliveries keep no number of vehicles: set vehicles=unlimited",)


PDPTW = tsplib(
    "NAME : pairs", "TYPE : PDPTW", "DIMENSION : 5", "VEHICLES : 2", "CAPACITY : 20", "EDGE_WEIGHT_TYPE : EXACT_2D",
    NODE_COORD_SECTION="1 40 50|2 45 68|3 42.5 66|4 42 68|5 40 69",
    PICKUP_AND_DELIVERY_SECTION="1 0 0 1236 0 0 0|2 -10 0 967 90 4 0|3 7 65 246 90 0 5|4 10 0 782 90 0 2|5 -7 15 467 90 3 0",
    DEPOT_SECTION="1|-1",
) + "EOF\n"  # fmt: skip


def test_pairs_of_lkh_are_shipments_as_pyvrp_reads_them(read_text_as: Read, tmp_path: Path) -> None:
    import pyvrp

    made = read_text_as(PDPTW)
    assert (made.problem, made.problems, made.fleet) == ("pdptw", ("pdptw", "min-cost-vrp"), (VehicleType(2, 20.0),))
    assert made.sites.shipments == (Shipment(2, 4, (7.0,)), Shipment(3, 1, (10.0,)))
    assert made.sites.ready.tolist() == [0, 0, 65, 0, 15] and made.sites.due.tolist() == [1236, 967, 246, 782, 467]
    assert made.sites.service.tolist() == [0, 90, 90, 90, 90] and not made.sites.demand.any()
    (tmp_path / "pairs.vrp").write_text(PDPTW.replace("EXACT_2D", "EUC_2D"))
    theirs = pyvrp.read(tmp_path / "pairs.vrp").shipments()
    told = [(s.amount[0], s.pickup.tw_early, s.pickup.tw_late, s.delivery.tw_early, s.delivery.tw_late) for s in theirs]
    assert told == [(7, 65, 246, 15, 467), (10, 0, 782, 0, 967)]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("2 -10 0 967 90 4 0", "2 -10 0 967 90 3 0", "partner names another one"),
        ("2 -10 0 967 90 4 0", "2 -10 0 967 90 6 0", "partner does not exist; expected 2 to 5"),
        ("2 -10 0 967 90 4 0", "2 -9 0 967 90 4 0", "a delivery is not as much as its pickup"),
        ("1 0 0 1236 0 0 0", "1 3 0 1236 0 0 0", "the depot has a demand, a service time or a partner"),
        ("DEPOT_SECTION\n1", "DEPOT_SECTION\n2", "the depot must be node 1; expected 1; found 2"),
        ("CAPACITY : 20\n", "", "CAPACITY"),
    ],
)
def test_a_fault_of_pairs_is_refused(read_text_as: Read, old: str, new: str, message: str) -> None:
    assert old in PDPTW
    assert message in refused(read_text_as, PDPTW.replace(old, new))


SECTIONS = tsplib(
    "NAME : pairs", "TYPE : PDPTW", "DIMENSION : 3", "VEHICLES : 1", "CAPACITY : 20 3", "EDGE_WEIGHT_TYPE : EXACT_2D",
    NODE_COORD_SECTION="1 40 50|2 45 68|3 42.5 66", DEMAND_SECTION="1 0 0|2 7 2|3 -7 -2", TIME_WINDOW_SECTION="1 0 900|2 5 400|3 0 500",
    SERVICE_TIME_SECTION="1 0|2 9|3 8", PICKUP_AND_DELIVERY_SECTION="1 0 0|2 0 3|3 2 0", DEPOT_SECTION="1",
) + "EOF\n"  # fmt: skip


def test_pairs_have_windows_and_several_loads_in_sections_of_their_own(read_text_as: Read) -> None:
    made = read_text_as(SECTIONS)
    assert made.sites.shipments == (Shipment(1, 2, (7.0, 2.0)),) and made.fleet == (VehicleType(1, 20.0, further_capacity=(3.0,)),)
    assert made.sites.ready.tolist() == [0, 5, 0] and made.sites.due.tolist() == [900, 400, 500]
    assert made.sites.service.tolist() == [0, 9, 8]
    full = SECTIONS.replace("1 0 0\n2 0 3\n3 2 0\n", "1 0 0 900 0 0 0\n2 7 5 400 9 0 3\n3 -7 0 500 8 2 0\n")
    same = read_text_as(full)
    assert same.sites.shipments == made.sites.shipments and same.sites.due.tolist() == made.sites.due.tolist()
    several = SECTIONS.replace("PDPTW", "CVRPTW").replace("3 -7 -2", "3 1 1")
    plain = read_text_as(several[: several.index("PICKUP")] + "DEPOT_SECTION\n1\nEOF\n")
    assert plain.sites.demand.tolist() == [0, 7, 1] and plain.sites.further_demand.tolist() == [[0], [2], [1]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CAPACITY : 20 3", "CAPACITY : 20", "CAPACITY has another number of loads than the demands; expected 2 numbers; found 1"),
        ("CAPACITY : 20 3", "CAPACITY : 20 0", "CAPACITY must be positive"),
        ("3 -7 -2", "3 -7 -1", "a delivery is not as much as its pickup"),
        ("2 7 2\n3 -7 -2", "2 7 -2\n3 -7 2", "demand of a pickup must be positive"),
        ("1 0 0\n2 0 3\n3 2 0\n", "1 0 0 900 0 0 0\n2 7 5 401 9 0 3\n3 -7 0 500 8 2 0\n", "row differs from TIME_WINDOW_SECTION"),
        ("1 0 0\n2 0 3\n3 2 0\n", "1 0 0 900 0 0 0\n2 6 5 400 9 0 3\n3 -6 0 500 8 2 0\n", "row differs from DEMAND_SECTION"),
        ("1 0\n2 9", "1 1\n2 9", "the depot has a service time"),
        ("2 5 400", "2 500 400", "time window closes before it opens"),
        ("1 0 0\n2 7 2", "1 0 1\n2 7 2", "the depot has a demand, a service time or a partner"),
    ],
)
def test_a_fault_of_sections_beside_pairs_is_refused(read_text_as: Read, old: str, new: str, message: str) -> None:
    assert old in SECTIONS
    assert message in refused(read_text_as, SECTIONS.replace(old, new))


def test_windows_that_routes_can_outlast_are_windows(read_text_as: Read) -> None:
    made = read_text_as(cvrp("3 0 0 10000000 5", "3 0 0 30 5", VRPSPD.replace("MVRPB", "VRPSPDTW")))
    assert (made.problem, made.sites.due.tolist()) == ("vrptw", [10000000, 10000000, 30])
    assert read_text_as(VRPSPD.replace("10000000", "15")).sites.due.tolist() == [15, 15, 15]


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("2 0 0 10000000 0 3 7", "2 1 0 10000000 0 3 7", "second column is not supported; expected 0", 13),
        ("2 0 0 10000000 0 3 7", "2 0 0 10000000 0 -3 7", "pickup is negative; expected 0 or more; found -3.0", 13),
        ("2 0 0 10000000 0 3 7", "2 0 0 10000000 0 3 -7", "delivery is negative", 13),
        ("2 0 0 10000000 0 3 7", "2 0 0 10000000 -1 3 7", "service time is negative", 13),
        ("2 0 0 10000000 0 3 7", "2 0 9 3 0 3 7", "time window closes before it opens", 13),
        ("2 0 0 10000000 0 3 7", "2 0 0 10000000 0 3", "row of PICKUP_AND_DELIVERY_SECTION has a wrong length", 13),
        ("1 0 0 10000000 0 0 0", "1 0 0 10000000 0 0 4", "the depot has a service time, a pickup or a delivery", 12),
        ("CAPACITY : 10\n", "", "header CAPACITY is missing", 17),
        ("MVRPB", "CVRP", "PICKUP_AND_DELIVERY_SECTION is not supported in a file of TYPE CVRP", 11),
        ("CAPACITY : 10", "SERVICE_TIME : 10", "header 'SERVICE_TIME' is not supported in a file of TYPE MVRPB", 5),
    ],
)
def test_a_fault_of_pickups_and_deliveries_is_refused_with_its_line(old: str, new: str, message: str, line: int, refusal: Refusal) -> None:
    check_fault(refusal(cvrp(old, new, VRPSPD)), message, line)


@pytest.mark.parametrize(
    ("name", "count", "note"),
    [
        ("A-n4-k2", 2, "at most 2 vehicles: the fleet is named only in the file's name"),
        ("X-n4-k2", None, "the fleet is unlimited"),
        ("XX-n4-k2", 2, "at most 2 vehicles"),
        ("small", None, None),
    ],
)
def test_the_fleet_of_a_name_is_a_limit_except_in_set_x(name: str, count: int | None, note: str | None, read_text_as: Read) -> None:
    for text, file in ((cvrp("NAME : small", f"NAME : {name}"), "file.vrp"), (CVRP, f"{name}.vrp")):
        made = read_text_as(text, file)
        assert made.fleet[0].count == count
        assert (note is None and made.notes == ()) or (note is not None and note in made.notes[0])


def test_a_vehicles_header_wins_over_the_name(read_text_as: Read) -> None:
    made = read_text_as(cvrp("NAME : small", "NAME : A-n4-k2\nVEHICLES : 4"))
    assert made.fleet[0].count == 4
    assert made.notes == ()


@pytest.mark.parametrize(
    ("layout", "numbers"),
    [
        ("FULL_MATRIX", "0 1 2 3 1 0 4 5 2 4 0 6 3 5 6 0"), ("UPPER_ROW", "1 2 3 4 5 6"), ("LOWER_ROW", "1 2 4 3 5 6"),
        ("UPPER_DIAG_ROW", "0 1 2 3 0 4 5 0 6 0"), ("LOWER_DIAG_ROW", "0 1 0 2 4 0 3 5 6 0"), ("UPPER_COL", "1 2 4 3 5 6"),
        ("LOWER_COL", "1 2 3 4 5 6"), ("UPPER_DIAG_COL", "0 1 0 2 4 0 3 5 6 0"), ("LOWER_DIAG_COL", "0 1 2 3 0 4 5 0 6 0"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("wrap", [3, 100])
def test_every_layout_of_a_matrix_gives_the_same_distances(layout: str, numbers: str, wrap: int, read_text_as: Read) -> None:
    tokens = numbers.split()
    lines = "\n".join(" ".join(tokens[k : k + wrap]) for k in range(0, len(tokens), wrap))
    made = read_text_as(TSP.format(layout=layout, numbers=lines), "t4.tsp")
    assert np.array_equal(made.travel.distances, MATRIX)
    assert (made.problem, made.fleet, made.sites.coordinates) == ("tsp", (VehicleType(1),), None)


def test_an_atsp_may_differ_by_direction_and_a_tsp_may_not(read_text_as: Read, refusal: Refusal) -> None:
    text = TSP.format(layout="FULL_MATRIX", numbers="9999 1 2 3\n1 9999 4 5\n2 4 9999 6\n3 5 7 9999")
    error = refusal(text)
    assert "symmetric, but the distance from 3 to 4 differs" in error.message
    assert error.line == 9
    made = read_text_as(text.replace("TYPE: TSP", "TYPE: ATSP"))
    assert (made.travel.distance(2, 3), made.travel.distance(3, 2)) == (6, 7)


def test_display_coordinates_serve_as_a_map_and_not_as_distances(read_text_as: Read) -> None:
    text = TSP.format(layout="UPPER_ROW", numbers="1 2 3 4 5 6").replace("EOF", "DISPLAY_DATA_SECTION\n1 5 6\n2 7 8\n3 1 1\n4 2 2\nEOF")
    made = read_text_as(text)
    assert made.sites.coordinates.tolist()[0] == [5, 6]
    assert np.array_equal(made.travel.distances, MATRIX)


def test_a_geographical_map_has_the_longitude_on_its_x_axis(read_text_as: Read) -> None:
    head = "NAME: g\nTYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: GEO\nEDGE_WEIGHT_FORMAT: FUNCTION\n"
    text = head + "NODE_COORD_SECTION\n1 38.24 20.42\n2 39.57 26.15\nEOF\n"
    made = read_text_as(text)
    assert made.travel.distance(0, 1) == 509
    assert made.sites.coordinates.tolist()[0] == [20.42, 38.24] and made.notes == ()
    (told,) = read_text_as(text.replace("38.24", "45.81")).notes
    assert "45.81 has 60 minutes or more" in told


FAULTS = [
    ("DIMENSION : 4", "DIMENSION : 5", "NODE_COORD_SECTION has a wrong number of rows", 11, "5 (DIMENSION)", "4"),
    ("DIMENSION : 4", "DIMENSION : 3", "NODE_COORD_SECTION has a wrong number of rows", 11, "3 (DIMENSION)", "4"),
    ("DIMENSION : 4", "DIMENSION : 2000000000", "NODE_COORD_SECTION has a wrong number of rows", 11, "2000000000 (DIMENSION)", "4"),
    ("DIMENSION : 4", "DIMENSION : -4", "DIMENSION must be a whole number", 4, "1 or more", "'-4'"),
    ("DIMENSION : 4", "DIMENSION : four", "DIMENSION must be a whole number", 4, "1 or more", "'four'"),
    ("DIMENSION : 4", "DIMENSION :", "DIMENSION has no value", 4, None, None),
    ("DIMENSION : 4\n", "", "header DIMENSION is missing", 19, None, None),
    ("TYPE : CVRP", "TYPE : SOP", "TYPE 'SOP' is not supported", 3, None, None),
    ("TYPE : CVRP", "TYPE : CVRP\nTYPE : TSP", "header TYPE stands twice, first in line 3", 4, None, None),
    ("EUC_2D", "EUC_3D", "EDGE_WEIGHT_TYPE 'EUC_3D' is not supported", 5, None, None),
    ("EUC_2D", "EXPLICIT", "header EDGE_WEIGHT_FORMAT is missing", 20, None, None),
    ("CAPACITY : 10\n", "", "header CAPACITY is missing", 19, None, None),
    ("CAPACITY : 10", "CAPACITY : 0", "CAPACITY must be positive", 6, "more than 0", "0"),
    ("CAPACITY : 10", "CAPACITY : -5", "CAPACITY must be positive", 6, "more than 0", "-5"),
    ("CAPACITY : 10", "CAPACITY : inf", "CAPACITY must be a finite number", 6, "a number", "'inf'"),
    ("CAPACITY : 10", "CAPACITY : 10\nVEHICLES : 0", "VEHICLES must be a whole number", 7, "1 or more", "'0'"),
    ("CAPACITY : 10", "CAPACITY : 10\nCOST_LIMIT : 7", "header 'COST_LIMIT' is not supported", 7, None, None),
    ("CAPACITY : 10", "CAPACITY : 10\nSERVICE_TIME : -1", "SERVICE_TIME is negative", 7, "0 or more", "-1.0"),
    ("CAPACITY : 10", "CAPACITY : 10\nDISTANCE : 9", "no vehicle can reach customer 4: shortest duration", 17, "at most 9", "at least 10"),
    ("NODE_COORD_SECTION\n", "", "neither a header nor a section", 7, None, None),
    ("2 3 4\n", "2 3 nan\n", "no finite number", 9, "a number", "'nan'"),
    ("2 3 4\n", "nan 3 4\n", "line is not understood", 9, "numbers of NODE_COORD_SECTION", "'nan 3 4'"),
    ("2 3 4\n", "2 3\n", "row of NODE_COORD_SECTION has a wrong length", 9, "node, x, y", "2 values"),
    ("2 3 4\n", "1 3 4\n", "NODE_COORD_SECTION names node 1 twice, first in line 8", 9, "different nodes", None),
    ("2 3 4\n", "9 3 4\n", "names a node that does not exist", 9, "1 to 4", "9.0"),
    ("2 3 4\n", "0 3 4\n", "names a node that does not exist", 9, "1 to 4", "0.0"),
    ("2 3 4\n", "1.5 3 4\n", "names a node that does not exist", 9, "1 to 4", "1.5"),
    ("2 5\n", "2 -5\n", "demand is negative", 14, "0 or more", "-5.0"),
    ("1 0\n2 5\n", "1 3\n2 5\n", "the depot has a demand", 13, "0", "3.0"),
    ("4 2\nDEPOT", "DEPOT", "DEMAND_SECTION has a wrong number of rows", 15, "4 (DIMENSION)", "3"),
    (" -1\nEOF\n", "", "DEPOT_SECTION ends early", 18, "-1 or EOF", None),
    (" 1\n -1\n", " -1\n", "there is no depot", 17, "at least one", None),
    (" 1\n -1\n", " 1\n 2\n -1\n", "the depot has a demand", 14, "0", "5.0"),
    (" 1\n -1\n", " 7\n -1\n", "DEPOT_SECTION names a node that does not exist", 18, "1 to 4", "7"),
    (" 1\n -1\n", " 1\n -1\n 3\n", "DEPOT_SECTION goes on after its end", 20, None, "'3'"),
    ("EOF", "DEMAND_SECTION\nEOF", "DEMAND_SECTION stands twice, first in line 12", 20, None, None),
    ("EOF", "PRIZE_SECTION\n1 2\nEOF", "PRIZE_SECTION has a wrong number of rows", 21, "4 (DIMENSION)", "1"),
    ("EOF", "TIME_WINDOW_SECTION\n1 2 3\nEOF", "TYPE CVRP has no TIME_WINDOW_SECTION", 20, None, None),
    (
        "EOF", "FIXED_EDGES_SECTION\n1 2\n-1\nEOF", "FIXED_EDGES_SECTION is not supported; fixed edges make it another problem", 20, None,
        None,
    ),
    ("EOF", "EDGE_WEIGHT_SECTION\n1 2\nEOF", "EDGE_WEIGHT_TYPE EUC_2D has no EDGE_WEIGHT_SECTION", 20, None, None),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message", "line", "expected", "found"), FAULTS)
def test_a_fault_is_refused_with_its_line(
    old: str, new: str, message: str, line: int, expected: str | None, found: str | None, refusal: Refusal
) -> None:
    check_fault(refusal(cvrp(old, new), "small.vrp"), message, line, expected, found)


@pytest.mark.parametrize(("old", "new"), [(" -1\n", ""), ("DEMAND_SECTION", "# who gets what\nDEMAND_SECTION\n  # all of them")])
def test_what_others_leave_out_or_remark_changes_nothing(old: str, new: str, read_text_as: Read) -> None:
    assert read_text_as(cvrp(old, new), "small.vrp").sites.demand.tolist() == [0, 5, 7, 2]


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("2 5 20\n", "2 25 20\n", "time window closes before it opens", 20),
        ("2 5 20\n", "2 1 3\n", "no vehicle can reach customer 2: earliest arrival", 20),
        ("1 0\n2 2\n", "1 1\n2 2\n", "the depot has a service time", 24),
        ("2 2\n3 3\n4 4", "2 2\n3 -3\n4 4", "service time is negative", 26),
        ("VEHICLES : 3", "SERVICE_TIME : 3", "SERVICE_TIME stands beside a SERVICE_TIME_SECTION", 7),
    ],
)
def test_a_fault_of_the_extensions_is_refused_with_its_line(old: str, new: str, message: str, line: int, refusal: Refusal) -> None:
    check_fault(refusal(cvrp(old, new, VRPTW)), message, line)


@pytest.mark.parametrize(
    ("numbers", "message", "line"),
    [
        ("1 2 3\n4 5", "wrong number of values for UPPER_ROW", 8),
        ("1 2 3\n4 5 6 7", "wrong number of values for UPPER_ROW", 8),
        ("1 2 3 4 5 6 7\n8", "wrong number of values for UPPER_ROW", 7),
        ("1 2 3\n4 -5 6", "distance is negative", 8),
        ("1 2 3\n4 1e999 6", "no finite number", 8),
    ],
)
def test_a_fault_of_a_matrix_is_refused_with_its_line(numbers: str, message: str, line: int, refusal: Refusal) -> None:
    check_fault(refusal(TSP.format(layout="UPPER_ROW", numbers=numbers)), message, line)


def test_a_huge_claim_about_a_matrix_is_compared_and_not_allocated(refusal: Refusal) -> None:
    error = refusal(TSP.format(layout="FULL_MATRIX", numbers="1 2 3").replace("DIMENSION: 4", "DIMENSION: 2000000000"))
    assert error.expected == "4000000000000000000 (DIMENSION 2000000000)"


def test_an_unknown_layout_is_refused(refusal: Refusal) -> None:
    assert "EDGE_WEIGHT_FORMAT 'SPIRAL' is not supported" in refusal(TSP.format(layout="SPIRAL", numbers="1")).message


@pytest.mark.parametrize("extra", ["CAPACITY: 5", "DISTANCE: 2"])
def test_a_tsp_with_headers_of_a_vrp_is_refused(extra: str, refusal: Refusal) -> None:
    text = TSP.format(layout="UPPER_ROW", numbers="1 2 3 4 5 6").replace("DIMENSION", f"{extra}\nDIMENSION")
    assert "in a file of TYPE TSP" in refusal(text).message


def test_every_cut_of_a_file_is_refused(tmp_path: Path) -> None:
    """Whatever the length of the rest: only EOF may be missing."""
    complete = CVRP.index("-1") + 3
    for length in range(20, complete):
        with pytest.raises(InputError):
            read(CVRP[:length], tmp_path / "x.vrp")
    assert len(read(CVRP[:complete], tmp_path / "x.vrp").sites) == 4


def test_every_cut_of_a_tsp_is_refused(tmp_path: Path) -> None:
    text = "NAME: t\nTYPE: TSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 10 10\n2 20 20\n3 30 30.25\nEOF\n"
    for length in [*range(10, text.index("EOF")), text.index("EOF") + 1, text.index("EOF") + 2]:
        if length != text.index("EOF"):
            with pytest.raises(InputError):
                read(text[:length], tmp_path / "x.tsp")
    assert len(read(text[: text.index("EOF")], tmp_path / "x.tsp").sites) == 3


def test_a_tour_file_is_named_as_what_it_is(refusal: Refusal) -> None:
    assert refusal("NAME: t\nTYPE: TOUR\nDIMENSION: 2\nTOUR_SECTION\n1\n2\n-1\n").code == "foreign"


def test_recognition_needs_a_keyword_at_the_start_of_a_line() -> None:
    assert recognises(CVRP)
    assert recognises("DIMENSION: 5")
    assert not recognises("the DIMENSION: 5")
    assert not recognises('{"DIMENSION": 5}')


def written(made: Any) -> Any:
    return read(write(made), Path("x.vrp"))


@pytest.mark.parametrize("text", [CVRP, VRPTW, TSP.format(layout="UPPER_ROW", numbers="1 2 3 4 5 6.5"), OP, VRPSPD])
def test_what_is_written_reads_back_the_same(text: str, read_text_as: Read, differences: Differences) -> None:
    made = read_text_as(text)
    assert differences(made, written(made)) == []


def test_generated_instances_read_back_the_same(differences: Differences) -> None:
    made = generate("uchoa", 3, customers=30)
    assert differences(made, written(made)) == []


def test_a_written_name_does_not_limit_the_fleet_by_accident(read_text_as: Read) -> None:
    made = read_text_as(cvrp("NAME : small", "NAME : A-n4-k2"))
    unlimited = replace(made, fleet=(replace(made.fleet[0], count=None),))
    check_refused(UsageError, "would be read as a limit", write, unlimited)
    assert written(made).fleet[0].count == 2


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    CVRP,
    (lambda i: replace(i, travel=i.travel.with_convention("exact")), "its convention is exact"),
    (lambda i: replace(i, sites=replace(i.sites, ids=("a", "b", "c", "d"))), "nodes must be numbered"),
    (lambda i: replace(i, fleet=(VehicleType(None, math.inf),)), "needs a capacity"),
    (lambda i: replace(i, fleet=(VehicleType(None, 10.0, fixed_cost=5.0),)), "no place for fixed-cost"),
    (lambda i: replace(i, name="a\nb"), "its name is no single line"),
)
