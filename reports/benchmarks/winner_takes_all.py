"""Winner takes all solved to proven optimality: the forms against each other, ten seeds, one thread.

20 robots with 2 actions each, 150 targets, density 15 %, the largest of the SATA experiments. The linear forms run with HiGHS; the product
as it stands with those who take it: CP-SAT, and SCIP through MathOpt and, where it is installed, through PySCIPOpt. Seconds are CPU time of
compiling and solving in one process (modules loaded before). All answers are judged from the data, and all proven optima must be equal.
"""

from __future__ import annotations

import statistics
import sys
from typing import Annotated

import waybound as wb
from waybound.solvers.backend import BACKENDS, RawResult

from ._harness import Option, command, generated, met, solved, timed

SIZE = {"robots": 20, "actions": 2, "targets": 150, "phi": 15}

RUNS = (
    ("facility-location", "highs"),
    ("strong-linearisation", "highs"),
    ("weak-linearisation", "highs"),
    ("product", "cpsat"),
    ("product", "mathopt:gscip"),
    ("product", "scip"),
)

TARGET_FORM, TARGET = "strong-linearisation", 3.0
"""Median CPU seconds that the strong form may take."""


def instance(seed: int, weights: str, **size: int) -> wb.WinnerTakesAllSATA:
    """One problem of the given size (by default the largest of the experiments)."""
    return wb.WinnerTakesAllSATA(generated(wb.SensingGraph, "sata", seed, weights=weights, **{**SIZE, **size}))


def run(problem: wb.WinnerTakesAllSATA, form: str, solver: str, limit: float) -> tuple[float, RawResult, float]:
    """CPU seconds, the solver's account, and the answer's value recomputed from the data."""
    compiling, model = timed(lambda: problem.compile(form))
    solving, result = solved(model.program, solver, limit)
    judged = problem.evaluate(model.decode(result.answer))
    assert judged.feasible, judged.violations
    return compiling + solving, result, judged.values[0]


def report(seeds: int, weights: str, limit: float, **size: int) -> str:
    """Solve all, compare, and say what came out."""
    runs = [r for r in RUNS if BACKENDS[r[1].partition(":")[0]].installed()]
    for form, solver in runs:
        run(instance(1, weights, robots=4, targets=10, phi=30), form, solver, limit)  # loads the modules
    problems = [instance(seed, weights, **size) for seed in range(seeds)]
    optima: list[float] = []
    lines = [
        f"winner takes all, {problems[0].graph!r} and others: {seeds} seeds, {weights} weights, one thread, limit {limit:g} s",
        f"{'form':22} {'solver':14} {'proven':>6} {'median':>8} {'longest':>8}   {'columns':>7} {'rows':>6} {'entries':>7}   gap left",
    ]
    medians = {}
    for form, solver in runs:
        seconds, gaps, proven = [], [], 0
        for k, problem in enumerate(problems):
            took, result, value = run(problem, form, solver, limit)
            seconds.append(took)
            proven += result.status == "optimal"
            gaps.append(0.0 if result.status == "optimal" else abs((result.bound or value) - value) / max(value, 1e-9))
            if k == len(optima):
                assert result.status == "optimal", "the first form must prove the optima that the others are held against"
                optima.append(value)
            short = optima[k] - value
            assert short >= -1e-6 and (result.status != "optimal" or short <= 1e-6), (
                f"{form} by {solver}: {value}, known optimum {optima[k]}"
            )
        medians[form, solver] = statistics.median(seconds)
        program = problems[0].compile(form).program
        lines.append(
            f"{form:22} {solver:14} {proven:>3}/{seeds:<2} {medians[form, solver]:>8.3f} {max(seconds):>8.3f}   {program.num_variables:>7} "
            f"{program.num_rows:>6} {len(program.data):>7}   {100 * statistics.median(gaps):.1f} % (median)"
        )
    lines.append(f"optima: {', '.join(f'{v:g}' for v in optima)}")
    strong = medians[TARGET_FORM, "highs"]
    lines.append(f"target: median of {TARGET_FORM} below {TARGET:g} s: {met(strong < TARGET)} ({strong:.3f} s)")
    return "\n".join(lines)


@command
def main(seeds: int = 10, weights: Annotated[str, Option(choices=["binary", "uniform"])] = "binary", limit: float = 20.0) -> str:
    return report(seeds, weights, limit)


if __name__ == "__main__":
    sys.exit(main())
