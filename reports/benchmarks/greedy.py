"""Greedy selection: waybound and submodlib's lazy greedy on the same data in one run.

Weighted coverage (20 of 2,000 items an element) and dense facility location (500 items, float32), a cardinality limit. CPU seconds of one
thread, best of the repeats, taken in turn. waybound's clock covers the whole heuristic from the problem to its outcome: picking, guarantee
and the evidence for its bound; "picking" is the part that finds the answer. submodlib's covers building its function object and maximising;
the conversion of the data into what it takes is outside. Compiling the kernels happens once a machine, outside the clock. Without the
package (``pip install submodlib-py``) waybound is measured alone.
"""

import importlib.util
import os
import time
from collections.abc import Callable
from typing import Any

# One thread for everybody, before numpy is imported.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import waybound as wb
from waybound.extending import HEURISTICS, NEVER, Context, LinearPrograms
from waybound.heuristics.sata.greedy_steps.picking import pick

from ._harness import command, met, timed
from .certified_ratio import random_coverage

ITEMS_OF_ELEMENT, ITEMS, CLIENTS = 20, 2000, 500
TARGETS = {"coverage": 10.0, "facility location": 3.0}
TARGET_EVALUATIONS = 0.05


def context() -> Context:
    return Context(np.random.default_rng(1), 600.0, None, lambda a: None, NEVER, LinearPrograms())


def generate(what: str, elements: int, picks: int, seed: int) -> wb.SubmodularSelection:
    """The data of the benchmark, the same for all."""
    rng = np.random.default_rng(seed)
    if what == "coverage":
        function: Any = random_coverage(rng, elements, ITEMS, ITEMS_OF_ELEMENT)
    else:
        points, clients = rng.normal(size=(elements, 8)), rng.normal(size=(CLIENTS, 8))
        matrix = np.empty((elements, CLIENTS), np.float32)
        for k in range(0, elements, 5000):
            matrix[k : k + 5000] = np.exp(-0.25 * ((points[k : k + 5000, None] - clients[None]) ** 2).sum(-1))
        function = wb.DenseFacilityLocation(matrix)
    return wb.SubmodularSelection(function, wb.Cardinality(picks), name=what)


Run = tuple[float, list[int], dict[str, Any]]
"""CPU seconds, the elements in the order in which they were picked, and statistics."""


def with_waybound(problem: wb.SubmodularSelection, heuristic: str, **options: Any) -> Run:
    seconds, outcome = timed(lambda: HEURISTICS[heuristic].run(problem, context(), **options))
    return seconds, list(outcome.answer.elements), outcome.statistics


def picking_alone(problem: wb.SubmodularSelection) -> Run:
    seconds, taken = timed(lambda: pick(problem, context().begin()))
    return seconds, taken.elements, {"evaluation": taken.evaluation}


def with_submodlib(problem: wb.SubmodularSelection) -> Callable[[], Run]:
    import submodlib

    f, n = problem.function, problem.num_elements
    budget = problem.constraint.limit  # type: ignore[attr-defined]
    if isinstance(f, wb.Coverage):
        sets = [set(f.indices[f.indptr[e] : f.indptr[e + 1]].tolist()) for e in range(n)]
        weights = f.item_weights.tolist()

        def build() -> Any:
            return submodlib.SetCoverFunction(n=n, cover_set=sets, num_concepts=f.num_items, concept_weights=weights)

    else:
        assert isinstance(f, wb.DenseFacilityLocation)
        similarity = np.ascontiguousarray(f.matrix.T)

        def build() -> Any:
            return submodlib.FacilityLocationFunction(n=n, mode="dense", separate_rep=True, n_rep=similarity.shape[0], sijs=similarity)

    def run() -> Run:
        seconds, chosen = timed(
            lambda: build().maximize(
                budget=budget, optimizer="LazyGreedy", stopIfZeroGain=False, stopIfNegativeGain=False, verbose=False, show_progress=False
            )
        )
        return seconds, [int(e) for e, _ in chosen], {}

    return run


def measure(problem: wb.SubmodularSelection, repeats: int) -> dict[str, Run]:
    """Best time of each contestant, its picks and statistics."""
    contestants: dict[str, Callable[[], Run]] = {
        "greedy": lambda: with_waybound(problem, "greedy"),
        "greedy, picking alone": lambda: picking_alone(problem),
        "lazy-greedy": lambda: with_waybound(problem, "lazy-greedy"),
        "greedy, evaluation=plain": lambda: with_waybound(problem, "greedy", evaluation="plain"),
    }
    if importlib.util.find_spec("submodlib") is not None:
        contestants["submodlib LazyGreedy"] = with_submodlib(problem)
    best: dict[str, Run] = {}
    for number in range(repeats):
        for name, run in contestants.items():
            if number and name.endswith("plain"):
                continue  # a reference, not a contestant
            result = run()
            if name not in best or result[0] < best[name][0]:
                best[name] = result
    return best


def report(elements: int = 100_000, picks: int = 100, repeats: int = 3, seed: int = 1) -> tuple[str, bool]:
    """Measure, and say what came out and whether the targets are met."""
    began = time.perf_counter()
    for what in TARGETS:  # compiles, or loads what was compiled before
        measure(generate(what, 50, 5, seed), 1)
    lines = [
        f"greedy, {elements:,} elements, {picks} picks, seed {seed}: CPU seconds of one thread, best of {repeats}",
        f"  compiling or loading the kernels, outside the clock: {time.perf_counter() - began:.1f} s",
    ]
    good = True
    for what, target in TARGETS.items():
        problem = generate(what, elements, picks, seed)
        runs = measure(problem, repeats)
        peer = runs.get("submodlib LazyGreedy")
        lines += ["", f"{what:28}{'CPU s':>9}{'value':>11}{'evaluations':>13}{'of plain':>10}{'against submodlib':>19}"]
        for name, (seconds, chosen, facts) in runs.items():
            evaluations = facts.get("evaluations")
            share = "" if evaluations is None else f"{evaluations / facts['plain_evaluations']:.1%}"
            faster = "" if peer is None else f"{peer[0] / seconds:.1f}x as fast"
            shown = f"{evaluations:,}" if evaluations is not None else ""
            lines.append(f"  {name:26}{seconds:>9.4f}{problem.value(chosen):>11.3f}{shown:>13}{share:>10}{faster:>19}")
        lines.append(f"  `greedy` chose the evaluation {runs['greedy'][2]['evaluation']!r}")
        lazy = runs["lazy-greedy"][2]
        few = lazy["evaluations"] <= TARGET_EVALUATIONS * lazy["plain_evaluations"]
        alike = all(chosen == runs["greedy"][1] for _, chosen, _ in runs.values())
        verdict = f"same answer: {'yes' if alike else 'NO'}; "
        verdict += f"lazy evaluations at most {TARGET_EVALUATIONS:.0%} of plain: {met(few)}"
        if peer is None:
            verdict += "; submodlib-py is not installed, so there is no comparison"
        else:
            fast = peer[0] / runs["greedy"][0] >= target
            verdict += f"; at least {target:.0f}x as fast as submodlib: {met(fast)}"
            good &= fast
        good &= alike and few
        lines.append("  " + verdict)
    return "\n".join(lines), good


main = command(report)
