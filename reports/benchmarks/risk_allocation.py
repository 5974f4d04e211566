"""Risk allocation side by side: equal risks, iterative, one convex program, and what is true of each; then how long they take.

Two problems of the literature's kind (a vehicle above a sea floor, one in a corridor), the two-variable problem on which the iterative
method stalls, random ones, and a hundred steps of four constraints. Milliseconds are CPU time in one process, modules loaded before, the
best of the repeats. Every answer is judged from the data, every bound is what its checker derives. The loop that `iterative` is compared
with writes its CVXPY model anew in each round. Where a round has several plans of equal cost, the next one depends on which of them the
solver takes, so that the two are held against each other where weights that differ a little leave one plan.
"""

import copy
import math
from functools import partial
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

import waybound as wb
from waybound.extending import Control, Options, RawResult, Stop, verified_bound
from waybound.formulations.risk.forms.fixed_risks import uniform_risks
from waybound.heuristics.heuristic import HeuristicWork
from waybound.heuristics.risk.iterative_risk_allocation import ACTIVE
from waybound.instances.number_arrays import Floats
from waybound.instances.risk.allocation import Affine, ChanceConstraints, Risk, RiskAllocationInstance
from waybound.instances.risk.gaussian import Quantities
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation
from waybound.solvers.engines.risk.convex_allocation_steps.session import open_session
from waybound.solvers.engines.risk.convex_allocation_steps.successive_tangents import Interval, SuccessiveTangents

from ._harness import best_of, command, generated, met, timed

GAP = 1e-5
"""Relative gap to which the default closes its interval on the two problems."""

LARGE_GAP, LARGE_SECONDS = 1e-4, 5.0
"""Gap and seconds for the hundred steps."""

FASTER = 10.0
"""Times as fast as the loop that writes its model anew."""

NO_WORSE = 1e-9

UNEQUAL = 1e-3
"""Largest share by which weights of a cost differ where plans shall be unique."""


def reference(family: str, **settings: Any) -> wb.RiskAllocation:
    """A generated problem, seed 1."""
    return wb.RiskAllocation(generated(RiskAllocationInstance, "risk-allocation", 1, family=family, **settings))


def stalling(most: float = 7.0) -> wb.RiskAllocation:
    """max x1 + 3 x2, x1 + x2 <= most, x_i + z(r_i) <= 5, x >= 0, total 0.1: with 7, all constraints are active at equal risks."""
    return linear(np.array([1.0, 3.0]), np.ones((1, 2)), np.array([most]), np.eye(2), np.array([5.0, 5.0]), np.eye(2), 0.1, name="stalling")


def linear(
    reward: Floats, rows: Floats, most: Floats, chance: Floats, limits: Floats, covariance: Floats, total: float, *, name: str = "random",
    upper: float = math.inf,
) -> wb.RiskAllocation:  # fmt: skip
    """max reward x over rows x <= most, 0 <= x <= upper, and chance x + noise <= limits but for the total risk."""
    n, many = len(reward), len(limits)
    none = np.zeros((len(most), many))
    return wb.RiskAllocation(
        RiskAllocationInstance(
            np.zeros(n), np.full(n, upper), tuple(f"x{k + 1}" for k in range(n)),
            Quantities(chance, np.zeros(many), covariance, tuple(f"y{k + 1}" for k in range(many))),
            Affine(reward[None], np.zeros((1, many)), np.zeros(1)),
            ChanceConstraints(Affine(np.zeros((many, n)), np.eye(many), np.zeros(many)), limits, tuple(str(k + 1) for k in range(many)),
                              np.arange(many)),
            Risk("allocated", total, np.full(many, total)), Affine(rows, none, np.zeros(len(most))), np.full(len(most), -math.inf), most,
            tuple(str(k + 1) for k in range(len(most))), sense="max", name=name,
        )
    )  # fmt: skip


def random_problem(rng: np.random.Generator) -> wb.RiskAllocation:
    """2 to 6 decisions, 2 to 8 correlated constraints, a total between 0.001 and 0.3."""
    n, many = int(rng.integers(2, 7)), int(rng.integers(2, 9))
    chance = rng.uniform(0.1, 2.0, (many, n)) * (rng.random((many, n)) < 0.6)
    chance[np.arange(many), rng.integers(0, n, many)] = 1.0
    root = rng.normal(size=(many, many)) * rng.uniform(0.1, 1.5, many)[:, None]
    total = float(10.0 ** rng.uniform(-3.0, -0.5))
    covariance = root @ root.T
    limits = -ndtri(total / many) * np.sqrt(np.diag(covariance)) + rng.uniform(0.5, 8.0, many)
    return linear(
        rng.uniform(0.2, 3.0, n), rng.uniform(0.2, 1.0, (1, n)), rng.uniform(2.0, 12.0, 1), chance, limits, covariance, total, upper=20.0
    )


