import datetime
import math
import re
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sp
from coded import coded
from file_cases import check_refused, refused

import waybound as wb
from waybound import InputError, RoutingProblem
from waybound.instances.routing.frames import instance_from_frame

SITES = pd.DataFrame({"id": ["yard", "a", "b"], "x": [0, 3, 6], "y": [0, 4, 8], "demand": [0, 2, 3]})


def test_columns_become_sites() -> None:
    made = instance_from_frame(SITES, vehicles=2, capacity=4, name="f")
    assert (made.name, made.format, made.problem, made.problems) == ("f", "frame", "cvrp", ("cvrp", "min-cost-vrp", "min-makespan-vrp"))
    assert made.sites.ids == ("yard", "a", "b")
    assert made.sites.depots.tolist() == [0]
    assert (made.fleet[0].count, made.fleet[0].capacity) == (2, 4)
    assert made.travel.distance(0, 2) == 10


def test_the_index_gives_the_ids_and_every_column_is_used() -> None:
    frame = pd.DataFrame(
        {
            "x": [0.0, 1, 2], "y": [0, 0, 0], "ready": [0, 1, 2], "due": [9, 8, np.inf], "service": [0, 1, 1], "reward": [0, 5, 6],
            "required": [False, True, False], "depot": [0, 0, 1],
        },
        index=["p", "q", "r"],
    )  # fmt: skip
    made = instance_from_frame(frame, max_duration=30, convention="trunc1")
    assert made.sites.ids == ("p", "q", "r")
    assert made.sites.due.tolist() == [9, 8, math.inf]
    assert made.sites.required.tolist() == [False, True, False]
    assert made.sites.depots.tolist() == [2]
    assert made.problem == "vrptw"
    assert made.fleet[0].max_duration == 30
    assert made.travel.convention == "trunc1"


def test_one_vehicle_without_limits_is_a_tsp() -> None:
    assert instance_from_frame(SITES, vehicles=1).problem == "tsp"


def test_a_matrix_may_be_an_array_or_a_frame_in_another_order() -> None:
    d = np.array([[0, 1, 2], [3, 0, 4], [5, 6, 0]])
    plain = instance_from_frame(SITES, travel=d, durations=d * 10)
    assert plain.travel.duration(2, 1) == 60
    order = [2, 0, 1]
    ids = [["yard", "a", "b"][k] for k in order]
    mixed = instance_from_frame(SITES, travel=pd.DataFrame(d[np.ix_(order, order)], index=ids, columns=ids))
    assert np.array_equal(mixed.travel.distances, plain.travel.distances)
    assert np.array_equal(instance_from_frame(SITES, travel=pd.DataFrame(d)).travel.distances, plain.travel.distances)


def test_a_sparse_matrix_is_a_road_graph() -> None:
    roads = sp.csr_matrix(np.array([[0, 1, 9], [1, 0, 2], [9, 2, 0]]))
    made = instance_from_frame(SITES[["id", "demand"]], travel=roads)
    assert made.travel.distances.tolist() == [[0, 1, 3], [1, 0, 2], [3, 2, 0]]
    assert made.sites.coordinates is None


def test_a_road_of_length_0_is_a_road() -> None:
    """Dense graph routines take 0 for no road; a sparse matrix that stores it says that there is one."""
    stored = sp.csr_matrix((np.array([0.0, 0.0, 2.0, 2.0]), ([0, 1, 1, 2], [1, 0, 2, 1])), shape=(3, 3))
    made = instance_from_frame(SITES[["id", "demand"]], travel=stored)
    assert made.travel.distances.tolist() == [[0, 0, 2], [0, 0, 2], [2, 2, 0]]


def test_roads_of_one_way_count_one_way() -> None:
    made = instance_from_frame(SITES, travel=sp.coo_matrix(np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])))
    assert made.travel.distances.tolist() == [[0, 1, 2], [2, 0, 1], [1, 2, 0]]


