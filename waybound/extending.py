"""Everything that a package outside waybound imports to add to it: contracts, building blocks and the registries.

Each registry has a group of entry points of its own, which docs/extending.md lists with all names of this module. How each thing is
written, with an example that runs: ``docs/adding-*.md``.

What stands here keeps its name and meaning within a minor version; other modules may move.
"""

from .formulations.checking.evidence_numbers import numbers as _evidence_numbers
from .formulations.evaluation import (
    Check as Check,
    Checklist as Checklist,
    Evaluation as Evaluation,
    Violation as Violation,
    judge as judge,
)
from .formulations.evidence import (
    CHECKERS as CHECKERS,
    ENDLESS as ENDLESS,
    Evidence as Evidence,
    EvidenceChecker as EvidenceChecker,
    Guarantee as Guarantee,
    Reason as Reason,
)
from .formulations.forms import FORMS as FORMS, Form as Form
from .formulations.problem import PROBLEMS as PROBLEMS, Problem as Problem, refuse_settings as refuse_settings
from .formulations.programs.circuits import Circuit as Circuit
from .formulations.programs.compiled import Compiled as Compiled
from .formulations.programs.cones import Cones as Cones
from .formulations.programs.exactness import Exactness as Exactness, Link as Link
from .formulations.programs.program import (
    CIRCUITS as CIRCUITS,
    CONES as CONES,
    INTEGERS as INTEGERS,
    LINEAR as LINEAR,
    QUADRATIC as QUADRATIC,
    FurtherLevel as FurtherLevel,
    Program as Program,
    Rows as Rows,
    Variables as Variables,
)
from .formulations.programs.reductions.linear_products import LINEAR_PRODUCTS as LINEAR_PRODUCTS
from .formulations.programs.reductions.minimisation import MINIMISATION as MINIMISATION
from .formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS as ONE_SIDED_ROWS
from .formulations.programs.reductions.reduction import Chain as Chain, Irreducible as Irreducible, Reduction as Reduction, Step as Step
from .formulations.programs.reductions.whole_numbers import WHOLE_NUMBERS as WHOLE_NUMBERS
from .formulations.programs.rows import rows as rows
from .formulations.programs.size import ProgramSize as ProgramSize
from .formulations.routing.problem import RoutingProblem as RoutingProblem
from .formulations.routing.routes import Route as Route, Routes as Routes
from .formulations.sata.bottleneck_sata import BottleneckSATA as BottleneckSATA
from .formulations.sata.decided_elements import DecidedElements as DecidedElements
from .formulations.sata.max_min_lp import MaxMinLP as MaxMinLP
from .formulations.sata.selections import Selection as Selection
from .formulations.sata.submodular_selection import SubmodularSelection as SubmodularSelection
from .formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA as WinnerTakesAllSATA
from .formulations.stop import NEVER as NEVER, Stop as Stop, Stopped as Stopped
from .formulations.tolerance import allowance as allowance, same as same, widening as widening
from .formulations.verified_bounds import proved as proved, verified_bound as verified_bound
from .heuristics.heuristic import HEURISTICS as HEURISTICS, Context as Context, Heuristic as Heuristic, Outcome as Outcome
from .instances.declared import Declared as Declared, NameOf as NameOf
from .instances.document import dump_json as dump_json, fields as fields, parse_json as parse_json
from .instances.errors import (
    InputError as InputError,
    MissingPackageError as MissingPackageError,
    UnsupportedError as UnsupportedError,
    UsageError as UsageError,
    WayboundError as WayboundError,
)
from .instances.formats import FORMATS as FORMATS, Format as Format
from .instances.generators import GENERATORS as GENERATORS, Draw as Draw, Generator as Generator
from .instances.generators.settings import Setting as Setting
from .instances.instance import Instance as Instance, digest as digest
from .instances.kinds import KINDS as KINDS, Kind as Kind, kind_of as kind_of
from .instances.parts import Axis as Axis, Choice as Choice, Flags as Flags, Numbers as Numbers, Whole as Whole, Wholes as Wholes
from .instances.registry import Registry as Registry
from .instances.routing.instance import Energy as Energy, RoutingInstance as RoutingInstance, Sites as Sites, VehicleType as VehicleType
from .instances.routing.travel import Travel as Travel
from .instances.sata.constraints import Constraint as Constraint, LimitRows as LimitRows, LinearConstraint as LinearConstraint
from .instances.sata.selection import (
    CONSTRAINTS as CONSTRAINTS,
    SET_FUNCTIONS as SET_FUNCTIONS,
    JsonPart as JsonPart,
    SelectionInstance as SelectionInstance,
)
from .instances.sata.sensing_graph import SensingGraph as SensingGraph
from .instances.sata.set_functions import (
    AT_ENTRY as AT_ENTRY,
    AT_ITEM as AT_ITEM,
    IN_MATRIX as IN_MATRIX,
    ItemFunction as ItemFunction,
    ItemWeights as ItemWeights,
    SetFunction as SetFunction,
)
from .instances.worlds import WORLDS as WORLDS, World as World, WorldKind as WorldKind
from .reports.campaigns.frames import EXPORTERS as EXPORTERS, Exporter as Exporter
from .reports.campaigns.running import WORKERS as WORKERS
from .reports.missions.mission import MISSIONS as MISSIONS, Decision as Decision, Mission as Mission, Scene as Scene
from .reports.pages import PAGES as PAGES, AnswerBlocks as AnswerBlocks
from .reports.plots import PLOTS as PLOTS, Plot as Plot
from .reports.plots.drawing import as_plot as as_plot, bars as bars
from .reports.studies.findings import Finding as Finding
from .reports.studies.study import (
    STUDIES as STUDIES,
    Fault as Fault,
    Figure as Figure,
    Report as Report,
    Study as Study,
    StudySetting as StudySetting,
    study as study,
)
from .reports.tables import TABLES as TABLES, Tables as Tables
from .reports.tables.table import Column as Column, Table as Table
from .solvers.backend import (
    BACKENDS as BACKENDS,
    Control as Control,
    Engine as Engine,
    LevelClaim as LevelClaim,
    Options as Options,
    RawResult as RawResult,
)
from .solvers.bounds import BOUNDS as BOUNDS, BoundMethod as BoundMethod
from .solvers.linear_programs import LinearPrograms as LinearPrograms
from .solvers.program_backend import ProgramBackend as ProgramBackend

evidence_numbers = _evidence_numbers
__all__ = sorted(name for name in globals() if not name.startswith("_") and name != "annotations")
