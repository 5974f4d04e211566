"""Modules that a campaign names: each registers solvers, heuristics, problems or whatever else of its own."""

import importlib
import sys
from collections.abc import Iterable
from pathlib import Path


def import_modules(names: Iterable[str], folder: Path | str) -> None:
    """Import modules, those that are nowhere else from the folder of the campaign.

    Raises ImportError for one that is not there, or that cannot be imported.
    """
    for name in names:
        if str(folder) not in sys.path:
            sys.path.append(str(folder))
        importlib.import_module(name)