def test_a_pair_without_a_path_is_named() -> None:
    with pytest.raises(InputError, match="no path leads from site yard to site b"):
        instance_from_frame(SITES, travel=sp.csr_matrix(np.array([[0, 1, 0], [1, 0, 0], [0, 1, 0]])))


@pytest.mark.parametrize(
    ("frame", "options", "message"),
    [
        (SITES.iloc[:0], {}, "the frame has no rows"),
        (SITES.rename(columns={"demand": "dmand"}), {}, "column 'dmand' is unknown"),
        (SITES.assign(demand=[0, "two", 3]), {}, "column demand must hold numbers"),
        (SITES.assign(demand=[0, np.nan, 3]), {}, "demand of site a must be finite"),
        (SITES.assign(demand=[0, -2, 3]), {}, "demand of site a must be finite and not negative"),
        (SITES.assign(depot=[True, "yes", False]), {}, "column depot must hold true and false; found yes"),
        (SITES.assign(id=["yard", "a", "a"]), {}, "two sites have the id 'a'"),
        (SITES.drop(columns="y"), {}, "coordinates need two columns"),
        (SITES.drop(columns=["x", "y"]), {}, "neither coordinates nor distances"),
        (SITES, {"vehicles": 0}, "at least 1"),
        (SITES, {"vehicles": 1.5}, "must be whole"),
        (SITES, {"capacity": -1}, "capacity of vehicle"),
        (SITES, {"travel": np.zeros((2, 2))}, r"expected \(3, 3\); found \(2, 2\)"),
        (SITES, {"travel": [[0, 1, 2], [1, 0, -1], [1, 1, 0]]}, "distance from site a to site b must be a number and not negative"),
        (SITES, {"travel": np.full((3, 3), "x")}, "must hold numbers"),
        (SITES, {"durations": np.full((3, 3), np.nan)}, "duration from site yard to site a"),
        (SITES, {"travel": sp.csr_matrix(np.array([[0, 1, 1], [1, 0, np.nan], [1, 1, 0]]))}, "road from site a to site b"),
        (SITES, {"travel": pd.DataFrame(np.zeros((3, 3)), index=list("pqr"), columns=list("pqr"))}, "labels of the distance frame"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(frame: pd.DataFrame, options: dict[str, Any], message: str) -> None:
    check_refused(InputError, message, instance_from_frame, frame, **options)


# -- the whole family ----------------------------------------------------------------------------------------------------

PLACES = pd.DataFrame(
    {
        "id": ["yard", "port", "a", "b", "c"], "x": [0, 9, 1, 2, 3], "y": 0.0, "depot": [True, True, False, False, False],
        "demand": [0, 0, 1, 2, 3], "demand2": [0, 0, 4, 5, 6], "pickup": [0, 0, 0, 7, 0], "penalty": [0, 0, 0, 0, 8],
        "required": [False, False, True, True, False], "skills": ["", None, "cold, tall", "", ""],
    }
)  # fmt: skip


def test_every_column_and_every_relation_is_taken() -> None:
    closing = pd.DataFrame(9.0, index=PLACES["id"], columns=PLACES["id"])
    made = instance_from_frame(
        PLACES, closing=closing, windows={"b": [(5, 9), (0, 3)]}, shipments=[("a", "b", 2.5)], min_vehicles=1,
        groups=[{"sites": ["c"], "required": False}][:0], fleet=[{"capacity": [5, 9], "skills": ["cold", "tall"]}],
    )  # fmt: skip
    sites = made.sites
    assert sites.further_demand.ravel().tolist() == [0, 0, 4, 5, 6] and sites.pickup.tolist() == [0, 0, 0, 7, 0]
    assert sites.penalty[4] == 8 and sites.skills[2] == {"cold", "tall"} and sites.skills[3] == frozenset()
    assert sites.windows[3] == ((0.0, 3.0), (5.0, 9.0)) and sites.shipments[0].load == (2.5,)
    assert made.travel.closing is not None and made.travel.closing[0, 1] == 9 and made.min_vehicles == 1
    assert made.fleet[0].capacities == (5, 9)


def test_a_group_is_a_list_of_ids_or_says_whether_it_is_required() -> None:
    frame = PLACES.drop(columns=["required", "penalty"])
    made = instance_from_frame(frame, groups=[["a", "b"], {"sites": ["c"], "required": False}], fleet=[{"skills": ["cold", "tall"]}])
    assert [(g.sites, g.required) for g in made.sites.groups] == [((2, 3), True), ((4,), False)]
    assert not made.sites.required.any()


def test_a_fleet_is_a_frame_with_the_keys_of_the_json() -> None:
    fleet = pd.DataFrame(
        {"name": ["drone", "rover"], "count": [2, math.inf], "start": ["port", "yard"], "end": ["port", "yard"], "speed": [3.0, None]}
    )
    made = instance_from_frame(PLACES.drop(columns=["skills"]), fleet=fleet)
    assert [(v.name, v.count, v.start, v.speed) for v in made.fleet] == [("drone", 2, 1, 3), ("rover", None, 0, 1)]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"fleet": [{"wheels": 4}]}, "fleet[0] has an unknown key 'wheels'"),
        ({"fleet": [{}], "vehicles": 3}, "fleet tells the vehicles already"),
        ({"fleet": [{"start": "a"}]}, "starts or ends at site a, which is no depot; expected "),
        ({"fleet": [{"name": "v"}, {"name": "v"}]}, "vehicle types must have different names"),
        ({"fleet": ["v"]}, "fleet[0] must be a mapping or a VehicleType"),
        ({"fleet": []}, "the fleet is empty"),
        ({"fleet": True}, "fleet must be a frame or a list"),
        ({"columns": True}, "columns must be a mapping of titles"),
        ({"variances": np.full((5, 5), np.inf)}, "variance from site yard to site port must be a number and not negative; expected a f"),
        ({"shipments": [("a", "z")]}, "shipments name the unknown site 'z'"),
        ({"shipments": ["ab"]}, "a shipment has a pickup, a delivery and perhaps a load"),
        ({"groups": [["c", "c"]]}, "group 1 has the site c twice"),
        ({"windows": {"z": [(0, 1)]}}, "windows name the unknown site 'z'"),
        ({"closing": np.full((5, 5), "x")}, "closing times must be a number or a moment"),
        ({"closing": np.full((4, 4), 1.0)}, "closing times must have one entry a move"),
        ({"closing": np.full((5, 5), np.nan)}, "closing time of the move in row 1, column 2 must be a number"),
        ({"fleet": [{"energy": {"capacity": 1.5}}]}, "the energy of no vehicle lasts to any site and back; expected at least 2; found 1.5"),
        ({"travel": np.full((5, 5), -1.0)}, "distance from site yard to site port must be a number and not negative"),
        ({"travel": np.full((5, 5), np.inf)}, "all distances between sites are infinite, so that no move can be made"),
    ],
)
def test_what_is_wrong_with_more_than_columns_is_named(given: dict[str, Any], message: str) -> None:
    assert message in refused(instance_from_frame, PLACES.drop(columns=["skills"]), **given)


