"""CPU time of PyVRP, OR-Tools and VROOM through waybound against the bare libraries, on the same integers, with the same routes.

Run as ``python -m waybound.reports.benchmarks.overhead [--repeats 3] [--iterations 20000] [--solutions 1500] [--level 5]
[--instance NAME ...]``. Each run is a fresh process; bare and wrapped runs alternate. Work is fixed, so that both sides do the same:
iterations of PyVRP, solutions of OR-Tools, the exploration level of VROOM (before which waybound has it search at level 0). ``engine`` is
the CPU time of building the library's model and searching, ``whole`` that of the whole process and its children, with imports, reading,
checking and, for OR-Tools and VROOM, the process of its own that they need. Instances are bundled ones, and C101, R101 and X-n101-k25 if
``WAYBOUND_BENCHMARKS`` names their folder. Exits with 1 if routes differ.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from waybound import read
from waybound.formulations.routing.problem import RoutingProblem
from waybound.solvers.backend import BACKENDS

TARGET = 1.03
"""Most CPU time that the wrapped library may take, relative to the bare one."""

BUNDLED: dict[str, dict[str, Any]] = {"demo-rc50": {"convention": "trunc1", "vehicles": 25}, "demo-x40": {"vehicles": 25}}
BENCHMARKS: dict[str, dict[str, Any]] = {
    "vrptw-solomon/C101.txt": {"convention": "trunc1"},
    "vrptw-solomon/R101.txt": {"convention": "trunc1"},
    "cvrp/X/X-n101-k25.vrp": {"vehicles": 40},
}

LOAD = """
import json, resource, sys, time
import numpy as np
d = dict(np.load(sys.argv[1])); work = int(sys.argv[2])
"""

TELL = """
usage = [resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
whole = sum(u.ru_utime + u.ru_stime for u in usage)
print(json.dumps({"routes": sorted(routes), "engine": engine, "whole": whole}))
"""

BARE = {
    "pyvrp": LOAD
    + """
import pyvrp
start = time.process_time()
windows = "due" in d
clients = [
    pyvrp.Client(i, delivery=[int(d["demand"][i])], service_duration=int(d["service"][i]),
                 **({"tw_early": int(d["ready"][i]), "tw_late": int(d["due"][i])} if windows else {}))
    for i in range(1, len(d["demand"]))
]
shift = {"tw_early": int(d["ready"][0]), "tw_late": int(d["due"][0])} if windows else {}
vehicles = pyvrp.VehicleType(int(d["vehicles"]), [int(d["capacity"])], **shift)
places = [pyvrp.Location(float(x), float(y)) for x, y in d["xy"]]
data = pyvrp.ProblemData(places, clients, [pyvrp.Depot(0)], [vehicles], [d["distance"]], [d["distance"]])
result = pyvrp.solve(data, pyvrp.stop.MaxIterations(work), seed=1, collect_stats=False, display=False)
routes = [[a.idx + 1 for a in route if a.is_client()] for route in result.best.routes()]
engine = time.process_time() - start
"""
    + TELL,
    "ortools": LOAD
    + """
from ortools.constraint_solver import pywrapcp, routing_enums_pb2
start = time.process_time()
n, v = len(d["demand"]), int(d["vehicles"])
manager = pywrapcp.RoutingIndexManager(n, v, 0)
model = pywrapcp.RoutingModel(manager)
model.SetArcCostEvaluatorOfAllVehicles(model.RegisterTransitMatrix(d["distance"].tolist()))
load = model.RegisterUnaryTransitVector(d["demand"].tolist())
model.AddDimensionWithVehicleCapacity(load, 0, [int(d["capacity"])] * v, True, "load")
if "due" in d:
    moves = d["service"][:, None] + d["distance"]
    horizon = int(d["ready"].max() + moves.max(axis=1).sum())
    model.AddDimension(model.RegisterTransitMatrix(moves.tolist()), horizon, horizon, False, "time")
    clock = model.GetDimensionOrDie("time")
    for i in range(1, n):
        clock.CumulVar(manager.NodeToIndex(i)).SetRange(int(d["ready"][i]), min(int(d["due"][i]), horizon))
    for k in range(v):
        clock.CumulVar(model.Start(k)).SetRange(int(d["ready"][0]), min(int(d["due"][0]), horizon))
        clock.CumulVar(model.End(k)).SetRange(0, min(int(d["due"][0]), horizon))
parameters = pywrapcp.DefaultRoutingSearchParameters()
parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
parameters.time_limit.FromSeconds(3600)
parameters.solution_limit = work
model.solver().ReSeed(1)
answer = model.SolveWithParameters(parameters)
routes = []
for k in range(v):
    at, visits = answer.Value(model.NextVar(model.Start(k))), []
    while not model.IsEnd(at):
        visits.append(manager.IndexToNode(at))
        at = answer.Value(model.NextVar(at))
    if visits:
        routes.append(visits)
engine = time.process_time() - start
"""
    + TELL,
    "vroom": LOAD
    + """
import vroom
start = time.process_time()
made = vroom.Input()
made.set_costs_matrix("car", d["distance"])
made.set_durations_matrix("car", d["distance"] if "due" in d else np.zeros_like(d["distance"]))
window = lambda i: vroom.TimeWindow(int(d["ready"][i]), int(d["due"][i]))
timed = (lambda i: {"default_service": int(d["service"][i]), "time_windows": [window(i)]}) if "due" in d else lambda i: {}
made.add_job([vroom.Job(i, i, delivery=[int(d["demand"][i])], **timed(i)) for i in range(1, len(d["demand"]))])
shift = {"time_window": window(0)} if "due" in d else {}
capacity = [min(int(d["capacity"]), int(d["demand"].sum()))]
made.add_vehicle([vroom.Vehicle(k, start=0, end=0, capacity=capacity, **shift) for k in range(int(d["vehicles"]))])
found = made.solve(exploration_level=work, nb_threads=1)
frame = found.routes[found.routes["type"] == "job"]
routes = [[int(i) for i in part["location_index"]] for _, part in frame.groupby("vehicle_id")]
engine = time.process_time() - start
"""
    + TELL,
}

FIXED = """
work = int(sys.argv[2])
options, limits = ({"exploration_level": work}, {}) if sys.argv[3] == "vroom" else ({}, {"iterations": work})
"""

ENGINE = (
    """
import json, resource, sys, time
import waybound as wb
from waybound.solvers.backend import BACKENDS, Control, Options
problem = wb.read(sys.argv[1], **json.loads(sys.argv[4]))
"""
    + FIXED
    + """
backend = BACKENDS[sys.argv[3]]()
import importlib
for module in backend.modules:
    importlib.import_module(module)
start = time.process_time()
result = backend.run(problem, Options(time_limit=3600.0, seed=1, extra=options, **limits), Control())
engine = time.process_time() - start
routes = [list(r.visits) for r in result.answer]
"""
    + TELL
)

WHOLE = (
    """
import json, resource, sys
import waybound as wb
problem = wb.read(sys.argv[1], **json.loads(sys.argv[4]))
"""
    + FIXED
    + """
solution = wb.solve(problem, sys.argv[3], time_limit=3600.0, seed=1, bound_time=0, options=options, **limits)
engine = None
routes = [list(r.visits) for r in solution.answer]
"""
    + TELL
)


def integers(problem: RoutingProblem) -> dict[str, Any]:
    """The data as a user of the bare library would scale them: everything that has decimals by ten."""
    scale = 1 if (problem.travel.distances % 1 == 0).all() else 10
    sites, vehicle = problem.sites, problem.fleet[0]
    whole: Callable[[Any], Any] = lambda values: np.rint(np.asarray(values) * scale).astype(np.int64)  # noqa: E731
    made: dict[str, Any] = {
        "distance": whole(problem.travel.distances), "service": whole(sites.service), "demand": sites.demand.astype(np.int64),
        "capacity": int(vehicle.capacity), "vehicles": vehicle.count, "xy": sites.coordinates,
    }  # fmt: skip
    if np.isfinite(sites.due).any():
        made.update(ready=whole(sites.ready), due=whole(sites.due))
    return made


def run(code: str, *arguments: str) -> dict[str, Any]:
    """Output of a fresh process."""
    done = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def compare(name: str, source: str, settings: dict[str, Any], engine: str, work: int, repeats: int) -> dict[str, Any]:
    """Medians of CPU seconds, bare and wrapped in turn, and whether all routes are the same."""
    problem = read(source, **settings)
    assert isinstance(problem, RoutingProblem)
    runs: dict[str, list[dict[str, Any]]] = {"bare": [], "engine": [], "whole": []}
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data.npz"
        np.savez(data, **integers(problem))
        for _ in range(repeats):
            runs["bare"].append(run(BARE[engine], str(data), str(work)))
            for kind, code in (("engine", ENGINE), ("whole", WHOLE)):
                runs[kind].append(run(code, source, str(work), engine, json.dumps(settings)))
    routes = [json.dumps(r["routes"]) for kind in runs.values() for r in kind]
    middle: Callable[[str, str], float] = lambda kind, what: statistics.median(r[what] for r in runs[kind])  # noqa: E731
    return {
        "instance": name, "engine": engine, "work": work, "same": len(set(routes)) == 1,
        "bare": middle("bare", "engine"), "wrapped": middle("engine", "engine"),
        "bare_whole": middle("bare", "whole"), "wrapped_whole": middle("whole", "whole"),
    }  # fmt: skip


def cases(names: list[str] | None) -> list[tuple[str, str, dict[str, Any]]]:
    """Name, source and settings of the instances; all that are there by default."""
    found: list[tuple[str, str, dict[str, Any]]] = [(name, name, settings) for name, settings in BUNDLED.items()]
    folder = os.environ.get("WAYBOUND_BENCHMARKS")
    if folder:
        found += [(Path(path).stem, str(Path(folder) / path), settings) for path, settings in BENCHMARKS.items()]
    return [case for case in found if not names or case[0] in names]


def main(arguments: list[str] | None = None) -> int:
    """Print one line a comparison; 1 if any routes differ."""
    parser = argparse.ArgumentParser(prog="python -m waybound.reports.benchmarks.overhead", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--iterations", type=int, default=20_000, help="of PyVRP")
    parser.add_argument("--solutions", type=int, default=1_500, help="of OR-Tools")
    parser.add_argument("--level", type=int, default=5, help="of VROOM's exploration")
    parser.add_argument("--instance", action="append", help="only this one; may be repeated")
    given = parser.parse_args(arguments)
    heads = ("instance", "engine", "work", "routes", "bare s", "wrapped s", "ratio", "bare whole s", "wrapped whole s", "ratio")
    print("  ".join(heads))
    sound = True
    for name, source, settings in cases(given.instance):
        for engine, work in (("pyvrp", given.iterations), ("ortools", given.solutions), ("vroom", given.level)):
            if not BACKENDS[engine].installed():
                print(f"{name}: {engine} is not installed")
                continue
            row = compare(name, source, settings, engine, work, given.repeats)
            sound = sound and row["same"]
            figures = [name, engine, str(work), "same" if row["same"] else "DIFFER"]
            for bare, wrapped in (("bare", "wrapped"), ("bare_whole", "wrapped_whole")):
                figures += [f"{row[bare]:.2f}", f"{row[wrapped]:.2f}", f"{row[wrapped] / row[bare]:.3f}"]
            print("  ".join(f"{figure:>{len(head)}}" for figure, head in zip(figures, heads, strict=True)), flush=True)
    print(f"target: ratio of at most {TARGET}")
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
