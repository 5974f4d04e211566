"""waybound: routing and assignment for vehicle fleets and robot teams, with answers that carry their own evidence.

Everything public is imported on first use, so that ``import waybound`` loads no solver, no pandas and no scipy.
"""

import importlib
import sys
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ._version import __version__ as __version__

try:
    from .formulations import plotting
except ModuleNotFoundError as fault:
    if fault.name != "waybound.formulations":
        raise
    raise ModuleNotFoundError(
        "this checkout of waybound has files where links to its folders should be (waybound/formulations and four more).\n"
        "Where links are allowed, clone again with: git clone -c core.symlinks=true ...\n"
        "Elsewhere, install it and start Python outside of the checkout: python -m pip install ."
    ) from None

if TYPE_CHECKING:
    from .api import bound as bound, check as check, explain as explain, generate as generate, judge as judge, read as read, solve as solve
    from .formulations.auctions.balanced_partition import BalancedPartition as BalancedPartition
    from .formulations.auctions.bin_assignment import BinAssignment as BinAssignment
    from .formulations.auctions.generalised_assignment import GeneralisedAssignment as GeneralisedAssignment
    from .formulations.auctions.joint_assignment import JointAssignment as JointAssignment
    from .formulations.auctions.orchard_day import OrchardDay as OrchardDay
    from .formulations.auctions.room_exploration import RoomExploration as RoomExploration
    from .formulations.auctions.task_allocation import TaskAllocation as TaskAllocation
    from .formulations.certificate import Certificate as Certificate
    from .formulations.evaluation import Check as Check, Evaluation as Evaluation, Violation as Violation
    from .formulations.evidence import Evidence as Evidence, Guarantee as Guarantee
    from .formulations.problem import Problem as Problem
    from .formulations.programs.compiled import Compiled as Compiled
    from .formulations.programs.exactness import Exactness as Exactness
    from .formulations.programs.program import Program as Program, Rows as Rows, Variables as Variables
    from .formulations.risk.allocations import Allocation as Allocation
    from .formulations.risk.risk_allocation import RiskAllocation as RiskAllocation
    from .formulations.risk.risky_path import RiskyPath as RiskyPath
    from .formulations.risk.uncertain_path import UncertainPath as UncertainPath
    from .formulations.routing.named_problems import (
        cvrp as cvrp,
        makespan_orienteering as makespan_orienteering,
        mdvrp as mdvrp,
        min_cost_vrp as min_cost_vrp,
        min_makespan_vrp as min_makespan_vrp,
        orienteering as orienteering,
        pdptw as pdptw,
        recharging_vrp as recharging_vrp,
        team_orienteering as team_orienteering,
        tsp as tsp,
        vrptw as vrptw,
    )
    from .formulations.routing.objective import (
        LatestReturn as LatestReturn,
        LongestRoute as LongestRoute,
        Makespan as Makespan,
        Objective as Objective,
        Penalties as Penalties,
        Reward as Reward,
        TotalCost as TotalCost,
        TotalDuration as TotalDuration,
        Vehicles as Vehicles,
    )
    from .formulations.routing.problem import RoutingProblem as RoutingProblem
    from .formulations.routing.routes import Route as Route, Routes as Routes
    from .formulations.sata.bottleneck_sata import BottleneckSATA as BottleneckSATA
    from .formulations.sata.max_min_lp import MaxMinLP as MaxMinLP
    from .formulations.sata.selections import Selection as Selection
    from .formulations.sata.submodular_selection import SubmodularSelection as SubmodularSelection
    from .formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA as WinnerTakesAllSATA
    from .formulations.solution import Solution as Solution
    from .heuristics.auctions.relay_steps.steiner_points import (
        RelayTree as RelayTree,
        fermat_weber as fermat_weber,
        fewest_relays as fewest_relays,
        spanning_tree_relays as spanning_tree_relays,
    )
    from .heuristics.sata.submodularity import check_submodular as check_submodular
    from .instances.auctions.assignment import AssignmentInstance as AssignmentInstance
    from .instances.auctions.exploration_map import ExplorationMap as ExplorationMap
    from .instances.auctions.generalised_assignment import GeneralisedAssignmentInstance as GeneralisedAssignmentInstance
    from .instances.auctions.orchard_jobs import OrchardJobs as OrchardJobs
    from .instances.auctions.robot_tasks import RobotTasks as RobotTasks
    from .instances.errors import (
        CheckFailedError as CheckFailedError,
        InputError as InputError,
        MissingPackageError as MissingPackageError,
        NoAnswerError as NoAnswerError,
        SearchFailedError as SearchFailedError,
        UnsupportedError as UnsupportedError,
        UsageError as UsageError,
        WayboundError as WayboundError,
    )
    from .instances.risk.allocation import RiskAllocationInstance as RiskAllocationInstance
    from .instances.risk.risky_graph import RiskyGraph as RiskyGraph
    from .instances.risk.uncertain_graph import UncertainGraph as UncertainGraph
    from .instances.routing.instance import (
        Energy as Energy,
        Group as Group,
        RoutingInstance as RoutingInstance,
        Shipment as Shipment,
        Sites as Sites,
        VehicleType as VehicleType,
    )
    from .instances.routing.travel import Travel as Travel
    from .instances.sata.constraints import Cardinality as Cardinality, Knapsack as Knapsack, PartitionMatroid as PartitionMatroid
    from .instances.sata.selection import SelectionInstance as SelectionInstance
    from .instances.sata.sensing_graph import SensingGraph as SensingGraph
    from .instances.sata.set_functions import (
        Coverage as Coverage,
        DenseFacilityLocation as DenseFacilityLocation,
        FacilityLocation as FacilityLocation,
        UserFunction as UserFunction,
    )
    from .reports.campaigns.frames import results as results
    from .reports.comparison import Comparison as Comparison, compare as compare
    from .reports.missions.running import run as run
    from .reports.plots.history import plot_history as plot_history
    from .reports.tables.listing import list_heuristics, list_solvers
    from .solving.explaining import Explanation as Explanation

    heuristics, solvers = list_heuristics, list_solvers

