"""Several depots, vehicles that differ and prizes in VRPLIB files; files without TYPE. PyVRP's reader is the reference."""

from pathlib import Path

import numpy as np
import pytest
from file_cases import Refusal, refused, tsplib

import waybound as wb
from waybound.instances.errors import InputError

HEAD = """NAME : tiny
DIMENSION : 6
EDGE_WEIGHT_TYPE : EUC_2D
CAPACITY : 10
"""
PLACES = tsplib(
    NODE_COORD_SECTION="1 0 0|2 10 0|3 1 2|4 2 1|5 9 2|6 8 1", DEMAND_SECTION="1 0|2 0|3 4|4 4|5 4|6 4", DEPOT_SECTION="1|2|-1",
    VEHICLES_DEPOT_SECTION="1 1|2 2|3 2",
)  # fmt: skip
PRIZES = "PRIZE_SECTION\n1 0\n2 0\n3 0\n4 0\n5 1\n6 30\n"
MIXED = (HEAD.replace("CAPACITY : 10\n", "VEHICLES_UNIT_DISTANCE_COST : 2\n") + PLACES
         + "CAPACITY_SECTION\n1 10\n2 4\n3 8\nVEHICLES_FIXED_COST_SECTION\n1 7\n2 1\n3 1\n")  # fmt: skip

SERVED = (HEAD + PLACES.split("DEPOT_SECTION")[0].replace("2 0\n3 4", "2 3\n3 4").replace("6 4\n", "6 0\n") + "DEPOT_SECTION\n1\n-1\n"
          "BACKHAUL_SECTION\n1 0\n2 0\n3 0\n4 0\n5 0\n6 7\n")  # fmt: skip
BACKHAULS = "TYPE : VRPB\n" + SERVED.replace("5 4\n6 0\nDEPOT", "5 0\n6 0\nDEPOT").replace("5 0\n6 7", "5 6\n6 7")
FLEET = "CAPACITIES\n10 15\nFIXED_COSTS\n3 5\nVARIABLE_COSTS\n1.0 1.5\nNUMBER_OF_VEHICLES\n2 1\n"
KINDS = (HEAD.replace("CAPACITY : 10\n", "TYPE : HFVRP\nVEHICLE_KINDS : 2\n" + FLEET)
         + PLACES.split("DEPOT_SECTION")[0] + "DEPOT_SECTION\n1\n-1\nEOF\n")  # fmt: skip


def read(tmp_path: Path, text: str) -> wb.RoutingProblem:
    path = tmp_path / "tiny.vrp"
    path.write_text(text)
    made = wb.read(path)
    assert isinstance(made, wb.RoutingProblem)
    return made


@pytest.mark.parametrize("text", [HEAD + PLACES, HEAD + PLACES + PRIZES, MIXED, "TYPE : MDVRP\n" + HEAD + PLACES, SERVED, BACKHAULS])
def test_the_optimum_is_what_pyvrp_finds_in_its_own_reading(tmp_path: Path, text: str) -> None:
    import pyvrp

    problem = read(tmp_path, text.replace("DIMENSION", "VEHICLES : 3\nDIMENSION"))
    solution = wb.solve(problem, "highs", form="three-index", bound_time=0.0)
    own = pyvrp.solve(pyvrp.read(tmp_path / "tiny.vrp", "round"), pyvrp.stop.MaxIterations(200), seed=1, display=False)
    assert solution.status == "optimal" and solution.objective == own.cost()


def test_vehicles_that_are_alike_are_one_type(tmp_path: Path) -> None:
    told = [(v.name, v.count, v.start, v.end, v.capacity) for v in read(tmp_path, HEAD + PLACES).fleet]
    assert told == [("type 1", 1, 0, 0, 10), ("type 2", 2, 1, 1, 10)]
    fleet = read(tmp_path, MIXED.replace("DIMENSION", "DISTANCE : 40\nDIMENSION")).fleet
    limits = [(v.count, v.capacity, v.fixed_cost, v.unit_cost, v.max_duration) for v in fleet]
    assert limits == [(1, 10, 7, 2, 40), (1, 4, 1, 2, 40), (1, 8, 1, 2, 40)]


def test_prizes_are_missed_where_a_customer_is_left_out(tmp_path: Path) -> None:
    problem = read(tmp_path, HEAD + PLACES + PRIZES)
    assert str(problem.objective) == "total-cost + penalties" and problem.sites.penalty.tolist() == [0, 0, 0, 0, 1, 30]
    assert problem.sites.required.tolist() == [False, False, True, True, False, False]
    assert any("prize" in note for note in problem.notes) and any("no TYPE" in note for note in problem.notes)


