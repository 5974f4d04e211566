"""The saddle engine on max-min linear programs of up to a million robots, beside HiGHS on the same program.

One thread, CPU seconds. The engine's clock starts with a ``SensingGraph`` of which nothing else is computed, and ends with answer and
bound; what its certificate takes (recomputing the objective, multiplying the prices out) is told apart. The seconds to a gap are those
after which best value and best bound, as published, were that close; of the repeats the one that took least is shown. Compiling the kernels
is outside and told apart. HiGHS starts with the compiled program, with simplex and with the interior point; it gets the programs of up to
10,000 robots, with ``--full`` also those of 100,000, and is given up after ``--highs-limit`` seconds of CPU time, which on a busy machine
may be more by the clock.

Near-regular and geometric graphs are the kinds ``sensing-regular`` and ``sensing-geometric`` with the number of robots as seed; their value
is a matter of a few targets. In the others all targets matter: in the expander, two actions a robot, two targets an action and four actions
a target are joined at random; on the torus, a robot has one action for each corner of its square; weights are uniform in [0.5, 1.5] and
[0.7, 1.3]. Planted graphs are random ones of which optimal shares and prices are known; their value is 1 a robot over the sum of prices.

Family ``joined`` is of programs of packing and covering rows: each variable in two of either, joined at random, four variables a row,
coefficients uniform in [0.5, 1.5]. ``robots`` are variables then, and HiGHS is also asked for its first-order method.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from scipy.sparse import csr_array

import waybound as wb
from waybound.extending import Control, Options
from waybound.formulations.certificate import certify
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.solvers.engines.sata.saddle import Saddle

from ._harness import Option, command, generated, solved, timed

GAPS = (1e-1, 1e-2, 1e-3, 1e-4)

LARGEST_FOR_HIGHS, LARGEST_FOR_HIGHS_FULL = 10_000, 100_000


def expander(robots: int) -> SensingGraph:
    rng, stub = np.random.default_rng(robots), np.arange(4 * robots)
    target, weight = rng.permutation(len(stub)) // 4, rng.uniform(0.5, 1.5, len(stub))
    return graph_of_edges(np.arange(2 * robots) // 2, stub // 2, target, weight, robots=robots, duplicates="sum")


def torus(robots: int) -> SensingGraph:
    side = math.isqrt(robots)
    action = np.arange(4 * side * side)
    robot, corner = np.divmod(action, 4)
    target = (robot // side + corner // 2) % side * side + (robot % side + corner % 2) % side
    weight = np.random.default_rng(robots).uniform(0.7, 1.3, len(action))
    return graph_of_edges(robot, action, target, weight, robots=side * side)


def planted(robots: int) -> SensingGraph:
    """Three actions a robot, two targets an action, six actions a target, joined at random: the first two actions of each robot are worth 1
    at the planted prices, the third less, and all targets are covered alike where the first two have equal shares, so that this is optimal.
    """
    rng, action = np.random.default_rng(robots), np.arange(6 * robots) // 2
    worth, used, target = rng.uniform(0.5, 1.5, len(action)), action % 3 < 2, np.empty(len(action), np.int64)
    for edges in (used, ~used):
        target[edges] = np.concatenate([rng.permutation(robots) for _ in range(edges.sum() // robots)])
    worth *= np.where(used, 1.0, rng.uniform(0.5, 0.95, 3 * robots)[action]) / np.bincount(action, worth)[action]
    price = np.bincount(target, np.where(used, 0.5 * worth, 0.0), minlength=robots)
    return graph_of_edges(np.arange(3 * robots) // 3, action, target, worth / price[target], robots=robots, duplicates="sum")


def joined(variables: int) -> wb.MaxMinLP:
    rng, stub = np.random.default_rng(variables), np.arange(2 * variables)
    rows = [csr_array((rng.uniform(0.5, 1.5, len(stub)), (rng.permutation(len(stub)) // 4, stub // 2))) for _ in range(2)]
    return wb.MaxMinLP(*rows, name=f"joined-{variables}")


FAMILIES: dict[str, Callable[[int], SensingGraph]] = {
    "near-regular": lambda robots: generated(SensingGraph, "sensing-regular", robots, robots=robots),
    "geometric": lambda robots: generated(SensingGraph, "sensing-geometric", robots, robots=robots),
    "expander": expander,
    "torus": torus,
    "planted": planted,
}
PROGRAMS: dict[str, Callable[[int], SensingGraph | wb.MaxMinLP]] = {**FAMILIES, "joined": joined}


def fresh(graph: SensingGraph) -> SensingGraph:
    """The same graph without what was computed of it before."""
    return replace(graph, notes=())


@dataclass(frozen=True)
class Measured:
    """One run: seconds until each of ``GAPS``, until the end, and for the certificate."""

    value: float
    bound: float
    gap: float
    until: tuple[float, ...]
    seconds: float
    certificate: float
    status: str
    limit: str
    statistics: dict[str, Any]


def measure(graph: SensingGraph | wb.MaxMinLP, gap: float, limit: float) -> Measured:
    """Run the engine once; the certificate must prove its bound."""
    problem = wb.BottleneckSATA(fresh(graph), fractional=True) if isinstance(graph, SensingGraph) else graph
    until = [math.nan] * len(GAPS)

    def hear(event: dict[str, Any]) -> None:
        now, value, bound = time.process_time() - began, event["objective"], event["bound"]
        if value is None or bound is None:
            return
        for k, wanted in enumerate(GAPS):
            if math.isnan(until[k]) and bound - value <= wanted * value:
                until[k] = now

    began = time.process_time()
    result = Saddle().run(problem, Options(time_limit=limit, gap=gap), Control(hear))
    seconds = time.process_time() - began
    checked, certificate = timed(lambda: certify(problem, problem.evaluate(result.answer), result.evidence))
    assert certificate.feasible and isinstance(certificate.objective, float)
    assert certificate.bound is not None and certificate.gap is not None
    return Measured(
        certificate.objective, certificate.bound, certificate.gap, tuple(until), seconds, checked, result.status, result.limit,
        result.statistics,
    )  # fmt: skip


def by_highs(graph: SensingGraph | wb.MaxMinLP, method: str, limit: float) -> str:
    """HiGHS on the compiled program: CPU seconds and optimum, or that it was given up."""
    problem = wb.BottleneckSATA(graph, fractional=True) if isinstance(graph, SensingGraph) else graph
    program = replace(problem.compile("max-min").program, name="unknown")
    seconds, result = solved(program, "highs", limit, solver=method)
    if result.status != "optimal":
        return f"{method} given up after {seconds:.1f} s"
    return f"{method} {seconds:.2f} s, optimum {result.objective:.6f}"


def _seconds(value: float) -> str:
    return f"{value:9.2f}" if math.isfinite(value) else f"{'-':>9s}"


@command
def main(
    families: Annotated[tuple[str, ...], Option(choices=PROGRAMS)] = tuple(PROGRAMS),
    robots: tuple[int, ...] = (10_000, 100_000, 1_000_000),
    gap: Annotated[float, Option(help="at which the engine ends")] = 1e-6,
    limit: Annotated[float, Option(help="of the engine, in seconds by the clock")] = 60.0,
    repeats: Annotated[int, Option(help="for runs of less than two seconds")] = 3,
    highs_limit: float = 120.0,
    full: bool = False,
) -> None:
    began = time.perf_counter()
    measure(expander(200), 1e-3, 60.0)
    print(f"kernels ready after {time.perf_counter() - began:.1f} s (compiled, or read from the disk's cache); CPU seconds of one thread")
    heads = "".join(f"{f'to {gap:.0e}':>9s}" for gap in GAPS)
    print(f"{'family':13s}{'robots':>9s}{'edges':>9s}{'value':>11s}{'bound':>11s}{'gap':>9s}{heads}{'end':>9s}{'certify':>9s}  how")
    for family in families:
        for size in robots:
            graph = PROGRAMS[family](size)
            best = measure(graph, gap, limit)
            for _ in range(repeats - 1):
                if best.seconds < 2.0:
                    best = min(best, measure(graph, gap, limit), key=lambda m: m.seconds)
            how = ", ".join(f"{number:.4g} {name.replace('_', ' ')}" for name, number in best.statistics.items())
            edges = graph.num_edges if isinstance(graph, SensingGraph) else len(graph.packing.data) + len(graph.covering.data)
            print(
                f"{family:13s}{size:9d}{edges:9d}{best.value:11.6f}{best.bound:11.6f}{best.gap:9.1e}"
                f"{''.join(map(_seconds, best.until))}{_seconds(best.seconds)}{_seconds(best.certificate)}  {how}; {best.limit}",
                flush=True,
            )
            if size <= (LARGEST_FOR_HIGHS_FULL if full else LARGEST_FOR_HIGHS):
                for method in ("simplex", "ipm", *(("pdlp",) if family == "joined" else ())):
                    print(f"{'':13s}HiGHS {by_highs(graph, method, highs_limit)}", flush=True)
