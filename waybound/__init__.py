"""waybound: routing and assignment for vehicle fleets and robot teams, with answers that carry their own evidence.

Everything public is imported on first use, so that ``import waybound`` loads no solver, no pandas and no scipy.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from .api import bound, check, explain, generate, read
    from .formulations.certificate import Certificate
    from .formulations.evaluation import Check, Evaluation, Violation
    from .formulations.evidence import Evidence, Guarantee
    from .formulations.exactness import Exactness
    from .formulations.objective import LongestRoute, Makespan, Objective, Reward, TotalCost, Vehicles
    from .formulations.problem import Problem
    from .formulations.problems.routing import RoutingProblem
    from .formulations.program import Program, Rows, Variables
    from .formulations.routes import Route, Routes
    from .formulations.solution import Solution
    from .instances.errors import (
        CheckFailedError,
        InputError,
        MissingPackageError,
        NoAnswerError,
        UnsupportedError,
        UsageError,
        WayboundError,
    )
    from .instances.instance import Energy, RoutingInstance, Sites, VehicleType
    from .instances.travel import Travel
    from .solvers.explaining import Explanation
    from .solvers.listing import heuristic_table as heuristics
    from .solvers.listing import solver_table as solvers
    from .solvers.solve import solve

_MODULES = {
    "api": ("bound", "check", "explain", "generate", "read"),
    "formulations.certificate": ("Certificate",),
    "formulations.evaluation": ("Check", "Evaluation", "Violation"),
    "formulations.evidence": ("Evidence", "Guarantee"),
    "formulations.exactness": ("Exactness",),
    "formulations.objective": ("LongestRoute", "Makespan", "Objective", "Reward", "TotalCost", "Vehicles"),
    "formulations.problem": ("Problem",),
    "formulations.problems.routing": ("RoutingProblem",),
    "formulations.program": ("Program", "Rows", "Variables"),
    "formulations.routes": ("Route", "Routes"),
    "formulations.solution": ("Solution",),
    "instances.errors": (
        "CheckFailedError",
        "InputError",
        "MissingPackageError",
        "NoAnswerError",
        "UnsupportedError",
        "UsageError",
        "WayboundError",
    ),
    "instances.instance": ("Energy", "RoutingInstance", "Sites", "VehicleType"),
    "instances.travel": ("Travel",),
    "solvers.explaining": ("Explanation",),
    "solvers.solve": ("solve",),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}

_TABLES = {"solvers": "solver_table", "heuristics": "heuristic_table"}
"""Names that are a package and, called, a table of what it holds: ``wb.solvers(problem)``."""

__all__ = [
    "Certificate",
    "Check",
    "CheckFailedError",
    "Energy",
    "Evaluation",
    "Evidence",
    "Exactness",
    "Explanation",
    "Guarantee",
    "InputError",
    "LongestRoute",
    "Makespan",
    "MissingPackageError",
    "NoAnswerError",
    "Objective",
    "Problem",
    "Program",
    "Reward",
    "Route",
    "Routes",
    "RoutingInstance",
    "RoutingProblem",
    "Rows",
    "Sites",
    "Solution",
    "TotalCost",
    "Travel",
    "UnsupportedError",
    "UsageError",
    "Variables",
    "VehicleType",
    "Vehicles",
    "Violation",
    "WayboundError",
    "__version__",
    "bound",
    "check",
    "explain",
    "generate",
    "heuristics",
    "read",
    "solve",
    "solvers",
]


class _Table(ModuleType):
    """A package that answers a call with the table of its entries."""

    def __call__(self, problem: Any = None) -> Any:
        listing = importlib.import_module("waybound.solvers.listing")
        return getattr(listing, _TABLES[self.__name__.rpartition(".")[2]])(problem)


class _Face(ModuleType):
    """Keeps ``solvers`` and ``heuristics`` callable: the import system binds the packages to these names whenever one is imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _TABLES and isinstance(value, ModuleType):
            value.__class__ = _Table
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Face


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        value = getattr(importlib.import_module(f"waybound.{_WHERE[name]}"), name)
        globals()[name] = value
        return value
    if name in _TABLES:
        return importlib.import_module(f"waybound.{name}")
    raise AttributeError(f"module 'waybound' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
