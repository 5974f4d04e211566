"""Installed packages and their versions, found without importing them."""

import importlib.util
from functools import cache

_FOUND: set[str] = set()


def is_installed(module: str) -> bool:
    """Whether a top-level module can be found; only missing ones are looked for again, since they may be installed meanwhile."""
    if module not in _FOUND and importlib.util.find_spec(module) is not None:
        _FOUND.add(module)
    return module in _FOUND


@cache
def version_of(package: str) -> str:
    """Version of an installed distribution; raises PackageNotFoundError."""
    from importlib.metadata import version

    return version(package)
