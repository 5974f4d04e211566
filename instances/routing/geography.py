"""Coordinates of a frame of sites: in the plane, or latitude and longitude in decimal degrees."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

if TYPE_CHECKING:
    from .frame_columns import Columns

Floats = NDArray[np.float64]

INHABITED = 66.0
"""Degrees of latitude, north or south, beyond which few vehicles drive."""

SQUARE = 1.15
"""Ratio of the spreads in degrees up to which sites may have been drawn from a square of them."""


def coordinates_of(table: Columns) -> tuple[bool, Floats | None, tuple[str, ...]]:
    """Whether they are geographic, the coordinates of shape (sites, 2) or None, and what to tell.

    Longitude stands before latitude, as x before y.

    Raises
    ------
    InputError
        For one column without the other, both kinds, and angles out of range.
    """
    for pair in (("x", "y"), ("lat", "lon")):
        if (pair[0] in table) != (pair[1] in table):
            raise InputError("coordinates need two columns", expected=" and ".join(pair), found="one of them")
    if "lat" not in table:
        return False, np.column_stack([_column(table, "x"), _column(table, "y")]) if "x" in table else None, ()
    if "x" in table:
        raise InputError("there are two kinds of coordinates", expected="x and y, or lat and lon", found="all four columns")
    lat, lon = _column(table, "lat"), _column(table, "lon")
    for what, values, most in (("latitude", lat, 90.0), ("longitude", lon, 180.0)):
        bad = ~(np.abs(values) <= most)
        if bad.any():
            k = int(np.argmax(bad))
            swapped = (
                "; are lat and lon swapped?" if what == "latitude" and np.abs(lon).max() <= 90.0 and np.abs(lat).max() <= 180.0 else ""
            )
            found = f"{values[k]}{swapped}"
            raise InputError(f"{what} of site {table.ids[k]} is out of range", expected=f"{-most:g} to {most:g} degrees", found=found)
    return True, np.column_stack([lon, lat]), ()


def _column(table: Columns, title: str) -> Floats:
    try:
        return np.array(table[title].to_numpy(dtype=np.float64, na_value=np.nan))
    except (TypeError, ValueError) as error:
        raise InputError(f"column {title} must hold numbers", found=str(error)) from None


def warn_of_swapped(xy: Floats) -> None:
    """Warn where (longitude, latitude) look like (latitude, longitude).

    Where all latitudes are beyond any road and the longitudes are not; or where the sites, which seen from above would lie as widely from
    west to east as from south to north, do so only with the two columns exchanged.
    """
    lon, lat = xy.T
    polar = bool((np.abs(lat) > INHABITED).all() and (np.abs(lon) <= INHABITED).all())
    if polar or _rounder_exchanged(lon, lat):
        why = "all latitudes are polar" if polar else "the sites would lie as widely from west to east as from south to north"
        warnings.warn(f"latitude and longitude may be swapped: {why}{'' if polar else ' with the columns exchanged, and do not now'}; "
                      "check the columns lat and lon", UserWarning, stacklevel=5)  # fmt: skip


def _rounder_exchanged(lon: Floats, lat: Floats) -> bool:
    if len(lon) < 8 or np.abs(lon).max() > 89.0 or min(np.ptp(lon), np.ptp(lat)) <= 0.0 or max(np.ptp(lon), np.ptp(lat)) > 20.0:
        return False
    spread = float(np.std(lat) / np.std(lon))
    given = abs(math.log(spread / math.cos(math.radians(float(lat.mean())))))
    exchanged = abs(math.log(1.0 / spread / math.cos(math.radians(float(lon.mean())))))
    # Degrees of longitude are the shorter ones: of a round place, those of latitude spread wider only where they are exchanged.
    return spread > SQUARE and given > math.log(1.3) and exchanged < math.log(1.15)