# -- what people have ----------------------------------------------------------------------------------------------------

DAY = pd.Timestamp("2026-05-04")
SHOPS = pd.DataFrame(
    {
        "name": ["Yard", "Aldi", "Bakery", "Clinic"], "latitude": [52.52, 52.50, 52.55, 52.48], "longitude": [13.40, 13.45, 13.35, 13.38],
        "demand": [np.nan, 4, 2, 6], "ready": [DAY + pd.Timedelta("7h"), DAY + pd.Timedelta("8h"), pd.NaT, pd.NaT],
        "due": [DAY + pd.Timedelta("18h"), DAY + pd.Timedelta("9h"), pd.NaT, DAY + pd.Timedelta("12h")],
        "service": pd.to_timedelta([0, 10, 5, 20], unit="min"), "phone": ["-", "1", None, "3"],
    }
)  # fmt: skip


def test_a_frame_as_people_have_it() -> None:
    made = instance_from_frame(SHOPS, capacity=10, speed=30, time_unit="min", max_duration=pd.Timedelta("6h"), name="shops")
    sites = made.sites
    assert sites.ids == ("Yard", "Aldi", "Bakery", "Clinic") and sites.attributes == {"phone": ("-", "1", None, "3")} and sites.geographic
    assert sites.ready.tolist() == [420, 480, 0, 0] and sites.due.tolist() == [1080, 540, math.inf, 720]
    assert sites.service.tolist() == [0, 10, 5, 20] and made.fleet[0].max_duration == 360
    assert made.clock is not None and made.clock.origin == "2026-05-04T00:00:00"
    assert made.travel.duration(0, 1) == pytest.approx(2 * made.travel.distance(0, 1))  # 30 km an hour
    assert made.notes == ("columns kept and not used: phone", "times are in min since 2026-05-04 00:00:00")


