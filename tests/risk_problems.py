"""Small problems of risk allocation: those of the literature, and files as people write them."""

import copy
import json
from typing import Any

import numpy as np
from one_factor import any_fails_by_quadrature

from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.formulations.stop import Stop
from waybound.heuristics.heuristic import Context
from waybound.instances.risk.allocation_files import decode
from waybound.solvers.backend import Control, Options
from waybound.solvers.linear_programs import LinearPrograms

STALLING: dict[str, Any] = {
    "name": "stalling", "problem": "risk-allocation", "sense": "max", "decisions": 2, "lower": 0,
    "quantities": {"map": [[1, 0], [0, 1]], "covariance": [1, 1]},
    "cost": {"decisions": [1, 3]},
    "constraints": {"decisions": [[1, 1]], "upper": 7},
    "chance": {"quantities": [[1, 0], [0, 1]], "limits": [5, 5]},
    "risk": {"total": 0.1},
}  # fmt: skip
"""max x1 + 3 x2 with x1 + x2 <= 7 and x_i + z(r_i) <= 5: equal risks make all constraints active."""


STALLING_TEXT = json.dumps({"waybound": 1, "kind": "risk-allocation", **STALLING})
"""The same as a file."""


def changed(data: dict[str, Any] = STALLING, **changes: Any) -> dict[str, Any]:
    """A copy with other values; keys of parts as ``risk__total``, None deletes."""
    made = copy.deepcopy(data)
    for key, value in changes.items():
        part = made
        *path, last = key.split("__")
        for name in path:
            part = part.setdefault(name, {})
        if value is None:
            part.pop(last, None)
        else:
            part[last] = value
    return made


def problem(data: dict[str, Any] = STALLING, **changes: Any) -> RiskAllocation:
    """What a file with those changes holds."""
    return RiskAllocation(decode(changed(data, **changes)))


def margins(weights: list[float], total: float, **changes: Any) -> RiskAllocation:
    """min sum of weight times margin, each margin the quantile of its risk: no less than a standard normal number, but for the risk."""
    n = len(weights)
    unit = np.eye(n).tolist()
    return problem(
        sense="min", decisions=n, lower=None, quantities={"map": unit, "covariance": [1.0] * n}, cost={"decisions": weights},
        constraints=None, chance={"quantities": (-np.eye(n)).tolist(), "limits": [0.0] * n}, risk={"total": total, **changes},
    )  # fmt: skip


def around_a_box(**changes: Any) -> RiskAllocation:
    """One decision of the plane, near the origin, outside of a box that holds it."""
    data = changed(
        sense="min", decisions=2, lower=-3, upper=3, constraints=None,
        cost={"terms": [{"kind": "absolute", "decisions": [[1, 0], [0, 1.5]]}]},
        quantities={"map": [[1, 0], [0, 1]], "covariance": [0.04, 0.01]},
        chance={
            "quantities": [[1, 0], [-1, 0], [0, 1], [0, -1]], "limits": [-1, -1.2, -1, -0.9], "constraint": [0] * 4, "names": ["box"],
        },
        risk={"total": 0.05},
    )  # fmt: skip
    return problem(data, **changes)


def context(seed: int = 1, seconds: float = 60.0) -> Context:
    return Context(np.random.default_rng(seed), seconds, None, lambda answer: None, Stop(), LinearPrograms())


def run(engine: Any, problem: RiskAllocation, **options: Any) -> Any:
    """What an engine says."""
    return engine().run(problem, Options(**options), Control())


def two_sensors(total: float, limit: float, kind: str = "joint") -> RiskAllocation:
    """The furthest position x between two walls, where a second sensor, nearly the same as the first, has a limit of its own."""
    return problem(
        sense="max", decisions=["x"], lower=-20, upper=20, constraints=None, cost={"decisions": [1]},
        quantities={"map": [[1], [1]], "covariance": [[1.0, 1.0], [1.0, 1.0 + SECOND**2]]},
        chance={"quantities": [[1, 0], [-1, 0], [0, 1]], "limits": [limit] * 3, "names": ["left", "right", "second"]},
        risk={"total": total, "kind": kind},
    )  # fmt: skip


SECOND = 0.01
"""Deviation of the second sensor from the first."""


def risk_of_two_sensors(x: float, limit: float) -> float:
    """The true one, by quadrature."""
    return any_fails_by_quadrature(
        np.array([limit - x, limit + x, limit - x]), np.array([1.0, -1.0, 1.0]), np.array([1e-12, 1e-12, SECOND])
    )
