"""waybound: routing and assignment for vehicle fleets and robot teams, with answers that carry their own evidence.

Everything public is imported on first use, so that ``import waybound`` loads no solver, no pandas and no scipy.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ._version import __version__ as __version__

if TYPE_CHECKING:
    from .api import bound, check, explain, generate, read
    from .formulations.certificate import Certificate
    from .formulations.evaluation import Check, Evaluation, Violation
    from .formulations.evidence import Evidence, Guarantee
    from .formulations.exactness import Exactness
    from .formulations.objective import LongestRoute, Makespan, Objective, Reward, TotalCost, Vehicles
    from .formulations.problem import Problem
    from .formulations.problems.bottleneck_sata import BottleneckSATA
    from .formulations.problems.max_min_lp import MaxMinLP
    from .formulations.problems.routing import RoutingProblem
    from .formulations.problems.submodular_selection import SubmodularSelection, UserFunction
    from .formulations.problems.winner_takes_all_sata import WinnerTakesAllSATA
    from .formulations.program import Program, Rows, Variables
    from .formulations.routes import Route, Routes
    from .formulations.selections import Selection
    from .formulations.solution import Solution
    from .heuristics.submodularity import check_submodular
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
    from .instances.selection import (
        Cardinality,
        Coverage,
        DenseFacilityLocation,
        FacilityLocation,
        Knapsack,
        PartitionMatroid,
        SelectionInstance,
    )
    from .instances.sensing import SensingGraph
    from .instances.travel import Travel
    from .reports.missions.running import run
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
    "formulations.problems.bottleneck_sata": ("BottleneckSATA",),
    "formulations.problems.max_min_lp": ("MaxMinLP",),
    "formulations.problems.routing": ("RoutingProblem",),
    "formulations.problems.submodular_selection": ("SubmodularSelection", "UserFunction"),
    "formulations.problems.winner_takes_all_sata": ("WinnerTakesAllSATA",),
    "formulations.program": ("Program", "Rows", "Variables"),
    "formulations.routes": ("Route", "Routes"),
    "formulations.selections": ("Selection",),
    "formulations.solution": ("Solution",),
    "heuristics.submodularity": ("check_submodular",),
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
    "instances.selection": (
        "Cardinality",
        "Coverage",
        "DenseFacilityLocation",
        "FacilityLocation",
        "Knapsack",
        "PartitionMatroid",
        "SelectionInstance",
    ),
    "instances.sensing": ("SensingGraph",),
    "instances.travel": ("Travel",),
    "reports.missions.running": ("run",),
    "solvers.explaining": ("Explanation",),
    "solvers.solve": ("solve",),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}

_TABLES = {"solvers": "solver_table", "heuristics": "heuristic_table"}
"""Names that are a package and, called, a table of what it holds: ``wb.solvers(problem)``."""

__all__ = [
    "BottleneckSATA",
    "Cardinality",
    "Certificate",
    "Check",
    "CheckFailedError",
    "Coverage",
    "DenseFacilityLocation",
    "Energy",
    "Evaluation",
    "Evidence",
    "Exactness",
    "Explanation",
    "FacilityLocation",
    "Guarantee",
    "InputError",
    "Knapsack",
    "LongestRoute",
    "Makespan",
    "MaxMinLP",
    "MissingPackageError",
    "NoAnswerError",
    "Objective",
    "PartitionMatroid",
    "Problem",
    "Program",
    "Reward",
    "Route",
    "Routes",
    "RoutingInstance",
    "RoutingProblem",
    "Rows",
    "Selection",
    "SelectionInstance",
    "SensingGraph",
    "Sites",
    "Solution",
    "SubmodularSelection",
    "TotalCost",
    "Travel",
    "UnsupportedError",
    "UsageError",
    "UserFunction",
    "Variables",
    "VehicleType",
    "Vehicles",
    "Violation",
    "WayboundError",
    "WinnerTakesAllSATA",
    "__version__",
    "bound",
    "check",
    "check_submodular",
    "explain",
    "generate",
    "heuristics",
    "read",
    "run",
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
