"""Instances from pandas frames."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sp

from waybound.instances.errors import InputError
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
        (SITES, {"travel": [[0, 1, 2], [1, 0, -1], [1, 1, 0]]}, "distance from site a to site b must be finite and not negative"),
        (SITES, {"travel": np.full((3, 3), "x")}, "must hold numbers"),
        (SITES, {"durations": np.full((3, 3), np.nan)}, "duration from site yard to site a"),
        (SITES, {"travel": sp.csr_matrix(np.array([[0, 1, 1], [1, 0, np.nan], [1, 1, 0]]))}, "road from site a to site b"),
        (SITES, {"travel": pd.DataFrame(np.zeros((3, 3)), index=list("pqr"), columns=list("pqr"))}, "labels of the distance frame"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(frame: pd.DataFrame, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        instance_from_frame(frame, **options)