def test_tables_of_an_answer_tell_moments_and_attributes() -> None:
    problem = RoutingProblem.from_frame(SHOPS, capacity=10, speed=30, time_unit="min")
    frame = problem.answer_to_frame(problem.answer_of([["Aldi", "Clinic"]]))
    assert frame["begin"].tolist()[0] == DAY + pd.Timedelta("8h") and frame["departure"].tolist()[0] == DAY + pd.Timedelta("8h10min")
    assert frame["phone"].tolist() == ["1", "3"]
    routes = problem.answer_frames(problem.answer_of([["Aldi", "Clinic"]]))["routes"]
    assert routes["sites"].tolist() == ["Yard > Aldi > Clinic > Yard"] and routes["departure"].tolist()[0] > DAY + pd.Timedelta("7h")


def test_a_metric_may_be_named_and_a_unit_of_distance() -> None:
    assert instance_from_frame(SITES, travel="manhattan").travel.distance(0, 1) == 7
    places = SHOPS[["name", "latitude", "longitude"]]
    km, metres = (instance_from_frame(places, distance_unit=unit).travel.distance(0, 1) for unit in ("km", "m"))
    assert metres == pytest.approx(1000 * km)


def test_a_speed_that_leaves_no_number_in_another_unit_is_refused() -> None:
    with pytest.raises(InputError, match="too small or too large to compute with", check=coded("out-of-range")):
        instance_from_frame(SHOPS, capacity=10, speed=5e-324, time_unit="s")


def test_a_speed_of_one_is_a_speed() -> None:
    made = instance_from_frame(SHOPS.iloc[:, :3].assign(service=5.0), speed=1.0, time_unit="h")
    assert made.travel.duration(0, 1) == made.travel.distance(0, 1)
    with pytest.raises(InputError, check=coded("duplicate")):
        instance_from_frame(SHOPS, speed=1.0, time_unit="h", fleet=[{"speed": 40}])


def test_infinite_distances_are_moves_that_cannot_be_made() -> None:
    made = instance_from_frame(SITES, travel=[[0, 1, 2], [math.inf, 0, 3], [1, 1, 0]])
    assert made.forbidden is not None and np.argwhere(made.forbidden).tolist() == [[1, 0]]
    assert np.isfinite(made.travel.distances).all()


