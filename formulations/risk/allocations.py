"""Answers of risk allocation: a decision, and the risk that each constraint is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...instances.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Allocation:
    """A decision and its risks.

    Parameters
    ----------
    decision : array of shape (decisions,)
    risks : array of shape (constraints,), optional
        What each chance constraint is allowed; None leaves it to what each has.
    """

    decision: Floats
    risks: Floats | None = None

    @classmethod
    def of(cls, decision: ArrayLike, risks: ArrayLike | None = None) -> Allocation:
        """An allocation of anything that numpy takes for vectors."""
        allowed = None if risks is None else np.array(risks, dtype=np.float64)
        return cls(np.array(decision, dtype=np.float64), allowed)

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
        raise InputError(f"the answer's {what} must name each of them", expected=", ".join(names[:4]) + (", ..." if len(names) > 4 else ""))
    if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in data.values()):
        raise InputError(f"the answer's {what} must be numbers")
    return np.array([float(data[name]) for name in names])
