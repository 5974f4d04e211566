"""What is proved, and how fast: the battery's programs, winner takes all, and Solomon's files cut to 25 customers.

Run as ``python -m waybound.reports.benchmarks.proofs [--battery 3000] [--seconds 1] [--solomon FOLDER] [--files C101 R101 ...]``. Exits
with 1 if anything that is verified of the battery is not true.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter
from pathlib import Path

from waybound.formulations.certificate import beats_bound, verified_bound
from waybound.formulations.evidence import Evidence
from waybound.formulations.problem import Problem
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.selection.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.formulations.solution import Solution
from waybound.formulations.tolerance import same
from waybound.instances.generating import generate
from waybound.instances.routing.formats import solomon
from waybound.instances.sensing.graph import SensingGraph
from waybound.reports.battery.cases import Draw, cases
from waybound.reports.battery.truth import Truth
from waybound.solvers.backend import solver_named
from waybound.solvers.program_backend import takers
from waybound.solving.bounding import find_bounds
from waybound.solving.solve import solve

FIRST_CLASS = (*(f"C10{k}" for k in range(1, 10)), *(f"R1{k:02d}" for k in range(1, 13)), *(f"RC10{k}" for k in range(1, 9)))


def sensing(seed: int, **settings: object) -> SensingGraph:
    """A sensing graph of the generator ``sata``."""
    graph = generate("sata", seed, **settings)
    assert isinstance(graph, SensingGraph)
    return graph


def proof(problem: Problem, value: float | None, seconds: float) -> tuple[float | None, float, Evidence | None]:
    """The best verified bound found in ``seconds``, the time that it took, and its evidence; the bound is None where there is none."""
    began = time.perf_counter()
    found = find_bounds(problem, seconds, target=value)
    took = time.perf_counter() - began
    sign = 1.0 if problem.sense == "min" else -1.0
    bounds = [(sign * verified_bound(problem, e), k) for k, e in enumerate(found)]
    best = max(bounds, default=(-math.inf, -1))
    return (None, took, None) if best[0] == -math.inf else (sign * best[0], took, found[best[1]])


def battery(count: int, seconds: float, seed: int) -> int:
    """What is verified of the battery's programs, whose optima are known; how many verdicts are false."""
    told, left, spent = Counter[tuple[str, str, str]](), list[str](), list[tuple[float, float, int]]()
    for case in cases(Draw(count, seed)):
        made = case.problem.compile(case.form)
        began = time.process_time()
        found = solve(made, next(n for n in ("highs", *takers(made.program.features())) if not solver_named(n).missing(made.program)),
                      time_limit=60.0, bound_time=seconds)  # fmt: skip
        spent.append((time.process_time() - began, found.seconds["bound"], case.number))
        verdict = _verdict(found, case.truth)
        told[case.kind, case.truth.status, verdict] += 1
        if verdict != VERIFIED:
            left.append(f"case {case.number}, {case.kind}, {case.form}, {case.truth}: {verdict}; {found!r}")
    kinds = list(dict.fromkeys(kind for kind, *_ in told))
    print(f"{'kind':20s}" + "".join(f"{word:>22s}" for word in STATUSES))
    for kind in kinds:
        row = [(told[kind, word, VERIFIED], sum(n for (k, w, _), n in told.items() if (k, w) == (kind, word))) for word in STATUSES]
        print(f"{kind:20s}" + "".join(f"{f'{good} of {of}' if of else '-':>22s}" for good, of in row))
    print("\n".join(left))
    false = sum(n for (*_, verdict), n in told.items() if verdict == FALSE)
    verified = sum(n for (*_, verdict), n in told.items() if verdict == VERIFIED)
    (cpu, _, slow), wall = max(spent), max(bounding for _, bounding, _ in spent)
    within = sum(used <= 1.0 for used, *_ in spent)
    print(f"{verified} of {count} verified, {false} false; CPU seconds with the search: {within} within 1, at most {cpu:.2f} (case {slow});")
    print(f"wall seconds of bounding: at most {wall:.2f}\n")
    return false


VERIFIED, FALSE = "verified", "FALSE"
STATUSES = ("optimal", "infeasible", "unbounded")


def _verdict(found: Solution, truth: Truth) -> str:
    """Whether what is shown as verified is all that is true."""
    c, e = found.certificate, found.evaluation
    if truth.value is None:
        verified = c.infeasible if truth.status == "infeasible" else c.unbounded
        return VERIFIED if verified else FALSE if c.infeasible or c.unbounded or c.bound is not None else "not verified"
    best, size = float(truth.value), 0.0 if e is None else e.size
    if c.infeasible or c.unbounded or (c.bound is not None and beats_bound(found.problem.sense, best, c.bound, size)):
        return FALSE
    closed = found.status == "optimal" and found.bound_kind == "verified" and e is not None
    return VERIFIED if closed and same(e.values[0], best, size, e.precision) else "not verified"  # type: ignore[union-attr]


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
    print("file   answer    highs s  bound     proof s  leaves  proved")
    for name in names:
        path = folder / f"{name}.txt"
        if not path.exists():
            continue
        problem = RoutingProblem.from_instance(solomon.read(path.read_text(), path), settings={"customers": 25, "convention": "trunc1"})
        word = solve(problem, "highs", time_limit=20.0, bound_time=0)
        answer = solve(problem, "pyvrp", time_limit=2.0, bound_time=0, start=word.answer)
        assert isinstance(answer.objective, float)
        bound, took, evidence = proof(problem, answer.objective, seconds)
        proved = bound is not None and same(bound, answer.objective)
        own = f"{word.seconds['solve']:.1f}" if word.status == "optimal" else "-"
        shown, verdict = "-" if bound is None else f"{bound:.1f}", "yes" if proved else "no"
        print(f"{name:6s} {answer.objective:7.1f}  {own:>7s}  {shown:>7s}  {took:7.1f}  {_leaves(evidence):6d}  {verdict}", flush=True)


def _leaves(evidence: Evidence | None) -> int:
    return 0 if evidence is None else sum("branch" not in node for node in evidence.data.get("nodes", [{}]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--battery", type=int, default=3000)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--winner-takes-all", type=int, default=10)
    parser.add_argument("--solomon", type=Path)
    parser.add_argument("--files", nargs="*", default=list(FIRST_CLASS))
    parser.add_argument("--file-seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    wrong = battery(chosen.battery, chosen.seconds, chosen.seed) if chosen.battery else 0
    if chosen.winner_takes_all:
        winner_takes_all(chosen.winner_takes_all)
    if chosen.solomon is not None:
        files(chosen.solomon, chosen.files, chosen.file_seconds)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
