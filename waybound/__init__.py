"""waybound: routing and assignment for vehicle fleets and robot teams, with answers that carry their own evidence.

Everything public is imported on first use, so that ``import waybound`` loads no solver.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_WHERE = {
    "read": "waybound.instances.reading:read",
}
__all__ = ["__version__"]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        module, attribute = _WHERE[name].split(":")
        return getattr(importlib.import_module(module), attribute)
    raise AttributeError(f"module 'waybound' has no attribute {name!r}")
