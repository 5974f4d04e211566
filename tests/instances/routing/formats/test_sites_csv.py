"""Sites from CSV."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import InputError, UsageError
from waybound.instances.generating import generate
from waybound.instances.routing.formats.sites_csv import read, recognises, write
from waybound.instances.routing.instance import VehicleType
from waybound.instances.routing.travel import Travel

GOOD = """\
# Deliveries of a Monday, without a colon a remark
# vehicles: 2
# capacity: 10
id,x,y,demand,ready,due,service
yard,0,0,0,0,50,0
"a, b",3,4,5,2,30,1
c,6,8,,,,
"""


def csv(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new, 1)


def test_everything_in_the_file_is_read(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as(GOOD, "monday.csv")
    assert (made.name, made.format, made.problem, made.problems) == (
        "monday",
        "csv",
        "vrptw",
        ("vrptw", "min-cost-vrp", "min-makespan-vrp"),
    )
    assert made.fleet == (VehicleType(2, 10.0),)
    assert made.sites.ids == ("yard", "a, b", "c")
    assert made.sites.demand.tolist() == [0, 5, 0]
    assert made.sites.due.tolist() == [50, 30, math.inf]
    assert made.travel.distance(1, 2) == 5


@pytest.mark.parametrize("delimiter", [";", "\t", "|"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_delimiters_and_line_ends_are_found(delimiter: str, ends: str, read_text_as: Callable[..., Any]) -> None:
    text = GOOD.replace('"a, b"', "a").replace(",", delimiter).replace("\n", ends)
    assert read_text_as(text).sites.ids == ("yard", "a", "c")


def test_coordinates_alone_are_enough(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as("x,y\n0,0\n3,4\n")
    assert (made.problem, made.sites.ids, made.fleet) == ("min-cost-vrp", ("0", "1"), (VehicleType(),))


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ("# vehicles: 1", "tsp"),
        ("# capacity: 5", "cvrp"),
        ("# vehicles: 1\n# max-duration: 99", "min-cost-vrp"),
        ("# problem: min-cost-vrp", "min-cost-vrp"),
    ],
)
def test_the_problem_follows_from_the_data_or_is_named(settings: str, problem: str, read_text_as: Callable[..., Any]) -> None:
    assert read_text_as(f"{settings}\nx,y\n0,0\n3,4\n").problem == problem


def test_every_setting_is_read(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as(
        "# name: all of it\n# metric: EUC_2D\n# convention: ceil\n# vehicles: 3\n# min-vehicles: 2\n# capacity: 4.5\n# max_duration: 90\n"
        "# max-distance: 80\n# fixed-cost: 7\n# unit-cost: 0.5\nx,y,reward,required,depot\n1,1,0,,no\n0,0,0,no,YES\n2,2,5,false,0\n"
    )
    assert (made.name, made.travel.metric, made.travel.convention, made.min_vehicles) == ("all of it", "EUC_2D", "ceil", 2)
    assert made.fleet == (VehicleType(3, 4.5, 1, 1, max_duration=90, max_distance=80, fixed_cost=7, unit_cost=0.5),)
    assert made.sites.required.tolist() == [True, False, False]
    assert made.sites.reward.tolist() == [0, 0, 5]


def test_several_depots_have_a_fleet_each(read_text_as: Callable[..., Any]) -> None:
    made = read_text_as("# vehicles: 2\nid,x,y,depot\nd,0,0,1\na,1,1,0\ne,2,2,1\n")
    assert [(v.name, v.count, v.start, v.end) for v in made.fleet] == [("vehicle at d", 2, 0, 0), ("vehicle at e", 2, 2, 2)]
    assert made.notes == ("2 vehicles at each of 2 depots",)
    assert made.problems == ("min-cost-vrp", "mdvrp", "min-makespan-vrp")


def test_a_matrix_comes_from_a_file_beside_it(tmp_path: Path, read_text_as: Callable[..., Any]) -> None:
    (tmp_path / "roads").mkdir()
    (tmp_path / "roads" / "m.csv").write_text("0,1,2\n3,0,4\n5,6,0\n")
    (tmp_path / "t.txt").write_text("0 10 20\n30 0 40\n50 60 0\n")
    made = read_text_as("# matrix: roads/m.csv\n# durations: t.txt\nid,demand\nd,0\na,1\nb,1\n")
    assert made.travel.distances.tolist() == [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
    assert made.travel.duration(2, 1) == 60
    assert made.sites.coordinates is None


@pytest.mark.parametrize(
    ("matrix", "message", "line"),
    [
        (None, "matrix 'm.csv' no such file", 1),
        ("0,1\n1,0\n", "matrix has a wrong number of rows; expected 3; found 2", 2),
        ("0,1,2\n1,0\n1,1,0\n", "row of the matrix has a wrong length; expected 3; found 2", 2),
        ("0,1,2\n1,0,x\n1,1,0\n", "no finite number", 2),
        ("0,1,2\n1,0,\n1,1,0\n", "no finite number", 2),
        ("0,1,2\n1,0,2\n1,-1,0\n", "distance is negative", 3),
    ],
)
def test_a_fault_of_a_matrix_is_refused_with_its_place(matrix: str | None, message: str, line: int, tmp_path: Path) -> None:
    path = tmp_path / "sites.csv"
    path.write_text("# matrix: m.csv\nid,demand\nd,0\na,1\nb,1\n")
    if matrix is not None:
        (tmp_path / "m.csv").write_text(matrix)
    with pytest.raises(InputError, match=message) as caught:
        read(path.read_text(), path)
    assert caught.value.line == line
    assert matrix is None or caught.value.file == tmp_path / "m.csv"


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("# vehicles: 2", "# vehicles: 0", "vehicles must be a whole number", 2),
        ("# vehicles: 2", "# vehicles:", "setting vehicles has no value", 2),
        ("# vehicles: 2", "# trucks: 2", "setting 'trucks' is unknown", 2),
        ("# vehicles: 2", "# capacity: 2", "setting capacity stands twice, first in line 2", 3),
        ("# capacity: 10", "# capacity: nan", "capacity must be a finite number", 3),
        ("# capacity: 10", "# capacity: 0", "capacity must be positive", 3),
        ("# capacity: 10", "# unit-cost: -1", "unit-cost is negative", 3),
        ("# capacity: 10", "# metric: EUC_9D", "metric 'EUC_9D' is unknown", 3),
        ("# capacity: 10", "# convention: half", "unknown convention 'half'", 3),
        ("# capacity: 10", "# problem: tsp", "the data do not allow the problem 'tsp'", 3),
        ("id,x,y,demand", "id,x,y,dmand", "column 'dmand' is unknown", 4),
        ("id,x,y,demand", "id,x,y,y", "column y stands twice", 4),
        ("id,x,y,demand", "id,x,reward,demand", "coordinates need two columns", 4),
        ("yard,0,0", "yard,0,", "y must be a finite number", 5),
        ("yard,0,0", "yard,0,1_0", "y must be a finite number", 5),
        ("3,4,5", "3,4,-5", "demand is negative", 6),
        ("3,4,5,2,30", "3,4,5,32,30", "time window closes before it opens", 6),
        ("3,4,5,2,30", "3,4,5,0,4", "no vehicle can reach customer a, b", 6),
        ("c,6,8,,,,", "c,6,8,,,", "row has a wrong length", 7),
        ("c,6,8,,,,", "yard,6,8,,,,", "id 'yard' stands already in line 5", 7),
        ("c,6,8,,,,", ",6,8,,,,", "id is empty", 7),
        ('"a, b"', '"a, b', "is no CSV|wrong length", None),
    ],
)
def test_a_fault_is_refused_with_its_line(old: str, new: str, message: str, line: int | None, refusal: Callable[..., InputError]) -> None:
    error = refusal(csv(old, new))
    assert any(part in error.message for part in message.split("|"))
    if line is not None:
        assert error.line == line


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("id,x,y\n", "holds no sites"),
        ("id,x,y\nd,0,0\n", "there is no customer"),
        ("id,demand\nd,0\na,1\n", "neither coordinates nor a matrix"),
        ("id,x,y,depot\nd,0,0,no\na,1,1,no\n", "no row is marked as depot"),
        ("id,x,y,depot\nd,0,0,maybe\na,1,1,no\n", "depot must be true or false"),
    ],
)
def test_a_table_that_is_no_instance_is_refused(text: str, message: str, refusal: Callable[..., InputError]) -> None:
    assert message in refusal(text).message


def test_recognition_looks_at_the_titles() -> None:
    assert recognises(GOOD)
    assert recognises("X;Y;Demand\n")
    assert recognises('"id"\t"x"\n')
    assert not recognises("id\n1\n")
    assert not recognises("a,b,c\n")
    assert not recognises("# only: comments\n")


def written(made: Any) -> Any:
    return read(write(made), Path(f"{made.name}.csv"))


def test_what_is_written_reads_back_the_same(read_text_as: Callable[..., Any], differences: Callable[..., list[str]]) -> None:
    for text in (GOOD, "# vehicles: 2\n# unit-cost: 0\nid,x,y,depot,required\nd,0,0,1,\na,0.1,1e-7,0,no\ne,2,2,1,\n"):
        made = read_text_as(text)
        assert differences(made, written(made)) == []


@pytest.mark.parametrize(
    ("kind", "settings"), [("random", {"windows": True, "service": 9}), ("uchoa", {"customers": 12}), ("solomon", {"customers": 9})]
)
def test_generated_instances_read_back_the_same(kind: str, settings: dict[str, Any], differences: Callable[..., list[str]]) -> None:
    made = generate(kind, 3, **settings)
    assert differences(made, replace(written(made), problems=made.problems)) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i: replace(i, fleet=(VehicleType(2, 10.0, name="van"),)), "vehicles that differ"),
        (lambda i: replace(i, travel=Travel("EXPLICIT", matrix=i.travel.distances)), "do not follow from its coordinates"),
        (lambda i: replace(i, objective=("vehicles",)), "no place for objective"),
        (lambda i: replace(i, travel=replace(i.travel, variances=np.ones((3, 3)))), "no place for uncertain-durations"),
        (lambda i: replace(i, team_risk=0.1), "no place for team-risk"),
        (lambda i: replace(i, sites=replace(i.sites, pickup=np.array([0.0, 1.0, 0.0]))), "no place for pickups"),
    ],
)
def test_what_the_format_cannot_express_is_refused(change: Callable[[Any], Any], message: str, read_text_as: Callable[..., Any]) -> None:
    with pytest.raises(UsageError, match=message):
        write(change(read_text_as(GOOD)))
