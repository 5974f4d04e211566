"""VRPSolver, by the package VRPSolverEasy: branch, cut and price, whose bounds and optima are claims without evidence.

The wrapper is under the MIT licence; the authors of the engine in it, BaPCod, offer it for research, teaching and tests.
"""

import importlib.util
import math
import os
import platform
import re
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import chdir, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....formulations.problem import Problem
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import unreachable
from ....formulations.routing.routes import Route, Routes
from ....instances.errors import InputError, UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...children import scratch
from .integer_scales import UNLIMITED
from .routing_integers import IntegerRouting, fitting_integers
from .routing_objective import awaited, claimed_objective, unscalable

LIBRARIES = {"Linux": "libbapcod-shared.so", "Darwin": "libbapcod-shared.dylib", "Windows": "bapcod-shared.dll"}
"""File of the engine by operating system, in a folder of the wheel that is named for the system."""

MOST_POINTS = 1022
"""Depots and customers that the library takes."""

LARGEST, MOST = 100_000_000, 1_000_000_000
"""The largest sum of integers along an answer, and the largest cost that it is given: doubles are to tell whole numbers apart."""

FINE = (100_000, 10_000, 1_000, 100, 10)
"""Scales of data that three decimals cannot hold: the first that leaves room."""

WRONG_BY = 0.1
"""Largest error of a value or a bound that it prints, where all costs are whole numbers."""

TIMED = frozenset({"time-windows", "depot-windows", "shifts", "max-duration"})
"""Features for which it has to know how long moves take."""

LEAST_SECONDS = 0.01
"""Time limit that it is given at least."""

LOOK = 0.2
"""Seconds between two looks at what it prints."""

PROVED, FOUND, NONE_BETTER, NOTHING_FOUND, INFEASIBLE = 0, 1, 2, 3, -2
"""Its statuses; all others are errors."""

CRASHED = "the solver's process"
"""Part of what is told of a process that ended before its work did."""

LACKS_ROOM = "not enough to cover the total demand"
"""Part of what it says as an error where it finds before its search that there is no answer."""


@BACKENDS.register("vrpsolver")
class VRPSolver(Engine):
    """VRPSolver (Pessoa, Sadykov, Uchoa & Vanderbeck 2020) through VRPSolverEasy (Errami, Queiroga, Sadykov & Uchoa 2023): branch, cut and
    price over routes.

    It tells bounds and optima, and shows no evidence: they stay claims. The library cannot be stopped and has been seen to crash, so that
    it runs in a process of its own from wherever it is called. From a start it takes nothing but the value, one step above which it has
    to stay below.
    """

    name = "vrpsolver"
    package = "VRPSolverEasy"
    pinned = "0.1.3"
    modules = ("VRPSolverEasy",)
    summary = "VRPSolver: branch, cut and price; its bounds and optima stay claims"
    family: ClassVar[str] = "routing"
    order = 200
    by_default = False
    interrupts = "is ended; the last bound that it printed counts, and an answer only where it had ended by itself"
    honours = frozenset()
    one_thread = True
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "shifts", "max-duration", "max-distance", "optional-sites",
            "limited-fleet", "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "skills",
            "forbidden-moves", "objective:total-cost", "objective:vehicles", "objective:reward", "objective:penalties",
            "objective:weights", "objective:priorities",
        }
    )  # fmt: skip

    @classmethod
    def installed(cls) -> bool:
        return library() is not None

    def missing(self, problem: Problem) -> frozenset[str]:
        return super().missing(problem) or beyond(problem)  # type: ignore[arg-type]

    def memory(self, problem: Problem) -> float:
        return 1000.0 * float(problem.size) ** 2

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        from ...isolation import run_in_process

        options = self.converted(options)
        with scratch() as folder:
            printed = folder / "printed"
            result = run_in_process(Proof(problem, options, printed), options, control)  # type: ignore[arg-type]
            said = last_words(printed) if CRASHED in result.message else ""
        return replace(result, message=f"{result.message}: {said}") if said else result


