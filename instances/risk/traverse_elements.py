"""Risk elements of category traverse: what a path has collected, how far it went, and how its tether runs.

Source: Xiao (2019), section 3.3.3; docs/formulations/risky-path.md#risk-elements.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .element import Space, TraverseElement, placed, probabilities
from .elements import Floats, Indices
from .tether import Contacts, Tether


@dataclass(frozen=True, eq=False)
class CollectedRisk(TraverseElement):
    """The risk of what the path has collected, such as mud at the wheels or dust on a lens.

    ``collects``, shape (states,): where one more is collected, once the state is passed. ``risk``, shape (levels, states): row k: the risk
    of each state with k collected before it; the last row stands for all beyond.
    """

    kind: ClassVar[str] = "collected"
    collects: NDArray[np.bool_]
    risk: Floats
    label: str = "collected"

    def __post_init__(self) -> None:
        object.__setattr__(self, "risk", probabilities(f"risks of {self.label}", self.risk))
        object.__setattr__(self, "collects", np.asarray(self.collects, dtype=bool))
        if self.risk.ndim != 2 or not len(self.risk):
            raise InputError(f"risks of {self.label} must be one row a level", "wrong-shape", found=f"shape {self.risk.shape}")
        object.__setattr__(self, "_grows", bool((np.diff(self.risk, axis=0) >= 0).all()))

    def check(self, space: Space) -> None:
        for what, columns in (("places", self.collects.shape), ("risks", self.risk.shape[1:])):
            if columns != (space.num_states,):
                raise InputError(
                    f"{what} of {self.label} must be one a state", "wrong-shape", expected=str(space.num_states), found=str(columns)
                )

    def begin(self, space: Space, state: int) -> tuple[int, float]:
        return self.step(space, 0, -1, state)

    def step(self, space: Space, memory: int, state: int, after: int) -> tuple[int, float]:
        return min(memory + bool(self.collects[after]), len(self.risk) - 1), float(self.risk[memory, after])

    def no_worse(self, memory: int, other: int) -> bool:
        return memory <= other if self._grows else memory == other  # type: ignore[attr-defined]

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        return np.asarray(self.risk.min(axis=0)[after])


@dataclass(frozen=True, eq=False)
class TravelledRisk(TraverseElement):
    """The risk of the way travelled so far, as a battery has it: ``1 - exp(-rate * (way - free))`` at each state beyond ``free``.

    ``rate`` is per unit of length, ``free`` a length.
    """

    kind: ClassVar[str] = "travelled"
    rates: ClassVar[tuple[str, ...]] = ("rate", "free")
    rate: float
    free: float = 0.0
    label: str = "travelled"

    def begin(self, space: Space, state: int) -> tuple[float, float]:
        return 0.0, 0.0

    def step(self, space: Space, memory: float, state: int, after: int) -> tuple[float, float]:
        at = placed(self, space)
        way = memory + math.dist(at[state], at[after])
        return way, -math.expm1(-self.rate * max(0.0, way - self.free))

    def no_worse(self, memory: float, other: float) -> bool:
        return memory <= other


@dataclass(frozen=True, eq=False)
class TetherRisk(TraverseElement):
    """The risk of a tether: ``length_rate`` times its length, and ``contact_rate`` times its contacts, each 1 at most.

    ``length_rate`` is per unit of length, ``contact_rate`` per contact.
    """

    kind: ClassVar[str] = "tether"
    rates: ClassVar[tuple[str, ...]] = ("length_rate", "contact_rate")
    tether: Tether
    length_rate: float = 0.0
    contact_rate: float = 0.03
    label: str = "tether"

    def check(self, space: Space) -> None:
        if placed(self, space).shape[1] != 2:
            raise InputError(f"{self.label} bends in the plane: states need positions of two numbers", "unsupported")

    def parts(self) -> tuple[Any, ...]:
        t = self.tether
        return (self.kind, t.reel, t.obstacles, t.spacing, self.length_rate, self.contact_rate)

    def _risk(self, contacts: Contacts | None, at: Sequence[float]) -> float:
        if contacts is None:
            return 1.0
        long = min(1.0, self.length_rate * self.tether.length(contacts, at))
        return long + min(1.0, self.contact_rate * (len(contacts) - 1)) * (1.0 - long)

    def begin(self, space: Space, state: int) -> tuple[Contacts | None, float]:
        at = placed(self, space)[state].tolist()
        contacts = self.tether.begun(at)
        return contacts, self._risk(contacts, at)

    def step(self, space: Space, memory: Contacts | None, state: int, after: int) -> tuple[Contacts | None, float]:
        positions = placed(self, space)
        at = positions[after].tolist()
        contacts = None if memory is None else self.tether.moved(memory, positions[state].tolist(), at)
        return contacts, self._risk(contacts, at)

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        straight = np.linalg.norm(placed(self, space)[after] - self.tether.reel, axis=-1)
        return np.asarray(np.minimum(1.0, self.length_rate * straight * (1.0 - 1e-12)))


class FunctionRisk(TraverseElement):
    """A user's function of the whole path so far: from a tuple of states, the last one new, to its risk.

    ``label``: stands for the function in digests: another function needs another label.
    """

    kind: ClassVar[str] = "function"

    def __init__(self, function: Callable[[tuple[int, ...]], float], label: str) -> None:
        self.function, self.label = function, label

    def check(self, space: Space) -> None:
        if not callable(self.function):
            raise InputError(f"risk element {self.label} must be a function of paths", found=str(type(self.function).__name__))

    def parts(self) -> tuple[Any, ...]:
        return (self.kind, self.label)

    def begin(self, space: Space, state: int) -> tuple[tuple[int, ...], float]:
        return self.step(space, (), -1, state)

    def step(self, space: Space, memory: tuple[int, ...], state: int, after: int) -> tuple[tuple[int, ...], float]:
        path = (*memory, after)
        risk = float(self.function(path))
        if not 0.0 <= risk <= 1.0:
            raise InputError(f"the risk of {self.label} must lie in [0, 1]", "out-of-range", found=f"{risk:g} at path {path}")
        return path, risk
