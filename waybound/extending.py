"""Everything that a package outside waybound imports to add to it: contracts, building blocks and the registries.

Each registry has a group of entry points of its own, which docs/extending.md lists with all names of this module. How each thing is
written, with an example that runs: ``docs/adding-*.md``.

What stands here keeps its name and meaning within a minor version; other modules may move.
"""

from __future__ import annotations

from .formulations.checking.evidence_numbers import numbers as evidence_numbers
from .formulations.evaluation import Check, Checklist, Evaluation, Violation, judge
from .formulations.evidence import CHECKERS, ENDLESS, Evidence, EvidenceChecker, Guarantee, Reason
from .formulations.forms import FORMS, Form
from .formulations.problem import PROBLEMS, Problem, refuse_settings
from .formulations.programs.circuits import Circuit
from .formulations.programs.compiled import Compiled
from .formulations.programs.cones import Cones
from .formulations.programs.exactness import Exactness, Link
from .formulations.programs.program import CIRCUITS, CONES, INTEGERS, LINEAR, QUADRATIC, FurtherLevel, Program, Rows, Variables
from .formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from .formulations.programs.reductions.minimisation import MINIMISATION
from .formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS
from .formulations.programs.reductions.reduction import Chain, Irreducible, Reduction, Step
from .formulations.programs.reductions.whole_numbers import WHOLE_NUMBERS
from .formulations.programs.rows import rows
from .formulations.programs.size import ProgramSize
from .formulations.routing.problem import RoutingProblem
from .formulations.routing.routes import Route, Routes
from .formulations.sata.bottleneck_sata import BottleneckSATA
from .formulations.sata.decided_elements import DecidedElements
from .formulations.sata.max_min_lp import MaxMinLP
from .formulations.sata.selections import Selection
from .formulations.sata.submodular_selection import SubmodularSelection
from .formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .formulations.stop import NEVER, Stop, Stopped
from .formulations.tolerance import allowance, same, widening
from .formulations.verified_bounds import proved, verified_bound
from .heuristics.heuristic import HEURISTICS, Context, Heuristic, Outcome
from .instances.declared import Declared, NameOf
from .instances.document import dump_json, fields, parse_json
from .instances.errors import InputError, MissingPackageError, UnsupportedError, UsageError, WayboundError
from .instances.formats import FORMATS, Format
from .instances.generators import GENERATORS, Draw, Generator
from .instances.generators.settings import Setting
from .instances.instance import Instance, digest
from .instances.kinds import KINDS, Kind, kind_of
from .instances.parts import Axis, Choice, Flags, Numbers, Whole, Wholes
from .instances.registry import Registry
from .instances.routing.instance import Energy, RoutingInstance, Sites, VehicleType
from .instances.routing.travel import Travel
from .instances.sata.constraints import Constraint, LimitRows, LinearConstraint
from .instances.sata.selection import CONSTRAINTS, SET_FUNCTIONS, JsonPart, SelectionInstance
from .instances.sata.sensing_graph import SensingGraph
from .instances.sata.set_functions import AT_ENTRY, AT_ITEM, IN_MATRIX, ItemFunction, ItemWeights, SetFunction
from .instances.worlds import WORLDS, World, WorldKind
from .reports.campaigns.frames import EXPORTERS, Exporter
from .reports.campaigns.running import WORKERS
from .reports.missions.mission import MISSIONS, Decision, Mission, Scene
from .reports.pages import PAGES, AnswerBlocks
from .reports.plots import PLOTS, Plot
from .reports.plots.drawing import as_plot, bars
from .reports.studies.findings import Finding
from .reports.studies.study import STUDIES, Fault, Figure, Report, Study, StudySetting, study
from .reports.tables import TABLES, Tables
from .reports.tables.table import Column, Table
from .solvers.backend import BACKENDS, Control, Engine, LevelClaim, Options, RawResult
from .solvers.bounds import BOUNDS, BoundMethod
from .solvers.linear_programs import LinearPrograms
from .solvers.program_backend import ProgramBackend

__all__ = [
    "AT_ENTRY",
    "AT_ITEM",
    "BACKENDS",
    "BOUNDS",
    "CHECKERS",
    "CIRCUITS",
    "CONES",
    "CONSTRAINTS",
    "ENDLESS",
    "EXPORTERS",
    "FORMATS",
    "FORMS",
    "GENERATORS",
    "HEURISTICS",
    "INTEGERS",
    "IN_MATRIX",
    "KINDS",
    "LINEAR",
    "LINEAR_PRODUCTS",
    "MINIMISATION",
    "MISSIONS",
    "NEVER",
    "ONE_SIDED_ROWS",
    "PAGES",
    "PLOTS",
    "PROBLEMS",
    "QUADRATIC",
    "SET_FUNCTIONS",
    "STUDIES",
    "TABLES",
    "WHOLE_NUMBERS",
    "WORKERS",
    "WORLDS",
    "AnswerBlocks",
    "Axis",
    "BottleneckSATA",
    "BoundMethod",
    "Chain",
    "Check",
    "Checklist",
    "Choice",
    "Circuit",
    "Column",
    "Compiled",
    "Cones",
    "Constraint",
    "Context",
    "Control",
    "DecidedElements",
    "Decision",
    "Declared",
    "Draw",
    "Energy",
    "Engine",
    "Evaluation",
    "Evidence",
    "EvidenceChecker",
    "Exactness",
    "Exporter",
    "Fault",
    "Figure",
    "Finding",
    "Flags",
    "Form",
    "Format",
    "FurtherLevel",
    "Generator",
    "Guarantee",
    "Heuristic",
    "InputError",
    "Instance",
    "Irreducible",
    "ItemFunction",
    "ItemWeights",
    "JsonPart",
    "Kind",
    "LevelClaim",
    "LimitRows",
    "LinearConstraint",
    "LinearPrograms",
    "Link",
    "MaxMinLP",
    "MissingPackageError",
    "Mission",
    "NameOf",
    "Numbers",
    "Options",
    "Outcome",
    "Plot",
    "Problem",
    "Program",
    "ProgramBackend",
    "ProgramSize",
    "RawResult",
    "Reason",
    "Reduction",
    "Registry",
    "Report",
    "Route",
    "Routes",
    "RoutingInstance",
    "RoutingProblem",
    "Rows",
    "Scene",
    "Selection",
    "SelectionInstance",
    "SensingGraph",
    "SetFunction",
    "Setting",
    "Sites",
    "Step",
    "Stop",
    "Stopped",
    "Study",
    "StudySetting",
    "SubmodularSelection",
    "Table",
    "Tables",
    "Travel",
    "UnsupportedError",
    "UsageError",
    "Variables",
    "VehicleType",
    "Violation",
    "WayboundError",
    "Whole",
    "Wholes",
    "WinnerTakesAllSATA",
    "World",
    "WorldKind",
    "allowance",
    "as_plot",
    "bars",
    "digest",
    "dump_json",
    "evidence_numbers",
    "fields",
    "judge",
    "kind_of",
    "parse_json",
    "proved",
    "refuse_settings",
    "rows",
    "same",
    "study",
    "verified_bound",
    "widening",
]