def of_unique_plans(problem: wb.RiskAllocation) -> wb.RiskAllocation:
    """The same with weights of the rows of its cost that differ by up to ``UNEQUAL``."""
    rng, changed = np.random.default_rng(1), copy.copy(problem)
    weights = [1.0 + UNEQUAL * rng.uniform(-1.0, 1.0, len(constant)) for _, _, _, constant in problem.terms]
    changed.terms = tuple((kind, w, f * v[:, None], c * v) for (kind, w, f, c), v in zip(problem.terms, weights, strict=True))
    return changed


# -- methods -----------------------------------------------------------------------------------------------------------


def by_program(problem: wb.RiskAllocation, form: str) -> wb.Allocation | None:
    """The answer of a form's program; None where it has none."""
    if form not in problem.forms():
        return None
    model = problem.compile(form)
    result = open_session(model.program).solve(Stop())
    answer = model.decode(result.x) if result.status == "optimal" else None
    assert answer is None or isinstance(answer, wb.Allocation)
    return answer


def by_iterative(problem: wb.RiskAllocation) -> tuple[wb.Allocation | None, int]:
    """The heuristic's answer, and its rounds."""
    outcome = HeuristicWork("iterative", problem, Options())(Control())
    return outcome.answer, outcome.statistics["rounds"]


def convex(problem: wb.RiskAllocation, gap: float) -> Interval:
    """The default's interval."""
    return SuccessiveTangents(problem).run(Stop(60.0), gap)


def by_default(problem: wb.RiskAllocation, gap: float) -> RawResult:
    """The run of the default as ``solve`` has it."""
    return ConvexAllocation().run(problem, Options(gap=gap), Control())


def rebuilt(problem: wb.RiskAllocation) -> tuple[float, int]:
    """The iterative method with a CVXPY model that is written anew in each round: its cost, and its rounds."""
    import cvxpy as cp

    p, risks, values, keep = problem, uniform_risks(problem), list[float](), 0.7
    while len(values) < 200:
        x = cp.Variable(p.size)
        cost = p.linear @ x + p.offset + p.sign * sum(w * cp.norm1(f @ x + c) for kind, w, f, c in p.terms if kind == "absolute")
        rows = [p.chance @ x <= p.limits + p.deviation * ndtri(risks)]
        equal = p.row_lower == p.row_upper
        if equal.any():
            rows.append(p.rows[equal] @ x == p.row_lower[equal])
        if (~equal).any():
            rows.append(p.rows[~equal] @ x <= p.row_upper[~equal])
        bounded = np.isfinite(p.upper)
        rows += [x >= p.lower, x[bounded] <= p.upper[bounded]] if bounded.any() else [x >= p.lower]
        cp.Problem(cp.Minimize(p.sign * cost), rows).solve(solver=cp.HIGHS)
        values.append(float(p.sign * cost.value))
        if len(values) > 1 and values[-2] - values[-1] < 2e-7 * abs(values[-1]):
            break
        z = (p.limits - p.chance @ x.value) / p.deviation
        used, active = ndtr(-z), z + ndtri(risks) <= ACTIVE
        if not active.any() or active.all():
            break
        risks = np.where(active, risks, keep * risks + (1.0 - keep) * used)
        risks[active] += (p.budgets[0].risk - risks.sum()) / active.sum()
    return p.sign * values[-1], len(values)


# -- report --------------------------------------------------------------------------------------------------------------


def side_by_side(problem: wb.RiskAllocation, repeat: int) -> tuple[list[str], float, float]:
    """A line per method, with the risks that are true; the seconds of ``iterative`` and of the default."""
    lines = [f"{problem.name}: {problem.size} decisions, {len(problem.names)} chance constraints, total risk {problem.risk.total:g}"]

    def tell(name: str, answer: wb.Allocation | None, seconds: float, note: str) -> None:
        if answer is None:
            lines.append(f"  {name:18} {'no plan':>12}")
            return
        judged = problem.evaluate(answer)
        assert judged.feasible, judged.violations
        risk = next(iter(problem.joint_risk(answer.decision).values()))
        sums = f"{judged.quantities['sum_of_risks']:.3e}  {risk.value:.3e} [{risk.low:.2e}, {risk.high:.2e}]"
        lines.append(f"  {name:18} {judged.values[0]:>12.6f} {1e3 * seconds:>9.2f}  {sums}  {note}")

    lines.append(f"  {'method':18} {'cost':>12} {'CPU ms':>9}  {'sum':9}  any fails (99.9 %)")
    for form in ("uniform", "ellipsoid", "secants"):
        tell(form, by_program(problem, form), best_of(repeat, partial(by_program, problem, form))[0], "")
    answer, rounds = by_iterative(problem)
    slow, *times = best_of(repeat, partial(by_iterative, problem), *(partial(by_default, problem, gap) for gap in (GAP, 0.0)))
    tell("iterative", answer, slow, f"{rounds} rounds")
    for gap, took in zip((GAP, 0.0), times, strict=True):
        interval = convex(problem, gap)
        bound = verified_bound(problem, interval.evidence(problem.sign)[0])
        apart = abs(bound - problem.sign * interval.value) / abs(interval.value)
        tell(f"convex, gap {gap:g}", interval.answer, took, f"{interval.rounds} rounds, verified bound {bound:.6f}, interval {apart:.1e}")
        assert gap == 0.0 or apart <= GAP
    return lines, slow, times[0]


