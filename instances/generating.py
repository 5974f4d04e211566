"""Generation of instances by name of the recipe."""

from __future__ import annotations

from typing import Any

import numpy as np

from .generators import GENERATORS, Draw
from .instance import Instance
from .limits import check_whole


def generate(kind: str, seed: int, **settings: Any) -> Instance:
    """A new instance; the same seed and settings give the same instance, on every machine.

    Parameters
    ----------
    kind : str
        A name of ``GENERATORS``: ``solomon``, ``uchoa``, ``sata``, ``coverage``, ...
    seed : int
        At least 0.
    **settings
        The recipe's own; dashes and underscores are one. Values may be text, as on the command line.

    Returns
    -------
    Instance
        Of format ``generated``.

    Raises
    ------
    UsageError
        If the recipe or a setting does not exist, or a value is out of range.
    """
    recipe = GENERATORS[kind]
    check_whole("seed", seed, option="the seed")
    values = recipe.values(settings)
    return recipe.make(Draw(np.random.Generator(np.random.PCG64(int(seed)))), {**values, "seed": int(seed)})
