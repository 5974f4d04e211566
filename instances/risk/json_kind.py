"""Kinds of instances with risk in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from ..kinds import KINDS, Kind, kind_of
from . import allocation_files
from .risky_graph import RiskyGraph
from .uncertain_graph import UncertainGraph

KINDS.add("risk-allocation", Kind("risk-allocation", allocation_files.encode, allocation_files.decode))
KINDS.add(RiskyGraph.kind, kind_of(RiskyGraph))
KINDS.add(UncertainGraph.kind, kind_of(UncertainGraph))
