"""Subgradient ascent towards levels that are raised as they are met, so that no value of an answer is needed."""

import math
from collections.abc import Callable

import numpy as np

from ....formulations.stop import Stop
from .arcs import Floats

_MEMORY = 0.7
"""Share of the last direction in the next one (Volgenant and Jonker 1982 use 0.6 to 0.7 over two steps)."""

_SMALLEST_AIM = 1e-11
"""Relative rise at which the ascent gives up aiming higher."""


def ascend(
    look: Callable[[Floats], tuple[float, Floats]], price: Floats, scale: float, most: float, stop: Stop, patience: int = 30
) -> tuple[Floats, float]:
    """The best prices that an ascent from ``price`` meets, and their value: infinite where the first value is, NaN where it came too late.

    ``look`` gives value and subgradient of a concave function; ``scale`` is a small share of what values are made of, such as 1e-3 of the
    dearest move; a value that rises beyond ``most`` rises for ever. Every step aims at a rise above the best value so far; the aim is
    halved after ``patience`` steps without a rise, and widened when it is met.

    Source: level control after Brännlund (1993), Goffin and Kiwiel (1999).
    """
    value, slope = look(price)
    if not math.isfinite(value):
        return price, value
    best, best_price = value, price
    aim, direction, waited = 0.05 * max(abs(best), scale), np.zeros(len(price)), 0
    while not stop.reached() and aim > _SMALLEST_AIM * max(abs(best), scale) and best <= most:
        direction = slope + _MEMORY * direction
        length = float(direction @ direction)
        if length == 0.0:
            break
        price = price + (best + aim - value) / length * direction
        value, slope = look(price)
        if value > best:
            waited = 0 if value > best + 0.1 * aim else waited + 1
            if value > best + 0.5 * aim:
                aim *= 1.5
            best, best_price = value, price
        else:
            waited += 1
        if waited >= patience:
            aim, waited, price, direction = aim / 2.0, 0, best_price, np.zeros(len(price))
            value, slope = look(price)
    return best_price, best
