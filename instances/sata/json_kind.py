"""Kinds of instances of sensing and selection in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from ..kinds import KINDS, kind_of
from .max_min_lp import MaxMinInstance
from .selection import SelectionInstance
from .sensing_graph import SensingGraph

for model in (MaxMinInstance, SelectionInstance, SensingGraph):
    KINDS.add(model.kind, kind_of(model))
