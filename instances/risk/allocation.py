"""Risk allocation as data: decisions, a convex cost, Gaussian quantities, and constraints of which few may fail."""

import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..number_arrays import Floats, Integers as Ints
from ..text import label
from .gaussian import Quantities

RISKS = ("allocated", "joint")
TERMS = ("absolute", "norm", "square")
MOST_RISK = 0.5
"""Largest risk of one constraint: beyond it the quantile is not convex in the risk."""


@dataclass(frozen=True, eq=False)
class Affine:
    """Rows ``D x + Q y + constant`` over decisions x and quantities y, which stand for their means outside of chance constraints.

    Shapes: ``decisions`` (rows, decisions), ``quantities`` (rows, quantities), ``constant`` (rows,).
    """

    decisions: Floats
    quantities: Floats
    constant: Floats

    @property
    def rows(self) -> int:
        return len(self.constant)

    def mean(self, quantities: Quantities) -> tuple[Floats, Floats]:
        """Matrix over the decisions and constant of the rows' means."""
        return self.decisions + self.quantities @ quantities.map, self.constant + self.quantities @ quantities.offset

    def check(self, what: str, decisions: int, quantities: int, rows: int | None = None) -> None:
        """Raise InputError unless the shapes fit and all numbers are finite."""
        many = self.rows if rows is None else rows
        shapes = (self.decisions.shape, self.quantities.shape, self.constant.shape)
        if shapes != ((many, decisions), (many, quantities), (many,)):
            raise InputError(f"{what} does not fit the decisions and quantities", "wrong-shape",
                             expected=f"{(many, decisions)}, {(many, quantities)}",
                             found=", ".join(map(str, shapes)))  # fmt: skip
        if not all(np.isfinite(part).all() for part in (self.decisions, self.quantities, self.constant)):
            raise InputError(f"{what} must hold finite numbers", "out-of-range")

    def parts(self) -> tuple[Any, ...]:
        return (self.decisions, self.quantities, self.constant)


@dataclass(frozen=True, eq=False)
class CostTerm:
    """A convex cost of affine rows r: ``weight`` times the sum of |r| (``absolute``), the Euclidean norm of r (``norm``) or its square."""

    kind: str
    weight: float
    rows: Affine

    def __post_init__(self) -> None:
        if self.kind not in TERMS:
            raise InputError("the kind of a cost term is unknown", "unknown-name", expected=", ".join(TERMS), found=self.kind)
        if not (math.isfinite(self.weight) and self.weight >= 0):
            raise InputError(
                "the weight of a cost term must be finite and not negative, else the cost is not convex",
                "out-of-range",
                found=f"{self.weight:g}",
            )


@dataclass(frozen=True, eq=False)
class Cone:
    """A second-order constraint: the Euclidean norm of ``rows`` is at most ``limit``, one row."""

    rows: Affine
    limit: Affine


@dataclass(frozen=True, eq=False)
class Budget:
    """Risk that some constraints may have together: those of a step, of a robot."""

    name: str
    constraints: Ints
    risk: float


@dataclass(frozen=True, eq=False)
class ChanceConstraints:
    """Rows of quantities that must not exceed their limits, but for the risk.

    ``limits`` has the shape (rows,). ``names``: one a constraint. ``constraint``, shape (rows,): the constraint that each row belongs to,
    from 0. One of several rows holds where any of them does: alternatives, such as the sides of an obstacle.
    """

    rows: Affine
    limits: Floats
    names: tuple[str, ...]
    constraint: Ints

    def __post_init__(self) -> None:
        if self.limits.shape != (self.rows.rows,) or not np.isfinite(self.limits).all():
            raise InputError(
                "the limits of chance constraints must be one finite number a row", "wrong-shape", expected=str(self.rows.rows)
            )
        if self.constraint.shape != (self.rows.rows,) or not np.array_equal(np.unique(self.constraint), np.arange(len(self.names))):
            raise InputError(
                "each row belongs to a chance constraint, and each of these has a row",
                "contradiction",
                expected=f"0 to {len(self.names) - 1}",
            )
        arrays.names("chance constraint", self.names, len(self.names))


