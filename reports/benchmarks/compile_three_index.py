"""Time from a routing problem to a solver's model: waybound, PuLP and bare HiGHS calls on ready arrays, side by side.

All three write the three-index form of one generated problem with time windows. PuLP gets arcs, big-M constants and tightened windows
ready-made as lists, outside its clock, and writes the same rows and columns; that they are the same is checked through its MPS file.
Windows are wide by default, so that the arc filters remove nothing; ``--windows narrow`` shows what they remove otherwise.
"""

import time
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np

import waybound as wb
from waybound.formulations.routing.forms._routes import ArcIndex
from waybound.formulations.routing.preparation import prepare
from waybound.formulations.routing.reachability import minimum_vehicles

from ._harness import Option, command, met
from .side_by_side import MODEL, Medians, Once, print_clocks

WINDOWS = {"wide": (2000.0, 3000.0), "medium": (200.0, 400.0), "narrow": (20.0, 60.0)}
"""Widths of the time windows, within a day of 1000 units on a square of 100 x 100."""

TARGET_PULP, TARGET_BARE = 40.0, 3.0


def generate(customers: int, vehicles: int, windows: str, seed: int) -> wb.RoutingProblem:
    """Uniform customers with demands 1 to 19, services of 10, and windows around a uniform midpoint."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0.0, 100.0, (customers + 1, 2)).round(1)
    middle, width = rng.uniform(150.0, 850.0, customers), rng.uniform(*WINDOWS[windows], customers)
    ready, due = np.clip(middle - width / 2, 0.0, 850.0), np.clip(middle + width / 2, 150.0, 850.0)
    demand = np.append(0.0, rng.integers(1, 20, customers).astype(float))
    sites = wb.Sites.of(
        range(customers + 1), demand=demand, ready=np.append(0.0, ready.round(1)), due=np.append(1000.0, due.round(1)),
        service=np.append(0.0, np.full(customers, 10.0)), coordinates=xy,
    )  # fmt: skip
    capacity = float(np.ceil(1.3 * demand.sum() / vehicles))
    travel = wb.Travel("euclidean", coordinates=xy, convention="trunc1")
    return wb.RoutingProblem(sites, travel, (wb.VehicleType(count=vehicles, capacity=capacity),), name=f"generated-{customers}")


def with_waybound(problem: wb.RoutingProblem) -> Any:
    """Compile the problem to a HiGHS model ready to start."""
    return problem.compile("three-index").to_highs(names=False)


def with_bare_highs(program: wb.Program) -> tuple[Any, float]:
    """HiGHS calls on arrays that exist; also the seconds that ``addRows`` alone took."""
    import highspy

    n, none = program.num_variables, np.zeros(0, dtype=np.int32)
    integer = np.nonzero(program.integer)[0].astype(np.int32)
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.addCols(n, program.cost, program.lower, program.upper, 0, np.zeros(n, dtype=np.int32), none, np.zeros(0))
    model.changeColsIntegrality(len(integer), integer, np.ones(len(integer), dtype=np.uint8))
    began = time.perf_counter()
    model.addRows(
        program.num_rows, program.row_lower, program.row_upper, len(program.data), program.indptr[:-1], program.indices, program.data
    )
    return model, time.perf_counter() - began


def lists_for_pulp(problem: wb.RoutingProblem) -> dict[str, Any]:
    """The lists that a modeller would hold before the first variable is made: arcs with the idle one, windows, big-M."""
    prep = prepare(problem)
    clock, idle = prep.time, (0, prep.end)
    find = ArcIndex(prep).find
    arcs = sorted([*zip(prep.tail.tolist(), prep.head.tolist(), strict=True), idle])
    tails, heads = (np.array(side, dtype=np.int64) for side in zip(*arcs, strict=True))
    at = find(tails, heads)
    weight, cost = np.where(at >= 0, clock.weight[at], 0.0), np.where(at >= 0, prep.cost[at], 0.0)
    big = np.where(at >= 0, clock.upper[tails] + weight - clock.lower[heads], 0.0)
    return {
        "arcs": arcs, "cost": cost.tolist(), "weight": weight.tolist(), "M": big.tolist(), "lower": clock.lower.tolist(),
        "upper": clock.upper.tolist(), "demand": prep.demand.tolist(), "nodes": prep.nodes, "vehicles": prep.fleet,
        "upper_x": _upper_of_arcs(problem, tails, heads), "capacity": problem.fleet[0].capacity, "least": minimum_vehicles(problem),
    }  # fmt: skip


def _upper_of_arcs(problem: wb.RoutingProblem, tails: Any, heads: Any) -> list[list[float]]:
    """1, or 0 where vehicle k would visit a customer before the k-th: see the form's text."""
    end = len(problem.customers) + 1
    firsts = [min([node for node in arc if 0 < node < end], default=end) for arc in zip(tails.tolist(), heads.tolist(), strict=True)]
    return [[1.0 if first > k else 0.0 for k in range(problem.fleet[0].count or end)] for first in firsts]


