"""Base classes of risk elements.

Source: Xiao (2019), chapter 3; docs/formulations/risky-path.md#risk-elements.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Hashable
from dataclasses import fields
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..number_arrays import Floats, Integers as Indices, reals


class Space(Protocol):
    """The part of a graph that risk elements read."""

    @property
    def num_states(self) -> int: ...
    @property
    def positions(self) -> Floats | None: ...


class RiskElement(ABC):
    """One source of risk.

    ``kind``: its name in files. ``category``: ``locale``, ``action`` or ``traverse``. ``label``: its name for people.
    ``rates``: the fields that are numbers of at least 0.
    """

    kind: ClassVar[str]
    category: ClassVar[str]
    rates: ClassVar[tuple[str, ...]] = ()
    label: str

    def __post_init__(self) -> None:
        for key in self.rates:
            what = f"the rate of {self.label}" if key == "rate" and len(self.rates) == 1 else f"{key} of {self.label}"
            object.__setattr__(self, key, rate_of(what, getattr(self, key)))

    def check(self, space: Space) -> None:
        """Raise InputError where it does not fit the states, or is no probability; by default where these have no places."""
        placed(self, space)

    def parts(self) -> tuple[Any, ...]:
        """All data that risks depend on, for digests: by default the kind and the fields of a dataclass, but for its label."""
        return (self.kind, *(getattr(self, entry.name) for entry in fields(self) if entry.name != "label"))  # type: ignore[arg-type]

    @abstractmethod
    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        """The risk of ``after`` on reaching it from ``state``, reached from ``before``, whatever the path was until then: exact for locale
        and action elements, a lower bound for others. -1 stands for states that the path does not have."""


class MemorylessElement(RiskElement):
    """Depends on at most the last three states: ``least`` is the risk."""


class TraverseElement(RiskElement):
    """Depends on the whole path, through a memory of it that each move carries on."""

    category: ClassVar[str] = "traverse"

    @abstractmethod
    def begin(self, space: Space, state: int) -> tuple[Hashable, float]:
        """Memory and risk at the first state."""

    @abstractmethod
    def step(self, space: Space, memory: Any, state: int, after: int) -> tuple[Hashable, float]:
        """Memory and risk after the move from ``state`` to ``after``."""

    def no_worse(self, memory: Any, other: Any) -> bool:
        """True if every continuation of a path is at most as risky with ``memory`` as with ``other``."""
        return bool(memory == other)

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        return np.zeros(len(after))


def probabilities(what: str, values: ArrayLike) -> Floats:
    """``values`` as an array; raises InputError for the first one outside [0, 1]."""
    array = reals(what, values)
    wrong = ~((array >= 0.0) & (array <= 1.0))
    if wrong.any():
        at = np.argwhere(wrong)[0].tolist()
        where = ", ".join(f"{axis} {k + 1}" for axis, k in zip(("row", "column"), at, strict=False))
        raise InputError(f"{what} must lie in [0, 1]", "out-of-range", found=f"{array[tuple(at)]:g} in {where}" if where else f"{array:g}")
    return array


def rate_of(what: str, value: float) -> float:
    """``value`` as a number of at least 0; raises InputError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < math.inf:
        raise InputError(f"{what} must be a number of at least 0", "out-of-range", found=str(value)[:40])
    return float(value)


def placed(element: RiskElement, space: Space) -> Floats:
    """Places of the states; raises InputError where they have none."""
    if space.positions is None:
        raise InputError(f"risk element {element.label} needs positions of the states", "missing")
    return space.positions
