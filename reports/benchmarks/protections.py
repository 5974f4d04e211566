"""The cost of switching off parts of solvers that the battery found wrong.

Mixed-integer programs of all families, each with waybound's options, with the library's own, and for HiGHS without any presolve. Seconds
are CPU time of reductions and search, children included, one thread; all proven optima must be equal.
"""

import math
import resource
from collections.abc import Callable, Iterator
from typing import Any

from waybound.formulations.problem import Problem, problem_from_instance
from waybound.formulations.programs.program import Program
from waybound.instances.bundled import bundled_path
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.solvers.backend import RawResult

from ._harness import command, solved

RUNS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("highs", "waybound's", {}),
    ("highs", "HiGHS' own", {"presolve_rule_off": 0}),
    ("highs", "no presolve", {"presolve": "off"}),
    ("pulp", "waybound's", {}),
    ("pulp", "CBC's own", {"preprocess": "sos"}),
)


def routing(name: str, customers: int) -> Problem:
    """The first customers of a bundled file."""
    return problem_from_instance(read_instance(bundled_path(name)), convention="trunc1", customers=customers)


BUNDLED = ("demo-rc50", "demo-r25")
SIZE = {"robots": 20, "actions": 2, "targets": 150, "phi": 15}
COVERAGE = {"elements": 40, "items": 80, "per-element": 8, "k": 5}

GROUPS: dict[str, tuple[str, Callable[[int], Problem]]] = {
    "routing, windows": ("two-index-load-flow", lambda k: routing(BUNDLED[k % 2], 13 + k)),
    "routing, node levels": ("two-index-mtz", lambda k: routing(BUNDLED[k % 2], 11 + k)),
    "routing, three indices": ("three-index", lambda k: routing(BUNDLED[k % 2], 9 + k)),
    "winner takes all": ("strong-linearisation", lambda k: problem_from_instance(generate("sata", k, **SIZE), "winner-takes-all")),
    "coverage": ("facility-location", lambda k: problem_from_instance(generate("coverage", k, **COVERAGE))),
    "bottleneck": ("max-min", lambda k: problem_from_instance(generate("sata", k, robots=12, actions=3, targets=25, phi=15), "bottleneck")),
}
"""A form, and a problem by number, for each group."""


def run(program: Program, solver: str, own: dict[str, Any], limit: float) -> tuple[float, RawResult]:
    """CPU seconds of this process and of its children that have ended, and the solver's account."""
    began = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds, result = solved(program, solver, limit, **own)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return seconds + ended.ru_utime - began.ru_utime + ended.ru_stime - began.ru_stime, result


def rows(seeds: int, limit: float, groups: dict[str, tuple[str, Callable[[int], Problem]]] | None = None) -> Iterator[str]:
    """One line per group and run: how many were proved optimal, and the seconds of all together."""
    for group, (form, make) in (groups or GROUPS).items():
        programs = [make(k).compile(form).program for k in range(seeds)]
        known: dict[int, float] = {}
        for solver, word, own in RUNS:
            seconds, proven = 0.0, 0
            for k, program in enumerate(programs):
                took, result = run(program, solver, own, limit)
                seconds += took
                if result.status == "optimal":
                    assert result.objective is not None
                    proven += 1
                    first = known.setdefault(k, result.objective)
                    assert math.isclose(first, result.objective, rel_tol=1e-6), (
                        f"{group} {k}, {solver}, {word}: {result.objective}, not {first}"
                    )
            yield f"{group:24} {form:22} {solver:6} {word:12} {proven:>3}/{seeds:<2} {seconds:>9.2f} s"


@command
def main(seeds: int = 3, limit: float = 300.0) -> None:
    for solver in ("highs", "pulp"):  # loads the modules
        run(GROUPS["bottleneck"][1](0).compile().program, solver, {}, 5.0)
    for line in rows(seeds, limit):
        print(line, flush=True)
