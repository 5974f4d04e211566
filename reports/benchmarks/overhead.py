"""CPU time of PyVRP, OR-Tools and VROOM through waybound against the bare libraries, on the same integers, with the same routes.

Each run is a fresh process; bare and wrapped runs alternate. Work is fixed, so that both sides do the same: iterations of PyVRP, solutions
of OR-Tools, the exploration level of VROOM (before which waybound has it search at level 0). ``engine`` is the CPU time of building the
library's model and searching, ``whole`` that of the whole process and its children, with imports, reading, checking and, for OR-Tools and
VROOM, the process of its own that they need. The bare scripts, ``_bare_pyvrp`` and so on, know nothing of waybound. Instances are bundled
ones, and if ``WAYBOUND_BENCHMARKS`` names their folder a file of each routing family, which a library takes or lacks features of. Exits
with 1 if routes differ.
"""

import json
import os
import statistics
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound import read
from waybound.formulations.routing.problem import RoutingProblem
from waybound.solvers.backend import BACKENDS

from ._harness import Option, command, in_a_fresh_process

TARGET = 1.03
"""Most CPU time that the wrapped library may take, relative to the bare one."""

BUNDLED: dict[str, dict[str, Any]] = {"demo-rc50": {"convention": "trunc1", "vehicles": 25}, "demo-x40": {"vehicles": 25}}
BENCHMARKS: dict[str, dict[str, Any]] = {
    "vrptw-solomon/C101.txt": {"convention": "trunc1"},
    "vrptw-solomon/R101.txt": {"convention": "trunc1"},
    "cvrp/X/X-n101-k25.vrp": {"vehicles": 40},
    "tsplib/bays29.tsp": {},
    "mdvrp-cordeau/p01.txt": {},
    "pdptw-lilim/100/lc101.txt": {},
    "vrpspd-salhi/CMT1X.vrpspd": {"vehicles": 10},
    "op/tsiligirides1/tsiligirides_problem_1_budget_30.txt": {},
    "op/oplib-gen2/att48-gen2-50.oplib": {},
    "top/set4/p4.2.a.txt": {},
    "toptw/c101.txt": {"problem": "team-orienteering", "vehicles": 2, "convention": "trunc1"},
    "minmax-mtsp/mtsplib/eil51-m5.txt": {},
}

WRAPPED = "waybound.reports.benchmarks._wrapped"
"""The module that runs a library through waybound."""

BISECTED = frozenset({"this objective by itself, and takes it by bisection over limits of routes"})
"""An objective that the bare library does not solve in one run has no bare run to be compared with."""


def integers(problem: RoutingProblem, engine: str = "pyvrp") -> dict[str, Any]:
    """The arrays that ``_bare_routing`` describes: the data in the units in which waybound hands them to an engine."""
    from waybound.solvers.engines.routing import ortools_model, vroom
    from waybound.solvers.engines.routing.integer_scales import UNLIMITED
    from waybound.solvers.engines.routing.pyvrp import load_factor
    from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope
    from waybound.solvers.engines.routing.vroom import Priorities, priorities, vroom_integers

    sites, fleet = problem.sites, problem.fleet
    timed = vroom.TIMED if engine == "vroom" else ortools_model.TIMED
    asked = priorities(problem) if engine == "vroom" else None
    if isinstance(asked, Priorities):
        data = vroom_integers(asked.problem)
        data = replace(data, prize=np.array([asked.of.get(site, 0) for site in range(len(sites))]))
    else:
        data = integer_routing(problem)
    if engine != "vroom":
        data = with_slope(problem, data)
    loads = load_factor(data) if engine == "pyvrp" else 1
    column: Callable[[Any], Any] = lambda values: loads * (values[:, 0] if values.shape[1] else np.zeros(len(values), np.int64))  # noqa: E731
    limited = bool((data.max_distance != UNLIMITED).any()) and engine != "vroom"  # which has a matrix for costs, and one for limits
    moves = data.moves[0]
    spanned = data.service[:, None] + moves.duration if data.maxima[0] else moves.distance_up
    return {
        "spanned": spanned,
        "xy": np.zeros((len(sites), 2)) if sites.coordinates is None else sites.coordinates, "service": data.service, "ready": data.ready,
        "due": data.due, "demand": column(data.demand), "pickup": column(data.pickup), "prize": data.prize, "required": sites.required,
        "distance": moves.distance_up if limited else moves.distance, "duration": moves.duration, "depots": sites.depots,
        "shipments": np.array([(s.pickup, s.delivery) for s in sites.shipments], dtype=np.int64).reshape(-1, 2),
        "shipped": column(data.shipped), "vehicles": np.array([len(problem.customers) if v.count is None else v.count for v in fleet]),
        "start": np.array([v.start for v in fleet]), "end": np.array([v.end for v in fleet]),
        "capacity": np.where(data.capacity[:, 0] == UNLIMITED, UNLIMITED, data.capacity[:, 0] * loads), "fixed": data.fixed,
        "unit": data.unit, "opens": data.opens, "closes": data.closes, "max_duration": data.max_duration,
        "max_distance": data.max_distance, "span": data.maxima[:2].max(), "timed": bool(problem.features() & timed),
    }  # fmt: skip


