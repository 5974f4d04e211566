"""Searches of one routing problem side by side, of which the best answer counts: with seeds of their own, or beside other engines."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

from ....formulations.routing.problem import RoutingProblem
from ...backend import Control, Engine, Options, RawResult
from .best_routes import BestRoutes, PartControl

NEXT_SEED = 0xD1B54A32D192ED03
"""Difference between the seeds of two searches side by side: no two of 256 draw the same random numbers within 2^50 draws."""


def abreast(
    search: Callable[[RoutingProblem, Options, Control], RawResult], problem: RoutingProblem, options: Options, control: Control, many: int
) -> RawResult:
    """So many searches on the threads of ``options``, until all have ended."""
    best = BestRoutes(problem, control)

    def one(number: int) -> RawResult:
        own = replace(options, threads=options.threads // many, seed=(options.seed + number * NEXT_SEED) % 2**64)
        found = search(problem, own, PartControl(best, not number))
        if found.answer is not None:
            best.take(found.answer)
        return found

    with ThreadPoolExecutor(many) as pool:
        results = list(pool.map(one, range(many)))
    statistics = dict(results[0].statistics)
    for name in ("iterations", "better"):
        statistics[name] = sum(int(result.statistics.get(name, 0)) for result in results)
    first = next((result for result in results if result.answer is not None), results[0])
    if best.answer is None:
        return replace(first, statistics=statistics)
    return replace(first, answer=best.answer, objective=best.claim, statistics=statistics)


@contextmanager
def accompanied(companion: Engine, problem: RoutingProblem, options: Options, best: BestRoutes) -> Iterator[None]:
    """Within the block a companion searches on all threads of ``options`` but one. What it finds goes to ``best``; faults cost nothing."""
    line = PartControl(best, False)
    others = replace(options, threads=options.threads - 1, seed=(options.seed + NEXT_SEED) % 2**64, extra={})
    with ThreadPoolExecutor(1) as pool:
        beside = pool.submit(companion.run, problem, others, line)
        try:
            yield
        finally:
            line.stop()
            if beside.exception() is None and beside.result().answer is not None:
                best.take(beside.result().answer)
