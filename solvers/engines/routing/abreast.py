"""Searches of one routing problem side by side, a thread and a seed each, of which the best answer counts."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

from ...backend import Control, Options, RawResult
from .best_routes import BestRoutes, PartControl

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem
    from ....formulations.routing.routes import Routes

NEXT_SEED = 0xD1B54A32D192ED03
"""What the seeds of two searches are apart, no multiple of which is what the random numbers of ``search_kernels`` go on by."""


def abreast(
    search: Callable[[RoutingProblem, Options, Control], RawResult], problem: RoutingProblem, options: Options, control: Control
) -> RawResult:
    """Search on all threads of ``options``, until all have ended."""
    best = _Shared(problem, control)

    def one(number: int) -> RawResult:
        own = replace(options, threads=1, seed=(options.seed + number * NEXT_SEED) % 2**64)
        found = search(problem, own, PartControl(best, not number))
        if found.answer is not None:
            best.take(found.answer)
        return found

    with ThreadPoolExecutor(options.threads) as pool:
        results = list(pool.map(one, range(options.threads)))
    statistics = dict(results[0].statistics)
    for name in ("iterations", "better"):
        statistics[name] = sum(int(result.statistics.get(name, 0)) for result in results)
    first = next((result for result in results if result.answer is not None), results[0])
    if best.answer is None:
        return replace(first, statistics=statistics)
    return replace(first, answer=best.answer, objective=best.claim, statistics=statistics)


class _Shared(BestRoutes):
    """The best answer of several threads."""

    def __init__(self, problem: RoutingProblem, control: Control) -> None:
        super().__init__(problem, control)
        self._lock = threading.Lock()

    def take(self, answer: Routes) -> bool:
        with self._lock:
            return super().take(answer)
