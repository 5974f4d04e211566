"""Risk allocation: a convex cost under constraints on Gaussian quantities that may fail with a given probability."""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...instances.errors import InputError, UsageError
from ...instances.generators.settings import Setting
from ...instances.printable import printable
from ...instances.risk.allocation import MOST_RISK, RISKS, Risk, RiskAllocationInstance
from ...instances.risk.allocation_arrays import allocation_from_arrays
from ..evaluation import Evaluation
from ..evidence import Evidence
from ..problem import PROBLEMS, Decision, Problem, refuse_settings
from .allocations import Allocation, allocation_from_json, contradiction
from .joint_normal import MORE_POINTS, POINTS, Probability, any_fails
from .judge import evaluate_allocation, judged_slack, safest_risks

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SETTINGS = {
    "risk": Setting(None, "how risk is counted: allocated (Boole) or joint", type=str, choices=RISKS),
    "total": Setting(None, "risk of all constraints together", type=float),
}
"""Settings of ``--set``."""


class RiskAllocation(Problem):
    """Choose decisions x and risks, for ``min c x + sum of convex terms`` (or the ``max`` of a reward less these)::

        L <= A x <= U,  l <= x <= u,  |F x + f| <= g x + h          deterministic, on means
        P(a_i x + w_i > b_i) <= risk_i,  w ~ N(0, S)                each chance constraint
        sum of risk_i over a budget <= its risk                     ``allocated``
        P(any of a budget's constraints fails) <= its risk          ``joint``

    A constraint with alternatives holds where one of its rows does; the risk of one of them is an upper limit of its own.

    Parameters
    ----------
    instance : RiskAllocationInstance
        Rows, random quantities, and budgets of risk.

    Attributes
    ----------
    chance, limits : arrays of shape (rows, decisions) and (rows,)
        a and b.
    covariance, deviation : arrays of shape (rows, rows) and (rows,)
        S and the roots of its diagonal.
    constraint : array of shape (rows,)
        The constraint of each row.
    caps : array of shape (constraints,)
        The most risk that each can have under all budgets.
    open : array of shape (rows,)
        Whether a row may be the safest of its constraint; all of them, but where the problem is restricted.

    Notes
    -----
    Source: Ono and Williams (2008), "Iterative risk allocation"; Blackmore and Ono (2009), "Convex chance constrained predictive control
    without sampling"; docs/formulations/risk-allocation.md.
    """

    family: ClassVar[str] = "risk-allocation"

    def __init__(self, instance: RiskAllocationInstance) -> None:
        self.instance, self.risk = instance, instance.risk
        self.name, self.problem, self.notes = instance.name, "risk-allocation", instance.notes
        quantities, chance = instance.quantities, instance.chance
        self.lower, self.upper = instance.lower, instance.upper
        with np.errstate(over="ignore", invalid="ignore"):
            self.linear, offset = (part[0] for part in instance.cost.mean(quantities))
            self.offset = float(offset)
            self.terms = tuple((t.kind, t.weight, *t.rows.mean(quantities)) for t in instance.terms)
            self.rows, shift = instance.constraints.mean(quantities)
            self.cones = tuple((*c.rows.mean(quantities), *(part[0] for part in c.limit.mean(quantities))) for c in instance.cones)
            self.chance, moved = chance.rows.mean(quantities)
            self.covariance = chance.rows.quantities @ quantities.covariance @ chance.rows.quantities.T
            self.row_lower, self.row_upper = instance.constraint_lower - shift, instance.constraint_upper - shift
            self.limits = chance.limits - moved
        parts = (self.linear, offset, self.rows, shift, self.chance, self.limits, self.covariance, *(p for t in self.terms for p in t[2:]),
                 *(p for c in self.cones for p in c))  # fmt: skip
        if not all(np.isfinite(part).all() for part in parts):
            raise InputError("rows over quantities are too large: their means or variances are no finite numbers", "out-of-range")
        self.deviation = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        self.constraint, self.names, self.caps = chance.constraint, chance.names, instance.risk.caps()
        self.budgets = instance.risk.all_budgets()
        self.places: dict[str, tuple[int, tuple[int, ...]]] = {}
        self.open = np.ones(len(self.limits), dtype=bool)
        self._joint: tuple[tuple[bytes, int | None], dict[str, Probability]] = ((b"", None), {})

    @classmethod
    def from_arrays(cls, quantities: Any, covariance: Any, limits: Any, cost: Any, **further: Any) -> RiskAllocation:
        """A problem from numpy arrays, or pandas frames and series, whose labels are names and need not be in one order.

        Parameters
        ----------
        quantities : array or DataFrame of shape (quantities, decisions)
            What a decision adds to the mean of each.
        covariance : array or DataFrame of shape (quantities, quantities), or their variances, shape (quantities,)
            Of the noise that comes on top.
        limits : float, array or Series of shape (rows,)
            That the chance rows must not exceed.
        cost : array or Series of shape (decisions,)
            Or the reward, with ``sense="max"``.
        **further
            All that follows:
        chance : array or DataFrame of shape (rows, quantities), optional
            The chance rows, by the quantities; each quantity is one by default.
        constraint : sequence of shape (rows,), optional
            The constraint that each row belongs to, by any label: one of several rows, alternatives, is enough. Each row is one by default.
        total : float, optional
            Risk of all constraints together.
        each : float, array or Series of shape (constraints,), optional
            The most risk of one, at most 1/2.
        budgets : mapping of str to (constraints, risk), optional
            Of some constraints together, by name or by number from 0.
        risk : str
            ``allocated`` or ``joint``.
        offset : float, array or Series of shape (quantities,), optional
            Of the means.
        lower, upper : float, array or Series of shape (decisions,), optional
            Bounds of decisions; infinite by default.
        rows : array or DataFrame of shape (constraints, decisions), optional
            Deterministic, within ``row_lower`` and ``row_upper``: float, array or Series of shape (constraints,).
        sense : str
            ``min`` or ``max``.
        name : str
            For tables and files.

        Raises
        ------
        InputError
            If shapes or labels do not fit each other, or numbers are out of range.
        """
        return cls(allocation_from_arrays(quantities, covariance, limits, cost, **further))

    @classmethod
    def from_cvxpy(
        cls, model: Any, quantities: Any, covariance: ArrayLike, limits: ArrayLike, *, total: float | None = None,
        each: ArrayLike | None = None, risk: str = "allocated", name: str = "risk-allocation", names: Sequence[str] | None = None,
    ) -> RiskAllocation:  # fmt: skip
        """A problem declared with CVXPY: ``quantities`` plus noise must not exceed ``limits``.

        Parameters
        ----------
        model : cvxpy.Problem
            Cost and deterministic constraints: linear, quadratic, and second-order cones.
        quantities : cvxpy expression with q entries
            Affine in the model's variables.
        covariance : array of shape (q, q)
            Of the noise.
        limits : array of shape (q,)
            That the quantities must not exceed.
        total : float, optional
            Risk of all of them together.
        each : float or array of shape (q,), optional
            The most risk of one, at most 1/2.
        risk : str
            ``allocated`` or ``joint``.
        name : str
            For tables and files.
        names : sequence of str, optional
            Of the quantities.

        Returns
        -------
        RiskAllocation
            ``values(answer)`` tells the variables' values by name. Its other decisions are CVXPY's own auxiliary variables.

        Raises
        ------
        InputError
            If the model is not convex, the quantities not affine, or the risks out of range.
        UnsupportedError
            If it has integers, or exponential, power or semidefinite cones.
        """
        from .cvxpy_declarations import declared_instance

        instance, places = declared_instance(
            model, quantities, covariance, limits, total=total, each=each, risk=risk, name=name, names=names
        )
        problem = cls(instance)
        problem.places = places
        return problem

    def values(self, answer: Any) -> dict[str, Floats]:
        """The values of the variables of ``from_cvxpy``, by name and in their shapes."""
        x = self.answer_of(answer).decision
        return {name: x[at : at + math.prod(shape)].reshape(shape, order="F") for name, (at, shape) in self.places.items()}

    @property
    def senses(self) -> tuple[str, ...]:
        return (self.instance.sense,)

    @property
    def size(self) -> int:
        return len(self.lower)

    @property
    def sign(self) -> float:
        """1 where a cost is minimised, -1 where a reward is maximised."""
        return 1.0 if self.instance.sense == "min" else -1.0

    @property
    def disjunctive(self) -> bool:
        """True if some constraint has alternatives."""
        return len(self.names) < len(self.constraint)

    def digest(self) -> str:
        return self.instance.digest()

    def features(self) -> frozenset[str]:
        """The way that risk is counted, and ``alternatives``, ``quadratic-cost``, ``cones`` where it has them."""
        kinds = {t[0] for t in self.terms}
        marks = {"alternatives": self.disjunctive, "quadratic-cost": "square" in kinds, "cones": bool(self.cones) or "norm" in kinds}
        return frozenset({f"{self.risk.kind}-risk", *(name for name, present in marks.items() if present)})

    def facts(self) -> dict[str, Any]:
        """Sizes and budgets."""
        q = self.instance.quantities
        return {
            "decisions": len(self.lower), "quantities": len(q.names), "constraints": len(self.row_lower),
            "chance_constraints": len(self.names), "risk": self.risk.kind, "budgets": {b.name: b.risk for b in self.budgets},
        }  # fmt: skip

    def value(self, x: Floats) -> tuple[float, float]:
        """Objective of a decision, and the sum of the absolute values of its terms."""
        parts = [*(self.linear * x).tolist(), self.offset]
        for kind, weight, matrix, constant in self.terms:
            r = matrix @ x + constant
            size = {"absolute": np.abs(r).sum(), "norm": np.linalg.norm(r), "square": r @ r}[kind]
            parts.append(self.sign * weight * float(size))
        try:
            return math.fsum(parts), math.fsum(map(abs, parts))
        except (OverflowError, ValueError):  # beyond the range of numbers
            return sum(parts), sum(map(abs, parts))

    def risks(self, x: Floats) -> Floats:
        """For each constraint the risk of its safest row at the decision x."""
        return safest_risks(self, x)

    def joint_risk(self, x: Floats, seed: int | None = None) -> dict[str, Probability]:
        """Probability that any constraint fails at the decision x, the total's first and then each budget's, by name.

        ``seed`` is that of the samples. By default the decision has its own, so that a search with another one has not picked it by their
        errors.
        """
        key = (x.tobytes(), seed)
        if self._joint[0] != key:
            own = int.from_bytes(hashlib.sha256((x + 0.0).tobytes()).digest()[:8], "little") if seed is None else seed
            slack, joint = judged_slack(self, x), {}
            points = MORE_POINTS if self.risk.kind == "joint" else POINTS
            every = [(b.name, b.constraints) for b in self.budgets]
            if self.risk.total is None:
                every.insert(0, ("total", np.arange(len(self.names))))
            for name, constraints in every if self.risk.kind == "joint" else every[:1]:
                at = np.isin(self.constraint, constraints)
                joint[name] = any_fails(slack[at], self.covariance[np.ix_(at, at)], self.constraint[at], seed=own, points=points)
            self._joint = (key, joint)
        return self._joint[1]

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute cost, every constraint, every risk, and the probability that any of them fails.

        Deterministic rows and the limits of chance rows may be broken by ``VECTOR`` of the largest number in them, as solvers count;
        ``concession`` says what that can be worth.
        """
        return evaluate_allocation(self, self.answer_of(answer))

    def concession(self, evidence: Evidence, evaluation: Evaluation) -> float:
        """Difference that it makes to the bound of ``evidence`` if every limit is as wide as the answer's largest residuals."""
        from ..verified_bounds import verified_bound

        residual = {check.name: check.residual for check in evaluation.checks}
        if not any(residual.values()):
            return 0.0
        return abs(verified_bound(self, evidence) - verified_bound(self.widened(residual), evidence))

    # -- problems made of this one -----------------------------------------------------------------------------------

    def widened(self, residual: Mapping[str, float]) -> RiskAllocation:
        """The same with limits wider by these residuals, by the names of the checks."""
        wide, wider = copy.copy(self), residual.get("constraints", 0.0)
        wide.row_lower, wide.row_upper = self.row_lower - wider, self.row_upper + wider
        wide.limits = self.limits + residual.get("chance", 0.0)
        wide.cones = tuple((f, c, g, h + residual.get("cones", 0.0)) for f, c, g, h in self.cones)
        more = residual.get("budgets", 0.0) + residual.get("joint-risk", 0.0)
        wide.budgets = tuple(replace(b, risk=b.risk + more) for b in self.budgets)
        wide.caps = np.minimum(self.caps + residual.get("risks", 0.0) + more, MOST_RISK)
        return wide

    def choosing(self, rows: Ints) -> RiskAllocation:
        """The same with these chance rows alone, ascending, and the constraints that have one."""
        part = copy.copy(self)
        kept, constraint = np.unique(self.constraint[rows], return_inverse=True)
        part.chance, part.limits, part.deviation = self.chance[rows], self.limits[rows], self.deviation[rows]
        part.covariance, part.constraint, part.open = self.covariance[np.ix_(rows, rows)], constraint, np.ones(len(rows), dtype=bool)
        part.names, part.caps = tuple(self.names[k] for k in kept.tolist()), self.caps[kept]
        part.risk = Risk(self.risk.kind, self.risk.total, self.risk.each[kept])
        members = [(b, np.nonzero(np.isin(kept, b.constraints))[0]) for b in self.budgets]
        part.budgets = tuple(replace(b, constraints=at) for b, at in members if len(at))
        part._joint = ((b"", None), {})
        return part

    def by_allocation(self) -> RiskAllocation:
        """The same with allocated risk: a restriction where risk is joint."""
        allocated = copy.copy(self)
        allocated.risk = replace(self.risk, kind="allocated", budgets=())
        allocated._joint = ((b"", None), {})
        return allocated

    def convex_part(self) -> tuple[RiskAllocation, Ints]:
        """A convex relaxation, and the chance rows in it: no undecided alternatives, and joint risk as a limit of each constraint."""
        alternatives = np.bincount(self.constraint, weights=self.open)
        rows = np.nonzero(self.open & (alternatives[self.constraint] == 1))[0]
        part = self.choosing(rows) if self.disjunctive else copy.copy(self)
        if self.risk.kind == "joint":
            part.risk, part.budgets = Risk("allocated", None, part.caps), ()
        return part, rows

    def restricted(self, decisions: Sequence[Decision]) -> RiskAllocation:
        """The same with fewer rows open."""
        fewer = copy.copy(self)
        fewer.open = self.open.copy()
        for statement, holds in decisions:
            self.check_statement(statement)
            row = statement["safest"]
            if holds:
                kept = fewer.open[row]
                fewer.open[self.constraint == self.constraint[row]] = False
                fewer.open[row] = kept
            else:
                fewer.open[row] = False
        return fewer

    def check_statement(self, statement: Any) -> None:
        """``{"safest": row}``: of the rows of its constraint, this chance row has the least risk, or is the first that does."""
        row = statement.get("safest") if isinstance(statement, Mapping) and len(statement) == 1 else None
        if type(row) is not int or not 0 <= row < len(self.limits):
            expected = f'{{"safest": row}}, a chance row from 0 to {len(self.limits) - 1}'
            raise InputError("not a statement on the rows of a chance constraint", expected=expected, found=printable(str(statement), 80))

    def in_words(self, statement: Any, holds: bool) -> str:
        row = statement["safest"]
        place = int(np.count_nonzero(self.constraint[:row] == self.constraint[row])) + 1
        return f"alternative {place} of {self.names[self.constraint[row]]} is {'' if holds else 'not '}the safest"

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        if kind != "risk-allocation-duals":
            return super().why_none(kind, data)
        return contradiction(self, data)

    def answer_of(self, given: Any) -> Allocation:
        """An ``Allocation``, or a vector of shape (decisions,)."""
        try:
            answer = given if isinstance(given, Allocation) else Allocation.of(given)
        except InputError:
            raise InputError("an answer of risk allocation is an Allocation, or a vector with one number a decision") from None
        if answer.decision.shape != self.lower.shape or (answer.risks is not None and answer.risks.shape != (len(self.names),)):
            expected = f"{len(self.lower)} decisions and {len(self.names)} risks"
            raise InputError("the answer is one of other data", "foreign", expected=expected, found=str(answer.decision.shape))
        return answer

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        answer = self.answer_of(answer)
        data = {"kind": "allocation", "decision": dict(zip(self.instance.decision_names, answer.decision.tolist(), strict=True))}
        return data if answer.risks is None else {**data, "risks": dict(zip(self.names, answer.risks.tolist(), strict=True))}

    def answer_from_json(self, data: Any) -> Allocation:
        return allocation_from_json(data, self.instance.decision_names, self.names)

    def answer_to_frame(self, answer: Any) -> pd.DataFrame:
        """One row a chance constraint: constraint, risk allowed, risk there is."""
        import pandas as pd

        answer = self.answer_of(answer)
        own = self.risks(answer.decision)
        return pd.DataFrame({"constraint": self.names, "allowed": own if answer.risks is None else answer.risks, "risk": own})

    def allocated(self, x: Floats) -> Allocation:
        """The answer with decision x and its own risks, what is left of the total shared out in proportion where that breaks nothing."""
        own = self.risks(x)
        if self.risk.kind == "joint":
            return Allocation(x)
        spent = [(float(own[b.constraints].sum()), b.risk) for b in self.budgets]
        factor = min((risk / used for used, risk in spent if used > 0.0), default=1.0)
        factor = min([factor, *(self.risk.each[own > 0.0] / own[own > 0.0]).tolist()]) if (own > 0.0).any() else 1.0
        return Allocation(x, own * factor * (1.0 - 1e-14) if factor > 1.0 else own)

    def to_instance(self) -> RiskAllocationInstance:
        return self.instance

    def __repr__(self) -> str:
        return f"<RiskAllocation {self.name}: {self.risk.kind}, {len(self.lower)} decisions, {len(self.names)} chance constraints>"


@PROBLEMS.register("risk-allocation")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> RiskAllocation:
    if not isinstance(instance, RiskAllocationInstance):
        raise UsageError(f"{instance.name} holds no chance constraints, so it cannot be read as {problem}", "foreign")
    refuse_settings(problem, settings, tuple(SETTINGS))
    values = {key: SETTINGS[key].value(key, value) for key, value in settings.items() if key != "convention"}
    changes: dict[str, Any] = {"kind": values["risk"]} if values.get("risk") else {}
    if values.get("total") is not None:
        old = instance.risk
        each = np.full(len(old.each), values["total"]) if old.total is not None and (old.each == old.total).all() else old.each
        changes |= {"total": values["total"], "each": each}
    return RiskAllocation(instance.with_risk(**changes) if changes else instance)
