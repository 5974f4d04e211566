"""Proofs, and how fast they are found: the battery's programs, winner takes all, and covers.

Exits with 1 if anything that is verified of the battery is not true.
"""

import itertools
import math
from collections import Counter
from collections.abc import Iterable
from functools import partial

import numpy as np

import waybound as wb
from waybound.api import read
from waybound.extending import same
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.rows import rows as row_block
from waybound.formulations.verified_bounds import beats_bound, verified_bound
from waybound.reports.battery.cases import Draw, cases
from waybound.reports.battery.truth import Truth
from waybound.solvers.backend import solver_named
from waybound.solvers.program_backend import takers
from waybound.solving.bounding import find_bounds
from waybound.solving.request import Request
from waybound.solving.solve import solve

from ._harness import command, generated, timed


def proof(problem: wb.Problem, value: float | None, seconds: float) -> tuple[float | None, wb.Evidence | None]:
    """The best verified bound found in ``seconds``, and its evidence; None where there is none."""
    evidence = find_bounds(problem, seconds, target=value)
    sign = 1.0 if problem.sense == "min" else -1.0
    bounds = [(sign * verified_bound(problem, e), k) for k, e in enumerate(evidence)]
    best = max(bounds, default=(-math.inf, -1))
    return (None, None) if best[0] == -math.inf else (sign * best[0], evidence[best[1]])


def verified_of_battery(count: int, seconds: float, seed: int) -> int:
    """Count the verified verdicts on the battery's programs, whose optima are known; returns how many are false."""
    counts, unverified, spent = Counter[tuple[str, str, str]](), list[str](), list[tuple[float, float, int]]()
    for case in cases(Draw(count, seed)):
        model = case.problem.compile(case.form)
        able = (name for name in ("highs", *takers(model.program.features())) if not solver_named(name).missing(model.program))  # type: ignore[attr-defined]
        cpu_seconds, solution = timed(partial(solve, model, Request(solver=next(able), time_limit=60.0, bound_time=seconds)))
        spent.append((cpu_seconds, solution.seconds["bound"], case.number))
        verdict = _verdict(solution, case.truth)
        counts[case.kind, case.truth.status, verdict] += 1
        if verdict != VERIFIED:
            unverified.append(f"case {case.number}, {case.kind}, {case.form}, {case.truth}: {verdict}; {solution!r}")
    kinds = list(dict.fromkeys(kind for kind, *_ in counts))
    print(f"{'kind':20s}" + "".join(f"{word:>22s}" for word in STATUSES))
    for kind in kinds:
        row = [(counts[kind, word, VERIFIED], sum(counts[kind, word, v] for v in (VERIFIED, FALSE, OPEN))) for word in STATUSES]
        print(f"{kind:20s}" + "".join(f"{f'{good} of {of}' if of else '-':>22s}" for good, of in row))
    print("\n".join(unverified))
    false = sum(n for (*_, verdict), n in counts.items() if verdict == FALSE)
    verified = sum(n for (*_, verdict), n in counts.items() if verdict == VERIFIED)
    (cpu, _, slow), wall = max(spent), max(bounding for _, bounding, _ in spent)
    within = sum(used <= 1.0 for used, *_ in spent)
    print(f"{verified} of {count} verified, {false} false; CPU seconds with the search: {within} within 1, at most {cpu:.2f} (case {slow})")
    print(f"wall seconds of bounding: at most {wall:.2f}\n")
    return false


VERIFIED, FALSE, OPEN = "verified", "FALSE", "not verified"
STATUSES = ("optimal", "infeasible", "unbounded")


def _verdict(solution: wb.Solution, truth: Truth) -> str:
    """Compare what is shown as verified with the truth."""
    c, e = solution.certificate, solution.evaluation
    if truth.value is None:
        verified = c.infeasible if truth.status == "infeasible" else c.unbounded
        return VERIFIED if verified else FALSE if c.infeasible or c.unbounded or c.bound is not None else OPEN
    best, size = float(truth.value), 0.0 if e is None else e.size
    if c.infeasible or c.unbounded or (c.bound is not None and beats_bound(solution.problem.sense, best, c.bound, size)):
        return FALSE
    closed = solution.status == "optimal" and solution.bound_kind == "verified" and e is not None
    return VERIFIED if closed and same(e.values[0], best, size, e.precision) else OPEN  # type: ignore[union-attr]


