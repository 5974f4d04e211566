"""Winner takes all at up to 100,000 robots: greedy's certified ratio, by prices of items, beside HiGHS on the same relaxation.

One thread, CPU seconds, kernels compiled. The graphs are those of the saddle benchmark. Lazy greedy makes the answer. The clock of the
prices starts with the problem and ends at a gap of 5e-7 between what they prove and a fractional answer, both of which enclose the
relaxation's value, or at ``--limit``; the seconds to a gap are those after which they were that close. The bound is rounded down where all
weights are whole. The certificate (judging the answer, multiplying the prices out) is told apart. HiGHS starts with the compiled program;
it gets the programs of up to 10,000 robots, with ``--full`` all, and is given up after ``--highs-limit`` seconds. Exit code 1 if a bound
was not within 2 % of the relaxation's value after 60 seconds.
"""

import math
import time
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

import waybound as wb
from waybound.extending import HEURISTICS, Context, LinearPrograms, Stop
from waybound.formulations.certificate import certify
from waybound.formulations.kernels import kernels
from waybound.instances.sata.sensing_graph import SensingGraph
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.sata.item_prices import ROUND, PriceGame, evidence_of

from ._harness import Option, command, met, solved, timed
from .saddle import FAMILIES, LARGEST_FOR_HIGHS, fresh

GAPS = (1e-1, 2e-2, 1e-3, 1e-4)
WANTED, SECONDS = 2e-2, 60.0
METHODS = ("simplex", "ipm", "pdlp")


@dataclass(frozen=True)
class Measured:
    """Greedy's value, the ends between which the relaxation's lies and their gap, seconds to each of ``GAPS`` and of the rest."""

    greedy: float
    value: float
    bound: float
    gap: float
    steps: int
    picking: float
    until: tuple[float, ...]
    seconds: float
    certificate: float


def measure(graph: SensingGraph, limit: float) -> Measured:
    """Pick greedily, price, and certify; the certificate must prove the bound."""
    problem, stop = wb.WinnerTakesAllSATA(fresh(graph)), Stop(limit)
    context = Context(np.random.default_rng(1), limit, None, lambda answer: None, stop, LinearPrograms())
    picking, outcome = timed(lambda: HEURISTICS["lazy-greedy"].run(problem, context))
    stop, began, until = Stop(limit), time.process_time(), [math.nan] * len(GAPS)
    game = PriceGame(problem)
    while True:
        for k, wanted in enumerate(GAPS):
            if math.isnan(until[k]) and game.bound - game.value <= wanted * game.value:
                until[k] = time.process_time() - began
        if game.closed() or stop.reached():
            break
        game.run(stop, game.steps + ROUND)
    evidence, seconds = evidence_of(problem, game), time.process_time() - began
    checked, certificate = timed(lambda: certify(problem, problem.evaluate(outcome.answer), (evidence,)))
    assert certificate.feasible and isinstance(certificate.objective, float) and certificate.bound is not None
    return Measured(
        certificate.objective, game.value * game.unit, certificate.bound, game.bound / game.value - 1.0, game.steps, picking,
        tuple(until), seconds, checked,
    )  # fmt: skip


def by_highs(graph: SensingGraph, method: str, limit: float) -> str:
    """HiGHS on the compiled relaxation: CPU seconds and what it takes for the optimum, or how it ended without one."""
    program = replace(wb.WinnerTakesAllSATA(graph).compile("strong-linearisation").relaxed().program, name="unknown")
    seconds, result = solved(program, "highs", limit, solver=method)
    if result.status != "optimal":
        return f"{method} no optimum after {seconds:.1f} s: {result.status}, limit {result.limit}, {result.message or 'no message'}"
    return f"{method} {seconds:.2f} s, optimum {result.objective:.4f}"


@command
def main(
    families: Annotated[tuple[str, ...], Option(choices=FAMILIES)] = tuple(FAMILIES),
    robots: tuple[int, ...] = (10_000, 100_000),
    limit: Annotated[float, Option(help="of the prices, in seconds by the clock")] = 60.0,
    highs_limit: float = 120.0,
    full: bool = False,
) -> bool:
    for module in BOUNDS["item-prices"].kernels:
        for kernel in kernels(module):
            kernel.make()
    measure(FAMILIES["torus"](16), 60.0)
    heads = "".join(f"{f'to {gap:.0e}':>9s}" for gap in GAPS)
    print(
        f"{'family':13s}{'robots':>9s}{'edges':>9s}{'greedy':>11s}{'LP at least':>13s}{'bound':>13s}{'gap':>9s}{'ratio':>8s}"
        f"{'picking':>9s}{heads}{'end':>9s}{'steps':>7s}{'certify':>9s}"
    )
    good = True
    for family in families:
        for size in robots:
            graph = FAMILIES[family](size)
            m = measure(graph, limit)
            good &= m.until[GAPS.index(WANTED)] <= SECONDS
            print(
                f"{family:13s}{size:9d}{graph.num_edges:9d}{m.greedy:11.2f}{m.value:13.4f}{m.bound:13.4f}{m.gap:9.0e}"
                f"{m.greedy / m.bound:8.4f}{m.picking:9.2f}{''.join(f'{s:9.2f}' for s in m.until)}{m.seconds:9.2f}{m.steps:7d}"
                f"{m.certificate:9.2f}",
                flush=True,
            )
            if size <= LARGEST_FOR_HIGHS or full:
                for method in METHODS:
                    print(f"{'':13s}HiGHS {by_highs(graph, method, highs_limit)}", flush=True)
    print(f"target: within {WANTED:.0%} of the relaxation in {SECONDS:.0f} s: {met(good)}")
    return good
