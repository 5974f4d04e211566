"""Contradicting chance constraints in words, from prices that no decision can pay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .risk_allocation import RiskAllocation

SHOWN_NAMES = 6
"""Most constraints that are named."""


def contradiction(problem: RiskAllocation, data: Mapping[str, Any]) -> str:
    """Evidence ``risk-allocation-duals`` that there is no answer, in words: the constraints that have a price."""
    fixed = _named(data["rows"], problem.instance.constraint_names)
    names = _named(data["chance"], [problem.names[constraint] for constraint in problem.constraint.tolist()])
    if not names:
        if len(fixed) == 1:
            return f"no decision within its bounds keeps constraint {fixed[0]}, whatever the risk"
        return f"constraints {_listed(fixed)} contradict each other, whatever the risk" if fixed else "no alternative is left"
    held = f", where {'constraints' if len(fixed) > 1 else 'constraint'} {_listed(fixed)} {'hold' if len(fixed) > 1 else 'holds'}"
    if len(names) == 1:
        most = problem.caps[problem.names.index(names[0])]
        said = f"every decision gives chance constraint {names[0]} a risk above {most:g}, the most that it may have"
    else:
        said = f"no decision keeps the risks of chance constraints {_listed(names)} within their budgets, however they are shared out"
    return said + held if fixed else said


def _named(values: Any, names: Sequence[str]) -> list[str]:
    """Names of entries with a price, a list or positions and values: in their order, or the dearest first where they are many."""
    prices = dict(zip(values["at"], values["values"], strict=True)) if isinstance(values, Mapping) else dict(enumerate(values))
    priced = sorted((at for at, price in prices.items() if price != 0.0), key=lambda at: -abs(prices[at]))
    return [names[at] for at in (priced if len(priced) > SHOWN_NAMES else sorted(priced))]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN_NAMES]) + (f" and {len(names) - SHOWN_NAMES} more" if len(names) > SHOWN_NAMES else "")
