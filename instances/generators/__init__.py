"""Seeded generators of instances: each module registers one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import UsageError
from ..instance import Instance
from ..registry import Registry
from ..suggestions import did_you_mean
from .draw import Draw as Draw, Flags as Flags, Floats as Floats, Integers as Integers
from .settings import Setting as Setting


@dataclass(frozen=True)
class Generator:
    """A recipe for instances.

    Parameters
    ----------
    name : str
        Used with ``waybound generate``.
    summary : str
        One line.
    settings : mapping of Setting
        What ``--set`` takes.
    make : callable
        From random draws and one value for each setting to the instance.
    """

    name: str
    summary: str
    settings: Mapping[str, Setting]
    make: Callable[[Draw, Mapping[str, Any]], Instance]

    def values(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """A value for each setting; UsageError for one that does not exist or is out of range."""
        named = {key.replace("_", "-"): value for key, value in given.items()}
        strange = next((key for key in named if key not in self.settings), None)
        if strange is not None:
            known = f"{', '.join(self.settings)}{did_you_mean(strange, self.settings)}"
            raise UsageError(f"{self.name} has no setting {strange!r}; it takes {known}", "unknown-name")
        return {key: setting.value(key, named[key]) if key in named else setting.default for key, setting in self.settings.items()}


GENERATORS: Registry[Generator] = Registry("generator", "waybound.instances.*.generators", group="waybound.generators")