@dataclass(frozen=True, eq=False)
class Risk:
    """The allowed probability of failure, and how it is counted.

    ``kind``: ``allocated``: each constraint is given a risk, and the risks add up to the budgets at most (Boole). ``joint``: the
    probability that any of a budget's constraints fails is at most the budget. ``total``: budget of all constraints together, in (0, 1).
    ``each``, shape (constraints,): most that one constraint may have, at most 1/2.
    """

    kind: str
    total: float | None
    each: Floats
    budgets: tuple[Budget, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in RISKS:
            raise InputError("the kind of risk is unknown", "unknown-name", expected=" or ".join(RISKS), found=self.kind)
        named = [("the total risk", self.total), *((f"the risk of budget {b.name}", b.risk) for b in self.budgets)]
        for what, risk in named:
            if risk is not None and not 0.0 < risk < 1.0:
                raise InputError(f"{what} must lie between 0 and 1, both excluded", "out-of-range", found=f"{risk:g}")
        if not ((self.each > 0.0) & (self.each < 1.0)).all():
            k = int(np.argmin((self.each > 0.0) & (self.each < 1.0)))
            raise InputError("the risk of a constraint must lie between 0 and 1, both excluded", "out-of-range", found=f"{self.each[k]:g}")
        for budget in self.budgets:
            arrays.refuse_outside(f"constraint {{}} of budget {budget.name}", budget.constraints, len(self.each), "chance constraint")
            if len(np.unique(budget.constraints)) != len(budget.constraints):
                raise InputError(f"budget {budget.name} names a constraint twice", "duplicate")
        most = self.caps()
        if (most > MOST_RISK).any():
            k = int(np.argmax(most))
            raise InputError(
                f"chance constraint number {k + 1} may have a risk above 1/2, where the quantile is not convex", "out-of-range",
                expected="each: 0.5 or less", found=f"{most[k]:g}",
            )  # fmt: skip

    def caps(self) -> Floats:
        """The most that each constraint can have under all budgets."""
        most = np.minimum(self.each, 1.0 if self.total is None else self.total)
        for budget in self.budgets:
            most[budget.constraints] = np.minimum(most[budget.constraints], budget.risk)
        return most

    def all_budgets(self) -> tuple[Budget, ...]:
        """The total first, then the others."""
        if self.total is None:
            return self.budgets
        return (Budget("total", np.arange(len(self.each)), self.total), *self.budgets)


@dataclass(frozen=True, eq=False)
class RiskAllocationInstance:
    """Decide x for a convex cost, so that constraints on Gaussian quantities of x hold with a given probability.

    Parameters
    ----------
    lower, upper : array of shape (decisions,)
        Infinite where there is none.
    decision_names : tuple of str
        One a decision.
    quantities : Quantities
        The random quantities: means and covariance.
    cost : Affine
        One row: the linear cost (``min``) or reward (``max``).
    terms : tuple of CostTerm
        Added to a cost, subtracted from a reward.
    constraints : Affine
        Rows on means.
    constraint_lower, constraint_upper : array of shape (rows of constraints,)
        Between which they lie; infinite where there is no limit.
    cones : tuple of Cone
        Rows ``|F x + f| <= g x + h``, on means.
    chance : ChanceConstraints
        The rows that may fail, and the alternatives among them.
    risk : Risk
        How much may fail: budgets, and whether they are shared out or held jointly.
    constraint_names : tuple of str
        One a row of ``constraints``.
    sense : str
        ``min`` of a cost or ``max`` of a reward.
    name, format, problem, problems, notes
        See ``Instance``.
    """

    kind: ClassVar[str] = "risk-allocation"
    lower: Floats
    upper: Floats
    decision_names: tuple[str, ...]
    quantities: Quantities
    cost: Affine
    chance: ChanceConstraints
    risk: Risk
    constraints: Affine
    constraint_lower: Floats
    constraint_upper: Floats
    constraint_names: tuple[str, ...]
    terms: tuple[CostTerm, ...] = ()
    cones: tuple[Cone, ...] = ()
    sense: str = "min"
    name: str = "risk-allocation"
    format: str = "arrays"
    problem: str = "risk-allocation"
    problems: tuple[str, ...] = ("risk-allocation",)
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        n, q = len(self.decision_names), len(self.quantities.names)
        if not n:
            raise InputError("there must be at least one decision", "missing")
        arrays.names("decision", self.decision_names, n)
        arrays.names("quantity", self.quantities.names, q)
        if self.sense not in ("min", "max"):
            raise InputError("the sense must be min or max", "unknown-name", found=str(self.sense))
        if self.quantities.map.shape[1] != n:
            raise InputError(
                "the quantities' map has one column a decision", "wrong-shape", expected=str(n), found=str(self.quantities.map.shape[1])
            )
        for what, low, high, many in (
            ("bounds of the decisions", self.lower, self.upper, n),
            ("limits of the constraints", self.constraint_lower, self.constraint_upper, self.constraints.rows),
        ):
            if low.shape != (many,) or high.shape != (many,) or np.isnan(low).any() or np.isnan(high).any():
                raise InputError(
                    f"{what} must be one number each", "wrong-shape", expected=str(many), found=f"{low.shape} and {high.shape}"
                )
            if (low > high).any():
                k = int(np.argmax(low > high))
                raise InputError(f"{what} cross at {k}", "contradiction", expected="lower <= upper", found=f"{low[k]:g} > {high[k]:g}")
        self.cost.check("the cost", n, q, 1)
        self.constraints.check("the constraints", n, q)
        self.chance.rows.check("the chance constraints", n, q)
        for term in self.terms:
            term.rows.check(f"a cost term of kind {term.kind}", n, q)
        for cone in self.cones:
            cone.rows.check("a cone", n, q)
            cone.limit.check("the limit of a cone", n, q, 1)
        if not self.chance.names:
            raise InputError("there must be at least one chance constraint", "missing")
        if self.risk.each.shape != (len(self.chance.names),):
            found = str(len(self.risk.each))
            raise InputError(
                "there is one largest risk for each chance constraint", "wrong-shape", expected=str(len(self.chance.names)), found=found
            )
        if len(arrays.names("constraint", self.constraint_names, self.constraints.rows) or ()) != self.constraints.rows:
            raise InputError("there must be one name for each constraint", "wrong-shape")
        object.__setattr__(self, "name", label(self.name))

    def digest(self) -> str:
        """Hash of everything that value and feasibility depend on."""
        terms = [part for t in self.terms for part in (t.kind, t.weight, *t.rows.parts())]
        cones = [part for c in self.cones for part in (*c.rows.parts(), *c.limit.parts())]
        budgets = [part for b in self.risk.budgets for part in (b.constraints, b.risk)]
        q, c = self.quantities, self.chance
        return digest(
            "risk-allocation", self.sense, self.lower, self.upper, q.map, q.offset, q.covariance, *self.cost.parts(), *terms,
            *self.constraints.parts(), self.constraint_lower, self.constraint_upper, *cones, *c.rows.parts(), c.limits, c.constraint,
            self.risk.kind, self.risk.total, self.risk.each, *budgets,
        )  # fmt: skip

    def with_risk(self, **changes: Any) -> "RiskAllocationInstance":
        """The same with another kind of risk, total, or both."""
        return replace(self, risk=replace(self.risk, **changes))
