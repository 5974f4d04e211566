"""Everything that a package outside waybound imports to add to it: contracts, building blocks and the registries.

Each registry has a group of entry points of its own: ``waybound.solvers``, ``waybound.heuristics``, ``waybound.forms``,
``waybound.formats``, ``waybound.problems``, ``waybound.bounds``, ``waybound.checkers``, ``waybound.generators``, ``waybound.kinds``,
``waybound.set_functions``, ``waybound.constraints``. An entry point names a module that registers itself on import, or the entry. How
each is written, with an example: ``docs/adding-*.md``; set functions and constraints, which need an entry for files only:
``docs/selection.md``.

What stands here keeps its name and meaning within a minor version; other modules may move.
"""

from __future__ import annotations

from .formulations.certificate import verified_bound
from .formulations.evaluation import Check, Evaluation, Violation, judge
from .formulations.evidence import CHECKERS, Evidence, EvidenceChecker, Guarantee
from .formulations.forms import FORMS, Form
from .formulations.problem import PROBLEMS, Problem
from .formulations.programs.compiled import Compiled
from .formulations.programs.cones import Cones
from .formulations.programs.exactness import Exactness
from .formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC, Program, Rows, Variables
from .formulations.programs.rows import rows
from .formulations.stop import NEVER, Stop, Stopped
from .formulations.tolerance import allowance, same, widening
from .heuristics.heuristic import HEURISTICS, Heuristic, Outcome, Setting
from .instances.document import dump_json, fields, parse_json
from .instances.errors import InputError, MissingPackageError, UnsupportedError, UsageError, WayboundError
from .instances.formats import FORMATS, Format
from .instances.generators import GENERATORS, Generator
from .instances.instance import Instance, digest
from .instances.kinds import KINDS, Kind
from .instances.registry import Registry
from .instances.selection.constraints import Constraint, LimitRows, LinearConstraint
from .instances.selection.functions import AT_ENTRY, AT_ITEM, ItemFunction, ItemWeights, SetFunction
from .instances.selection.json_kind import CONSTRAINTS, SET_FUNCTIONS, JsonPart
from .solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from .solvers.bounds import BOUNDS, BoundMethod
from .solvers.linear_programs import LinearPrograms
from .solvers.program_backend import ProgramBackend

__all__ = [
    "AT_ENTRY",
    "AT_ITEM",
    "BACKENDS",
    "BOUNDS",
    "CHECKERS",
    "CONES",
    "CONSTRAINTS",
    "FORMATS",
    "FORMS",
    "GENERATORS",
    "HEURISTICS",
    "INTEGERS",
    "KINDS",
    "LINEAR",
    "NEVER",
    "PROBLEMS",
    "QUADRATIC",
    "SET_FUNCTIONS",
    "BoundMethod",
    "Check",
    "Compiled",
    "Cones",
    "Constraint",
    "Control",
    "Engine",
    "Evaluation",
    "Evidence",
    "EvidenceChecker",
    "Exactness",
    "Form",
    "Format",
    "Generator",
    "Guarantee",
    "Heuristic",
    "InputError",
    "Instance",
    "ItemFunction",
    "ItemWeights",
    "JsonPart",
    "Kind",
    "LimitRows",
    "LinearConstraint",
    "LinearPrograms",
    "MissingPackageError",
    "Options",
    "Outcome",
    "Problem",
    "Program",
    "ProgramBackend",
    "RawResult",
    "Registry",
    "Rows",
    "SetFunction",
    "Setting",
    "Stop",
    "Stopped",
    "UnsupportedError",
    "UsageError",
    "Variables",
    "Violation",
    "WayboundError",
    "allowance",
    "digest",
    "dump_json",
    "fields",
    "judge",
    "parse_json",
    "rows",
    "same",
    "verified_bound",
    "widening",
]