def compared(count: int) -> list[str]:
    """Random problems: the default is no worse than ``iterative``, that no worse than equal risks, and all keep the true risk."""
    rng, better, worst, stalls = np.random.default_rng(1), 0, 0.0, 0
    for _ in range(count):
        problem = random_problem(rng)
        interval, (plan, _), even = convex(problem, 0.0), by_iterative(problem), by_program(problem, "uniform")
        assert interval.answer is not None and plan is not None and even is not None
        judged = [problem.evaluate(answer) for answer in (interval.answer, plan, even)]
        assert all(e.feasible for e in judged), [e.violations for e in judged]
        assert all(e.quantities["joint_risk_low"] <= problem.budgets[0].risk for e in judged)
        best, middle, equal = (e.values[0] for e in judged)
        size = NO_WORSE * abs(best)
        assert best >= middle - size >= equal - 2.0 * size, (problem.name, best, middle, equal)
        bound = verified_bound(problem, interval.evidence(problem.sign)[0])
        worst = max(worst, (bound - best) / abs(best))
        assert bound >= best - size
        better += best > middle + 1e-6 * abs(best)
        stalls += middle <= equal + size
    return [
        f"random: {count} problems, the default never worse than iterative, iterative never worse than equal risks, all within their risk; "
        f"the default better by more than 1e-6 on {better}, iterative no better than equal risks on {stalls}; widest interval {worst:.1e}"
    ]


def report(count: int, repeat: int, steps: int = 100) -> str:
    """All of it, as text."""
    lines, targets = list[str](), list[tuple[str, bool, str]]()
    for problem in (stalling(), reference("auv"), reference("corridor")):
        table, slow, quick = side_by_side(problem, repeat)
        lines += table
        if problem.name == "stalling":
            continue
        value, rounds = rebuilt(problem)
        (loop,) = best_of(max(1, repeat // 3), partial(rebuilt, problem))
        lines.append(f"  {'rebuilt loop':18} {value:>12.6f} {1e3 * loop:>9.2f}  {rounds} rounds, each a new CVXPY model")
        alike = of_unique_plans(problem)
        (plan, _), (ended, _) = by_iterative(alike), rebuilt(alike)
        assert plan is not None
        apart = abs(alike.evaluate(plan).values[0] - ended) / abs(ended)
        name = problem.name
        targets += [
            (f"{name}: with unique plans, iterative ends where the rebuilt loop does", apart <= NO_WORSE, f"{apart:.0e} apart"),
            (f"{name}: default to {GAP:g} in less time than iterative", quick < slow, f"{1e3 * quick:.2f} against {1e3 * slow:.2f} ms"),
            (f"{name}: iterative {FASTER:g} times as fast as the rebuilt loop", loop >= FASTER * slow, f"{loop / slow:.0f} times"),
        ]
    lines += compared(count)
    large = reference("corridor", steps=steps, constraints=4)
    seconds, interval = timed(partial(convex, large, LARGE_GAP))
    bound = verified_bound(large, interval.evidence(large.sign)[0])
    apart = abs(bound - interval.value) / abs(interval.value)
    lines.append(f"{large.name}: {len(large.names)} chance constraints, {interval.value:.6f}, verified bound {bound:.6f}, {seconds:.2f} s")
    quickly = apart <= LARGE_GAP and seconds < LARGE_SECONDS
    targets.append((f"{steps} steps of 4 constraints to {LARGE_GAP:g} in {LARGE_SECONDS:g} s", quickly, f"{apart:.1e} in {seconds:.2f} s"))
    return "\n".join([*lines, *(f"target {what}: {met(good)} ({figures})" for what, good, figures in targets)])


@command
def main(random: int = 500, repeat: int = 7) -> str:
    return report(random, repeat)