def with_pulp(data: dict[str, Any], path: Path) -> Any:
    """The same rows and columns in PuLP's own words, and its MPS file."""
    import pulp

    arcs, nodes, vehicles = data["arcs"], range(data["nodes"]), range(data["vehicles"])
    out: dict[int, list[int]] = {i: [] for i in nodes}
    into: dict[int, list[int]] = {i: [] for i in nodes}
    for a, (i, j) in enumerate(arcs):
        out[i].append(a)
        into[j].append(a)
    end, customers = data["nodes"] - 1, range(1, data["nodes"] - 1)
    model = pulp.LpProblem("three_index", pulp.LpMinimize)
    x = {
        (a, k): model.add_variable(f"x_{i}_{j}_{k}", 0, data["upper_x"][a][k], cat="Integer")
        for a, (i, j) in enumerate(arcs) for k in vehicles
    }  # fmt: skip
    t = {(i, k): model.add_variable(f"t_{i}_{k}", data["lower"][i], data["upper"][i]) for i in nodes for k in vehicles}
    model += pulp.lpSum(data["cost"][a] * x[a, k] for a in range(len(arcs)) for k in vehicles)
    for i in customers:
        model += pulp.lpSum(x[a, k] for a in out[i] for k in vehicles) == 1, f"visit_{i}"
    model += pulp.lpSum(x[a, k] for a in out[0] if arcs[a][1] != end for k in vehicles) >= data["least"], "fleet"
    for k in vehicles:
        model += pulp.lpSum(x[a, k] for a in out[0]) == 1, f"depart_{k}"
        for i in customers:
            model += pulp.lpSum(x[a, k] for a in into[i]) - pulp.lpSum(x[a, k] for a in out[i]) == 0, f"flow_{i}_{k}"
        model += pulp.lpSum(data["demand"][i] * x[a, k] for i in customers for a in out[i]) <= data["capacity"], f"load_{k}"
    for a, (i, j) in enumerate(arcs):
        big = data["M"][a]
        if big > 0:
            for k in vehicles:
                model += t[i, k] - t[j, k] + big * x[a, k] <= big - data["weight"][a], f"time_{i}_{j}_{k}"
    model.writeMPS(str(path), rename=True)
    return model


def run_once(which: str, size: tuple[int, int, str, int], folder: Path) -> None:
    """One measurement in this process, after imports and data; ``size`` holds the arguments of ``generate``."""
    import highspy  # noqa: F401  (imports are not part of any clock)
    import scipy.sparse  # noqa: F401

    problem = generate(*size)
    if which == "pulp":
        import pulp  # noqa: F401

        print_clocks(partial(with_pulp, lists_for_pulp(problem), folder / MODEL))
        return
    with_waybound(generate(2, 1, size[2], size[3]))  # loads the modules
    if which == "waybound":
        print_clocks(partial(with_waybound, problem))
        return
    program = problem.compile("three-index").program
    for name in ("cost", "lower", "upper", "integer", "row_lower", "row_upper", "indptr", "indices", "data"):
        getattr(program, name)  # made on first use
    print_clocks(partial(with_bare_highs, program))


def report(customers: int, vehicles: int, windows: str, seed: int, repeats: int) -> str:
    """Measure, and say what came out."""
    size = (customers, vehicles, windows, seed)
    program = generate(*size).compile("three-index").program
    unfiltered = (customers * (customers - 1) + 2 * customers + 1) * vehicles
    time_rows = sum(b.size for b in program.rows if b.name == "time")
    module = __spec__.name if __spec__ else __name__
    options = ("--customers", customers, "--vehicles", vehicles, "--windows", windows, "--seed", seed)
    median = Medians(module, options, ["waybound", "bare", "pulp"], program, repeats)
    a, b, c = (median(which, "wall") for which in median.runs)
    a_cpu, b_cpu, c_cpu = (median(which, "cpu") for which in median.runs)
    rows = median("bare", "part")
    good = c / a >= TARGET_PULP and a / rows <= TARGET_BARE
    lines = [
        f"three-index form, {customers} customers, {vehicles} vehicles, {windows} windows, seed {seed}; each run in a fresh process",
        f"  {program.num_variables} columns, {program.num_rows} rows, {len(program.data)} entries",
        f"  arc variables left by the filters: {program.variables[0].size} of {unfiltered}; time rows with M > 0: {time_rows}",
        "",
        f"{median.heading:40}{'wall s':>9}{'CPU s':>9}   waybound, by wall (CPU) time",
        f"{'waybound: problem to HiGHS model':40}{a:>9.4f}{a_cpu:>9.4f}",
        f"{'bare HiGHS calls on ready arrays':40}{b:>9.4f}{b_cpu:>9.4f}   {a / b:.2f}x ({a_cpu / b_cpu:.2f}x) as long",
        f"{'  of these addRows alone':40}{rows:>9.4f}{'':9}   {a / rows:.2f}x as long",
        f"{'PuLP: lists to MPS file, same model':40}{c:>9.4f}{c_cpu:>9.4f}   {c / a:.0f}x ({c_cpu / a_cpu:.0f}x) as fast",
        "",
        f"targets: at least {TARGET_PULP:.0f}x as fast as PuLP, at most {TARGET_BARE:.0f}x addRows alone: {met(good)}",
    ]
    return "\n".join(lines)


@command
def main(
    customers: int = 100,
    vehicles: int = 10,
    windows: Annotated[str, Option(choices=list(WINDOWS))] = "wide",
    seed: int = 1,
    repeats: int = 7,
    once: Once = "",
    folder: Annotated[Path, Option(type=Path)] = Path(),
) -> None:
    size = (customers, vehicles, windows, seed)
    if once:
        run_once(once, size, folder)
    else:
        print(report(*size, repeats))
