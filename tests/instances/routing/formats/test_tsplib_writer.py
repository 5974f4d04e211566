import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound import RoutingInstance, Sites, UsageError, VehicleType
from waybound.instances.routing.formats._tsplib_writer import always_open, longest_route, write
from waybound.instances.routing.travel import EXPLICIT, Travel

XY = np.array([(0, 0), (3, 0), (0, 4.5)], dtype=float)


def instance(
    vehicle: VehicleType | None = None, problem: str = "cvrp", travel: Travel | None = None, name: str = "tiny", **sites: Any
) -> RoutingInstance:  # fmt: skip
    travel = travel or Travel("EUC_2D", XY)
    places = Sites.of(list(sites.pop("ids", "123")), coordinates=None if travel.metric == EXPLICIT else XY, **sites)
    return RoutingInstance(name, "json", places, travel, (vehicle or VehicleType(),), problem)


def test_every_section_of_a_vrptw_is_written() -> None:
    made = instance(VehicleType(2, 7.5, max_duration=90), demand=[0, 2, 1.5], service=[0, 10, 10], ready=[0, 1, 2], due=[90, 50.25, 60])
    assert write(made) == (
        "NAME : tiny\nTYPE : VRPTW\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EUC_2D\nVEHICLES : 2\nCAPACITY : 7.5\nDISTANCE : 90\n"
        "NODE_COORD_SECTION\n1 0 0\n2 3 0\n3 0 4.5\n"
        "DEMAND_SECTION\n1 0\n2 2\n3 1.5\n"
        "SERVICE_TIME_SECTION\n1 0\n2 10\n3 10\n"
        "TIME_WINDOW_SECTION\n1 0 90\n2 1 50.25\n3 2 60\n"
        "DEPOT_SECTION\n1\n-1\nEOF\n"
    )


def test_a_tour_over_a_matrix_is_an_atsp_where_directions_differ() -> None:
    matrix = np.array([[0, 1, 2], [3, 0, 4], [5, 6, 0]], dtype=float)
    made = instance(VehicleType(1), "tsp", Travel(EXPLICIT, matrix=matrix))
    assert write(made) == (
        "NAME : tiny\nTYPE : ATSP\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EXPLICIT\nEDGE_WEIGHT_FORMAT : FULL_MATRIX\n"
        "EDGE_WEIGHT_SECTION\n0 1 2\n3 0 4\n5 6 0\nEOF\n"
    )
    assert "TYPE : TSP\n" in write(instance(VehicleType(1), "tsp", Travel(EXPLICIT, matrix=matrix + matrix.T)))


def test_the_depot_is_told_by_its_node() -> None:
    assert write(instance(VehicleType(None, 5, start=2, end=2), depot=[False, False, True])).endswith("DEPOT_SECTION\n3\n-1\nEOF\n")


def test_a_tour_of_limited_length_is_an_op() -> None:
    made = instance(VehicleType(1, max_distance=9.5), "orienteering", reward=[1, 2, 3.5], required=False)
    assert write(made) == (
        "NAME : tiny\nTYPE : OP\nDIMENSION : 3\nCOST_LIMIT : 9.5\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 3 0\n3 0 4.5\n"
        "NODE_SCORE_SECTION\n1 1\n2 2\n3 3.5\nDEPOT_SECTION\n1\n-1\nEOF\n"
    )


def test_euclidean_distances_that_are_not_rounded_have_the_word_of_lkh() -> None:
    assert "\nEDGE_WEIGHT_TYPE : EXACT_2D\n" in write(instance(LOADED, travel=Travel("euclidean", XY)))


def test_pickups_and_deliveries_stand_in_one_section_with_a_window_that_never_closes() -> None:
    made = instance(VehicleType(2, 7.5), travel=Travel("euclidean", XY), demand=[0, 2, 1.5], pickup=[0, 0, 3], service=[0, 10, 10])
    assert write(made) == (
        "NAME : tiny\nTYPE : VRPSPD\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EXACT_2D\nVEHICLES : 2\nCAPACITY : 7.5\n"
        "NODE_COORD_SECTION\n1 0 0\n2 3 0\n3 0 4.5\n"
        "PICKUP_AND_DELIVERY_SECTION\n1 0 0 10000000 0 0 0\n2 0 0 10000000 10 0 2\n3 0 0 10000000 10 3 1.5\n"
        "DEPOT_SECTION\n1\n-1\nEOF\n"
    )
    windows = replace(made, sites=replace(made.sites, due=np.array([90.0, 50, 60])))
    assert "TYPE : VRPSPDTW\n" in write(windows) and "\n3 0 0 60 10 3 1.5\n" in write(windows)


