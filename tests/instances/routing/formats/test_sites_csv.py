import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import coded
from file_cases import Differences, Read, Refusal, unwritable

import waybound as wb
from waybound import InputError, Travel, UsageError
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.routing.formats.sites_csv import read, recognises, write
from waybound.instances.routing.frames import instance_from_frame
from waybound.instances.routing.instance import Clock, VehicleType

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


def test_everything_in_the_file_is_read(read_text_as: Read) -> None:
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
def test_delimiters_and_line_ends_are_found(delimiter: str, ends: str, read_text_as: Read) -> None:
    text = GOOD.replace('"a, b"', "a").replace(",", delimiter).replace("\n", ends)
    assert read_text_as(text).sites.ids == ("yard", "a", "c")


def test_coordinates_alone_are_enough(read_text_as: Read) -> None:
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
def test_the_problem_follows_from_the_data_or_is_named(settings: str, problem: str, read_text_as: Read) -> None:
    assert read_text_as(f"{settings}\nx,y\n0,0\n3,4\n").problem == problem


def test_every_setting_is_read(read_text_as: Read) -> None:
    made = read_text_as(
        "# name: all of it\n# metric: EUC_2D\n# convention: ceil\n# vehicles: 3\n# min-vehicles: 2\n# capacity: 4.5\n# max_duration: 90\n"
        "# max-distance: 80\n# fixed-cost: 7\n# unit-cost: 0.5\nx,y,reward,required,depot\n1,1,0,,no\n0,0,0,no,YES\n2,2,5,false,0\n"
    )
    assert (made.name, made.travel.metric, made.travel.convention, made.min_vehicles) == ("all of it", "EUC_2D", "ceil", 2)
    assert made.fleet == (VehicleType(3, 4.5, 1, 1, max_duration=90, max_distance=80, fixed_cost=7, unit_cost=0.5),)
    assert made.sites.required.tolist() == [True, False, False]
    assert made.sites.reward.tolist() == [0, 0, 5]


def test_several_depots_have_a_fleet_each(read_text_as: Read) -> None:
    made = read_text_as("# vehicles: 2\nid,x,y,depot\nd,0,0,1\na,1,1,0\ne,2,2,1\n")
    assert [(v.name, v.count, v.start, v.end) for v in made.fleet] == [("vehicle at d", 2, 0, 0), ("vehicle at e", 2, 2, 2)]
    assert made.notes == ("2 vehicles at each of 2 depots",)
    assert made.problems == ("min-cost-vrp", "mdvrp", "min-makespan-vrp")


def test_a_matrix_comes_from_a_file_beside_it(tmp_path: Path, read_text_as: Read) -> None:
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
def test_a_fault_is_refused_with_its_line(old: str, new: str, message: str, line: int | None, refusal: Refusal) -> None:
    error = refusal(csv(old, new))
    assert any(part in error.message for part in message.split("|"))
    if line is not None:
        assert error.line == line


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("id,x,y\n", "holds no sites"),
        ("id,x,y\nd,0,0\n", "there is no customer"),
        ("id,demand\nd,0\na,1\n", "neither coordinates nor distances"),
        ("id,x,y,depot\nd,0,0,no\na,1,1,no\n", "no row is marked as depot"),
        ("id,x,y,depot\nd,0,0,maybe\na,1,1,no\n", "depot must be true or false"),
    ],
)
def test_a_table_that_is_no_instance_is_refused(text: str, message: str, refusal: Refusal) -> None:
    assert message in refusal(text).message


PEOPLE = """\
Name,Latitude,longitude,crates,ready,due,service,phone,stars
Yard,45.81,15.98,,07:00,18:00,,-,
Graz,47.07,15.44,4,2026-05-04T08:00,2026-05-04 12:30:00,0 days 00:20:00,007,4
Rijeka,45.33,14.44,2,,,1h 5min,,5
"""