@pytest.mark.parametrize(
    ("drop", "problem"),
    [(("DEMAND_SECTION", "DEPOT_SECTION", "VEHICLES_DEPOT_SECTION", "CAPACITY"), "tsp"), (("VEHICLES_DEPOT_SECTION",), "cvrp")],
)
def test_a_file_without_type_is_what_it_holds(tmp_path: Path, drop: tuple[str, ...], problem: str) -> None:
    text = (HEAD + PLACES).replace("\n2\n-1", "\n-1")
    for name in drop:
        at = text.index(name)
        rest = text[at:].split("\n")
        kept = next((k for k, line in enumerate(rest[1:], start=1) if line[:1].isalpha()), len(rest))
        text = text[:at] + "\n".join(rest[kept:])
    assert read(tmp_path, text).problem == problem


def test_several_salesmen(tmp_path: Path) -> None:
    text = "NAME : team\nTYPE : TSP\nVEHICLES : 2\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 3 4\n3 6 8\nEOF\n"
    made = read(tmp_path, text)
    assert made.vehicle_limit == 2 and made.problem == "min-cost-vrp"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("3 2\n", "3 5\n", "VEHICLES_DEPOT_SECTION names a node that is no depot; expected 1, 2; found 5.0"),
        ("VEHICLES_DEPOT_SECTION\n1 1\n2 2\n3 2\n", "", "there are 2 depots, and nothing says where vehicles start"),
        ("CAPACITY : 10", "CAPACITY : 10\nVEHICLES : 2", "VEHICLES_DEPOT_SECTION has a wrong number of rows"),
        ("CAPACITY : 10", "CAPACITY : 10\nVEHICLES_FIXED_COST : -1", "VEHICLES_FIXED_COST is negative"),
        ("VEHICLES_DEPOT", "CAPACITY_SECTION\n1 1\n2 1\n3 1\nVEHICLES_DEPOT", "CAPACITY stands beside a CAPACITY_SECTION"),
        ("VEHICLES_DEPOT", "PRIZE_SECTION\n1 1\n2 0\n3 0\n4 0\n5 0\n6 0\nVEHICLES_DEPOT", "a depot has a prize"),
        ("VEHICLES_DEPOT", "PRIZE_SECTION\n1 0\n2 0\n3 -4\n4 0\n5 0\n6 0\nVEHICLES_DEPOT", "prize is negative"),
        ("VEHICLES_DEPOT", "RELEASE_TIME_SECTION\n1 0\nVEHICLES_DEPOT", "RELEASE_TIME_SECTION is not supported"),
    ],
)
def test_a_fault_is_refused(refusal: Refusal, old: str, new: str, message: str) -> None:
    assert message in str(refusal((HEAD + PLACES).replace(old, new)))


def test_backhauls_are_pickups_and_come_last_where_the_type_says_so(tmp_path: Path) -> None:
    mixed, late = read(tmp_path, SERVED), read(tmp_path, BACKHAULS)
    assert mixed.sites.pickup.tolist() == [0, 0, 0, 0, 0, 7] and mixed.forbidden is None
    assert late.sites.pickup.tolist() == [0, 0, 0, 0, 6, 7] and late.forbidden is not None
    assert [tuple(move) for move in np.argwhere(late.forbidden).tolist()] == [
        (0, 4), (0, 5), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 3),
    ]  # fmt: skip
    assert any("from the depot to a backhaul" in note for note in late.notes)
    same = read(tmp_path, BACKHAULS.replace("DEMAND_SECTION", "LINEHAUL_SECTION"))
    assert same.digest() == late.digest()


RELOADS = (HEAD + "VEHICLES : 3\nVEHICLES_MAX_RELOADS : 2\n" + PLACES.split("VEHICLES_DEPOT")[0].replace("6 4\n", "6 9\n")
           + "VEHICLES_DEPOT_SECTION\n1 1\n2 1\n3 2\nVEHICLES_RELOAD_DEPOT_SECTION\n1 1 2\n2 1 2\n3\n"
           "VEHICLES_ALLOWED_CLIENTS_SECTION\n1 3 4 5 6\n2 3 4 5 6\n3 5 6\n"
           "MUTUALLY_EXCLUSIVE_GROUP_SECTION\n1 3 5\n2 4\nEOF\n")  # fmt: skip


