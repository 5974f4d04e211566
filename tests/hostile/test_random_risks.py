"""Random problems at risk of any scale, against all their paths, or against all that any method says of them: no false word is shown."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hostile_instances import UNCERTAIN, Rng, Units, shaken

import waybound as wb
from waybound import Problem, Solution, UnsupportedError
from waybound.formulations.tolerance import VECTOR
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS
from waybound.solving.bounding import find_bounds

SEED = 85
PATHS = ("uncertain-path", "risky-path")
ROUNDED = 1e-9
"""Of the value of a path: sums of the judge and of enumeration end in other digits."""

SAMPLING = ("scenario", "cvar")

SOLVED: dict[str, tuple[dict[str, str], ...]] = {
    "uncertain-path": ({"solver": "supported-paths"}, {"solver": "non-dominated-paths"}),
    "risky-path": ({"solver": "risk-labels"}, {"solver": "path-enumeration"}, {"solver": "highs"}),
    "risk-allocation": (
        {"solver": "convex-allocation"}, {"solver": "disjunctive-allocation"}, {"solver": "highs", "form": "uniform"},
        {"solver": "highs", "form": "secants"}, {"solver": "highs", "form": "tangents"}, {"solver": "highs", "form": "ellipsoid"},
    ),
}  # fmt: skip


def paths(problem: Any) -> Iterator[tuple[int, ...]]:
    """Every path from the start that comes to no vertex twice."""
    graph = problem.graph
    pairs = zip(graph.tails.tolist(), graph.heads.tolist(), strict=True) if hasattr(graph, "tails") else None
    ahead: dict[int, list[int]] = {}
    for a, b in pairs or ():
        ahead.setdefault(a, []).append(b)
    open_: list[tuple[int, ...]] = [(graph.start,)]
    while open_:
        path = open_.pop()
        yield path
        follow = ahead.get(path[-1], []) if pairs is not None else graph.neighbours(path[-1])
        open_ += [(*path, int(v)) for v in follow if v not in path]


def methods(problem: Problem) -> list[dict[str, str]]:
    """All of ours that take the problem but those that sample, by the million where risks are small."""
    able = (name for name in HEURISTICS if name not in SAMPLING and not HEURISTICS[name].missing(problem))
    return [*SOLVED[problem.family], *({"heuristic": name} for name in able)]


def solutions(problem: Problem) -> Iterator[tuple[dict[str, str], Solution]]:
    for keywords in methods(problem):
        try:
            yield keywords, wb.solve(problem, time_limit=5.0, bound_time=0.0, **keywords)  # type: ignore[arg-type]
        except UnsupportedError:
            continue


def bounds_of(problem: Problem, rng: Rng) -> Iterator[tuple[str, float]]:
    """What evidence proves, and the same with other numbers."""
    evidence = find_bounds(problem, 0.5)
    for e in [*evidence, *(replace(e, data=shaken(rng, e.data)) for e in evidence)]:
        yield e.kind, verified_bound(problem, e)


def beats(problem: Problem, value: float, bound: float, part: float) -> bool:
    """Whether a value is better than a bound by more than a part of either."""
    sign = 1.0 if problem.sense == "min" else -1.0
    size = max(abs(value), abs(bound) if math.isfinite(bound) else 0.0)
    return sign * (bound - value) > part * size


def faults_of_paths(problem: Problem, rng: Rng) -> Iterator[str]:
    """What is false of a problem all of whose paths are known."""
    values = [judged.values[0] for path in paths(problem) if (judged := problem.evaluate(path)).feasible]
    best = (min if problem.sense == "min" else max)(values, default=None)
    for kind, bound in bounds_of(problem, rng):
        if best is not None and beats(problem, best, bound, ROUNDED):
            yield f"{kind} proves {bound!r}, beyond the best {best!r}"
    for keywords, s in solutions(problem):
        if s.faults or (s.objective is None) != (s.answer is None) or (best is None and s.answer is not None):
            yield f"{keywords}: faults {s.faults}"
        if best is None:
            continue
        if s.status in ("infeasible", "unbounded") or (s.bound is not None and beats(problem, best, float(s.bound), ROUNDED)):
            yield f"{keywords} says {s.status}, bound {s.bound!r}, where the best is {best!r}"
        if s.objective is not None and beats(problem, float(s.objective), best, ROUNDED):
            yield f"{keywords} has {s.objective!r}, better than the best {best!r}"
        if s.status == "optimal" and s.objective is not None and beats(problem, best, float(s.objective), 1e-7):
            yield f"{keywords} calls {s.objective!r} optimal, where the best is {best!r}"
        promised = s.certificate.guarantee
        if promised is not None and s.objective is not None and s.objective > 0.0 and best > 0.0:
            ratio = s.objective / best if problem.sense == "min" else best / s.objective
            if ratio > promised.ratio * (1.0 + ROUNDED):
                yield f"{keywords} promises {promised.ratio!r} and is {ratio!r}"


def faults_of_allocations(problem: Any, rng: Rng) -> Iterator[str]:
    """What contradicts itself in what is said of a problem: its judged answers, all bounds and all claims."""
    bounds, found = dict(bounds_of(problem, rng)), dict[str, Solution]()
    for keywords, s in solutions(problem):
        found[str(keywords)] = s
        if s.faults:
            yield f"{keywords}: faults {s.faults}"
        if s.bound is not None and s.status != "infeasible":
            bounds[str(keywords)] = float(s.bound)
    answers = {name: s for name, s in found.items() if s.answer is not None and s.certificate.feasible}
    for name, s in answers.items():
        size = problem.value(s.answer.decision)[1]
        assert s.objective is not None
        for other, bound in bounds.items():
            if abs(float(s.objective) - bound) > 10 * VECTOR * size and beats(problem, float(s.objective), bound, 0.0):
                yield f"{name} has {s.objective!r}, and {other} says {bound!r}"
        spent = problem.risks(s.answer.decision)
        if problem.risk.kind == "allocated" and spent.sum() > problem.risk.total * (1.0 + 10 * VECTOR):
            yield f"{name} spends {spent.sum()!r} of {problem.risk.total!r}"
    if answers and any(s.status == "infeasible" for s in found.values() if s.form != "uniform"):
        yield f"infeasible and not: { {name: s.status for name, s in found.items()} }"


def faults_of(family: str, case: int) -> list[str]:
    """False words on one drawn problem."""
    rng = np.random.default_rng([SEED, case])
    problem = UNCERTAIN[family](rng, Units.drawn(rng))
    return list((faults_of_paths if family in PATHS else faults_of_allocations)(problem, rng))


@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::UserWarning")
@pytest.mark.parametrize(("family", "few", "full"), [("uncertain-path", 12, 400), ("risky-path", 12, 400), ("risk-allocation", 6, 120)])
def test_no_false_word_on_problems_at_risk(
    family: str, few: int, full: int, share: Callable[[int, int], int], tally: Any
) -> None:  # fmt: skip
    cases = share(few, full)
    found = {case: faults for case in range(cases) if (faults := faults_of(family, case))}
    tally[f"random problems at risk: {family}"] += cases
    assert not found, f"{len(found)} of {cases}: {dict(list(found.items())[:5])}"
