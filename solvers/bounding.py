"""Valid bounds for answers of engines that have none: every method that applies, cheapest first, within a budget."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..formulations.certificate import verified_bound
from ..formulations.evidence import BOUNDS, Evidence
from ..formulations.problem import Problem
from ..formulations.program import Program
from ..formulations.tolerance import same
from ..instances.errors import UnsupportedError
from .backend import BACKENDS, Control, Options, ProgramBackend

LP_SOLVER = "highs"


def find_bounds(
    problem: Problem,
    seconds: float,
    *,
    target: float | None = None,
    known: Sequence[Evidence] = (),
    control: Control | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
) -> list[Evidence]:
    """Evidence for bounds of ``problem``, to be verified by the checker.

    Parameters
    ----------
    problem : Problem
    seconds : float
        Budget for all methods together, without what they prepare once a process; 0 turns bounding off.
    target : float, optional
        Value of an answer: evidence that reaches it ends the search.
    known : sequence of Evidence
        What was found already, by whoever made the answer.
    control : Control, optional
        Stops between and inside methods.
    progress : callable, optional
        Receives an event for each bound found.

    Returns
    -------
    list of Evidence, in the order found
    """
    found: list[Evidence] = []
    if seconds <= 0 or any(_reaches(e.value, target) and _reaches(verified_bound(problem, e), target) for e in known):
        return found
    control = control or Control()
    methods = sorted((m for m in BOUNDS.values() if not m.missing(problem)), key=lambda m: m.order)
    for method in methods:
        method.prepare()
    end = time.perf_counter() + seconds

    def solve_program(program: Program, limit: float) -> NDArray[np.float64] | None:
        backend = BACKENDS[LP_SOLVER]()
        assert isinstance(backend, ProgramBackend)
        inner = Control()  # the outer one carries evidence, which a program backend would take for its own incumbent
        control.on_stop(inner.stop)
        result = backend.run(program, Options(time_limit=min(limit, max(0.0, end - time.perf_counter()))), inner)
        return result.row_duals

    for method in methods:
        left = end - time.perf_counter()
        if control.stopped or left <= 0:
            break
        try:
            evidence = method.compute(problem, left, solve_program)
        except UnsupportedError:
            continue
        if evidence is None:
            continue
        found.append(evidence)
        control.publish(list(found))
        if progress is not None:
            progress({"phase": "bound", "seconds": seconds - (end - time.perf_counter()), "objective": target, "bound": evidence.value})
        if _reaches(evidence.value, target):
            break
    return found


def _reaches(bound: float, target: float | None) -> bool:
    return target is not None and same(bound, target)
