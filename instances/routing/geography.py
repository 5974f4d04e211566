"""Coordinates of a frame of sites: in the plane, or latitude and longitude in decimal degrees."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .open_sea import at_open_sea
from .travel import Travel

if TYPE_CHECKING:
    from .frame_columns import Columns

Floats = NDArray[np.float64]

INHABITED = 66.0
"""Degrees of latitude, north or south, beyond which few vehicles drive."""

SQUARE = 1.15
"""Ratio of the spreads in degrees up to which sites may have been drawn from a square of them."""


def coordinates_of(table: Columns) -> tuple[bool, Floats | None, tuple[str, ...]]:
    """True if coordinates are geographic, the coordinates of shape (sites, 2), longitude before latitude, or None, and notes.

    Raises InputError for one column without the other, both kinds, and angles out of range.
    """
    for pair in (("x", "y"), ("lat", "lon")):
        if (pair[0] in table) != (pair[1] in table):
            alone = table.titles[pair[0] if pair[0] in table else pair[1]]
            raise InputError("coordinates need two columns", expected=" and ".join(pair), found=f"{alone!r} alone")
    if "lat" not in table:
        return False, np.column_stack([_column(table, "x"), _column(table, "y")]) if "x" in table else None, ()
    if "x" in table:
        four = ", ".join(repr(table.titles[own]) for own in ("x", "y", "lat", "lon"))
        raise InputError("there are two kinds of coordinates", expected="x and y, or lat and lon", found=four)
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

    That is the case where all latitudes are beyond any road and the longitudes are not; where most sites lie in the open sea, and all on
    land or by a coast with the two columns exchanged; or where the sites, which seen from above would lie as widely from west to east as
    from south to north, do so only exchanged.
    """
    lon, lat = xy.T
    if (np.abs(lat) > INHABITED).all() and (np.abs(lon) <= INHABITED).all():
        why = "all latitudes are polar"
    elif _on_land_exchanged(xy):
        why = f"most sites lie in the open sea ({middle(xy)}), and all on land with the columns exchanged ({middle(xy[:, ::-1])})"
    elif _rounder_exchanged(lon, lat):
        why = "the sites would lie as widely from west to east as from south to north with the columns exchanged, and do not now"
    else:
        return
    warnings.warn(f"latitude and longitude may be swapped: {why}; check the columns lat and lon", UserWarning, stacklevel=5)


@dataclass(frozen=True)
class Middle:
    """Direction of the mean of some sites, as seen from the centre of the globe, in degrees, and the km ``within`` which all lie of it."""

    latitude: float
    longitude: float
    within: float

    def __str__(self) -> str:
        north, east = "N" if self.latitude >= 0 else "S", "E" if self.longitude >= 0 else "W"
        return f"around {abs(self.latitude):.1f} {north}, {abs(self.longitude):.1f} {east}"


def middle(xy: Floats) -> Middle:
    """The middle of sites at (longitude, latitude), also across the date line."""
    lon, lat = np.radians(xy).T
    points = np.column_stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    x, y, z = points.mean(axis=0).tolist()
    centre = math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, math.hypot(x, y)))
    around = Travel("haversine", coordinates=np.vstack([centre, xy]))
    return Middle(centre[1], centre[0], float(around.distance(0, np.arange(1, len(xy) + 1)).max()))


def _on_land_exchanged(xy: Floats) -> bool:
    if np.abs(xy[:, 0]).max() > 90.0:
        return False
    return bool(at_open_sea(xy).mean() > 0.5 and not at_open_sea(xy[:, ::-1]).any())


def _rounder_exchanged(lon: Floats, lat: Floats) -> bool:
    if len(lon) < 8 or np.abs(lon).max() > 89.0 or min(np.ptp(lon), np.ptp(lat)) <= 0.0 or max(np.ptp(lon), np.ptp(lat)) > 20.0:
        return False
    spread = float(np.std(lat) / np.std(lon))
    given = abs(math.log(spread / math.cos(math.radians(float(lat.mean())))))
    exchanged = abs(math.log(1.0 / spread / math.cos(math.radians(float(lon.mean())))))
    # Degrees of longitude are the shorter ones: of a round place, those of latitude spread wider only where they are exchanged.
    return spread > SQUARE and given > math.log(1.3) and exchanged < math.log(1.15)
