"""The normal distribution function and its inverse; scipy is loaded when one is first asked for."""

from typing import Any


def ndtr(x: Any) -> Any:
    """The probability below ``x`` standard deviations, element by element."""
    from scipy.special import ndtr as below

    return below(x)


def ndtri(p: Any) -> Any:
    """Standard deviations below which the probability is ``p``, element by element."""
    from scipy.special import ndtri as quantile

    return quantile(p)
