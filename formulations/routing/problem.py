"""Routing problems: sites, travel, fleet, and an objective made of terms."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.document import dump_json
from ...instances.errors import UsageError
from ...instances.routing.features import restrictions
from ...instances.routing.instance import Clock, RoutingInstance, Sites, VehicleType, check_moves, check_routing_data, fleet_size
from ...instances.routing.solution_files import routes_from_text, sol_text, tour_text
from ...instances.routing.travel import Travel
from ..evaluation import Evaluation
from ..evidence import Evidence, Reason
from ..problem import Problem
from . import statements
from .answers import (
    answer_geojson,
    answer_graph,
    routes_frame,
    routes_from_json,
    routes_lines,
    routes_to_frame,
    routes_to_json,
    visits_of,
    visits_of_geojson,
)
from .facts import digested, facts, remarks
from .fleet_need import fleet_conflicts, infeasible_bound
from .judge import evaluate_routes
from .objective import Composable, Objective, Reward, default_objective, pointless
from .parse_routes import routes_given
from .reachability import unreachable
from .routes import Routes
from .settings import parts_of
from .unvisited_sites import left_out
from .vroom_answers import is_vroom_output, routes_from_vroom, vroom_output

if TYPE_CHECKING:
    import pandas as pd

SLOWLY_JUDGED = 10_000
"""Sites beyond which judging an answer takes a good part of a second, and the last ``REMEMBERED`` verdicts are kept."""

REMEMBERED = 3
"""Verdicts: those on a start, on an answer on the way and on the last one."""


@dataclass(frozen=True, eq=False, init=False)
class RoutingProblem(Problem):
    """Visit sites with a fleet.

    Parameters
    ----------
    sites : Sites
        Depots and customers.
    travel : Travel
        Distances and durations between them.
    fleet : sequence of VehicleType
        Kinds of vehicles.
    objective : Objective, term, weighted sum of terms, or text
        Default: total cost. As text: ``"vehicles then total-cost"``, ``"total-cost - 2*reward"``.
    min_vehicles : int
        Routes that must be used at least.
    forbidden : bool array of shape (sites, sites), optional
        Moves that no route makes.
    needed : sequence of such arrays, keyword-only
        Sets of moves, as proofs distinguish cases by them: of each set at least one is made in the answers that bounds speak of.
        ``evaluate`` does not look whether it is.
    exceeded : mapping from the name of a term to a number, keyword-only
        Makespan, longest route and latest return, as proofs distinguish cases by them: in the answers that bounds speak of the term is
        more than the number. ``evaluate`` does not look whether it is.
    team_risk : float, optional
        Largest probability that any route overruns a limit, where durations are uncertain.
    clock : Clock, optional
        What times count, where that is known: tables of an answer then tell moments where it has an origin.
    name : str
        For tables and files.
    notes : tuple of str
        What a user should be told.
    problem : str
        Name of the member of the family ("vrptw", "cvrp", "tsp", ...).

    Raises
    ------
    InputError
        If the parts do not fit each other.
    """

    family: ClassVar[str] = "routing"
    answer_suffixes: ClassVar[tuple[str, ...]] = (".sol", ".tour", ".vroom", ".geojson")
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
    clock: Clock | None
    needed: tuple[NDArray[np.bool_], ...]
    exceeded: Mapping[str, float]

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
        clock: Clock | None = None,
        *,
        needed: Sequence[NDArray[np.bool_]] = (),
        exceeded: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        aim = Objective() if objective is None else Objective.of(objective)
        self.__dict__.update(
            sites=sites, travel=travel, fleet=tuple(fleet), objective=aim, min_vehicles=min_vehicles, name=name, problem=problem,
            notes=tuple(notes), forbidden=forbidden, team_risk=team_risk, clock=clock, needed=tuple(needed),
            exceeded=dict(exceeded),
        )  # fmt: skip
        check_moves(sites, forbidden)
        for moves in self.needed:
            check_moves(sites, moves, "needed")
        check_routing_data(sites, travel, self.fleet, min_vehicles, team_risk, clock)

    def altered(self, **parts: Any) -> RoutingProblem:
        """A problem of other parts, which are not checked again. Nothing is kept that was derived from the former ones."""
        problem = object.__new__(type(self))
        problem.__dict__.update({field.name: getattr(self, field.name) for field in fields(self)} | parts)
        return problem

    # -- construction ------------------------------------------------------------------------------------------------

    @classmethod
    def from_frame(
        cls,
        sites: pd.DataFrame,
        *,
        travel: Any = None,
        durations: Any = None,
        vehicles: int | None = None,
        capacity: float | Sequence[float] = math.inf,
        max_duration: Any = math.inf,
        max_distance: float = math.inf,
        fixed_cost: float = 0.0,
        unit_cost: float = 1.0,
        speed: float | None = None,
        fleet: Any = None,
        columns: Mapping[Any, Any] | str | None = None,
        extra: Iterable[Any] | bool = (),
        time_unit: str | None = None,
        distance_unit: str = "km",
        weight: str = "weight",
        objective: Composable | str | None = None,
        convention: str = "",
        name: str = "frame",
        closing: Any = None,
        min_vehicles: int = 0,
        windows: Mapping[Any, Sequence[tuple[Any, Any]]] | pd.DataFrame | None = None,
        shipments: Iterable[Sequence[Any]] | pd.DataFrame = (),
        groups: Iterable[Any] | pd.DataFrame = (),
        variances: Any = None,
        team_risk: float | None = None,
        problem: str | None = None,
    ) -> RoutingProblem:
        """A problem from a pandas frame, one row a site; docs/data.md has an example of each.

        Parameters
        ----------
        sites : DataFrame
            Columns ``id`` (else the index, or ``name``), ``x, y`` or ``lat, lon`` (decimal degrees), ``demand, pickup, ready, due,
            service, reward, required, penalty, depot, skills``, all but the coordinates (or ``travel``) optional; ``demand2, pickup2, ...``
            are further load dimensions, ``skills`` words with commas between. Without ``depot`` the first row is the depot. Titles are read
            in any case. All other columns are kept, shown, and not used, as solutions tell; one that looks like a misspelt title, or has
            the name that another toolkit gives to what counts (``tw_early``), is refused.
        travel : optional
            Distances, Euclidean or on the globe without it: a matrix (array, or frame with the ids as labels) in which ``inf`` stands for a
            move that cannot be made; a frame with one row a move (``from, to, distance`` and perhaps ``duration``); a scipy.sparse matrix
            or a networkx graph, whose shortest paths are taken; a routing service's table (OSRM, Valhalla), parsed or as the path of its
            JSON file; or the name of a metric (``manhattan``, ...).
        durations : optional
            A matrix or frame, of numbers or timedeltas; of a networkx graph the name of an attribute of edges. Without, the distances.
        vehicles, capacity, max_duration, max_distance, fixed_cost, unit_cost
            The fleet, all alike: ``vehicles`` at each depot, any number by default; a list of capacities for several loads.
        speed : float, optional
            Of all vehicles: durations are divided by it. Where sites have latitude and longitude it is a distance in an hour.
        fleet : DataFrame or sequence of mappings or VehicleType, optional
            In their place: one entry a vehicle type, with the keys of waybound's JSON (docs/formats.md), sites by id. A frame without the
            column ``count`` has one vehicle a row; ``shift_start, shift_end`` and ``capacity2, ...`` stand for the JSON's lists. ``travel``
            may be a matrix as that of all, with ``inf`` for moves that this vehicle cannot make.
        columns : mapping or str, optional
            From the titles above to those of the frame, or the other way round; or the same as text, ``"demand=crates, id=shop"``.
        extra : list of titles, or bool
            Columns that are kept though they look like misspelt ones, or are called as other toolkits call what counts; True for all.
        time_unit : str, optional
            ``s, min, h`` or ``d``: what times count. Needed where any are timestamps, timedeltas or texts (``06:00``); time 0 is then
            midnight of the first day.
        distance_unit : str
            ``km, m`` or ``mi``, for distances on the globe and those of a routing service.
        weight : str
            Attribute of a networkx graph's edges that holds distances.
        objective : optional
            Terms (``Vehicles().then(TotalCost())``), or their text (``"vehicles"``); the usual one of the problem by default, with the
            penalties and rewards of sites that may be left out.
        convention : str
            Distance convention, ``exact`` by default.
        name : str
            For tables and files.
        closing : array or DataFrame of shape (sites, sites), optional
            Latest times at which moves may begin.
        min_vehicles : int
            Routes that must be used at least.
        windows : mapping from id to a list of pairs, or DataFrame, optional
            Sites with several time windows; a frame has one row a window, with columns ``site, ready, due``.
        shipments : iterable of (pickup id, delivery id) or (pickup id, delivery id, load), or DataFrame
            Columns of a frame: ``pickup, delivery`` and perhaps ``load, load2, ...``.
        groups : iterable of iterables of ids, or DataFrame
            Alternatives, of which exactly one is visited; ``{"sites": [...], "required": False}`` for at most one. A frame has one row a
            member, with columns ``group, site`` and perhaps ``required``.
        variances : array or DataFrame of shape (sites, sites), optional
            Variances of the durations of moves, independent and normal; ``risk`` in ``fleet`` limits what they do to one route.
        team_risk : float, optional
            Largest probability that any route overruns its longest duration or its store.
        problem : str, optional
            Name of the member of the family.

        Raises
        ------
        InputError
            Naming the column, site or pair of sites that is wrong, and what to do.
        UsageError
            For a unit, a problem or a term that does not exist.
        """
        arguments = dict(locals())  # all parameters, and nothing else yet
        for own in ("cls", "sites", "objective", "problem"):
            del arguments[own]
        from ...instances.routing.frames import instance_from_frame

        instance = instance_from_frame(sites, **arguments)
        return cls.from_instance(instance, problem, {} if objective is None else {"objective": objective})

    @classmethod
    def from_instance(
        cls, instance: RoutingInstance, problem: str | None = None, settings: Mapping[str, Any] | None = None
    ) -> RoutingProblem:
        """The problem that an instance stands for, or another that its data allow.

        ``settings`` are those of ``--set`` (``vehicles``, ``vehicles-exactly``, ``customers``, ``capacity``, ``risk``, ``team-risk``) and
        ``convention``.
        """
        return cls(**parts_of(instance, problem, settings or {}))

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

    @cached_property
    def site_index(self) -> dict[str, int]:
        """Index of each site by its id."""
        return self.sites.index()

    def travel_of(self, kind: int) -> Travel:
        """Travel of the vehicles of a type: their own, at their speed, or the common one."""
        return self._travels[kind]

    @cached_property
    def _travels(self) -> tuple[Travel, ...]:
        return tuple((self.travel if v.travel is None else v.travel).at_speed(v.speed) for v in self.fleet)

    def __repr__(self) -> str:
        limit = self.vehicle_limit
        fleet = "any number of vehicles" if limit is None else f"at most {limit} vehicle{'s' if limit != 1 else ''}"
        aims = ", then ".join(f"{sense} {level}" for sense, level in zip(self.senses, self.objective.levels(), strict=True))
        what = f"{self.problem}, {len(self.customers)} customers, {fleet}"
        return f"<RoutingProblem {self.name}: {what}, {aims}, convention {self.convention}>"

    digest = digested
    remarks = remarks
    facts = facts

    def features(self) -> frozenset[str]:
        """Features a solver must support: those of ``instances.routing.features`` that restrict routes, and those of the objective."""
        return self._features

    @cached_property
    def _features(self) -> frozenset[str]:
        return restrictions(self) | self.objective.features()

    @property
    def size(self) -> int:
        return len(self.sites)

    @property
    def constant(self) -> float:
        """Part of the first level of the objective that does not depend on visits: the rewards of depots."""
        depots = math.fsum(self.sites.reward[self.sites.depots])
        return math.fsum(w * depots for w, term in self.objective.levels()[0].terms if isinstance(term, Reward))

    def linear_entries(self) -> int:
        return 8 * len(self.sites) ** 2  # an arc is in two rows of visits and in six of a resource

    check_statement = statements.check_statement
    restricted = statements.restricted
    given = statements.later_levels
    in_words = statements.in_words

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        if kind == "arc-multipliers":
            return "no choice of the moves that are left visits all sites within the limits"
        if kind in ("all-routes", "customer-sets"):
            return "none of all routes can be put together"
        return super().why_none(kind, data)

    def evaluate(self, answer: Routes) -> Evaluation:
        """Recompute everything from the data: visits, loads, windows with waiting and service, durations, distances, energy, fleet size,
        objective."""
        if not isinstance(answer, Routes):
            raise UsageError(
                f"an answer to a routing problem is Routes, not {type(answer).__name__}: Routes.of([[1, 2], [3]]) makes one", "malformed"
            )
        known: tuple[tuple[Routes, Evaluation], ...] = self.__dict__.get("_judged", ())
        for other, verdict in known:
            if other is answer:
                return verdict
        verdict = evaluate_routes(self, answer)
        if len(self.sites) > SLOWLY_JUDGED:  # who searches, who concludes and who reports ask about the same answer
            self.__dict__["_judged"] = (*known[1 - REMEMBERED :], (answer, verdict))
        return verdict

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in ("_judged", "_move_sets")}

    def continue_from(self, plan: Any, time: float) -> RoutingProblem:
        """The problem of the next horizon, where ``plan`` has been driven until ``time``.

        Parameters
        ----------
        plan : Solution or Routes
            A feasible answer to this problem, or to one with fewer sites: those that it does not visit are new orders. Each route is
            driven on the schedule that its tables show.
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
        from .rolling_horizon import continued

        own = getattr(plan, "problem", self) is self  # sites of another problem are told by their ids
        return continued(self, self.answer_of(getattr(plan, "answer", plan) if own else plan.routes), float(time))

    def vehicle_names(self, answer: Routes) -> list[str]:
        """Name of the vehicle of each route: that of its type, and a number from 1 within the type; none is the name of a type."""
        types = {v.name for v in self.fleet}
        numbers = [_numbered(v.name, types) for v in self.fleet]
        kinds = (route.vehicle if 0 <= route.vehicle < len(self.fleet) else 0 for route in answer)
        return [next(numbers[kind]) for kind in kinds]

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """Required sites that no vehicle can serve, or else proofs that the fleet is too small."""
        ids, sites = self.sites.ids, [(k, why) for k, why in unreachable(self).items() if self.sites.required[k]]
        for k, why in sites:
            yield Reason(
                "site", ids[k], why, Evidence("infeasible-site", f"site {ids[k]}: {why}", infeasible_bound(self), {"site": ids[k]})
            )
        if not sites and not stopped():
            for evidence in fleet_conflicts(self, stopped):
                site = evidence.data.get("site")
                yield Reason("fleet" if site is None else "site", "fleet" if site is None else site, evidence.source, evidence)

    left_out = left_out

    answer_to_json = routes_to_json
    answer_from_json = routes_from_json
    answer_of = routes_given
    answer_to_frame = routes_to_frame
    answer_lines = routes_lines
    answer_routes = visits_of
    answer_to_networkx = answer_graph

    def answer_from_frame(self, frame: pd.DataFrame) -> Routes:
        return routes_given(self, frame)

    def check_start(self, answer: Routes) -> None:
        for number, route in enumerate(answer, start=1):
            if not isinstance(route.vehicle, int | np.integer) or not 0 <= route.vehicle < len(self.fleet):
                raise UsageError(
                    f"route {number} has vehicle type {route.vehicle}, and there are {len(self.fleet)}, numbered from 0", "unknown-name"
                )
            for site in route.visits:
                if not isinstance(site, int | np.integer) or not 0 <= site < len(self.sites):
                    raise UsageError(f"route {number} visits site {site}, and there are {len(self.sites)}, numbered from 0", "unknown-name")

    def searched_from(self, answer: Routes) -> Routes:
        """The routes without stated timetables."""
        return answer.untimed()

    def answer_frames(self, answer: Routes) -> dict[str, pd.DataFrame]:
        """``visits``, as of ``answer_to_frame``, and ``routes``, one row each."""
        return {"visits": routes_to_frame(self, answer), "routes": routes_frame(self, answer)}

    def to_instance(self) -> RoutingInstance:
        usual = str(self.objective) == str(default_objective(self.problem, self.sites)) and pointless(self.sites) < len(self.customers)
        objective = () if usual else tuple(str(level) for level in self.objective.levels())
        return RoutingInstance(
            self.name, "json", self.sites, self.travel, self.fleet, self.problem, (), self.min_vehicles, objective, self.notes,
            self.team_risk, self.forbidden, self.clock,
        )  # fmt: skip

    def check_answer_suffix(self, suffix: str) -> None:
        super().check_answer_suffix(suffix)
        if suffix in (".sol", ".tour"):
            self._need_one_type()
        if suffix == ".tour" and self.vehicle_limit != 1:
            raise UsageError(
                "a .tour file holds one route, and this problem allows more; use .sol or .json, or set vehicles=1", "unsupported"
            )
        if suffix == ".vroom":
            self._need_no_pauses()
        if suffix == ".geojson":
            answer_geojson(self, Routes(()))

    def foreign_answer(self, data: Mapping[str, Any]) -> Routes | None:
        """VROOM's output, or GeoJSON."""
        if is_vroom_output(data):
            return routes_from_vroom(self, data)
        lines = visits_of_geojson(data)
        return None if lines is None else routes_given(self, lines)

    def answer_to_text(self, answer: Routes, suffix: str, objective: float | None = None) -> str:
        """CVRPLIB's ``.sol``, TSPLIB's ``.tour``, ``.geojson``, or ``.vroom``, VROOM's output."""
        if suffix in (".vroom", ".geojson"):
            return dump_json(vroom_output(self, answer) if suffix == ".vroom" else answer_geojson(self, answer))
        routes = [route.visits for route in answer]
        return sol_text(self.sites, routes, objective) if suffix == ".sol" else tour_text(self.sites, routes, objective, self.name)

    def answer_from_text(self, text: str) -> tuple[Routes, float | None]:
        """Routes from CVRPLIB's ``.sol`` or TSPLIB's ``.tour``."""
        file = routes_from_text(text, self.sites)
        self._need_one_type()
        return Routes.of(file.routes), file.cost

    def _need_one_type(self) -> None:
        if len(self.fleet) > 1:
            raise UsageError(
                f"such a file cannot say which of the {len(self.fleet)} vehicle types drives a route; use .json", "unsupported"
            )
        self._need_no_pauses()

    def _need_no_pauses(self) -> None:
        if any(v.reloads or v.stations for v in self.fleet):
            raise UsageError("such a file has no place for stops at depots on the way; use .json", "unsupported")


def _numbered(name: str, taken: Collection[str]) -> Iterator[str]:
    """The name with 1, 2, ... behind it, but for those that are taken."""
    return (numbered for k in itertools.count(1) if (numbered := f"{name} {k}") not in taken)
