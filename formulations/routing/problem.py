"""Routing problems: sites, travel, fleet, and an objective made of terms."""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.document import dump_json
from ...instances.errors import InputError, UsageError
from ...instances.printable import printable
from ...instances.routing.features import restrictions
from ...instances.routing.instance import RoutingInstance, Sites, VehicleType, check_routing_data, fleet_size
from ...instances.routing.solution_files import routes_from_text, sol_text, tour_text
from ...instances.routing.travel import Travel
from ..evaluation import Evaluation
from ..evidence import Evidence, LeftOut, Reason
from ..problem import Decision, Problem
from ..references import indices_of
from .answers import routes_from_json, routes_to_frame, routes_to_json
from .facts import digested, facts
from .fleet_need import fleet_conflicts, none
from .judge import evaluate_routes
from .left_out import left_out
from .objective import Composable, Objective, Reward, Vehicles
from .reachability import unreachable
from .routes import Route, Routes
from .vroom_answers import is_vroom_output, routes_from_vroom, vroom_output

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, init=False)
class RoutingProblem(Problem):
    """Visit sites with a fleet.

    Parameters
    ----------
    sites : Sites
    travel : Travel
    fleet : sequence of VehicleType
    objective : Objective, term, weighted sum of terms, or text
        Default: total cost. As text: ``"vehicles then total-cost"``, ``"total-cost - 2*reward"``.
    min_vehicles : int
        Routes that must be used at least.
    forbidden : bool array of shape (sites, sites), optional
        Moves that no route makes. Checkers and the judge know them; what is for whole problems refuses them.
    team_risk : float, optional
        Largest probability that any route overruns a limit, where durations are uncertain.
    name : str
    problem : str
        Name of the member of the family ("vrptw", "cvrp", "tsp", ...).

    Raises
    ------
    InputError
        If the parts do not fit each other.
    """

    family: ClassVar[str] = "routing"
    answer_suffixes: ClassVar[tuple[str, ...]] = (".sol", ".tour", ".vroom")
    sites: Sites
    travel: Travel
    fleet: tuple[VehicleType, ...]
    objective: Objective
    min_vehicles: int
    name: str
    problem: str
    notes: tuple[str, ...]
    forbidden: NDArray[np.bool_] | None
    team_risk: float | None

    def __init__(
        self,
        sites: Sites,
        travel: Travel,
        fleet: Sequence[VehicleType],
        objective: Composable | str | None = None,
        min_vehicles: int = 0,
        name: str = "problem",
        problem: str = "cvrp",
        notes: Sequence[str] = (),
        forbidden: NDArray[np.bool_] | None = None,
        team_risk: float | None = None,
    ) -> None:
        aim = Objective() if objective is None else Objective.of(objective)
        self.__dict__.update(
            sites=sites, travel=travel, fleet=tuple(fleet), objective=aim, min_vehicles=min_vehicles, name=name, problem=problem,
            notes=tuple(notes), forbidden=forbidden, team_risk=team_risk,
        )  # fmt: skip
        if forbidden is not None and (forbidden.shape != (len(sites), len(sites)) or forbidden.dtype != np.bool_):
            raise InputError(
                "forbidden moves must be truth values, one for each pair of sites", found=f"{forbidden.dtype} {forbidden.shape}"
            )
        check_routing_data(sites, travel, self.fleet, min_vehicles, team_risk)

    # -- construction ------------------------------------------------------------------------------------------------

    @classmethod
    def from_frame(
        cls,
        sites: pd.DataFrame,
        *,
        travel: Any = None,
        durations: Any = None,
        vehicles: int | None = None,
        capacity: float = math.inf,
        max_duration: float = math.inf,
        convention: str = "",
        objective: Composable | str | None = None,
        name: str = "frame",
        closing: Any = None,
        fleet: Any = None,
        min_vehicles: int = 0,
        windows: Mapping[Any, Sequence[tuple[float, float]]] | None = None,
        shipments: Iterable[Sequence[Any]] = (),
        groups: Iterable[Any] = (),
        variances: Any = None,
        team_risk: float | None = None,
        problem: str | None = None,
    ) -> RoutingProblem:
        """A problem from a pandas frame, one row a site.

        Parameters
        ----------
        sites : DataFrame
            Columns ``id`` (or the index), ``x, y, demand, pickup, ready, due, service, reward, required, penalty, depot, skills``, all
            but the coordinates (or ``travel``) optional; ``demand2, pickup2, ...`` are further load dimensions. Without ``depot`` the
            first row is the depot.
        travel, durations, closing : array or DataFrame of shape (sites, sites), or (the first two) scipy.sparse (CSR), optional
            Distances, durations, and latest times at which moves may begin; Euclidean from ``x, y`` without them. A sparse matrix stands
            for a road graph: its shortest paths are the distances.
        vehicles, capacity, max_duration
            The fleet, all alike.
        fleet : DataFrame or sequence of mappings, optional
            In their place: one entry a vehicle type, with the keys of waybound's JSON (docs/formats.md).
        min_vehicles : int
            Routes that must be used at least.
        windows : mapping from id to a list of pairs, optional
            Sites with several time windows.
        shipments : iterable of (pickup id, delivery id) or (pickup id, delivery id, load)
        groups : iterable of iterables of ids
            Alternatives, of which exactly one is visited; ``{"sites": [...], "required": False}`` for at most one.
        variances : array or DataFrame of shape (sites, sites), optional
            Variances of the durations of moves, independent and normal; ``risk`` in ``fleet`` limits what they do to one route.
        team_risk : float, optional
            Largest probability that any route overruns its longest duration or its store.
        problem : str, optional
            Name of the member of the family.
        """
        from ...instances.routing.frames import instance_from_frame

        instance = instance_from_frame(
            sites, travel=travel, durations=durations, vehicles=vehicles, capacity=capacity, max_duration=max_duration,
            convention=convention, name=name, closing=closing, fleet=fleet, min_vehicles=min_vehicles, windows=windows,
            shipments=shipments, groups=groups, variances=variances, team_risk=team_risk,
        )  # fmt: skip
        made = cls.from_instance(instance, problem)
        return made if objective is None else replace(made, objective=Objective.of(objective))

    @classmethod
    def from_instance(
        cls, instance: RoutingInstance, problem: str | None = None, settings: Mapping[str, Any] | None = None
    ) -> RoutingProblem:
        """The problem that an instance stands for, or another that its data allow.

        ``settings`` are those of ``--set`` (``vehicles``, ``vehicles-exactly``, ``customers``, ``capacity``, ``risk``, ``team-risk``)
        and ``convention``.
        """
        from .settings import parts_of

        return cls(**parts_of(instance, problem, settings or {}))

    # -- what it is --------------------------------------------------------------------------------------------------

    @property
    def senses(self) -> tuple[str, ...]:
        return self.objective.senses

    @property
    def convention(self) -> str:
        return self.travel.convention

    @property
    def vehicle_limit(self) -> int | None:
        """Largest number of routes, None if unlimited."""
        return fleet_size(self.fleet)

    @cached_property
    def customers(self) -> NDArray[np.int64]:
        """Indices of the sites that may be visited."""
        return self.sites.customers

    def travel_of(self, kind: int) -> Travel:
        """Travel of the vehicles of a type: their own, at their speed, or the common one."""
        return self._travels[kind]

    @cached_property
    def _travels(self) -> tuple[Travel, ...]:
        return tuple((self.travel if v.travel is None else v.travel).at_speed(v.speed) for v in self.fleet)

    def __repr__(self) -> str:
        limit = self.vehicle_limit
        fleet = "any number of vehicles" if limit is None else f"at most {limit} vehicle{'s' if limit != 1 else ''}"
        aim = f"{' then '.join(self.senses)} {self.objective}, convention {self.convention}"
        return f"<RoutingProblem {self.name}: {self.problem}, {len(self.customers)} customers, {fleet}, {aim}>"

    def digest(self) -> str:
        return digested(self)

    def features(self) -> frozenset[str]:
        """Features a solver must support: those of ``instances.routing.features`` that restrict routes, and those of the objective."""
        moves = frozenset() if self.forbidden is None else frozenset({"forbidden-moves"})
        return restrictions(self) | self.objective.features() | moves

    @property
    def size(self) -> int:
        return len(self.sites)

    @property
    def constant(self) -> float:
        """What the first level of the objective holds whatever is visited: the rewards of depots, which forms have no variable for."""
        depots = math.fsum(self.sites.reward[self.sites.depots])
        return math.fsum(w * depots for w, term in self.objective.levels()[0].terms if isinstance(term, Reward))

    def linear_entries(self) -> int:
        return 8 * len(self.sites) ** 2  # an arc is in two rows of visits and in six of a resource

    def facts(self) -> dict[str, Any]:
        """Objective, sites, demand, service, windows, travel and fleet, and what else there is."""
        return facts(self)

    # -- parts of all answers ----------------------------------------------------------------------------------------

    @cached_property
    def _index(self) -> dict[str, int]:
        return self.sites.index()

    def check_statement(self, statement: Any) -> None:
        """``{"arc": [id, id]}``: some route goes from the one site to the other without a stop between. ``{"routes": k}``: there are k
        routes at most."""
        given = statement if isinstance(statement, Mapping) and len(statement) == 1 else {}
        arc, routes = given.get("arc"), given.get("routes")
        if type(routes) is int and 1 <= routes <= len(self.sites):
            return
        if not isinstance(arc, list) or len(arc) != 2 or not all(isinstance(site, str) and site in self._index for site in arc):
            expected = '{"arc": [the id of a site, the id of a site]}, or {"routes": a number of them}'
            raise InputError("not a statement on a move or on the number of routes", expected=expected, found=printable(str(statement), 80))

    def restricted(self, decisions: Sequence[Decision]) -> RoutingProblem:
        """The same problem without moves: one that is not made, and those that are not made beside one that is, for a customer is left and
        entered once. Of each type of vehicle there are as many as there are routes at most."""
        moves = np.zeros((len(self.sites),) * 2, dtype=bool) if self.forbidden is None else self.forbidden.copy()
        depot, least, most = self.sites.depot, self.min_vehicles, len(self.sites)
        for statement, holds in decisions:
            self.check_statement(statement)
            if "routes" in statement:
                least, most = (least, min(most, statement["routes"])) if holds else (max(least, statement["routes"] + 1), most)
                continue
            i, j = (self._index[site] for site in statement["arc"])
            if not holds:
                moves[i, j] = True
                continue
            kept = moves[i, j]
            if not depot[i]:
                moves[i] = True
            if not depot[j]:
                moves[:, j] = True
            moves[i, j] = kept
        made = copy.copy(self)
        fleet = tuple(v if v.count is not None and v.count <= most else replace(v, count=most) for v in self.fleet)
        made.__dict__.update(forbidden=moves, min_vehicles=least, fleet=fleet if most < len(self.sites) else self.fleet)
        return made

    def given(self, values: Sequence[float]) -> RoutingProblem | None:
        """The levels after those of ``values``. Where a level before counts vehicles alone, there are no more of them than its value
        says; other levels restrict nothing, so that bounds hold for more answers than they need to."""
        levels = self.objective.levels()
        if not 0 < len(values) < len(levels):
            return None
        made = copy.copy(self)
        for level, value in zip(levels, values, strict=False):
            ((weight, term), *others) = level.terms
            if isinstance(term, Vehicles) and not others and weight > 0 and math.isfinite(value):
                most = max(1, math.floor(value / weight * (1.0 + 1e-9)))
                fleet = tuple(v if v.count is not None and v.count <= most else replace(v, count=most) for v in made.fleet)
                made.__dict__.update(fleet=fleet)
        made.__dict__.update(objective=Objective(levels[len(values) :]))
        return made

    def in_words(self, statement: Any, holds: bool) -> str:
        tail, head = statement["arc"]
        return f"{'some' if holds else 'no'} route goes from {tail} straight to {head}"

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        if kind == "arc-multipliers":
            return "no choice of the moves that are left visits all sites within the limits"
        return "none of all routes can be put together" if kind == "all-routes" else super().why_none(kind, data)

    # -- judging answers ---------------------------------------------------------------------------------------------

    def evaluate(self, answer: Routes) -> Evaluation:
        """Recompute everything from the data: visits, loads, windows with waiting and service, durations, distances,
        energy, fleet size, objective."""
        if not isinstance(answer, Routes):
            raise UsageError(f"an answer to a routing problem is Routes, not {type(answer).__name__}: Routes.of([[1, 2], [3]]) makes one")
        return evaluate_routes(self, answer)

    def continue_from(self, plan: Any, time: float) -> RoutingProblem:
        """The problem of the next horizon, where ``plan`` has been driven until ``time``.

        Parameters
        ----------
        plan : Solution or Routes
            A feasible answer. Each route is driven on its earliest schedule, departing as late as delays nothing.
        time : float
            Sites begun before it are done. A vehicle under way then is committed to the next stop of its route and starts a route of its
            own there, when it has served it, with the energy, load, distance and duration it has left; it drives home from there even
            where it serves nobody. Vehicles that are back are ready again.

        Raises
        ------
        UsageError
            If the plan breaks a constraint, nothing is left to plan, or vehicles reload or carry shipments, pickups or several loads.

        Notes
        -----
        Source: Mitchell (2020), sections 3.2 and 5, virtual nodes; docs/formulations/routing.md#horizons.
        """
        from .horizon import continued

        return continued(self, self.answer_of(getattr(plan, "answer", plan)), float(time))

    def vehicle_names(self, answer: Routes) -> list[str]:
        """Name of the vehicle of each route: that of its type, and a number from 1 within the type."""
        numbers = [itertools.count(1) for _ in self.fleet]
        kinds = (route.vehicle if 0 <= route.vehicle < len(self.fleet) else 0 for route in answer)
        return [f"{self.fleet[kind].name} {next(numbers[kind])}" for kind in kinds]

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """Required sites that no vehicle can serve, or else proofs that the fleet is too small."""
        ids, sites = self.sites.ids, [(k, why) for k, why in unreachable(self).items() if self.sites.required[k]]
        for k, why in sites:
            yield Reason("site", ids[k], why, Evidence("infeasible-site", f"site {ids[k]}: {why}", none(self), {"site": ids[k]}))
        if not sites and not stopped():
            for found in fleet_conflicts(self, stopped):
                site = found.data.get("site")
                yield Reason("fleet" if site is None else "site", "fleet" if site is None else site, found.source, found)

    def left_out(self, answer: Routes) -> tuple[LeftOut, ...]:
        """Customers that ``answer`` does not visit, each with the reason: that no vehicle can serve it, or what every place for it in these
        routes would break or cost."""
        return left_out(self, answer)

    # -- answers as files and tables ---------------------------------------------------------------------------------

    def answer_to_json(self, answer: Routes) -> dict[str, Any]:
        return routes_to_json(self, answer)

    def answer_from_json(self, data: Any) -> Routes:
        return routes_from_json(self, data)

    def answer_of(self, given: Any) -> Routes:
        """``Routes``; or a list of routes, each a ``Route`` or, where all vehicles are alike, a list of site indices or ids."""
        listed: list[Any] = list(given) if isinstance(given, Iterable) else [None]
        if all(isinstance(route, Route) for route in listed):
            return Routes.of(listed)
        if not all(isinstance(route, Sequence | np.ndarray) and not isinstance(route, str | bytes) for route in listed):
            raise UsageError(f"{printable(repr(given), 80)} is no list of routes; Routes.of([[1, 2], [3]]) makes an answer")
        if len(self.fleet) > 1:
            raise UsageError(f"lists do not say which of the {len(self.fleet)} vehicle types drives a route; Route(visits, type) does")
        sites = indices_of(itertools.chain.from_iterable(listed), self.sites.index(), "site")
        ends = itertools.accumulate(map(len, listed), initial=0)
        return Routes.of(sites[first:last] for first, last in itertools.pairwise(ends))

    def check_start(self, answer: Routes) -> None:
        for number, route in enumerate(answer, start=1):
            if not 0 <= route.vehicle < len(self.fleet):
                raise UsageError(f"route {number} has vehicle type {route.vehicle}, and there are {len(self.fleet)}, numbered from 0")
            for site in route.visits:
                if not 0 <= site < len(self.sites):
                    raise UsageError(f"route {number} visits site {site}, and there are {len(self.sites)}, numbered from 0")

    def answer_to_frame(self, answer: Routes) -> pd.DataFrame:
        """One row a stop: vehicle, position, site, arrival, begin, departure, load, distance (cumulated); ``on_board`` where loads are
        collected or shipped, ``energy`` where stores are filled on the way.
        """
        return routes_to_frame(self, answer)

    def check_answer_suffix(self, suffix: str) -> None:
        super().check_answer_suffix(suffix)
        if suffix not in (".json", ".vroom"):
            self._need_one_type()
        if suffix == ".tour" and self.vehicle_limit != 1:
            raise UsageError("a .tour file holds one route, and this problem allows more; use .sol or .json, or set vehicles=1")

    def foreign_answer(self, data: Mapping[str, Any]) -> Routes | None:
        """VROOM's output."""
        return routes_from_vroom(self, data) if is_vroom_output(data) else None

    def answer_to_text(self, answer: Routes, suffix: str, objective: float | None = None) -> str:
        """CVRPLIB's ``.sol``, TSPLIB's ``.tour``, or ``.vroom``, VROOM's output."""
        if suffix == ".vroom":
            return dump_json(vroom_output(self, answer))
        routes = [route.visits for route in answer]
        return sol_text(self.sites, routes, objective) if suffix == ".sol" else tour_text(self.sites, routes, objective, self.name)

    def answer_from_text(self, text: str) -> tuple[Routes, float | None]:
        """From CVRPLIB's ``.sol`` or TSPLIB's ``.tour``."""
        found = routes_from_text(text, self.sites)
        self._need_one_type()
        return Routes.of(found.routes), found.cost

    def _need_one_type(self) -> None:
        if len(self.fleet) > 1:
            raise UsageError(f"such a file cannot say which of the {len(self.fleet)} vehicle types drives a route; use .json")
        if any(v.reloads or v.stations for v in self.fleet):
            raise UsageError("such a file has no place for stops at depots on the way; use .json")
