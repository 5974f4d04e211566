"""Sites of a routing instance: validated, immutable columns, and what holds between sites."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import Code, InputError, UsageError
from ..number_arrays import Flags, Floats, Integers
from ..printable import LONGEST_LINE, printable

Window = tuple[float, float]

COLUMNS = ("depot", "demand", "ready", "due", "service", "reward", "required", "penalty", "pickup", "further_demand", "further_pickup")
"""Arrays of ``Sites`` with one entry per site."""


@dataclass(frozen=True)
class Shipment:
    """A load that one vehicle picks up at a site and delivers at another one later on the same route.

    Parameters
    ----------
    pickup, delivery : int
        Site indices of customers. Both are visited, or, where they are optional, neither.
    load : tuple of float, units of load, >= 0
        One entry a load dimension; a number is the load of the first one.

    Notes
    -----
    Source: Savelsbergh and Sol (1995), The general pickup and delivery problem.
    """

    pickup: int
    delivery: int
    load: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        loads = self.load if isinstance(self.load, Iterable) else (self.load,)
        object.__setattr__(self, "load", tuple(float(v) for v in loads))


@dataclass(frozen=True)
class Group:
    """Alternatives: sites of which at most one is visited, and exactly one where the group is required.

    Parameters
    ----------
    sites : tuple of int
        Site indices of customers, none of them required by itself.
    required : bool
        Whether one of them must be visited.
    """

    sites: tuple[int, ...]
    required: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "sites", tuple(int(v) for v in self.sites))


@dataclass(frozen=True, eq=False)
class Sites:
    """Places to visit or to start from, one entry per site in the file's order.

    Parameters
    ----------
    ids : sequence of str
        The file's own names, all different.
    depot : array of bool
        Sites where routes start and end, where vehicles reload or recharge on their way; they are never visited for their own sake.
    demand : array, units of load, >= 0
        Carried from where the trip starts to the site.
    ready, due : arrays, units of time
        Service may start within [ready, due]; a vehicle may wait. Defaults 0 and infinity.
        At a depot: the earliest departure and the latest return; a stop on the way begins within them too.
    service : array, units of time, >= 0
        At a depot: of a stop there on the way, none at departure and return.
    reward : array, >= 0
        Collected by a visit; counts where the objective has the term ``reward``.
    required : array of bool
        Customers that must be visited; by default all that are no depots and in no group.
    penalty : array, units of cost, >= 0
        Of leaving an optional site out; 0 for members of groups.
    pickup : array, units of load, >= 0
        Collected at the site and carried to where the trip ends; the room that ``demand`` leaves may take it.
    further_demand, further_pickup : arrays of shape (sites, dimensions)
        Of the second load dimension, the third, ...
    coordinates : array of shape (sites, 2), optional
        For maps; distances belong to ``Travel``.
    windows : tuple, optional
        Empty, or one entry per site: empty, or several windows [ready, due] in order, apart from each other. ``ready`` and ``due``
        hold the first opening and the last close.
    skills : tuple of frozenset of str, optional
        Empty, or one entry per site: what a vehicle must be able to do in order to serve it.
    shipments : tuple of Shipment
        Loads to be fetched at one site and brought to another by the same vehicle.
    groups : tuple of Group
        Alternatives, of which at most one is visited.
    attributes : mapping from title to tuple, optional
        Whatever else is known of the sites, one entry per site: shown in tables and maps, kept in files, and never computed with.
    geographic : bool
        Whether coordinates are longitude and latitude in decimal degrees.

    Raises
    ------
    InputError
        Naming the site and the quantity that is wrong.
    """

    ids: tuple[str, ...]
    depot: Flags
    demand: Floats
    ready: Floats
    due: Floats
    service: Floats
    reward: Floats
    required: Flags
    penalty: Floats
    pickup: Floats
    further_demand: Floats
    further_pickup: Floats
    coordinates: Floats | None = None
    windows: tuple[tuple[Window, ...], ...] = ()
    skills: tuple[frozenset[str], ...] = ()
    shipments: tuple[Shipment, ...] = ()
    groups: tuple[Group, ...] = ()
    attributes: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    geographic: bool = False

    @classmethod
    def of(
        cls,
        ids: Sequence[object],
        *,
        depot: ArrayLike | None = None,
        demand: ArrayLike = 0.0,
        ready: ArrayLike = 0.0,
        due: ArrayLike = math.inf,
        service: ArrayLike = 0.0,
        reward: ArrayLike = 0.0,
        required: ArrayLike | None = None,
        penalty: ArrayLike = 0.0,
        pickup: ArrayLike = 0.0,
        coordinates: ArrayLike | None = None,
        windows: Mapping[int, Sequence[Window]] | None = None,
        skills: Mapping[int, Iterable[str]] | None = None,
        shipments: Iterable[Shipment] = (),
        groups: Iterable[Group] = (),
        attributes: Mapping[str, Sequence[Any]] | None = None,
        geographic: bool = False,
    ) -> "Sites":
        """Sites from arrays or scalars; without ``depot`` the first site is the only depot.

        ``demand`` and ``pickup`` of shape (sites, dimensions) hold several loads. ``windows`` and ``skills`` are by site index; a site
        with several windows takes ``ready`` and ``due`` from them.

        Parameters
        ----------
        ids, depot, demand, ready, due, service, reward, required, penalty, pickup, coordinates
            As of the class.
        windows, skills : mapping from site index, optional
            The windows of a site, and what serving it asks for.
        shipments, groups, attributes, geographic
            As of the class.
        """
        n = len(ids)
        if n == 0:
            raise InputError("there are no sites", "missing")
        flags = np.zeros(n, dtype=bool)
        if depot is None:
            flags[0] = True
        else:
            flags[:] = np.asarray(depot, dtype=bool)
        chosen = tuple(groups)
        if required is None:
            must = ~flags
            must[[k for g in chosen for k in g.sites if 0 <= k < n]] = False
        else:
            must = np.array(np.broadcast_to(np.asarray(required, dtype=bool), n))

        def spread(v: ArrayLike) -> Floats:
            return np.array(np.broadcast_to(np.asarray(v, dtype=np.float64), n))

        delivered, collected = _dimensions(demand, n, "demand"), _dimensions(pickup, n, "pickup")
        dimensions = max(delivered.shape[1], collected.shape[1])
        delivered, collected = _widened(delivered, dimensions), _widened(collected, dimensions)
        opens, closes = spread(ready), spread(due)
        several: list[tuple[Window, ...]] = [()] * n if windows else []
        for k, intervals in (windows or {}).items():
            listed = tuple(sorted((float(a), float(b)) for a, b in intervals))
            if not listed:
                raise InputError(f"site {ids[k]} has no time window at all", "missing")
            opens[k], closes[k] = listed[0][0], listed[-1][1]
            several[k] = listed if len(listed) > 1 else ()
        able: list[frozenset[str]] = [frozenset()] * n if skills else []
        for k, names in (skills or {}).items():
            able[k] = frozenset(str(name) for name in names)
        xy = None if coordinates is None else np.array(coordinates, dtype=np.float64)
        return cls(
            tuple(str(i) for i in ids), flags, delivered[:, 0].copy(), opens, closes, spread(service), spread(reward), must & ~flags,
            spread(penalty), collected[:, 0].copy(), delivered[:, 1:].copy(), collected[:, 1:].copy(), xy,
            tuple(several) if any(several) else (), tuple(able) if any(able) else (), tuple(shipments), chosen,
            {str(title): tuple(values) for title, values in (attributes or {}).items()}, geographic,
        )  # fmt: skip

    def __post_init__(self) -> None:
        n = len(self.ids)
        for name in COLUMNS:
            values = getattr(self, name)
            if values.shape[:1] != (n,) or values.ndim != (2 if name.startswith("further") else 1):
                raise InputError(f"{name} must have one entry a site", "wrong-shape", expected=str(n), found=str(values.shape))
            values.setflags(write=False)
        if self.further_demand.shape != self.further_pickup.shape:
            raise InputError("demand and pickup have different numbers of load dimensions", "wrong-shape")
        if self.coordinates is not None:
            if self.coordinates.shape != (n, 2):
                message = "coordinates must have two entries a site"
                raise InputError(message, "wrong-shape", expected=f"({n}, 2)", found=str(self.coordinates.shape))
            self._refuse(~np.isfinite(self.coordinates).all(axis=1), "coordinate of site {} is not finite", self.coordinates)
            self.coordinates.setflags(write=False)
        seen: set[str] = set()
        for site in self.ids:
            if site in seen:
                raise InputError(f"two sites have the id {site!r}", "duplicate", expected="different ids")
            seen.add(site)
        for name in ("demand", "service", "reward", "penalty", "pickup"):
            values = getattr(self, name)
            self._refuse(np.asarray(~(values >= 0) | np.isinf(values)), name + " of site {} must be finite and not negative", values)
        for name in ("demand", "pickup"):
            values = getattr(self, f"further_{name}")
            bad = (~(values >= 0) | np.isinf(values)).any(axis=1) if values.size else np.zeros(n, dtype=bool)
            self._refuse(bad, name + " of site {} must be finite and not negative in each load dimension", values)
        self._refuse(~np.isfinite(self.ready), "ready time of site {} must be finite", self.ready)
        self._refuse(np.asarray(np.isnan(self.due) | np.isneginf(self.due)), "due time of site {} must be a number", self.due)
        window = np.column_stack([self.ready, self.due])
        self._refuse(np.asarray(self.ready > self.due), "time window of site {} closes before it opens", window, "contradiction")
        if not self.depot.any():
            raise InputError("there is no depot", "missing")
        self._check_windows()
        if self.skills and len(self.skills) != n:
            raise InputError("skills must have one entry a site", "wrong-shape", expected=str(n), found=str(len(self.skills)))
        self._check_groups()
        self._check_shipments()
        for title, entries in self.attributes.items():
            if len(entries) != n:
                raise InputError(f"attribute {title!r} must have one entry a site", "wrong-shape", expected=str(n), found=str(len(entries)))

    def _refuse(self, bad: Flags | np.bool_, message: str, values: Floats, code: Code = "out-of-range") -> None:
        if np.any(bad):
            k = int(np.argmax(bad))
            raise InputError(message.format(self.ids[k]), code, found=str(values[k]))

    def _check_windows(self) -> None:
        if not self.windows:
            return
        if len(self.windows) != len(self.ids):
            raise InputError("windows must have one entry a site", "wrong-shape", expected=str(len(self.ids)), found=str(len(self.windows)))
        for k, listed in enumerate(self.windows):
            if not listed:
                continue
            name, times = self.ids[k], [t for window in listed for t in window]
            if self.depot[k]:
                message = f"depot {name} has several time windows"
                raise InputError(message, "unsupported", expected="one, from the earliest departure to the latest return")
            if len(listed) < 2 or any(math.isnan(t) for t in times) or times != sorted(times) or len(set(times[1:-1])) < len(times) - 2:
                message = f"time windows of site {name} must be in order and apart from each other"
                raise InputError(message, "contradiction", found=str(list(listed)))
            if (times[0], times[-1]) != (float(self.ready[k]), float(self.due[k])):
                found = f"[{self.ready[k]:g}, {self.due[k]:g}]"
                raise InputError(f"ready and due of site {name} are not the ends of its windows", "contradiction", found=found)

    def _customer(self, site: int, what: str) -> str:
        """The id of a customer; raises InputError where there is none."""
        if not 0 <= site < len(self.ids):
            raise InputError(f"{what} names site {site}, which does not exist", "unknown-name", expected=f"0 to {len(self.ids) - 1}")
        if self.depot[site]:
            raise InputError(f"{what} names the depot {self.ids[site]}", "contradiction", expected="a customer")
        return self.ids[site]

    def _check_groups(self) -> None:
        grouped: set[int] = set()
        for number, group in enumerate(self.groups, start=1):
            what = f"group {number}"
            if not group.sites:
                raise InputError(f"{what} has no sites", "missing")
            if len(set(group.sites)) < len(group.sites):
                twice = next(k for k in group.sites if group.sites.count(k) > 1)
                raise InputError(f"{what} has the site {self._customer(twice, what)} twice", "duplicate", expected="different sites")
            for site in group.sites:
                name = self._customer(site, what)
                if site in grouped:
                    raise InputError(f"site {name} is in two groups", "duplicate", expected="one group a site")
                if self.required[site]:
                    message = f"site {name} is required and in {what}"
                    raise InputError(message, "contradiction", expected="a group whose members may be left out")
                if self.penalty[site]:
                    message = f"site {name} of {what} has a penalty of its own"
                    raise InputError(message, "contradiction", expected="0", found=str(self.penalty[site]))
            grouped.update(group.sites)

    def _check_shipments(self) -> None:
        dimensions = 1 + self.further_demand.shape[1]
        follows: dict[int, set[int]] = {}
        for shipment in self.shipments:
            first, last = (self._customer(k, "a shipment") for k in (shipment.pickup, shipment.delivery))
            what = f"shipment from {first} to {last}"
            if first == last:
                raise InputError(f"{what} ends where it begins", "contradiction", expected="two sites")
            if not 1 <= len(shipment.load) <= dimensions or not all(0 <= v < math.inf for v in shipment.load):
                found = ", ".join(f"{v:g}" for v in shipment.load)
                message = f"load of the {what} must be finite and not negative"
                raise InputError(message, "out-of-range", expected=f"{dimensions} numbers at most", found=found)
            if self.required[shipment.pickup] != self.required[shipment.delivery]:
                raise InputError(f"one end of the {what} is required, the other is not", "contradiction", expected="both or neither")
            begins = float(self.ready[shipment.pickup] + self.service[shipment.pickup])
            if self.required[shipment.pickup] and float(self.due[shipment.delivery]) < begins:
                found = f"due {self.due[shipment.delivery]:g}, picked up at {begins:g} at the earliest"
                message = f"delivery of the {what} comes before its pickup"
                raise InputError(message, "contradiction", expected="a delivery after the pickup", found=found)
            follows.setdefault(shipment.pickup, set()).add(shipment.delivery)
        unordered = dict(follows)
        while unordered:
            free = [k for k in unordered if not unordered[k] & unordered.keys()]
            if not free:
                names = ", ".join(self.ids[k] for k in sorted(unordered))
                message = f"each of these sites is to be visited before the others: {names}"
                raise InputError(message, "contradiction", expected="shipments without a cycle")
            for k in free:
                del unordered[k]

    def __len__(self) -> int:
        return len(self.ids)

    @cached_property
    def depots(self) -> Integers:
        """Indices of the depots."""
        return _fixed(np.nonzero(self.depot)[0])

    @cached_property
    def customers(self) -> Integers:
        """Indices of all sites that are no depots."""
        return _fixed(np.nonzero(~self.depot)[0])

    @property
    def dimensions(self) -> int:
        """Number of load dimensions."""
        return 1 + int(self.further_demand.shape[1])

    def index(self) -> dict[str, int]:
        """Index of each id."""
        return {site: k for k, site in enumerate(self.ids)}

    def subset(self, sites: ArrayLike) -> "Sites":
        """The given sites, in the given order; groups keep the members that are among them.

        Raises
        ------
        UsageError
            If a shipment has one end among them and one outside.
        """
        keep = np.asarray(sites, dtype=np.int64)
        place = {site: k for k, site in enumerate(keep.tolist())}
        shipments = []
        for s in self.shipments:
            ends = [k in place for k in (s.pickup, s.delivery)]
            if any(ends) and not all(ends):
                raise UsageError(f"these sites hold one end only of the shipment from {self.ids[s.pickup]} to {self.ids[s.delivery]}")
            if all(ends):
                shipments.append(Shipment(place[s.pickup], place[s.delivery], s.load))
        members = [(tuple(place[k] for k in g.sites if k in place), g.required) for g in self.groups]
        return Sites(
            ids=tuple(self.ids[k] for k in keep.tolist()),
            coordinates=None if self.coordinates is None else np.array(self.coordinates[keep]),
            windows=tuple(self.windows[k] for k in keep.tolist()) if self.windows else (),
            skills=tuple(self.skills[k] for k in keep.tolist()) if self.skills else (),
            shipments=tuple(shipments),
            groups=tuple(Group(kept, required) for kept, required in members if kept),
            attributes={title: tuple(entries[k] for k in keep.tolist()) for title, entries in self.attributes.items()},
            geographic=self.geographic,
            **{name: np.array(getattr(self, name)[keep]) for name in COLUMNS},
        )


UNUSED = "columns kept and not used: "


def unused(attributes: Iterable[str]) -> tuple[str, ...]:
    """Notes on columns that are kept and count for nothing."""
    return in_lines(UNUSED, attributes)


def with_unused(notes: Iterable[str], attributes: Iterable[str]) -> tuple[str, ...]:
    """Notes with those on unused columns as the columns are, whatever was noted before."""
    listed = list(notes)
    at = next((k for k, note in enumerate(listed) if note.startswith(UNUSED)), len(listed))
    kept = [[note for note in part if not note.startswith(UNUSED)] for part in (listed[:at], listed[at:])]
    return (*kept[0], *unused(attributes), *kept[1])


def in_lines(beginning: str, names: Iterable[str]) -> tuple[str, ...]:
    """Notes that list names, each short enough to be shown whole."""
    notes: list[str] = []
    for title in names:
        name = printable(title, 60)
        if notes and len(notes[-1]) + len(name) < LONGEST_LINE - 2:
            notes[-1] += f", {name}"
        else:
            notes.append(beginning + name)
    return tuple(notes)


def _dimensions(values: ArrayLike, n: int, what: str) -> Floats:
    """Loads as an array of shape (sites, dimensions)."""
    loads = np.asarray(values, dtype=np.float64)
    if loads.ndim < 2:
        return np.array(np.broadcast_to(loads, n))[:, None]
    if loads.ndim > 2 or loads.shape[0] != n or loads.shape[1] < 1:
        message = f"{what} must have one row a site and one column a load dimension"
        raise InputError(message, "wrong-shape", expected=f"({n}, ...)", found=str(loads.shape))
    return loads


def _widened(values: Floats, dimensions: int) -> Floats:
    return np.hstack([values, np.zeros((len(values), dimensions - values.shape[1]))])


def _fixed(indices: Integers) -> Integers:
    indices.setflags(write=False)
    return indices
