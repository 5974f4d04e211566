"""Settings of risk allocation on the command line."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...instances.errors import UsageError
from ...instances.generators.settings import Setting
from ...instances.risk.allocation import RISKS, RiskAllocationInstance
from ...instances.suggestions import did_you_mean
from ..problem import PROBLEMS
from .risk_allocation import RiskAllocation

SETTINGS = {
    "risk": Setting(None, "how risk is counted: allocated (Boole) or joint", type=str, choices=RISKS),
    "total": Setting(None, "risk of all constraints together", type=float),
}


@PROBLEMS.register("risk-allocation")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> RiskAllocation:
    if not isinstance(instance, RiskAllocationInstance):
        raise UsageError(f"{instance.name} holds no chance constraints, so it cannot be read as {problem}")
    settings = {key: value for key, value in settings.items() if key != "convention" or value != "exact"}
    unknown = settings.keys() - SETTINGS.keys()
    if unknown:
        raise UsageError(f"{problem} has no setting {min(unknown)!r}; it takes {', '.join(SETTINGS)}{did_you_mean(min(unknown), SETTINGS)}")
    values = {key: SETTINGS[key].value(key, value) for key, value in settings.items()}
    changes: dict[str, Any] = {"kind": values["risk"]} if values.get("risk") else {}
    if values.get("total") is not None:
        old = instance.risk
        each = np.full(len(old.each), values["total"]) if old.total is not None and (old.each == old.total).all() else old.each
        changes |= {"total": values["total"], "each": each}
    return RiskAllocation(instance.with_risk(**changes) if changes else instance)
