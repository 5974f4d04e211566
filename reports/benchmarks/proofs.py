"""What is proved, and how fast: small instances of every family, winner takes all, and Solomon's files cut to 25 customers.

Run as ``python -m waybound.reports.benchmarks.proofs [--instances 400] [--seconds 1] [--solomon FOLDER] [--files C101 R101 ...]``. Exits
with 1 if a bound passes an optimum, or evidence that there is no answer stands beside one.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.evidence import Evidence
from waybound.formulations.max_min.bottleneck_sata import BottleneckSATA
from waybound.formulations.problem import Problem
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.selection.submodular_selection import SubmodularSelection
from waybound.formulations.selection.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.formulations.tolerance import same
from waybound.instances.generating import generate
from waybound.instances.routing.formats import solomon
from waybound.instances.selection.constraints import Knapsack
from waybound.instances.selection.functions import DenseFacilityLocation
from waybound.instances.sensing.graph import SensingGraph
from waybound.reports.benchmarks.small_cases import random_problem
from waybound.solving.bounding import find_bounds
from waybound.solving.solve import solve

FIRST_CLASS = (*(f"C10{k}" for k in range(1, 10)), *(f"R1{k:02d}" for k in range(1, 13)), *(f"RC10{k}" for k in range(1, 9)))


def sensing(seed: int, **settings: object) -> SensingGraph:
    """A sensing graph of the generator ``sata``."""
    graph = generate("sata", seed, **settings)
    assert isinstance(graph, SensingGraph)
    return graph


def small_instances(count: int, seed: int) -> Iterator[Problem]:
    """``count`` instances, the families in turn."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        kind = number % 5
        if kind == 0:
            yield random_problem(rng, number // 5)
        elif kind == 1:
            yield _program(rng)
        elif kind == 2:
            n, items = int(rng.integers(4, 13)), int(rng.integers(4, 20))
            function = DenseFacilityLocation(rng.random((n, items)).round(2))
            yield SubmodularSelection(function, Knapsack(rng.integers(1, 20, n).astype(float), float(rng.integers(15, 50))))
        else:
            graph = sensing(number, robots=int(rng.integers(4, 9)), actions=2, targets=int(rng.integers(4, 12)), phi=40, weights="uniform")
            yield BottleneckSATA(graph) if kind == 3 else WinnerTakesAllSATA(graph)


def _program(rng: np.random.Generator) -> ArrayProblem:
    m, n = int(rng.integers(1, 8)), int(rng.integers(2, 12))
    matrix = rng.integers(-9, 20, (m, n)).astype(float)
    lower = matrix.sum(axis=1) * rng.uniform(0.2, 0.6) + rng.integers(0, 9, m) / 4.0
    indptr, indices = (np.arange(0, m * n + 1, n).astype(np.int32), np.tile(np.arange(n), m).astype(np.int32))
    rows = Rows("row", indptr=indptr, indices=indices, data=matrix.ravel(), lower=lower, upper=lower + rng.integers(1, 60))
    upper, cost = rng.integers(1, 4, n).astype(float), rng.integers(-20, 40, n).astype(float)
    columns = Variables("x", lower=np.zeros(n), upper=upper, cost=cost, integer=True)
    return ArrayProblem(Program("random", str(rng.choice(["min", "max"])), (columns,), (rows,)))


def proof(problem: Problem, value: float | None, seconds: float) -> tuple[float | None, float, Evidence | None]:
    """The best verified bound found in ``seconds``, the time that it took, and its evidence; the bound is None where there is none."""
    began = time.perf_counter()
    found = find_bounds(problem, seconds, target=value)
    took = time.perf_counter() - began
    sign = 1.0 if problem.sense == "min" else -1.0
    bounds = [(sign * verified_bound(problem, e), k) for k, e in enumerate(found)]
    best = max(bounds, default=(-math.inf, -1))
    return (None, took, None) if best[0] == -math.inf else (sign * best[0], took, found[best[1]])


def small(count: int, seconds: float, seed: int) -> int:
    """How many optima, and how many times that there is no answer, are proved; the number of contradictions."""
    wrong, told, longest = 0, Counter[tuple[str, str]](), 0.0
    for problem in small_instances(count, seed):
        answer = solve(problem, "highs", time_limit=60.0, bound_time=0)
        value = answer.objective if isinstance(answer.objective, float) else None
        bound, took, _ = proof(problem, value, seconds)
        longest = max(longest, took)
        sign = 1.0 if problem.sense == "min" else -1.0
        if value is None:
            verdict = "no answer: proved" if bound is not None and math.isinf(bound) else "no answer: not proved"
        elif bound is not None and same(bound, value):
            verdict = "optimum: proved"
        else:
            verdict = "optimum: not proved"
            wrong += bound is not None and sign * bound > sign * value
        told[problem.problem, verdict] += 1
    for (kind, verdict), number in sorted(told.items()):
        print(f"{kind:18s} {verdict:24s} {number}")
    proved = sum(number for (_, verdict), number in told.items() if not verdict.endswith("not proved"))
    print(f"{proved} of {count} proved, the longest in {longest:.2f} s; {wrong} contradictions\n")
    return wrong


def winner_takes_all(seeds: int) -> None:
    """20 robots of 2 actions and 150 targets: seconds of HiGHS' own search, and of the proof."""
    print("seed  highs s  proof s  leaves  proved")
    for seed in range(1, seeds + 1):
        problem = WinnerTakesAllSATA(sensing(seed, robots=20, actions=2, targets=150, phi=15, weights="uniform"))
        answer = solve(problem, "highs", bound_time=0)
        assert isinstance(answer.objective, float)
        bound, took, evidence = proof(problem, answer.objective, 60.0)
        proved = bound is not None and same(bound, answer.objective)
        print(f"{seed:4d}  {answer.seconds['solve']:7.2f}  {took:7.2f}  {_leaves(evidence):6d}  {'yes' if proved else bound}")
    print()


def files(folder: Path, names: list[str], seconds: float) -> None:
    """Solomon's files cut to 25 customers: what HiGHS proves in 20 s by its own word, and what is verified."""
    print("file   answer    highs s  (CPU)  bound    proof s  (CPU)  leaves  proved")
    for name in names:
        path = folder / f"{name}.txt"
        if not path.exists():
            continue
        problem = RoutingProblem.from_instance(solomon.read(path.read_text(), path), settings={"customers": 25, "convention": "trunc1"})
        began = time.process_time()
        word = solve(problem, "highs", time_limit=20.0, bound_time=0)
        searching = time.process_time() - began
        answer = solve(problem, "pyvrp", time_limit=2.0, bound_time=0, start=word.answer)
        assert isinstance(answer.objective, float)
        began = time.process_time()
        bound, took, evidence = proof(problem, answer.objective, seconds)
        proving = time.process_time() - began
        proved = bound is not None and same(bound, answer.objective)
        own = f"{word.seconds['solve']:.1f}" if word.status == "optimal" else "-"
        shown, verdict = "-" if bound is None else f"{bound:.1f}", "yes" if proved else "no"
        figures = f"{own:>7s}  {searching:5.1f}  {shown:>7s}  {took:7.1f}  {proving:5.1f}  {_leaves(evidence):6d}"
        print(f"{name:6s} {answer.objective:7.1f}  {figures}  {verdict}", flush=True)


def _leaves(evidence: Evidence | None) -> int:
    return 0 if evidence is None else sum("branch" not in node for node in evidence.data.get("nodes", [{}]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", type=int, default=400)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--winner-takes-all", type=int, default=10)
    parser.add_argument("--solomon", type=Path)
    parser.add_argument("--files", nargs="*", default=list(FIRST_CLASS))
    parser.add_argument("--file-seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    wrong = small(chosen.instances, chosen.seconds, chosen.seed) if chosen.instances else 0
    if chosen.winner_takes_all:
        winner_takes_all(chosen.winner_takes_all)
    if chosen.solomon is not None:
        files(chosen.solomon, chosen.files, chosen.file_seconds)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