@pytest.mark.parametrize(
    ("frame", "options", "message"),
    [
        (SHOPS, {"speed": 30}, "column ready holds timestamps: say in which unit of time the problem counts; expected time_unit='min'"),
        (SHOPS, {"time_unit": "min"}, "there are times of sites or vehicles beside them; expected speed=50"),
        (SHOPS.iloc[:, :3].assign(service=5.0), {"speed": 30}, "a speed is a distance in an hour, and the unit of times is not said"),
        (SHOPS, {"time_unit": "min", "speed": -1}, "speed must be positive and finite"),
        (SHOPS, {"time_unit": "min", "speed": 30, "fleet": pd.DataFrame({"speed": [40]})}, "speeds are given twice"),
        (SITES, {"travel": "manhatten"}, "travel by 'manhatten' is unknown; did you mean 'manhattan'?"),
        (SITES, {"travel": "haversine"}, "travel by haversine does not fit the coordinates; expected columns lat and lon"),
        (SHOPS, {"travel": "euclidean", "time_unit": "min"}, "travel by euclidean does not fit the coordinates"),
        (SITES.assign(due=9.0), {"travel": {"durations": [[0, 1, 1]] * 3}}, "durations of the routing service are in seconds"),
        (SITES, {"travel": "no/such/table.json"}, "no/such/table.json: no such file"),
        (SITES, {"windows": {"aa": [(0, 1)]}}, "windows name the unknown site 'aa'"),
        (SITES, {"fleet": pd.DataFrame({"capcity": [1]})}, "the fleet has an unknown column 'capcity'; did you mean 'capacity'?"),
    ],
)  # fmt: skip
def test_what_would_be_misread_is_refused_with_the_cure(frame: pd.DataFrame, options: dict[str, Any], message: str) -> None:
    assert message in refused(instance_from_frame, frame, **options)