def test_no_route_is_longer_than_the_longest() -> None:
    assert longest_route(Travel("euclidean", XY)) == 3 * 8.5
    assert longest_route(Travel(EXPLICIT, matrix=np.array([[0, 1, 2], [3, 0, 4], [5, 6, 0]], dtype=float))) == 12
    assert longest_route(Travel("GEO", XY)) == math.inf
    zero, due = np.zeros(3), np.full(3, 30.0)
    assert always_open(Travel("euclidean", XY), zero, due, np.full(3, 1.5))
    assert not always_open(Travel("euclidean", XY), zero, due, np.full(3, 1.6))
    assert not always_open(Travel("euclidean", XY), zero, np.array([30, 31, 30.0]), zero)
    assert not always_open(Travel("euclidean", XY), np.array([0, 1, 0.0]), due, zero)


LOADED = VehicleType(None, 5)


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: instance(LOADED, travel=Travel("manhattan", XY)), "has no manhattan distances without rounding"),
        (lambda: instance(LOADED, travel=Travel("EUC_2D", XY, convention="exact")), "its convention is exact"),
        (lambda: instance(LOADED, ids="012"), "nodes must be numbered 1, 2, 3"),
        (lambda: instance(LOADED, name="two\nlines"), "its name is no single line"),
        (lambda: instance(LOADED, name=" "), "its name is no single line"),
        (lambda: instance(LOADED, due=[9, 9, math.inf]), "every site needs a due date if one has it"),
        (lambda: instance(VehicleType(1, 5), "tsp"), "a TSP has no windows, service, loads"),
        (lambda: instance(VehicleType(1), "tsp", service=[0, 1, 0]), "a TSP has no windows, service, loads"),
        (lambda: instance(VehicleType(1, start=1, end=1), "tsp", depot=[False, True, False]), "its first node is the depot"),
        (lambda: instance(VehicleType(2), "tsp"), "a TSP has one vehicle without a limit"),
        (lambda: instance(VehicleType(1, max_duration=9), "tsp"), "a TSP has one vehicle without a limit"),
        (lambda: instance(), "the format needs a capacity"),
        (lambda: instance(VehicleType(), demand=[0, 1, 1]), "the format needs a capacity"),
        (lambda: instance(LOADED, name="mine-k7"), "the end of its name would be read as a limit"),
        (lambda: instance(VehicleType(None, 5, max_distance=3)), "no place for max-distance"),
        (lambda: instance(LOADED, pickup=[0, 1, 1], due=99), "windows that no route can outlast are not told from none"),
        (lambda: instance(LOADED, travel=Travel("GEO", XY), pickup=[0, 1, 1]), "a time that no route outlasts, which GEO distances do not"),
        (lambda: instance(VehicleType(1), "orienteering", required=False), "one tour of limited length through sites that may be left out"),
        (lambda: instance(VehicleType(2, max_distance=3), "orienteering", required=False), "one tour of limited length"),
        (lambda: instance(VehicleType(1, max_distance=3), "orienteering"), "one tour of limited length"),
        (
            lambda: instance(VehicleType(1, max_distance=3), "team-orienteering", required=False),
            "no place for max-distance, optional-sites",
        ),
    ],
)
def test_what_the_format_has_no_word_for_is_refused(made: Any, words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        write(made())
    assert "cannot be written as vrplib" in str(caught.value) and "use json" in str(caught.value)


def test_a_name_with_a_fleet_is_written_where_that_is_what_it_means() -> None:
    """With a limit of its own, and in set X, where the number is none."""
    assert "VEHICLES : 7" in write(instance(VehicleType(7, 5), name="mine-k7"))
    assert "VEHICLES" not in write(replace(instance(LOADED), name="X-n3-k7"))
