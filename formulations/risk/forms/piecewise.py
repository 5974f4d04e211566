"""Forms of risk allocation in which risks are variables, beside the normal tail in pieces: ``tangents`` and ``secants``.

    a_i x + s_i z_i <= b_i,   z_i >= z(largest risk of i)
    r_i >= tail(p) - density(p) (z_i - p)                               ``tangents`` at the points p: below the tail, a relaxation
    r_i >= the chord of the tail between neighbouring points            ``secants``: above it, a restriction
    sum of r_i over a budget <= its risk

The tail of the normal distribution is convex where risks are at most 1/2. Risks are counted in parts of a mean one, so that solvers see
numbers near 1, and rows of secants so that they neither drop small deviations nor round large limits. Constraints with alternatives have
one z for all their rows, and a binary each that lets a row be broken. See docs/formulations/risk-allocation.md.
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ..allocations import Allocation, Floats
from ..normal import ndtr, ndtri
from ..risk_allocation import Ints, RiskAllocation
from ._blocks import Blocks, dense_rows, evidence_of, prices, size_of
from .fixed_risks import FEATURES, add_choices, largest, makes, refuses, spared

POINTS = 60
"""Points of each constraint, of both forms."""

STEEPEST = 1e-7
"""Part of a mean risk below which the pieces end: smaller coefficients are lost on solvers."""

NEGLIGIBLE = 1e-8
"""Part of a limit up to which the largest margin of a row is written as a number, in place of a variable, by restrictions."""

SMALL, ORDINARY, LARGE = -10, 8, 18
"""Binary exponents of deviations and limits: rows below the first are scaled up, as far as the last, rows above the second scaled down."""


def density(z: Floats) -> Floats:
    """Density of the standard normal distribution."""
    return np.asarray(np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi))


def points(problem: RiskAllocation, unit: float, count: int, least: float = STEEPEST) -> Floats:
    """Ascending arguments of the tail, risks geometrically spaced from the largest of each constraint; shape (constraints, count)."""
    shares = np.linspace(0.0, 1.0, count)
    low = np.minimum(least * unit, problem.caps * 0.5)
    risks = problem.caps[:, None] * (low / problem.caps)[:, None] ** shares
    return np.asarray(-ndtri(risks))


@dataclass(frozen=True)
class Pieces:
    """A piecewise program, and where its parts are.

    ``z`` and ``risk`` are the columns of the first z and the first risk, one each a constraint, ``unit`` the unit of risks, ``budget`` and
    ``chance`` the first rows of the budgets and of the chance rows, ``choice`` the column of the first binary, one a chance row, or -1.
    """

    program: Program
    z: int
    risk: int
    unit: float
    budget: int
    chance: int
    choice: int


def piecewise_program(problem: RiskAllocation, name: str, at: Floats, *, above: bool) -> Pieces:
    """The program with pieces at ``at``, shape (constraints, points); ``above`` the tail (secants) or below it (tangents)."""
    blocks, many = Blocks(problem), len(problem.names)
    each = np.arange(many)
    unit = mean_risk(problem)
    floor = -ndtri(problem.caps)
    if above:
        slope, constant = _chords(at, unit)
        most = at[:, -1]
    else:
        slope, constant = tangents(at, unit)
        most = np.max(constant / slope, axis=1) + 1e-6  # where all tangents are below 0
    choice = add_choices(blocks) if problem.disjunctive else -1
    top = np.full(many, math.inf)
    shared = np.bincount(problem.constraint, minlength=many) > 1
    top[shared] = most[shared]
    z = blocks.add(Variables("z", (each,), (problem.names,), floor, np.maximum(top, floor), np.zeros(many)))
    least = ndtr(-at[:, -1]) / unit if above else np.zeros(many)
    risk = blocks.add(Variables("risk", (each,), (problem.names,), least, np.maximum(problem.caps / unit, least), np.zeros(many)))
    row, limits, deviation = np.arange(len(problem.limits)), problem.limits.copy(), problem.deviation
    times = np.ones(len(row))
    if above:
        farthest = deviation * most[problem.constraint]
        fixed = farthest <= NEGLIGIBLE * np.abs(limits)
        limits -= spared(problem) + np.where(fixed, farthest, 0.0)
        deviation = np.where(fixed, 0.0, deviation)
        times = _factors(problem, deviation)
    extra = [(row, z + problem.constraint, deviation)]
    if problem.disjunctive:
        slack = np.maximum(largest(problem) + deviation * np.where(shared, top, 0.0)[problem.constraint] - limits, 0.0)
        slack[~shared[problem.constraint]] = 0.0
        extra.append((row, choice + row, slack))
        limits += slack
    first = sum(block.size for block in blocks.rows)
    keys = (problem.constraint,) if not problem.disjunctive else (problem.constraint, row)
    extra = [(at, column, entries * times) for at, column, entries in extra]
    blocks.rows.append(dense_rows("chance", times[:, None] * problem.chance, -math.inf, times * limits, extra, keys, (problem.names,)))
    budget = first + len(row)
    for k, b in enumerate(problem.budgets):
        part = [(np.zeros(len(b.constraints), dtype=np.int64), risk + b.constraints, 1.0)]
        blocks.rows.append(rows(f"budget-{k + 1}", 1, part, -math.inf, b.risk / unit))
    count = slope.shape[1]
    blocks.rows.append(piece_rows(np.repeat(each, count), slope.ravel(), constant.ravel(), z, risk, problem.names))
    return Pieces(blocks.program(name), z, risk, unit, budget, first, choice)


def _factors(problem: RiskAllocation, deviation: Floats) -> Floats:
    """Powers of two that bring chance rows to numbers in which solvers drop no deviation, and round little of the limit."""
    sizes = np.maximum(np.abs(problem.limits), np.abs(problem.chance).max(axis=1, initial=0.0))
    with np.errstate(divide="ignore"):
        wanted, room, over = (np.floor(power - np.log2(part)) for power, part in ((SMALL, deviation), (LARGE, sizes), (ORDINARY, sizes)))
    larger = np.where(deviation > 0.0, np.clip(np.minimum(wanted, room), 0.0, None), 0.0)
    return np.asarray(np.exp2(np.where(over < 0.0, over, larger)))


def mean_risk(problem: RiskAllocation) -> float:
    """The unit of risks: the largest mean risk per constraint of a budget."""
    parts = [b.risk / len(b.constraints) for b in problem.budgets if len(b.constraints)]
    return max(parts, default=float(problem.caps.max(initial=0.0)) or 1.0)


def tangents(at: Floats, unit: float) -> tuple[Floats, Floats]:
    """Slope and constant of ``risk / unit >= constant - slope z`` that touch the tail at ``at``."""
    slope = density(at) / unit
    return slope, ndtr(-at) / unit + slope * at


def _chords(at: Floats, unit: float) -> tuple[Floats, Floats]:
    tail = ndtr(-at) / unit
    slope = -np.diff(tail, axis=1) / np.diff(at, axis=1)
    return slope, tail[:, :-1] + slope * at[:, :-1]


def piece_rows(constraint: Ints, slope: Floats, constant: Floats, z: int, risk: int, names: tuple[str, ...]) -> Rows:
    """Rows ``slope z + risk >= constant``, one a piece."""
    many = len(constraint)
    indices, data = np.empty(2 * many, dtype=np.int32), np.ones(2 * many)
    indices[::2], indices[1::2], data[::2] = z + constraint, risk + constraint, slope
    starts = np.arange(0, 2 * many + 1, 2, dtype=np.int32)
    return Rows("piece", (constraint, np.arange(many)), (names,), starts, indices, data, constant, np.full(many, math.inf))


def build_tangents(problem: RiskAllocation) -> Compiled:
    """The program of form ``tangents``, whose optimum is a bound on that of the allocated problem.

    Towards the joint problem it is neither relaxation nor restriction, as the allocated problem is a restriction of that.
    """
    pieces = piecewise_program(problem, "tangents", points(problem, mean_risk(problem), POINTS), above=False)
    allocated = problem.risk.kind == "allocated"

    def dual_evidence(duals: Floats) -> Evidence:
        row_prices = prices(problem, pieces.program, np.zeros(pieces.program.num_variables), duals)
        spent = -problem.sign * duals[pieces.budget : pieces.budget + len(problem.budgets)] / pieces.unit
        return evidence_of({**row_prices, "budgets": np.maximum(spent, 0.0)}, float("nan"), "duals of tangents")

    linear = allocated and not pieces.program.cones and pieces.program.quadratic is None
    exactness = Exactness.EXACT if allocated else Exactness.RESTRICTION
    evidence = dual_evidence if linear else None
    return Compiled(pieces.program, problem, partial(_decoded, problem), dual_evidence=evidence, exactness=exactness)


def build_secants(problem: RiskAllocation) -> Compiled:
    """The program of form ``secants``, whose points are answers, of the joint problem too."""
    pieces = piecewise_program(problem, "secants", points(problem, mean_risk(problem), POINTS), above=True)
    return Compiled(pieces.program, problem, partial(_decoded, problem))


def _decoded(problem: RiskAllocation, vector: Floats) -> Allocation:
    return problem.allocated(np.array(vector[: len(problem.lower)]))


for _order, _name, _build, _exactness in (
    (0, "secants", build_secants, Exactness.RESTRICTION),
    (1, "tangents", build_tangents, Exactness.RELAXATION),
):
    FORMS.enter(
        Form(
            _name, "risk-allocation", FEATURES, _build, _exactness, refuses=refuses, makes=makes, order=_order,
            size=partial(size_of, pieces=POINTS),
        ),
    )  # fmt: skip