def test_a_table_as_people_have_it_is_read_as_a_frame_is(read_text_as: Read, differences: Differences) -> None:
    """The same sites as a pandas frame, given to ``from_frame``, and as text with ``--set``."""
    day = pd.Timestamp("2026-05-04")
    frame = pd.DataFrame(
        {
            "Name": ["Yard", "Graz", "Rijeka"], "Latitude": [45.81, 47.07, 45.33], "longitude": [15.98, 15.44, 14.44], "crates": [0, 4, 2],
            "ready": [day + pd.Timedelta("7h"), day + pd.Timedelta("8h"), pd.NaT], "service": pd.to_timedelta([0, 20, 65], unit="min"),
            "due": [day + pd.Timedelta("18h"), day + pd.Timedelta("12.5h"), pd.NaT], "phone": ["-", "007", None], "stars": [None, 4, 5],
        }
    )  # fmt: skip
    given = {"columns": {"demand": "crates"}, "capacity": 5, "vehicles": 2, "speed": 70, "time_unit": "min", "distance_unit": "mi"}
    meant = instance_from_frame(frame, **given, max_duration=pd.Timedelta("9h"), name="people", source="csv")
    texts = {"columns": "demand=crates", "capacity": 5, "vehicles": 2, "speed": 70, "time-unit": "min", "distance-unit": "mi"}
    made = read_text_as(PEOPLE, "people.csv", settings={**texts, "max-duration": "9h"})
    assert differences(made, meant) == [] and made.clock == meant.clock
    assert dict(made.sites.attributes) == {"phone": ("-", "007", None), "stars": (None, 4, 5)}
    lines = "".join(f"# {key}: {value}\n" for key, value in {**texts, "max-duration": "09:00:00"}.items())
    assert differences(read_text_as(lines + PEOPLE, "people.csv"), meant) == []


def test_settings_of_the_caller_go_before_those_of_the_file_and_are_taken(read_text_as: Read) -> None:
    settings = {"vehicles": 7, "customers": 1}
    assert read_text_as(GOOD, settings=settings).fleet == (VehicleType(7, 10.0),) and settings == {"customers": 1}


def test_a_fleet_and_a_table_of_a_service_come_from_files(tmp_path: Path, read_text_as: Read) -> None:
    (tmp_path / "fleet.csv").write_text(
        "name,count,capacity,shift_start,shift_end,max_duration,skills\nvan,2,6,08:00,16:00,6h,\ntruck,unlimited,14,,,,cold\n"
    )
    table = {"code": "Ok", "distances": [[0, 5200], [5300, 0]], "durations": [[0, 480], [500, 0]]}
    (tmp_path / "t.json").write_text(json.dumps(table))
    made = read_text_as("# fleet: fleet.csv\n# matrix: t.json\n# time-unit: min\nid,service\nhub,\nnorth,15\n")
    van, truck = made.fleet
    assert (van.count, van.capacity, van.shift, van.max_duration) == (2, 6, (480, 960), 360)
    assert (truck.name, truck.count, truck.capacity, truck.skills) == ("truck", None, 14, {"cold"})
    assert (made.travel.distance(0, 1), made.travel.duration(0, 1)) == (5.2, 8)
    with pytest.raises(InputError, check=coded("contradiction")):
        read_text_as("# fleet: fleet.csv\n# capacity: 3\nid,x,y\nhub,0,0\na,1,1\n")


