"""Answers of risk allocation: a decision, and the risk that each constraint is given; or in words why there is none."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import InputError
from ...instances.number_arrays import Floats as Floats, reals
from ..references import is_number

if TYPE_CHECKING:
    from .risk_allocation import RiskAllocation


@dataclass(frozen=True, eq=False)
class Allocation:
    """A decision and its risks.

    Parameters
    ----------
    decision : array of shape (decisions,)
        A value a decision, in the units of the instance.
    risks : array of shape (constraints,), optional
        What each chance constraint is allowed; None leaves it to what each has.
    """

    decision: Floats
    risks: Floats | None = None

    @classmethod
    def of(cls, decision: ArrayLike, risks: ArrayLike | None = None) -> "Allocation":
        """An allocation of anything that numpy takes for vectors.

        Parameters
        ----------
        decision : array-like, shape (decisions,)
            A value a decision.
        risks : array-like, shape (constraints,), optional
            As of the class.
        """
        return cls(reals("the decision", decision).copy(), None if risks is None else reals("the risks", risks).copy())

    def __repr__(self) -> str:
        return f"<Allocation: {len(self.decision)} decisions{'' if self.risks is None else f', {len(self.risks)} risks'}>"


def allocation_from_json(data: Any, decisions: Sequence[str], constraints: Sequence[str]) -> Allocation:
    """Answer in ``{"kind": "allocation", "decision": {name: number}, "risks": {name: number}}``, risks optional; raises InputError."""
    if not isinstance(data, Mapping) or data.get("kind") != "allocation":
        raise InputError("not an answer of risk allocation", expected='{"kind": "allocation", "decision": {...}, "risks": {...}}')
    risks = None if data.get("risks") is None else _named(data["risks"], constraints, "risks")
    return Allocation(_named(data.get("decision"), decisions, "decision"), risks)


def _named(data: Any, names: Sequence[str], what: str) -> Floats:
    if not isinstance(data, Mapping) or set(data) != set(names):
        raise InputError(
            f"the answer's {what} must name each of them", "missing", expected=", ".join(names[:4]) + (", ..." if len(names) > 4 else "")
        )
    if not all(map(is_number, data.values())):
        raise InputError(f"the answer's {what} must be numbers")
    return np.array([float(data[name]) for name in names])


SHOWN_NAMES = 6
"""Most constraints that are named."""


def contradiction(problem: "RiskAllocation", data: Mapping[str, Any]) -> str:
    """Evidence ``risk-allocation-duals`` that there is no answer, in words: the constraints that have a price."""
    fixed = _priced_names(data["rows"], problem.instance.constraint_names)
    names = _priced_names(data["chance"], [problem.names[constraint] for constraint in problem.constraint.tolist()])
    if not names:
        if len(fixed) == 1:
            return f"no decision within its bounds keeps constraint {fixed[0]}, whatever the risk"
        return f"constraints {_listed(fixed)} contradict each other, whatever the risk" if fixed else "no alternative is left"
    held = f", where {'constraints' if len(fixed) > 1 else 'constraint'} {_listed(fixed)} {'hold' if len(fixed) > 1 else 'holds'}"
    if len(names) == 1:
        most = problem.caps[problem.names.index(names[0])]
        reason = f"every decision gives chance constraint {names[0]} a risk above {most:g}, the most that it may have"
    else:
        reason = f"no decision keeps the risks of chance constraints {_listed(names)} within their budgets, however they are shared out"
    return reason + held if fixed else reason


def _priced_names(values: Any, names: Sequence[str]) -> list[str]:
    """Names of entries with a price, a list or positions and values: in their order, or the dearest first where they are many."""
    prices = dict(zip(values["at"], values["values"], strict=True)) if isinstance(values, Mapping) else dict(enumerate(values))
    priced = sorted((at for at, price in prices.items() if price != 0.0), key=lambda at: -abs(prices[at]))
    return [names[at] for at in (priced if len(priced) > SHOWN_NAMES else sorted(priced))]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN_NAMES]) + (f" and {len(names) - SHOWN_NAMES} more" if len(names) > SHOWN_NAMES else "")
