import math
import warnings

import numpy as np
import pandas as pd
import pytest
from file_cases import refused

import waybound as wb
from waybound.instances.routing.frame_columns import columns_of
from waybound.instances.routing.geography import at_open_sea, coordinates_of, middle, warn_of_swapped
from waybound.instances.routing.travel import Travel

BERLIN, SYDNEY, NEW_YORK, QUITO, ZAGREB = (52.52, 13.40), (-33.87, 151.21), (40.71, -74.01), (-0.18, -78.47), (45.81, 15.98)


def around(place: tuple[float, float], seed: int, count: int = 40) -> np.ndarray:
    """(longitude, latitude) of sites that lie evenly around a place, as widely in one direction as in the other."""
    rng = np.random.default_rng(seed)
    lat, lon = place
    return np.column_stack([lon + rng.normal(0, 0.05, count) / math.cos(math.radians(lat)), lat + rng.normal(0, 0.05, count)])


def test_great_circles_are_those_of_the_sphere() -> None:
    """Quarters of the equator and of a meridian, and Berlin to Sydney by the law of cosines."""
    xy = np.array([[0.0, 0.0], [90.0, 0.0], [0.0, 90.0], [BERLIN[1], BERLIN[0]], [SYDNEY[1], SYDNEY[0]]])
    travel = Travel("haversine", coordinates=xy)
    quarter = math.pi / 2 * 6371.0088
    assert travel.distance([0, 0, 1], [1, 2, 2]) == pytest.approx([quarter] * 3)
    a, b, across = math.radians(BERLIN[0]), math.radians(SYDNEY[0]), math.radians(SYDNEY[1] - BERLIN[1])
    cosine = math.sin(a) * math.sin(b) + math.cos(a) * math.cos(b) * math.cos(across)
    assert travel.distance(3, 4) == pytest.approx(6371.0088 * math.acos(cosine))
    assert Travel("haversine-m", coordinates=xy).distance(0, 1) == pytest.approx(1000 * quarter)
    assert Travel("haversine-mi", coordinates=xy).distance(0, 1) == pytest.approx(quarter / 1.609344)


@pytest.mark.parametrize("place", [BERLIN, SYDNEY, NEW_YORK, QUITO])
@pytest.mark.parametrize("seed", range(5))
def test_no_warning_where_the_columns_are_right(place: tuple[float, float], seed: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_swapped(around(place, seed))


@pytest.mark.parametrize(("place", "why"), [(ZAGREB, "as widely from west to east"), (NEW_YORK, "polar"), (BERLIN, "open sea")])
def test_swapped_columns_are_seen_by_the_spread_or_the_latitude(place: tuple[float, float], why: str) -> None:
    with pytest.warns(UserWarning, match=f"may be swapped: .*{why}"):
        warn_of_swapped(around(place, 1, 200)[:, ::-1])


@pytest.mark.parametrize("place", [(51.5, -0.1), (48.9, 2.35), (6.5, 3.4), (-23.5, -46.6), (-26.2, 28.0), (44.6, -63.6), (59.3, 18.0)])
def test_a_few_sites_that_only_the_exchange_brings_ashore_are_enough(place: tuple[float, float]) -> None:
    """London, Paris, Lagos, Sao Paulo, Johannesburg, Halifax, Stockholm."""
    xy = around(place, 1, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_swapped(xy)
    told = f"open sea \\({middle(xy[:, ::-1])}\\), and all on land with the columns exchanged \\({middle(xy)}\\)"
    with pytest.warns(UserWarning, match=told):
        warn_of_swapped(xy[:, ::-1])


def test_ships_at_sea_are_not_warned_of() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_swapped(around((40.0, -30.0), 1, 20))


def test_the_middle_is_a_place_on_the_globe() -> None:
    quarter = math.pi / 2 * 6371.0088
    across = middle(np.array([[179.0, 0.0], [-179.0, 0.0]]))
    assert abs(across.longitude) == pytest.approx(180.0) and across.within == pytest.approx(quarter / 90.0)
    assert str(middle(np.array([[-46.6, -23.5]]))) == "around 23.5 S, 46.6 W"


def test_the_warning_reaches_who_makes_the_problem() -> None:
    xy = around(NEW_YORK, 1)
    with pytest.warns(UserWarning, match="latitude and longitude may be swapped"):
        wb.RoutingProblem.from_frame(pd.DataFrame({"lat": xy[:, 0], "lon": xy[:, 1]}))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"lat": [0.0, 151.2], "lon": [0.0, -33.9]},
            "latitude of site 1 is out of range; expected -90 to 90 degrees; found 151.2; are lat and lon swapped?",
        ),
        ({"lat": [0.0, 95.0], "lon": [0.0, 120.0]}, "latitude of site 1 is out of range; expected -90 to 90 degrees; found 95.0"),
        ({"lat": [0.0, 1.0], "lon": [0.0, 181.0]}, "longitude of site 1 is out of range"),
        ({"lat": [0.0, np.nan], "lon": [0.0, 1.0]}, "latitude of site 1 is out of range"),
        ({"lat": [0.0, 1.0]}, "coordinates need two columns; expected lat and lon"),
        ({"lat": [0.0, 1], "lon": [0, 1], "x": [0, 1], "y": [0, 1]}, "there are two kinds of coordinates"),
        ({"lat": [0.0, "north"], "lon": [0, 1]}, "column lat must hold numbers"),
    ],
)
def test_what_is_no_place_is_refused(columns: dict[str, list[object]], message: str) -> None:
    assert refused(coordinates_of, columns_of(pd.DataFrame(columns), None, ())).startswith(message)


def test_a_square_of_degrees_is_not_warned_of() -> None:
    rng = np.random.default_rng(2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for place in ((8.0, 47.0), (24.0, 60.0), (-80.0, 37.0)):
            warn_of_swapped(np.array(place) + rng.random((60, 2)))


LAND = [(2.35, 48.86), (-74.0, 40.7), (15.98, 45.81), (151.2, -33.9), (-157.9, 21.3), (36.8, -1.3), (0.0, -90.0), (180.0, -85.0)]
SEA = [(-30.0, 40.0), (0.0, 0.0), (-180.0, 0.5), (180.0, 0.5), (80.0, -30.0), (10.0, 90.0)]


def test_cities_are_on_land_and_the_middle_of_oceans_is_not() -> None:
    assert not at_open_sea(np.array(LAND)).any()
    assert at_open_sea(np.array(SEA)).all()