def test_inf_in_a_matrix_is_a_move_that_cannot_be_made(tmp_path: Path, read_text_as: Read) -> None:
    (tmp_path / "m.csv").write_text("0,1,2\ninf,0,4\n5,6,0\n")
    made = read_text_as("# matrix: m.csv\nid,demand\nd,0\na,1\nb,1\n")
    assert np.argwhere(made.forbidden).tolist() == [[1, 0]]


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        (PEOPLE, {}, "did you mean|column ready holds time"),
        (PEOPLE, {"time-unit": "min"}, "expected --set speed=50 (an hour), or --set durations=FILE"),
        (PEOPLE, {"speed": 50}, "expected --set time-unit=min"),
        (PEOPLE, {"speed": "fast"}, "speed must be a finite number"),
        (PEOPLE, {"time-unit": "fortnight"}, "unknown unit of time 'fortnight'"),
        (PEOPLE, {"columns": "crates"}, "columns must pair titles"),
        (PEOPLE, {"columns": "demand=boxes"}, "columns maps 'demand' to the column 'boxes', which is not there"),
        (PEOPLE.replace("08:00,", "8 o'clock,"), {"time-unit": "min"}, "ready must be a number or a moment; expected 480, 08:00"),
        (PEOPLE.replace("1h 5min", "1h 5 fur"), {"time-unit": "min"}, "service must be a number or a length of time; expected 20, 20min"),
        (PEOPLE.replace("crates", "demnd"), {}, "expected --set columns=demand=demnd to use it, --set extra=demnd to keep it only"),
        (PEOPLE.replace("crates", "demand").replace("stars", "demands"), {}, "columns 'demand' and 'demands' both tell demand"),
        (PEOPLE.replace("45.81", "145.81"), {"time-unit": "min", "speed": 9}, "latitude of site Yard is out of range"),
        (GOOD, {"fleet": "no.csv"}, "fleet 'no.csv' no such file"),
        (GOOD, {"matrix": "no.csv"}, "matrix 'no.csv' no such file"),
        (GOOD.replace("service", ""), {}, "column 7 has no title"),
    ],
)  # fmt: skip
def test_what_a_table_of_people_lacks_is_told_with_the_cure(text: str, settings: dict[str, Any], message: str, tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(text)
    with pytest.raises((InputError, UsageError)) as caught:
        read_instance(tmp_path / "s.csv", settings=dict(settings))
    assert any(part in str(caught.value) for part in message.split("|")) and "\n" not in str(caught.value)


@pytest.mark.parametrize("columns", [{"lat": "Latitude", "lon": "Longitude", "id": "Shop"}, {"Latitude": "lat"}, {"id": "Shop"}, None])
def test_columns_are_named_as_in_a_frame(columns: Any, tmp_path: Path) -> None:
    """As they stand in the file, whatever their case."""
    frame = pd.DataFrame({"Shop": ["h", "a"], "Latitude": [48.1, 48.2], "Longitude": [11.5, 11.6], "Demand": [0, 3]})
    frame.to_csv(tmp_path / "s.csv", index=False)
    read, made = wb.read(tmp_path / "s.csv", columns=columns, vehicles=1), wb.RoutingProblem.from_frame(frame, columns=columns, vehicles=1)
    assert read.sites.ids == made.sites.ids and read.digest() == made.digest() and read.sites.demand.tolist() == [0, 3]  # type: ignore[attr-defined]


def test_recognition_looks_at_the_titles() -> None:
    assert recognises("CUST NO.,XCOORD.,YCOORD.\n")
    assert recognises(GOOD)
    assert recognises("X;Y;Demand\n")
    assert recognises('"id"\t"x"\n')
    assert recognises("name,lat,lng\n") and recognises("name,lat\n")
    assert not recognises("id\n1\n")
    assert not recognises("a,b,c\n")
    assert not recognises("# only: comments\n")


def written(made: Any) -> Any:
    return read(write(made), Path(f"{made.name}.csv"))


def test_what_is_written_reads_back_the_same(read_text_as: Read, differences: Differences) -> None:
    for text in (
        GOOD,
        "# vehicles: 2\n# unit-cost: 0\nid,x,y,depot,required\nd,0,0,1,\na,0.1,1e-7,0,no\ne,2,2,1,\n",
        "# time-unit: h\n# distance-unit: mi\nname,lat,lon,demands of all,skill,code\nd,45,15,,,\na,46,16,3.5,some,007\n",
    ):
        made = read_text_as(text, settings={"extra": True})
        assert differences(made, written(made)) == [] and written(made).clock == made.clock


@pytest.mark.parametrize(
    ("kind", "settings"), [("random", {"windows": True, "service": 9}), ("uchoa", {"customers": 12}), ("solomon", {"customers": 9})]
)
def test_generated_instances_read_back_the_same(kind: str, settings: dict[str, Any], differences: Differences) -> None:
    made = generate(kind, 3, **settings)
    assert differences(made, replace(written(made), problems=made.problems)) == []


test_what_the_format_cannot_express_is_refused = unwritable(
    write,
    GOOD,
    (lambda i: replace(i, fleet=(VehicleType(2, 10.0, name="van"),)), "vehicles that differ"),
    (lambda i: replace(i, travel=Travel("EXPLICIT", matrix=i.travel.distances)), "do not follow from its coordinates"),
    (lambda i: replace(i, objective=("vehicles",)), "no place for objective"),
    (lambda i: replace(i, travel=replace(i.travel, variances=np.ones((3, 3)))), "no place for uncertain-durations"),
    (lambda i: replace(i, team_risk=0.1), "no place for team-risk"),
    (lambda i: replace(i, clock=Clock("min", "2026-05-04T00:00:00")), "its times are those of a calendar"),
    (lambda i: replace(i, sites=replace(i.sites, geographic=True)), "its distances are euclidean, and its coordinates angles"),
    (lambda i: replace(i, sites=replace(i.sites, attributes={"Demand": (1, 2, 3)})), "called as one that counts"),
    (lambda i: replace(i, sites=replace(i.sites, pickup=np.array([0.0, 1.0, 0.0]))), "no place for pickups"),
)