_MODULES = {
    module: tuple(names.split())
    for module, names in {
        "api": "bound check explain generate judge read solve",
        "formulations.auctions.balanced_partition": "BalancedPartition",
        "formulations.auctions.bin_assignment": "BinAssignment",
        "formulations.auctions.generalised_assignment": "GeneralisedAssignment",
        "formulations.auctions.joint_assignment": "JointAssignment",
        "formulations.auctions.orchard_day": "OrchardDay",
        "formulations.auctions.room_exploration": "RoomExploration",
        "formulations.auctions.task_allocation": "TaskAllocation",
        "formulations.certificate": "Certificate",
        "formulations.evaluation": "Check Evaluation Violation",
        "formulations.evidence": "Evidence Guarantee",
        "formulations.problem": "Problem",
        "formulations.programs.compiled": "Compiled",
        "formulations.programs.exactness": "Exactness",
        "formulations.programs.program": "Program Rows Variables",
        "formulations.risk.allocations": "Allocation",
        "formulations.risk.risk_allocation": "RiskAllocation",
        "formulations.risk.risky_path": "RiskyPath",
        "formulations.risk.uncertain_path": "UncertainPath",
        "formulations.routing.named_problems": (
            "cvrp makespan_orienteering mdvrp min_cost_vrp min_makespan_vrp orienteering pdptw recharging_vrp team_orienteering tsp vrptw"
        ),
        "formulations.routing.objective": "LatestReturn LongestRoute Makespan Objective Penalties Reward TotalCost TotalDuration Vehicles",
        "formulations.routing.problem": "RoutingProblem",
        "formulations.routing.routes": "Route Routes",
        "formulations.sata.bottleneck_sata": "BottleneckSATA",
        "formulations.sata.max_min_lp": "MaxMinLP",
        "formulations.sata.selections": "Selection",
        "formulations.sata.submodular_selection": "SubmodularSelection",
        "formulations.sata.winner_takes_all_sata": "WinnerTakesAllSATA",
        "formulations.solution": "Solution",
        "heuristics.auctions.relay_steps.steiner_points": "RelayTree fermat_weber fewest_relays spanning_tree_relays",
        "heuristics.sata.submodularity": "check_submodular",
        "instances.auctions.assignment": "AssignmentInstance",
        "instances.auctions.exploration_map": "ExplorationMap",
        "instances.auctions.generalised_assignment": "GeneralisedAssignmentInstance",
        "instances.auctions.orchard_jobs": "OrchardJobs",
        "instances.auctions.robot_tasks": "RobotTasks",
        "instances.errors": (
            "CheckFailedError InputError MissingPackageError NoAnswerError SearchFailedError UnsupportedError UsageError WayboundError"
        ),
        "instances.risk.allocation": "RiskAllocationInstance",
        "instances.risk.risky_graph": "RiskyGraph",
        "instances.risk.uncertain_graph": "UncertainGraph",
        "instances.routing.instance": "Energy Group RoutingInstance Shipment Sites VehicleType",
        "instances.routing.travel": "Travel",
        "instances.sata.constraints": "Cardinality Knapsack PartitionMatroid",
        "instances.sata.selection": "SelectionInstance",
        "instances.sata.sensing_graph": "SensingGraph",
        "instances.sata.set_functions": "Coverage DenseFacilityLocation FacilityLocation UserFunction",
        "reports.campaigns.frames": "results",
        "reports.comparison": "Comparison compare",
        "reports.missions.running": "run",
        "reports.plots.history": "plot_history",
        "solving.explaining": "Explanation",
    }.items()
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}

_TABLES = {"solvers": "list_solvers", "heuristics": "list_heuristics"}
"""Names that are a package and, called, a table of what it holds: ``wb.solvers(problem)``."""

__all__ = sorted(["__version__", *_WHERE, *_TABLES])


class _Table(ModuleType):
    """A package that answers a call with the table of its entries."""

    def __call__(self, problem: Any = None) -> Any:
        listing = importlib.import_module("waybound.reports.tables.listing")
        return getattr(listing, _TABLES[self.__name__.rpartition(".")[2]])(problem)


class _Face(ModuleType):
    """Keeps ``solvers`` and ``heuristics`` callable: the import system binds the packages to these names whenever one is imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _TABLES and isinstance(value, ModuleType):
            value.__class__ = _Table
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Face


def _later(module: str, name: str) -> Callable[..., Any]:
    """A function of a module that is imported when it is called."""
    return lambda *given, **options: getattr(importlib.import_module(f"waybound.reports.{module}"), name)(*given, **options)


plotting.draw, plotting.page = _later("plots", "plot_solution"), _later("pages.answers", "answer_html")
plotting.streets, plotting.tell = _later("pages.routing.streets", "street_map"), _later("tables.facts", "problem_table")


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        value = getattr(importlib.import_module(f"waybound.{_WHERE[name]}"), name)
        globals()[name] = value
        return value
    if name in _TABLES:
        return importlib.import_module(f"waybound.{name}")
    if name.startswith("__"):  # asked for by whoever inspects a module
        raise AttributeError(f"module 'waybound' has no attribute {name!r}")
    from .instances.suggestions import did_you_mean

    raise AttributeError(f"module 'waybound' has no attribute {name!r}{did_you_mean(name, __all__)}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