def test_reloads_allowed_clients_and_groups_are_those_that_pyvrp_reads(tmp_path: Path) -> None:
    import pyvrp

    made = read(tmp_path, RELOADS)
    assert [(v.count, v.start, v.reloads, v.max_reloads, v.skills) for v in made.fleet] == [
        (2, 0, (0, 1), 2, {"as node 3"}), (1, 1, (), None, set()),
    ]  # fmt: skip
    assert [(g.sites, g.required) for g in made.sites.groups] == [((2, 4), True)]
    assert made.sites.skills == (set(), set(), {"as node 3"}, {"as node 3"}, set(), set())
    assert made.sites.required.tolist() == [False, False, False, True, False, True]
    theirs = pyvrp.read(tmp_path / "tiny.vrp", round_func="exact")
    assert [(t.num_available, t.start_depot, tuple(t.reload_depots)) for t in theirs.vehicle_types()] == [(2, 0, (0, 1)), (1, 1, ())]
    best = pyvrp.solve(theirs, pyvrp.stop.MaxIterations(50), display=False).best
    ours = wb.solve(wb.read(tmp_path / "tiny.vrp", convention="exact"), "pyvrp", iterations=50, bound_time=0)
    assert best.is_feasible() and ours.objective == pytest.approx(best.distance() / 1000, abs=0.01)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1 1 2\n2 1", "1 1 3\n2 1", "VEHICLES_RELOAD_DEPOT_SECTION names a node that is no depot; expected 1, 2; found 3"),
        ("1 1 2\n2 1 2\n3\n", "1 1 2\n2\n", "VEHICLES_RELOAD_DEPOT_SECTION has a wrong number of rows; expected 3; found 2"),
        ("3 5 6\nM", "M", "VEHICLES_ALLOWED_CLIENTS_SECTION has a wrong number of rows; expected 3; found 2"),
        ("3 5 6\nM", "4 5 6\nM", "VEHICLES_ALLOWED_CLIENTS_SECTION has a row of a wrong number; expected each of 1 to 3 once; found 4"),
        ("3 5 6\nM", "3 5 9\nM", "VEHICLES_ALLOWED_CLIENTS_SECTION names a node that does not exist; found 9"),
        ("1 3 5\n2 4", "1 3 1\n2 4", "MUTUALLY_EXCLUSIVE_GROUP_SECTION names a node that is a depot; found 1"),
        ("1 3 5\n2 4", "1 3 3\n2 4", "MUTUALLY_EXCLUSIVE_GROUP_SECTION names a node twice in a row; found 3"),
        ("1 3 5\n2 4", "1 3 5\n2 4 3", ":39: site 3 is in two groups, the other in line 38"),
        ("MUTUALLY", PRIZES.replace("3 0", "3 9") + "MUTUALLY", ":45: site 3 of a group has a prize of its own; expected 0; found 9"),
        ("RELOADS : 2", "RELOADS : 1.5", ":6: VEHICLES_MAX_RELOADS must be a whole number"),
        ("RELOADS : 2", "RELOADS : 1e300", ":6: VEHICLES_MAX_RELOADS must be a whole number; expected 0 or more; found '1e+300'"),
    ],
)
def test_a_fault_of_reloads_allowed_clients_and_groups_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in RELOADS
    with pytest.raises(InputError) as caught:
        read(tmp_path, RELOADS.replace(old, new))
    assert message in str(caught.value) and str(tmp_path) in str(caught.value)


@pytest.mark.parametrize("more", ["", "MUTUALLY_EXCLUSIVE_GROUP_SECTION\n1 3 5\n", PRIZES])
def test_the_fleet_of_the_name_is_kept_beside_groups_and_prizes(tmp_path: Path, more: str) -> None:
    text = HEAD.replace("tiny", "A-n6-k2") + PLACES.split("VEHICLES_DEPOT")[0].replace("\n2\n-1", "\n-1") + more
    made = read(tmp_path, text)
    assert made.vehicle_limit == 2 and any("A-n6-k2" in note for note in made.notes)


def test_mixed_fleets_by_kind(tmp_path: Path) -> None:
    made = read(tmp_path, KINDS)
    told = [(v.name, v.count, v.capacity, v.fixed_cost, v.unit_cost) for v in made.fleet]
    assert told == [("type 1", 2, 10, 3, 1), ("type 2", 1, 15, 5, 1.5)] and made.travel.metric == "EUC_2D"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (KINDS.replace("10 15", "10"), "CAPACITIES has a wrong length; expected 2 (VEHICLE_KINDS); found 1"),
        (KINDS.replace("3 5\n", "3 -5\n"), "FIXED_COSTS holds a negative value"),
        (KINDS.replace("2 1\nNODE", "2 0\nNODE"), "NUMBER_OF_VEHICLES must be a whole number"),
        (KINDS.replace("VEHICLE_KINDS : 2\n", ""), "header VEHICLE_KINDS is missing"),
        (KINDS.replace("VARIABLE_COSTS\n1.0 1.5\n", ""), "VARIABLE_COSTS is missing"),
        (KINDS.replace("VEHICLE_KINDS", "VEHICLES : 3\nVEHICLE_KINDS"), "VEHICLE_KINDS has one depot and no VEHICLES beside it"),
        (BACKHAULS.replace("5 6\n", "5 -6\n"), "backhaul is negative"),
        (BACKHAULS.replace("SECTION\n1 0\n2 0\n3 0\n4 0\n5 6", "SECTION\n1 2\n2 0\n3 0\n4 0\n5 6"), "a depot has a backhaul"),
        (SERVED.replace("BACKHAUL_", "RELEASE_TIME_"), "RELEASE_TIME_SECTION is not supported"),
    ],
)
def test_a_fault_of_kinds_and_backhauls_is_refused(tmp_path: Path, text: str, message: str) -> None:
    assert message in refused(read, tmp_path, text)