def library() -> Path | None:
    """The engine's file; the wheel of version 0.1.4 has none."""
    spec = importlib.util.find_spec("VRPSolverEasy")
    system = platform.system()
    files = [Path(folder) / "lib" / system / LIBRARIES.get(system, "none") for folder in (spec and spec.submodule_search_locations) or ()]
    return next((file for file in files if file.exists()), None)


def beyond(problem: RoutingProblem) -> frozenset[str]:
    """Combinations of its features that the library does not model: beside its load, a route has one resource."""
    held, lacking = problem.features(), set(unscalable(problem))
    if "max-duration" in held and awaited(problem):
        lacking.add("max-duration with waiting")
    if "max-distance" in held and held & TIMED:
        lacking.add("max-distance with limits of time")
    if len(problem.sites) > MOST_POINTS:
        lacking.add(f"more than {MOST_POINTS} sites")
    return frozenset(lacking)


@dataclass(frozen=True)
class Proof:
    """One search, called in the process that it is to have for itself: what is printed there meanwhile, to a file, is the library's."""

    problem: RoutingProblem
    options: Options
    printed: Path

    @property
    def modules(self) -> tuple[str, ...]:
        """Modules that are loaded before time is counted."""
        return ("VRPSolverEasy.src.solver",)

    def __call__(self, control: Control) -> RawResult:
        problem, start = self.problem, self.options.start
        if not len(problem.customers):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        began = time.perf_counter()
        control.begin_set_up()
        for site, why in unreachable(problem).items():
            if problem.sites.required[site]:  # of which the library says no more than that it failed
                return RawResult("infeasible", message=f"no vehicle can serve {problem.sites.ids[site]}: {why}")
        model = Model(problem, fitting_integers(problem, largest=LARGEST, total=LARGEST, scales=FINE))
        begun = start is not None and model.begin(start)
        if begun:
            control.publish(start, model.worth(start))
        if not model.types:
            status, answer = ("infeasible", None) if problem.sites.required.any() else ("feasible", Routes(()))
            return RawResult(status, answer=answer, message="no vehicle can leave its depot and return in time")
        made = model.made()
        took = time.perf_counter() - began
        control.end_set_up(took)
        with chdir(self.printed.parent), printing(self.printed, lambda bound: model.publish(bound, control)):  # it writes a file there
            result = model.solved(made, max(self.options.time_limit - took, LEAST_SECONDS))
        if result.answer is not None:
            control.publish(result.answer, result.objective)
        told = {} if start is None else {"start": "used" if begun else "refused"}
        statistics = {**result.statistics, **told, "scale": model.data.scales}
        return replace(result, statistics=statistics, holds=model.data.holds, links=(model.data.link,))