def winners(seeds: int) -> None:
    """20 robots of 2 actions and 150 targets."""
    size = {"robots": 20, "actions": 2, "targets": 150, "phi": 15}
    graphs = ((seed, generated(wb.SensingGraph, "sata", seed, **size, weights="uniform")) for seed in range(1, seeds + 1))
    problems = ((f"{seed}", wb.WinnerTakesAllSATA(graph)) for seed, graph in graphs)
    beside_highs("winner takes all", problems)


def set_covers(seeds: int) -> None:
    """The bundled cover of 30 elements, and set covers of 200 rows and 2,000 columns, density 2 %, costs of 1 to 100."""
    cover = read("cover-30")
    random = ((f"200x2000-{seed}", set_cover(seed)) for seed in range(1, seeds + 1))
    beside_highs("covers", itertools.chain([("cover-30", cover)], random))


def set_cover(seed: int, rows: int = 200, columns: int = 2000, density: float = 0.02) -> ArrayProblem:
    """A set cover as the OR-Library's: every column covers a row, every row is covered by two columns at least."""
    rng = np.random.default_rng(seed)
    covered = rng.random((rows, columns)) < density
    covered[rng.integers(0, rows, columns), np.arange(columns)] = True
    for row in covered:
        row[rng.choice(columns, 2, replace=False)] = True
    row, column = np.nonzero(covered)
    x = wb.Variables("x", lower=np.zeros(columns), upper=np.ones(columns), cost=rng.integers(1, 101, columns).astype(float), integer=True)
    need = row_block("row", rows, [(row, column, 1.0)], lower=1.0)
    return ArrayProblem(wb.Program(f"cover-{rows}x{columns}-{seed}", "min", (x,), (need,)))


def beside_highs(title: str, problems: Iterable[tuple[str, wb.Problem]]) -> None:
    """CPU seconds of HiGHS' own search, of the proof that its answer is optimal, and what that proves in 60 s."""
    print(f"{title:18s}  answer        bound         highs s  proof s  ratio  leaves  proved")
    for name, problem in problems:
        own, answer = timed(partial(solve, problem, Request(solver="highs", bound_time=0)))
        assert isinstance(answer.objective, float)
        took, (bound, evidence) = timed(partial(proof, problem, answer.objective, 60.0))
        proved = bound is not None and same(bound, answer.objective)
        shown = "-" if bound is None else f"{bound:.8g}"
        print(
            f"{name:18s}  {answer.objective:<12.8g}  {shown:12s}  {own:7.2f}  {took:7.2f}  {took / own:5.1f}  {_leaves(evidence):6d}  "
            f"{'yes' if proved else 'no'}", flush=True,
        )  # fmt: skip
    print()


def checking(leaves: int, rows: int = 100, columns: int = 150) -> None:
    """CPU seconds that the checker takes for a tree of so many leaves, each with a dual for every row."""
    rng = np.random.default_rng(1)
    matrix = rng.integers(1, 100, (rows, columns)).astype(float)
    at = np.arange(matrix.size)
    row = row_block("row", rows, [(at // columns, at % columns, matrix.ravel())], upper=matrix.sum(axis=1) / 2.0)
    x = wb.Variables("x", lower=np.zeros(columns), upper=np.ones(columns), cost=matrix.sum(axis=0) / rows, integer=True)
    problem = ArrayProblem(wb.Program("tree", "max", (x,), (row,)))
    nodes, waiting, unmade = list[object](), [0], leaves - 1
    while waiting:
        depth = waiting.pop()
        if unmade and depth < math.ceil(math.log2(leaves)):
            unmade -= 1
            nodes.append({"branch": {"variable": depth, "most": 0}})
            waiting += [depth + 1, depth + 1]
        else:
            nodes.append({"kind": "lp-dual", "data": {"duals": rng.random(rows).tolist()}})
    evidence = wb.Evidence("branching-tree", "a tree", math.inf, {"nodes": nodes})
    seconds, _ = timed(lambda: verified_bound(problem, evidence))
    print(f"the checker takes {seconds:.1f} CPU s for {_leaves(evidence)} leaves of a program of {rows} rows\n")


def _leaves(evidence: wb.Evidence | None) -> int:
    return 0 if evidence is None else sum("branch" not in node for node in evidence.data.get("nodes", [{}]))


@command
def main(
    battery: int = 3000,
    seconds: float = 1.0,
    seed: int = 1,
    winner_takes_all: int = 10,
    covers: int = 5,
    leaves: int = 10_000,
) -> bool:
    false = verified_of_battery(battery, seconds, seed) if battery else 0
    if winner_takes_all:
        winners(winner_takes_all)
    if leaves:
        checking(leaves)
    if covers:
        set_covers(covers)
    return not false
