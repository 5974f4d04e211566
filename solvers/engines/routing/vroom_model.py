"""Routing problems as VROOM's own input."""

from __future__ import annotations

from datetime import timedelta
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.routes import Route, Routes
from .integer_scales import UNLIMITED, Integers
from .routing_integers import IntegerRouting

if TYPE_CHECKING:
    from .vroom_priorities import Priorities

LARGEST = 2**32 - 1
"""VROOM reads costs, distances and times as 32 bits without a sign, and refuses costs whose sum along an answer could be larger."""

SEARCHES = 32
"""The most searches that VROOM makes at once. With fewer threads they wait at a semaphore of libstdc++, which may miss that it is free, and
then waits for ever (GCC#98033)."""

STAYS = frozenset({"max-duration", "energy:elapsed"})
"""Limits on a route's duration. VROOM has one on time on the move: where nobody waits, services can be added to the moves."""

TIMED = STAYS | {"time-windows", "several-windows", "depot-windows", "shifts", "energy:travel", "energy:elapsed-fixed-start"}
"""Features for which VROOM has to know how long moves take."""

PRICED = frozenset({"duration-cost", "objective:total-duration"})
"""Costs of a route's duration. VROOM knows costs of moves: where nobody waits, those of time and service can be added to them."""


class Model:
    """A routing problem as VROOM's input.

    Parameters
    ----------
    asked : Priorities
    data : IntegerRouting
        Of what is asked after the priorities.
    most : int
        Vehicles of each unlimited type.

    Attributes
    ----------
    types : list of int
        Fleet's type of each vehicle; those that no route can use are left out.
    clipped : bool
        Whether an answer of the problem may be too late for VROOM's clock.
    """

    def __init__(self, asked: Priorities, data: IntegerRouting, most: int) -> None:
        self.asked, self.problem, self.data = asked, asked.problem, data
        problem = asked.problem
        held = problem.features()
        self.timed = bool(TIMED & held)
        self.types = [
            k for k, v in enumerate(problem.fleet) if data.closes[k] >= data.opens[k]
            for _ in range(most if v.count is None else min(v.count, len(asked.of)))
        ]  # fmt: skip
        # Without waiting, a route's duration is what its moves take if each begins with the service of where it starts.
        self.within = bool(STAYS & held)
        longest = max(int((m.duration + data.service[:, None]).max(axis=1).sum()) for m in data.moves)
        horizon = int(max(opens for listed in data.windows for opens, _ in listed)) + longest
        self.clipped = self.timed and min(max(horizon, int(data.opens.max()) + longest), int(data.closes.max())) > LARGEST
        self.words = {word: k for k, word in enumerate(sorted({w for s in problem.sites.skills for w in s}))}
        self.carried = [int(sum(values[:, k].sum() for values in (data.demand, data.pickup, data.shipped))) for k in data.limited]
        self.routes: dict[int, tuple[int, ...]] = {}

    def begin(self, answer: Routes) -> None:
        """Start from an answer, if it has no site or route too many and breaks no rule, which VROOM would refuse."""
        if not {site for route in answer for site in route.visits} <= self.asked.of.keys():
            return
        free: dict[int, list[int]] = {}
        for vehicle, kind in enumerate(self.types):
            free.setdefault(kind, []).append(vehicle)
        if any(len(free.get(kind, ())) < len([r for r in answer if r.vehicle == kind]) for kind in {r.vehicle for r in answer}):
            return
        if self.problem.evaluate(answer).feasible:
            self.routes = {free[route.vehicle].pop(0): route.visits for route in answer}

    def solved(self, level: int, seconds: float) -> tuple[int, Routes | None]:
        """Cost and routes, or None where a required site is left out."""
        asked = {"exploration_level": level, "nb_threads": SEARCHES, "timeout": timedelta(seconds=seconds)}
        try:
            found = self._input().solve(**asked)
        except Exception as fault:
            if not self.routes or type(fault).__name__ != "VroomInputException":
                raise
            # It holds a site that is too far for a round trip of its own out of reach, whatever ways there are through others.
            self.routes = {}
            found = self._input().solve(**asked)
        visits: dict[int, list[int]] = {}
        frame = found.routes
        for vehicle, kind, site in zip(frame["vehicle_id"], frame["type"], frame["location_index"], strict=True):
            if kind in ("job", "pickup", "delivery"):
                visits.setdefault(int(vehicle), []).append(int(site))
        if not self.asked.required <= {site for sites in visits.values() for site in sites}:
            return 0, None
        return int(found.summary.cost), Routes.of(Route(tuple(sites), self.types[v]) for v, sites in sorted(visits.items()))

    def _input(self) -> Any:
        import vroom

        made, data = vroom.Input(), self.data
        measured = any(data.max_distance[k] != UNLIMITED for k in self.types)  # all profiles have distances, or none has
        for k in sorted(set(self.types)):
            moves = data.moves_of(k)
            taken = moves.duration + data.service[:, None]
            durations = taken if self.within else moves.duration
            made.set_costs_matrix(str(k), _unsigned(moves.distance * data.unit[k] + taken * data.time[k]))
            made.set_durations_matrix(str(k), _unsigned(durations if self.timed else np.zeros_like(durations)))
            if measured:
                made.set_distances_matrix(str(k), _unsigned(moves.distance_up))
        shipments = self.problem.sites.shipments
        ends = {site for s in shipments for site in (s.pickup, s.delivery)}
        made.add_job([self._job(vroom, site) for site in self.asked.of if site not in ends])
        for k, shipment in enumerate(shipments):
            first, last = shipment.pickup, shipment.delivery
            if first not in self.asked.of:
                continue
            made.add_shipment(
                self._step(vroom, first), self._step(vroom, last), vroom.Amount(data.shipped[k, data.limited].tolist()),
                self._skills(first) | self._skills(last), self.asked.of[first],
            )  # fmt: skip
        made.add_vehicle([self._vehicle(vroom, number, k) for number, k in enumerate(self.types)])
        return made

    def _skills(self, site: int) -> set[int]:
        return {self.words[word] for word in self.problem.sites.skills[site]} if self.words else set()

    def _time(self, vroom: Any, site: int) -> dict[str, Any]:
        if not self.timed:
            return {}
        served = 0 if self.within else int(self.data.service[site])
        return {"default_service": served, "time_windows": [_window(vroom, *w) for w in self.data.windows[site] if w[0] <= LARGEST]}

    def _step(self, vroom: Any, site: int) -> Any:
        return vroom.ShipmentStep(site, site, **self._time(vroom, site))

    def _job(self, vroom: Any, site: int) -> Any:
        delivery, pickup = (values[site, self.data.limited].tolist() for values in (self.data.demand, self.data.pickup))
        return vroom.Job(
            site, site, delivery=delivery, pickup=pickup, skills=self._skills(site), priority=self.asked.of[site], **self._time(vroom, site)
        )  # fmt: skip

    def _vehicle(self, vroom: Any, number: int, k: int) -> Any:
        data, vehicle, limits = self.data, self.problem.fleet[k], {}
        longest = int(min(data.travel_limit[k], data.max_duration[k]))
        if longest != UNLIMITED:
            limits["max_travel_time"] = min(longest, LARGEST)
        if data.max_distance[k] != UNLIMITED:
            limits["max_distance"] = int(min(data.max_distance[k], LARGEST))
        return vroom.Vehicle(
            number, start=vehicle.start, end=vehicle.end, profile=str(k), costs=vroom.VehicleCosts(fixed=int(data.fixed[k])),
            capacity=[min(int(data.capacity[k, dimension]), most) for dimension, most in zip(data.limited, self.carried, strict=True)],
            time_window=_window(vroom, data.opens[k], data.closes[k]) if self.timed else None,
            skills={number for word, number in self.words.items() if word in vehicle.skills},
            steps=self._steps(vroom, self.routes.get(number, ())), **limits,
        )  # fmt: skip

    def _steps(self, vroom: Any, visits: tuple[int, ...]) -> list[Any]:
        begun: dict[int, Any] = {}
        for shipment in self.problem.sites.shipments:
            begun |= {shipment.pickup: vroom.VehicleStepPickup, shipment.delivery: vroom.VehicleStepDelivery}
        return [begun.get(site, vroom.VehicleStepSingle)(site) for site in visits]


def _unsigned(values: Integers) -> Any:
    return values.astype(np.uint32)


def _window(vroom: Any, opens: int, closes: int) -> Any:
    return vroom.TimeWindow(int(min(opens, LARGEST)), int(min(closes, LARGEST)))
