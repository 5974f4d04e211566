"""Whole days of small orchards, in which each group has a route of its own."""

from collections.abc import Mapping
from typing import Any

from ...generators import GENERATORS, Draw, Generator, Setting
from ..orchard_jobs import OrchardJobs
from ..orchard_rules import ORCHARD, draw_routes, orchard_rules

SMALL = {"rows": 2, "columns": 6, "robots": 2, "groups": 2, "bins-per-cell": 1}
"""Settings that differ from the world's defaults: whole days of larger orchards are too long for an optimum."""

DAY: Mapping[str, Setting] = {
    **{
        key: Setting(SMALL.get(key, setting.default), setting.help, setting.type, setting.least, setting.most, setting.choices)
        for key, setting in ORCHARD.items()
        if key not in ("pickers", "relocation")
    },
    "name": Setting("orchard-day", "name of the instance", str),
}


def make(draw: Draw, values: Mapping[str, Any]) -> OrchardJobs:
    """The day: all cells dealt out to the groups, robots at the repository, a bin before each group."""
    rules = orchard_rules({**values, "pickers": 1, "relocation": "nearest"})
    day = OrchardJobs.of_routes(rules, draw_routes(rules, draw), values["name"])
    object.__setattr__(day, "format", "generated")
    return day


GENERATORS.enter(Generator("orchard-day", "whole days of small orchards, for their optimum", DAY, make))
