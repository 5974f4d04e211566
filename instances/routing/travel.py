"""Distances and durations between sites under a stated rounding convention."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError, UsageError
from ..memory import fits, readable
from ..number_arrays import Floats
from ..suggestions import did_you_mean

CONVENTIONS = ("file", "exact", "trunc1", "trunc2", "round", "ceil")
ALIASES = {"dimacs": "trunc1"}

# The shortest decimal of a distance may lie a few ulps below the number meant (0.29 * 100 = 28.999999999999996).
# Square roots of integers are either integers or at least 1e-9 away from one up to 5e8, so this changes none of them.
_GUARD = 1e-9


def convention_named(name: str) -> str:
    """Canonical name of a distance convention; raises UsageError for an unknown one."""
    name = ALIASES.get(name, name)
    if name not in CONVENTIONS:
        known = (*CONVENTIONS, *ALIASES)
        raise UsageError(f"unknown convention {name!r}; choose from {', '.join(known)}{did_you_mean(name, known)}", "unknown-name")
    return name


def _nint(d: Floats) -> Floats:
    return np.floor(d + 0.5)


def _truncate(d: Floats, scale: float) -> Floats:
    return np.floor(d * scale + _GUARD) / scale


def _ceil(d: Floats) -> Floats:
    return np.ceil(d - _GUARD)


# No lambdas: a travel is pickled when a solver runs in a process of its own.
_ROUNDING: dict[str, Callable[[Floats], Floats]] = {
    "exact": np.asarray,
    "trunc1": partial(_truncate, scale=10.0),
    "trunc2": partial(_truncate, scale=100.0),
    "round": _nint,
    "ceil": _ceil,
}


def _euclidean(a: Floats, b: Floats) -> Floats:
    dx, dy = a[..., 0] - b[..., 0], a[..., 1] - b[..., 1]
    return np.asarray(np.sqrt(dx * dx + dy * dy))


def _manhattan(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.abs(a - b).sum(axis=-1))


def _att(a: Floats, b: Floats) -> Floats:
    dx, dy = a[..., 0] - b[..., 0], a[..., 1] - b[..., 1]
    return np.asarray(np.sqrt((dx * dx + dy * dy) / 10.0))


def _geo(a: Floats, b: Floats) -> Floats:
    """Great-circle distance in km, TSPLIB 95 section 2.4 (degrees.minutes, its own pi and radius), before rounding."""

    def radians(xy: Floats) -> Floats:
        degrees = np.trunc(xy)
        return 3.141592 * (degrees + 5.0 * (xy - degrees) / 3.0) / 180.0

    p, q = radians(a), radians(b)
    q1 = np.cos(p[..., 1] - q[..., 1])
    q2 = np.cos(p[..., 0] - q[..., 0])
    q3 = np.cos(p[..., 0] + q[..., 0])
    cosine = np.clip(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3), -1.0, 1.0)
    return np.asarray(6378.388 * np.arccos(cosine))


EARTH = 6371.0088
"""Mean radius of the Earth in km (IUGG)."""

UNITS_OF_DISTANCE = {"km": 1.0, "m": 1000.0, "mi": 1.0 / 1.609344}
"""Number of each unit in a km."""


def _haversine(a: Floats, b: Floats, unit: str = "km") -> Floats:
    """Great-circle distance between (longitude, latitude) in decimal degrees, on a sphere (Sinnott 1984)."""
    p, q = np.radians(a), np.radians(b)
    half = np.sin((q - p) / 2.0) ** 2
    h = half[..., 1] + np.cos(p[..., 1]) * np.cos(q[..., 1]) * half[..., 0]
    return np.asarray(2.0 * EARTH * UNITS_OF_DISTANCE[unit] * np.arcsin(np.sqrt(np.clip(h, 0.0, 1.0))))


def _file_att(d: Floats) -> Floats:
    t = _nint(d)
    return np.where(t < d, t + 1.0, t)


def _file_geo(d: Floats) -> Floats:
    return np.floor(d + 1.0)


@dataclass(frozen=True)
class Metric:
    """A rule from coordinates to distances, and the rounding that a TSPLIB file prescribes with it (None: none)."""

    name: str
    distance: Callable[[Floats, Floats], Floats]
    file_rounding: Callable[[Floats], Floats] | None


METRICS: dict[str, Metric] = {
    m.name: m
    for m in (
        Metric("euclidean", _euclidean, None),
        Metric("manhattan", _manhattan, None),
        Metric("EUC_2D", _euclidean, _nint),
        Metric("MAN_2D", _manhattan, _nint),
        Metric("CEIL_2D", _euclidean, np.ceil),
        Metric("ATT", _att, _file_att),
        Metric("GEO", _geo, _file_geo),
        Metric("haversine", _haversine, None),
        *(Metric(f"haversine-{unit}", partial(_haversine, unit=unit), None) for unit in UNITS_OF_DISTANCE if unit != "km"),
    )
}
GEOGRAPHIC = frozenset(name for name in METRICS if name.startswith("haversine"))
"""Metrics whose coordinates are longitude and latitude in decimal degrees."""

EXPLICIT = "EXPLICIT"

STRIP = 1 << 20
"""Distances that are computed at once: more would only take more memory, and be slower."""


@dataclass(frozen=True, eq=False)
class Travel:
    """Distances and durations of direct moves between sites.

    Parameters
    ----------
    metric : str
        A key of ``METRICS``, or ``"EXPLICIT"`` for a matrix.
    coordinates : array of shape (sites, 2), optional
        Needed by every metric but EXPLICIT.
    matrix : array of shape (sites, sites), optional
        Distances of an EXPLICIT metric, in the file's units.
    duration_matrix : array of shape (sites, sites), optional
        Durations, where they differ from the distances. Taken as they are: a convention rounds distances.
    closing : array of shape (sites, sites), optional
        Latest time at which a direct move may begin, infinite where it never closes: roads and cells that close with time.
    variances : array of shape (sites, sites), optional
        Variances of the durations, which are then means of independent normal times. Taken as they are.
    pace : float
        Without a duration matrix: how many units of time a unit of distance takes.
    convention : str
        ``file, exact, trunc1, trunc2, round`` or ``ceil``; ``dimacs`` is ``trunc1``. The default is ``file`` where the
        metric prescribes a rounding and ``exact`` elsewhere.

    Raises
    ------
    InputError
        If the arrays do not fit the metric, or hold a NaN or a negative distance.
    UsageError
        If the convention is unknown, or ``file`` where the metric prescribes nothing.

    Notes
    -----
    Without a duration matrix one unit of distance takes ``pace`` units of time, one by default, and it is distances that are rounded,
    which is how Solomon's files are scored. Source of the metrics: TSPLIB 95, section 2.
    """

    metric: str
    coordinates: Floats | None = None
    matrix: Floats | None = None
    duration_matrix: Floats | None = None
    convention: str = ""
    closing: Floats | None = None
    variances: Floats | None = None
    pace: float = 1.0
    _rounding: Callable[[Floats], Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        put: Callable[[str, Any], None] = lambda name, value: object.__setattr__(self, name, value)  # noqa: E731
        if self.metric == EXPLICIT:
            if self.matrix is None:
                raise InputError("an EXPLICIT travel needs a matrix", "missing")
            put("matrix", _square(self.matrix, "distance"))
        elif self.metric in METRICS:
            if self.coordinates is None:
                raise InputError(f"travel by {self.metric} needs coordinates", "missing")
        else:
            raise InputError(f"unknown metric {self.metric!r}", "unknown-name", expected=", ".join((*METRICS, EXPLICIT)))
        if self.coordinates is not None:
            xy = np.array(self.coordinates, dtype=np.float64)
            if xy.ndim != 2 or xy.shape[1] != 2:
                raise InputError("coordinates must be an array of shape (sites, 2)", "wrong-shape", found=f"shape {xy.shape}")
            if not np.isfinite(xy).all():
                raise InputError(f"coordinate of site {int(np.nonzero(~np.isfinite(xy).all(axis=1))[0][0])} is not finite", "out-of-range")
            xy.setflags(write=False)
            put("coordinates", xy)
        for field_name, what in (("duration_matrix", "duration"), ("variances", "variance")):
            values = getattr(self, field_name)
            if values is not None:
                put(field_name, _square(values, what))
                if len(getattr(self, field_name)) != len(self):
                    raise InputError(f"the {what} matrix has another size than the sites", "wrong-shape", found=str(len(values)))
        if self.closing is not None:
            put("closing", self._closing(self.closing))
        if not 0.0 < self.pace < np.inf:
            raise InputError("the time that a unit of distance takes must be positive and finite", "out-of-range", found=str(self.pace))
        file_rounding = METRICS[self.metric].file_rounding if self.metric in METRICS else _ROUNDING["exact"]
        convention = convention_named(self.convention or ("file" if file_rounding is not None else "exact"))
        if convention == "file":
            if file_rounding is None:
                raise UsageError(f"convention 'file' needs a file that prescribes a rounding; {self.metric} distances have none, use exact")
            rounding = file_rounding
        else:
            rounding = _ROUNDING[convention]
        put("convention", convention)
        put("_rounding", rounding)

    def __len__(self) -> int:
        data = self.matrix if self.matrix is not None else self.coordinates
        assert data is not None
        return len(data)

    def with_convention(self, convention: str) -> "Travel":
        """The same travel under another rounding convention."""
        return replace(self, convention=convention)

    def subset(self, sites: ArrayLike) -> "Travel":
        """The travel between the given sites, in the given order."""
        keep = np.asarray(sites, dtype=np.int64)
        cut: Callable[[Floats | None], Floats | None] = lambda m: None if m is None else m[np.ix_(keep, keep)]  # noqa: E731
        xy = None if self.coordinates is None else self.coordinates[keep]
        return replace(
            self, coordinates=xy, matrix=cut(self.matrix), duration_matrix=cut(self.duration_matrix), closing=cut(self.closing),
            variances=cut(self.variances),
        )  # fmt: skip

    def at_speed(self, speed: float) -> "Travel":
        """The same distances, in durations divided by ``speed``."""
        if speed == 1.0:
            return self
        varied = None if self.variances is None else self.variances / speed / speed
        if self.duration_matrix is None:
            return replace(self, pace=self.pace / speed, variances=varied)
        return replace(self, duration_matrix=self.duration_matrix / speed, variances=varied)

    @property
    def own_durations(self) -> bool:
        """True if durations differ from the distances."""
        return self.duration_matrix is not None or self.pace != 1.0

    @property
    def uncertain(self) -> bool:
        """True if some duration is uncertain."""
        return self.variances is not None and bool(self.variances.any())

    def _closing(self, values: ArrayLike) -> Floats:
        times = np.array(values, dtype=np.float64)
        if times.shape != (len(self), len(self)):
            message = "closing times must have one entry a move"
            raise InputError(message, "wrong-shape", expected=f"({len(self)}, {len(self)})", found=str(times.shape))
        np.fill_diagonal(times, np.inf)
        if np.isnan(times).any():
            i, j = np.argwhere(np.isnan(times))[0].tolist()
            raise InputError(f"closing time of the move in row {i + 1}, column {j + 1} must be a number", "out-of-range", found="nan")
        times.setflags(write=False)
        return times

    def distance(self, origin: ArrayLike, destination: ArrayLike) -> Floats:
        """Distances of the moves ``origin[k] -> destination[k]``; broadcasts like numpy."""
        return self._between(origin, destination, self._rounding)

    def duration(self, origin: ArrayLike, destination: ArrayLike) -> Floats:
        """Durations of the moves ``origin[k] -> destination[k]``; broadcasts like numpy."""
        if self.duration_matrix is None:
            return self.distance(origin, destination) if self.pace == 1.0 else self.pace * self.distance(origin, destination)
        return np.asarray(self.duration_matrix[np.asarray(origin, dtype=np.int64), np.asarray(destination, dtype=np.int64)])

    def rounded(self, distances: ArrayLike) -> Floats:
        """Distances of the metric, as the convention rounds them: it keeps their order."""
        return self._rounding(np.asarray(distances, dtype=np.float64))

    def least_distance(self, origin: ArrayLike, destination: ArrayLike) -> Floats:
        """Distances rounded down to whole numbers, which no convention undercuts."""
        return self._between(origin, destination, np.floor)

    def least_duration(self, origin: ArrayLike, destination: ArrayLike) -> Floats:
        """Durations that no convention undercuts."""
        if self.duration_matrix is None:
            return self.pace * self.least_distance(origin, destination)
        return self.duration(origin, destination)

    def _between(self, origin: ArrayLike, destination: ArrayLike, rounding: Callable[[Floats], Floats]) -> Floats:
        i, j = np.asarray(origin, dtype=np.int64), np.asarray(destination, dtype=np.int64)
        if self.matrix is not None:
            raw = self.matrix[i, j]
        else:
            assert self.coordinates is not None
            raw = METRICS[self.metric].distance(self.coordinates[i], self.coordinates[j])
        return np.where(i == j, 0.0, rounding(raw))  # GEO prescribes 1 between distinct sites in one place

    @cached_property
    def distances(self) -> Floats:
        """All distances, shape (sites, sites), zero diagonal, read-only.

        Raises
        ------
        UsageError
            If there is no memory for them.
        """
        n = len(self)
        if not fits(16.0 * n * n):  # whoever asks for them makes at least one more such matrix
            message = f"all distances between {n:,} sites need {readable(8.0 * n * n)}, more than there is; savings needs none of them"
            raise UsageError(message, "too-large")
        matrix, every = np.empty((n, n)), np.arange(n)
        step = max(1, STRIP // max(1, n))
        for first in range(0, n, step):
            matrix[first : first + step] = self.distance(every[first : first + step, None], every[None, :])
        return _frozen_matrix(matrix)

    @cached_property
    def durations(self) -> Floats:
        """All durations, shape (sites, sites), zero diagonal, read-only."""
        if not self.own_durations:
            return self.distances
        return _frozen_matrix(self.pace * self.distances if self.duration_matrix is None else self.duration_matrix.copy())


def _frozen_matrix(matrix: Floats) -> Floats:
    np.fill_diagonal(matrix, 0.0)
    matrix.setflags(write=False)
    return matrix


def _square(values: ArrayLike, what: str) -> Floats:
    matrix = np.array(values, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise InputError(f"the {what} matrix must be square", "wrong-shape", found=f"shape {matrix.shape}")
    bad = ~(matrix >= 0.0) | np.isinf(matrix)
    np.fill_diagonal(bad, False)
    if bad.any():
        i, j = (int(v[0]) for v in np.nonzero(bad))
        cure = "forbidden=array of the problem for moves that cannot be made" if matrix[i, j] == np.inf else None
        message = f"{what} in row {i + 1}, column {j + 1} must be finite and not negative"
        raise InputError(message, "out-of-range", expected=cure, found=str(matrix[i, j]))
    np.fill_diagonal(matrix, 0.0)
    matrix.setflags(write=False)
    return matrix
