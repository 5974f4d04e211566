"""Where the open sea is."""

from __future__ import annotations

import numpy as np

from waybound.instances.routing.open_sea import at_open_sea

LAND = [(2.35, 48.86), (-74.0, 40.7), (15.98, 45.81), (151.2, -33.9), (-157.9, 21.3), (36.8, -1.3), (0.0, -90.0), (180.0, -85.0)]
SEA = [(-30.0, 40.0), (0.0, 0.0), (-180.0, 0.5), (180.0, 0.5), (80.0, -30.0), (10.0, 90.0)]


def test_cities_are_on_land_and_the_middle_of_oceans_is_not() -> None:
    assert not at_open_sea(np.array(LAND)).any()
    assert at_open_sea(np.array(SEA)).all()