def bare(problem: RoutingProblem, engine: str, *work: object) -> dict[str, Any]:
    """Routes and CPU seconds of the bare library on a problem; ``work`` is what its script is told."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data.npz"
        np.savez(data, **integers(problem, engine))
        return in_a_fresh_process(Path(__file__).with_name(f"_bare_{engine}.py"), data, *work)


def shown(routes: list[list[int]], engine: str) -> list[list[int]]:
    """Routes for comparison. VROOM drives a route one way or the other, in one run or the next, where both cost the same."""
    return sorted(min(route, route[::-1]) for route in routes) if engine == "vroom" else sorted(routes)


def compare(name: str, source: str, settings: dict[str, Any], engine: str, work: int, repeats: int) -> dict[str, Any]:
    """Medians of CPU seconds, bare and wrapped in turn, and whether all routes are the same."""
    problem = read(source, **settings)
    assert isinstance(problem, RoutingProblem)
    runs: dict[str, list[dict[str, Any]]] = {"bare": [], "engine": [], "whole": []}
    for _ in range(repeats):
        runs["bare"].append(bare(problem, engine, work))
        for part in ("engine", "whole"):
            runs[part].append(in_a_fresh_process("-m", WRAPPED, part, source, work, engine, json.dumps(settings)))
    routes = [json.dumps(shown(r["routes"], engine)) for kind in runs.values() for r in kind]
    middle: Callable[[str, str], float] = lambda kind, what: statistics.median(r[what] for r in runs[kind])  # noqa: E731
    return {
        "instance": name, "engine": engine, "work": work, "same": len(set(routes)) == 1,
        "bare": middle("bare", "engine"), "wrapped": middle("engine", "engine"),
        "bare_whole": middle("bare", "whole"), "wrapped_whole": middle("whole", "whole"),
    }  # fmt: skip


def cases(names: list[str] | None) -> list[tuple[str, str, dict[str, Any]]]:
    """Name, source and settings of the instances; all that are there by default."""
    listed = [(name, name, settings) for name, settings in BUNDLED.items()]
    folder = os.environ.get("WAYBOUND_BENCHMARKS")
    if folder:
        listed += [(Path(path).stem, str(Path(folder) / path), settings) for path, settings in BENCHMARKS.items()]
    return [case for case in listed if not names or case[0] in names]


@command
def main(
    repeats: int = 3,
    iterations: Annotated[int, Option(help="of PyVRP")] = 20_000,
    solutions: Annotated[int, Option(help="of OR-Tools")] = 1_500,
    level: Annotated[int, Option(help="of VROOM's exploration")] = 5,
    instance: Annotated[list[str] | None, Option(action="append", help="only this one; may be repeated")] = None,
) -> bool:
    heads = ("instance", "engine", "work", "routes", "bare s", "wrapped s", "ratio", "bare whole s", "wrapped whole s", "ratio")
    print("  ".join(heads))
    sound = True
    for name, source, settings in cases(instance):
        for engine, work in (("pyvrp", iterations), ("ortools", solutions), ("vroom", level)):
            if not BACKENDS[engine].installed():
                print(f"{name}: {engine} is not installed")
                continue
            backend: Any = BACKENDS[engine]()
            problem = read(source, **settings)
            assert isinstance(problem, RoutingProblem)
            lacking = backend.missing(problem) or (BISECTED if getattr(backend, "bisects", lambda _: False)(problem) else frozenset())
            if lacking:
                print(f"{name}: {engine} lacks {', '.join(sorted(lacking))}")
                continue
            row = compare(name, source, settings, engine, work, repeats)
            sound = sound and row["same"]
            figures = [name, engine, str(work), "same" if row["same"] else "DIFFER"]
            for bare, wrapped in (("bare", "wrapped"), ("bare_whole", "wrapped_whole")):
                figures += [f"{row[bare]:.2f}", f"{row[wrapped]:.2f}", f"{row[wrapped] / row[bare]:.3f}"]
            print("  ".join(f"{figure:>{len(head)}}" for figure, head in zip(figures, heads, strict=True)), flush=True)
    print(f"target: ratio of at most {TARGET}")
    return sound
