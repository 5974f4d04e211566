"""Generation of instances by name of the recipe."""

from typing import Any

import numpy as np

from .generators import GENERATORS, Draw
from .instance import Instance
from .limits import check_whole


def generate(kind: str, seed: int, **settings: Any) -> Instance:
    """A new instance of the generator ``kind``; the same seed and settings give the same instance, on every machine.

    Settings may be text, as on the command line; dashes and underscores are one. Raises UsageError for an unknown generator or setting, and
    for values out of range.
    """
    recipe = GENERATORS[kind]
    check_whole("seed", seed, option="the seed")
    values = recipe.values(settings)
    return recipe.make(Draw(np.random.Generator(np.random.PCG64(int(seed)))), {**values, "seed": int(seed)})