class Model:
    """A routing problem as the library's.

    ``types`` is the type in the fleet of each of its vehicle types, without those that no route can use; ``points`` the site of each of its
    points, the ``depots`` first. Of its resource a route has what lies between ``opens`` and ``closes`` of its type. A site without a price
    has to be visited there: where ``idle`` sites may be left out and earn nothing, leaving one out costs 1, and all other costs are
    multiplied by ``steps``, which is more than all of these together.
    """

    def __init__(self, problem: RoutingProblem, data: IntegerRouting) -> None:
        self.problem, self.data = problem, data
        fleet, held, moves = problem.fleet, problem.features(), data.moves[0]
        self.timed, self.measured = bool(TIMED & held), "max-distance" in held
        self.types = [k for k in range(len(fleet)) if data.closes[k] >= data.opens[k]]
        depots = sorted({site for k in self.types for site in (fleet[k].start, fleet[k].end)})
        self.depots, self.points = len(depots), np.array([*depots, *problem.customers], dtype=np.int64)
        square = np.ix_(self.points, self.points)
        self.moves = self._moves()
        self.lengths = np.where(self.moves, moves.distance[square], 0)
        self.spent = np.where(self.moves, moves.duration[square] if self.timed else moves.distance_up[square] if self.measured else 0, 0)
        self.served, self.opens = data.service, data.opens
        if self.timed:
            self.closes = np.minimum(data.closes, np.minimum(self.opens, UNLIMITED // 2) + np.minimum(data.max_duration, UNLIMITED // 2))
        else:
            self.served, self.opens, self.closes = np.zeros_like(self.served), np.zeros_like(self.opens), data.max_distance
        endless = int(max(self.opens.max(), data.ready.max())) + int(self.served.sum()) + len(self.points) * int(self.spent.max())
        self.closes = np.minimum(self.closes, endless)
        self.optional = frozenset(site for site in problem.customers.tolist() if not problem.sites.required[site])
        self.idle = sum(not data.prize[site] for site in self.optional)
        self.steps = self.idle + 1
        self.cutoff = self.steps * self._dearest() + self.idle + 1
        if self.cutoff > MOST:
            raise InputError("the costs are too large for vrpsolver", "out-of-range", expected=f"at most {MOST}", found=str(self.cutoff))
        self.start: Routes | None = None

    def _dearest(self) -> int:
        """No answer costs more: each site is reached and each route ends over the longest way."""
        data, customers = self.data, self.problem.customers
        limit = self.problem.vehicle_limit
        routes = len(customers) if limit is None else min(limit, len(customers))
        farthest = self.lengths.max(axis=0)
        length = int(farthest[self.depots :].sum()) + routes * int(farthest[: self.depots].max(initial=0))
        return int(data.unit.max()) * length + routes * int(data.fixed.max()) + int(data.prize[customers].sum())

    # -- what the library is given ----------------------------------------------------------------------------------------

    def made(self) -> Any:
        """The library's model."""
        from VRPSolverEasy.src import solver

        data, problem, model = self.data, self.problem, solver.Model()
        limited = data.limited[0] if data.limited else None
        demand = np.ones(len(problem.sites), dtype=np.int64) if limited is None else data.demand[:, limited]  # there have to be loads
        carried = int(demand[problem.customers].sum())
        room = np.full(len(problem.fleet), carried) if limited is None else np.minimum(data.capacity[:, limited], carried)
        if not room.all():  # nor is there a capacity of 0
            demand, room = 2 * demand, 2 * room + 1
        latest = max(self.closes[k] for k in self.types)
        for number, k in enumerate(self.types, 1):
            vehicle = problem.fleet[k]
            most = len(problem.customers)
            model.add_vehicle_type(
                id=number, start_point_id=self._number(vehicle.start), end_point_id=self._number(vehicle.end),
                capacity=int(room[k]), fixed_cost=self.steps * int(data.fixed[k]), var_cost_dist=self.steps * int(data.unit[k]),
                max_number=most if vehicle.count is None else min(vehicle.count, most), **self._window(self.opens[k], self.closes[k]),
            )  # fmt: skip
        for number, site in enumerate(self.points.tolist()):
            if number < self.depots:
                model.add_depot(id=number, **self._window(min(self.opens[k] for k in self.types), latest))
                continue
            opens, closes = data.windows[site][0] if self.timed else (0, latest)
            served = int(self.served[site])
            price = (self.steps * int(data.prize[site]) or 1) if site in self.optional else 0
            needed = problem.sites.skills[site] if problem.sites.skills else frozenset()
            lacking = [n for n, k in enumerate(self.types, 1) if not needed <= problem.fleet[k].skills]
            model.add_customer(
                id=number, id_customer=number - self.depots + 1, demand=int(demand[site]), penalty=price, service_time=served,
                incompatible_vehicles=lacking, **self._window(opens, min(closes, latest) + served),
            )  # fmt: skip
        for link in self._links():
            model.add_link(**link)
        return model

    def _number(self, depot: int) -> int:
        return int(np.searchsorted(self.points[: self.depots], depot))

    def _window(self, opens: int, closes: int) -> dict[str, int]:
        return {"tw_begin": int(opens), "tw_end": int(closes)} if self.timed or self.measured else {}

    def _moves(self) -> NDArray[np.bool_]:
        """The moves that routes make."""
        problem, points = self.problem, self.points
        moves = ~np.eye(len(points), dtype=bool)
        moves[: self.depots, : self.depots] = False
        if problem.forbidden is not None:
            moves &= ~problem.forbidden[np.ix_(points, points)]
        for number, depot in enumerate(points[: self.depots].tolist()):
            moves[number] &= any(problem.fleet[k].start == depot for k in self.types)
            moves[:, number] &= any(problem.fleet[k].end == depot for k in self.types)
        return moves

    def _links(self) -> Iterator[dict[str, Any]]:
        """The moves, one link for both ways where all are alike: of some of each kind, the library takes the cheaper way for both."""
        alike = all((values == values.T).all() for values in (self.moves, self.lengths, self.spent))
        for i, j in np.argwhere(np.triu(self.moves) if alike else self.moves).tolist():
            yield {
                "start_point_id": i, "end_point_id": j, "is_directed": not alike, "distance": int(self.lengths[i, j]),
                "time": int(self.spent[i, j]),
            }  # fmt: skip

    def begin(self, start: Routes) -> bool:
        """Ask for answers of less than one step more than the start costs; whether it is an answer."""
        try:
            if not self.problem.evaluate(start).feasible or not {route.vehicle for route in start} <= {*self.types}:
                return False
        except InputError:
            return False
        self.start, at = start, {site: number for number, site in enumerate(self.points.tolist())}
        cost, visited = 0, set[int]()
        for route in start:
            vehicle, k = self.problem.fleet[route.vehicle], route.vehicle
            stops = [at[site] for site in (vehicle.start, *route.visits, vehicle.end)]
            cost += int(self.data.fixed[k]) + int(self.data.unit[k]) * int(self.lengths[stops[:-1], stops[1:]].sum())
            visited.update(route.visits)
        left_out = self.optional - visited
        cost += int(self.data.prize[list(left_out)].sum())
        idle = sum(not self.data.prize[site] for site in left_out)
        self.cutoff = min(self.cutoff, self.steps * cost + idle + 1)
        return True

    # -- what comes back --------------------------------------------------------------------------------------------------

    def solved(self, model: Any, seconds: float) -> RawResult:
        """Search, and what the library says of it."""
        from VRPSolverEasy.src import solver

        model.set_parameters(time_limit=seconds, upper_bound=self.cutoff, print_level=-1)
        began = time.perf_counter()
        try:
            model.solve()
        except solver.ModelError as fault:
            return RawResult("error", message=f"VRPSolver failed: {' '.join(fault.message.split())}")
        said = f"VRPSolver says: {' '.join(model.message.split())}"
        nodes, cost = model.statistics.nb_branch_and_bound_nodes, round(model.solution.value)
        root = self.bound(model.statistics.root_lb, cost or None)
        statistics = {"nodes": nodes, **({} if root is None else {"root bound": root})}
        status = INFEASIBLE if LACKS_ROOM in said else model.status
        if status == NONE_BETTER and (not nodes or time.perf_counter() - began >= seconds):
            status, said = NOTHING_FOUND, "VRPSolver ended in its first node"  # it says no otherwise where it had no time to look
        limit = "none" if status in (PROVED, NONE_BETTER, INFEASIBLE) else "time"
        if status not in (PROVED, FOUND, NONE_BETTER, NOTHING_FOUND, INFEASIBLE):
            return RawResult("error", message=said)
        if status in (PROVED, FOUND):
            answer = self._routes(model.solution.routes)
            objective = self._told(cost // self.steps) if self.data.scales["exact"] else self.worth(answer)
            bound = objective if status == PROVED else self.bound(model.statistics.best_lb, cost)
            return RawResult("optimal" if status == PROVED else "feasible", limit, answer, objective, bound, statistics=statistics)
        bound = self.bound(model.statistics.best_lb) if status == NOTHING_FOUND else None
        if self.start is not None:
            return RawResult("feasible", limit, self.start, self.worth(self.start), bound, statistics=statistics, message=said)
        none = "infeasible" if status in (NONE_BETTER, INFEASIBLE) else "unknown"
        return RawResult(none, limit, bound=bound, statistics=statistics, message=said)

    def _routes(self, routes: Iterable[Any]) -> Routes:
        stops = [([p for p in route.point_ids if p >= self.depots], self.types[route.vehicle_type_id - 1]) for route in routes]
        return Routes.of(Route(tuple(self.points[visits].tolist()), k) for visits, k in stops if visits)

    def bound(self, told: float, cost: float | None = None) -> float | None:
        """The objective of a bound on the library's costs; None where it is no bound but the cutoff, or nothing."""
        if not 0.0 <= told < (self.cutoff if cost is None else cost + 0.5):
            return None
        whole = int(np.ceil(told - WRONG_BY))
        return self._told(-((self.idle - whole) // self.steps))

    def publish(self, told: float, control: Control) -> None:
        """Publish a bound that was printed, if it is one of the problem."""
        bound = self.bound(told) if self.data.scales["exact"] else None
        if bound is not None:
            control.publish(bound=bound)

    def worth(self, answer: Routes) -> float:
        """The value of an answer."""
        return self.problem.evaluate(answer).values[0]

    def _told(self, cost: int) -> float | None:
        return claimed_objective(self.problem, (cost - int(self.data.prize[self.problem.customers].sum())) / self.data.cost_factor)


# -- what the library prints ------------------------------------------------------------------------------------------------

BOUNDS = re.compile(rb"global bounds : \[ (\S+) ,|final dual bound: \S+ \(rounded: (\S+)\)")
"""Bounds: of all open nodes, or of one."""

BEST = re.compile(rb"<PB=([^>]+)>")
"""The value that answers have to be below. Once it knows one of that value, bounds of nodes may be anything above it."""

BRANCHES = b"Strong branching"
"""Begins what is printed of nodes below the root."""

LONG, SIX_DIGITS = 1e6, 5e-6
"""Size from which numbers are printed with six digits, and the largest part by which they are wrong then."""


@contextmanager
def printing(path: Path, hear: Callable[[float], None]) -> Iterator[None]:
    """Have the standard output of this process in a file, which is read for bounds meanwhile: the library calls nobody."""
    done = threading.Event()
    with path.open("w+b") as file:
        kept = os.dup(1)
        os.dup2(file.fileno(), 1)
        reader = threading.Thread(target=_listen, args=(file.fileno(), done, hear), daemon=True)
        reader.start()
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)
            done.set()
            reader.join()


def _listen(descriptor: int, done: threading.Event, hear: Callable[[float], None]) -> None:
    reader, text, offset, best = Reader(), b"", 0, 0.0
    while not done.wait(LOOK):
        more = os.pread(descriptor, 1 << 20, offset)
        offset += len(more)
        *lines, text = (text + more).split(b"\n")
        for line in lines:
            bound = reader.bound(line)
            if bound is not None and bound > best:
                best = bound
                hear(bound)


@dataclass
class Reader:
    """Reads what is printed line by line: ``best`` is the value to stay below, ``below`` tells whether there are nodes below the root."""

    best: float = math.inf
    below: bool = False

    def bound(self, line: bytes) -> float | None:
        """The bound on all answers in a line."""
        self.below = self.below or BRANCHES in line
        if (best := BEST.search(line)) is not None:
            self.best = printed(best[1])
        found = BOUNDS.search(line)
        if found is None or (self.below and found[1] is None):
            return None
        return min(printed(found[1] or found[2]), self.best)


def printed(number: bytes) -> float:
    """The least that a printed number may stand for."""
    value = float(number)
    return value if value < LONG else value * (1.0 - SIX_DIGITS)


def last_words(path: Path) -> str:
    """The last line that was printed, if it tells of an error."""
    lines = path.read_text(errors="replace").splitlines() if path.exists() else []
    return lines[-1].strip() if lines and "error" in lines[-1].lower() else ""