@pytest.mark.parametrize(
    ("columns", "given"),
    [
        ({}, {"max_distance": 1.0}), ({}, {"fleet": [{"energy": {"capacity": 1}}]}), ({}, {"travel": np.full((3, 3), np.inf)}),
        ({"due": [9.0, 0.0, 0.0]}, {}), ({"demand": [0.0, 9, 9]}, {"capacity": 1}), ({"skills": ["", "cold", "cold"]}, {}),
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("solver", "limits"),
    [("highs", {}), ("pyvrp", {"iterations": 20}), pytest.param("ortools", {"time_limit": 5.0}, marks=pytest.mark.slow)],
)
def test_where_all_may_be_left_out_and_none_can_be_reached_nobody_drives(
    columns: dict[str, Any], given: dict[str, Any], solver: str, limits: dict[str, Any]
) -> None:
    sites = pd.DataFrame({"x": [0, 30, 50], "y": [0, 40, -10], "required": False, "reward": [0, 500, 500], **columns})
    solution = wb.solve(RoutingProblem.from_frame(sites, **given), solver, bound_time=0, **limits)
    assert solution.answer is not None and solution.routes == [] and solution.objective == 0


def test_names_of_others_are_refused_and_all_other_columns_are_told() -> None:
    sites = pd.DataFrame({"x": [0, 3], "y": [0, 4], "colour": ["red", "blue"], "node": [1, 2]})
    for title, cure in (
        ("tw_early", "columns={'ready': 'tw_early'} to use it"),
        ("release_time", "no release times"),
        ("priority", "reward"),
    ):
        check_refused(InputError, re.escape(cure), RoutingProblem.from_frame, sites.assign(**{title: 1}))
    for frame, extra in ((sites, ()), (sites.assign(tw_early=1), ["tw_early"])):
        told = f"columns kept and not used: {', '.join(frame.columns[2:3].tolist() + list(extra) + ['node'])}"
        solution = wb.solve(RoutingProblem.from_frame(frame, extra=extra, vehicles=1), "highs", bound_time=0)
        assert told in str(solution) and told in solution._repr_html_() and told in solution.to_json()["notes"]
    assert "node" in RoutingProblem.from_frame(sites, vehicles=1).sites.attributes
    made = RoutingProblem.from_instance(instance_from_frame(sites), settings={"vehicles": 2})
    assert made.notes == () and made.remarks() == ("columns kept and not used: colour, node",)


def test_many_columns_that_are_kept_are_told_in_full() -> None:
    titles = [f"remark of person {k}" for k in range(200)]
    sites = pd.DataFrame({"x": [0, 3], "y": [0, 4], **dict.fromkeys(titles, "so")})
    text = str(wb.solve(RoutingProblem.from_frame(sites, vehicles=1), "highs", bound_time=0))
    assert all(title in text for title in titles)


def test_times_of_day_are_told_as_such_in_errors_reasons_and_files(tmp_path) -> None:
    early, noon, late = datetime.time(6), datetime.time(6, 10), datetime.time(18)
    sites = pd.DataFrame({"x": [0, 30], "y": [0, 0], "demand": [0, 1], "ready": [early, early], "due": [late, noon]})
    problem = wb.RoutingProblem.from_frame(sites, time_unit="min", vehicles=1, capacity=5)
    assert wb.explain(problem).reasons[0].message == "it is reached at 06:30 at the earliest, due 06:10"
    (broken,) = problem.evaluate(problem.answer_of([[1]])).violations
    assert broken.message.endswith("at 06:30, due 06:10")
    fine = wb.RoutingProblem.from_frame(sites.assign(due=[late, late]), time_unit="min", vehicles=1, capacity=5)
    fine.save(tmp_path / "day.json")
    assert wb.read(tmp_path / "day.json").clock == fine.clock and fine.clock.of_day
    assert "06:00 to 18:00" in fine._repr_html_()


@pytest.mark.parametrize(
    "given",
    [
        {"capacity": 9},
        {"fleet": [{"capacity": 9}]},
        {"fleet": [{"capacity": 9}, {"name": "other"}]},
        {"fleet": pd.DataFrame({"capacity": [9]})},
    ],
)
@pytest.mark.parametrize("title", ["demand2", "pickup2", "demand3"])
def test_a_capacity_of_the_first_load_alone_is_no_capacity_of_the_others(given, title):
    sites = pd.DataFrame({"x": [0, 3], "y": [0, 4], "demand": [0, 1], title: [0, 9]})
    with pytest.raises(InputError, match=r"sites have [23] loads, and capacity is given for the first alone; expected .*inf for no limit"):
        wb.RoutingProblem.from_frame(sites, **given)


@pytest.mark.parametrize(
    "given",
    [
        {"capacity": [9, math.inf]},
        {"fleet": [{"capacity": [9, math.inf]}]},
        {"fleet": pd.DataFrame({"capacity": [9], "capacity2": [math.inf]})},
        {},
    ],
)
def test_a_load_may_be_said_to_have_no_limit_and_is_told_then(given):
    sites = pd.DataFrame({"x": [0, 3], "y": [0, 4], "demand": [0, 1], "demand2": [0, 9]})
    assert "demand2 counts for nothing: no vehicle has a capacity for it" in wb.RoutingProblem.from_frame(sites, **given).remarks()
    wb.RoutingProblem.from_frame(sites.assign(demand2=0), capacity=9)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"weight": "km"}, "weight='km' names the distances of a graph's edges, and there is no graph"),
        ({"weight": "km", "travel": np.ones((3, 3))}, "there is no graph"),
        ({"weight": "km", "travel": sp.csr_matrix(np.ones((3, 3)))}, "there is no graph"),
        ({"distance_unit": "mi"}, "distance_unit='mi' counts for nothing"),
        ({"distance_unit": "m", "travel": np.ones((3, 3))}, "distance_unit='m' counts for nothing"),
        ({"distance_unit": "m", "travel": "manhattan"}, "distance_unit='m' counts for nothing"),
    ],
)
def test_arguments_that_would_count_for_nothing_are_refused(given: dict[str, Any], message: str) -> None:
    check_refused(InputError, re.escape(message), instance_from_frame, SITES, **given)


def test_a_unit_beside_a_metric_of_the_globe_is_refused() -> None:
    places = pd.DataFrame({"lat": [45.0, 46.0], "lon": [15.0, 15.0]})
    check_refused(InputError, "distance_unit='mi' counts for nothing", instance_from_frame, places, travel="haversine", distance_unit="mi")
    table = {"code": "Ok", "distances": [[0, 1000], [1000, 0]]}
    assert instance_from_frame(places, travel=table, distance_unit="m").travel.distance(0, 1) == 1000
