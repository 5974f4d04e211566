"""Risk elements: what can end a path at a state, as a probability given that nothing did before.

An element depends on the state alone (locale), on it and the two before (action), or on the whole path (traverse). A path's elements are
put together as a list; the risk of the path is ``1 - prod (1 - r)`` over states and elements.

Source: Xiao (2019), chapter 3; docs/formulations/risky-path.md#risk-elements.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..number_arrays import reals, refuse_outside, whole_numbers
from .element import MemorylessElement, Space, placed, probabilities

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LocaleRisk(MemorylessElement):
    """A risk for each state: of its clearance, visibility, terrain, traffic.

    ``risk`` has the shape (states,).
    """

    kind: ClassVar[str] = "locale"
    risk: Floats
    label: str = "locale"
    category: ClassVar[str] = "locale"

    def __post_init__(self) -> None:
        object.__setattr__(self, "risk", probabilities(f"risks of {self.label}", self.risk))

    def check(self, space: Space) -> None:
        if self.risk.shape != (space.num_states,):
            raise InputError(
                f"risks of {self.label} must be one a state", "wrong-shape", expected=str(space.num_states), found=str(self.risk.shape)
            )

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        return self.risk[after]


GROWTHS = ("linear", "exponential")


@dataclass(frozen=True, eq=False)
class LengthRisk(MemorylessElement):
    """The risk of a move of length L: ``rate * L`` (linear, as the source has it) or ``1 - exp(-rate * L)``, which is the same when a move
    is cut into shorter ones.

    ``rate`` is per unit of length, ``growth`` ``linear`` or ``exponential``.
    """

    kind: ClassVar[str] = "length"
    rates: ClassVar[tuple[str, ...]] = ("rate",)
    rate: float
    growth: str = "exponential"
    label: str = "length"
    category: ClassVar[str] = "action"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.growth not in GROWTHS:
            raise InputError(f"the growth of {self.label} is unknown", "unknown-name", expected=", ".join(GROWTHS), found=str(self.growth))

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        at = placed(self, space)
        length = np.where(state >= 0, np.linalg.norm(at[after] - at[state], axis=-1), 0.0)
        return self.rate * length if self.growth == "linear" else -np.expm1(-self.rate * length)


MEASURES = ("norm", "angle", "change")
ROUNDED = 1e-12
"""Part of a direction, or of the places, below which a turn is rounding: going straight has no risk, not a tiny one."""


@dataclass(frozen=True, eq=False)
class TurnRisk(MemorylessElement):
    """The risk of a turn, which takes three states: ``rate`` times a measure of the turn.

    ``rate``: per unit of length (``norm``), per 45 degrees (``angle``), or for any change (``change``). ``measure``: ``norm``: of the
    difference of the two moves, as the source's text has it; it charges a change of length as well. ``angle``: of the headings, as its
    table 3.1. ``change``: 1 where the moves differ, as its chapter 7.
    """

    kind: ClassVar[str] = "turn"
    rates: ClassVar[tuple[str, ...]] = ("rate",)
    rate: float
    measure: str = "angle"
    label: str = "turn"
    category: ClassVar[str] = "action"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.measure not in MEASURES:
            raise InputError(
                f"the measure of {self.label} is unknown", "unknown-name", expected=", ".join(MEASURES), found=str(self.measure)
            )

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        at = placed(self, space)
        first, second = at[state] - at[before], at[after] - at[state]
        sizes = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
        if self.measure == "angle":
            with np.errstate(divide="ignore", invalid="ignore"):
                a, b = first / sizes[0][:, None], second / sizes[1][:, None]
            chord, sum_ = np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)
            value = np.nan_to_num(2.0 * np.arctan2(np.where(chord > ROUNDED, chord, 0.0), sum_) / (math.pi / 4.0))
        else:
            value = np.linalg.norm(second - first, axis=-1)
            value = np.where(value > ROUNDED * np.maximum(np.abs(at[after]), np.abs(at[before])).max(axis=-1), value, 0.0)
            if self.measure == "change":
                value = (value > 1e-9 * np.maximum(*sizes)).astype(np.float64)
        return np.where((before >= 0) & (state >= 0), self.rate * value, 0.0)


@dataclass(frozen=True, eq=False)
class AccessRisk(MemorylessElement):
    """The risk of a change in width, higher in one direction than in the other: ``narrowing`` times what a move loses of the
    width, or ``widening`` times what it gains.

    ``width`` has the shape (states,); ``narrowing`` and ``widening`` are per unit of width.
    """

    kind: ClassVar[str] = "access"
    rates: ClassVar[tuple[str, ...]] = ("narrowing", "widening")
    width: Floats
    narrowing: float
    widening: float = 0.0
    label: str = "access"
    category: ClassVar[str] = "action"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "width", reals(f"widths of {self.label}", self.width))

    def check(self, space: Space) -> None:
        if self.width.shape != (space.num_states,) or not np.isfinite(self.width).all():
            raise InputError(f"widths of {self.label} must be one finite number a state", "wrong-shape", expected=str(space.num_states))

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        gain = np.where(state >= 0, self.width[after] - self.width[state], 0.0)
        return np.where(gain < 0, -gain * self.narrowing, gain * self.widening)


@dataclass(frozen=True, eq=False)
class MoveRisk(MemorylessElement):
    """A table: risks of some moves, or of some pairs of moves; all others have none.

    ``before``, ``state``, ``after``, shape (entries,): states; -1 in ``before`` stands for any, the start of the path included. ``risk``
    has the shape (entries,).
    """

    kind: ClassVar[str] = "moves"
    before: Indices
    state: Indices
    after: Indices
    risk: Floats
    label: str = "moves"
    category: ClassVar[str] = "action"

    def __post_init__(self) -> None:
        object.__setattr__(self, "risk", probabilities(f"risks of {self.label}", self.risk))
        for key in ("before", "state", "after"):
            column = whole_numbers(f"{key} of {self.label}", getattr(self, key))
            if column.shape != self.risk.shape:
                raise InputError(
                    f"{key} of {self.label} must be one state a risk", "wrong-shape", expected=str(self.risk.shape), found=str(column.shape)
                )
            object.__setattr__(self, key, column)
        entries = list(zip(self.before.tolist(), self.state.tolist(), self.after.tolist(), strict=True))
        if len(set(entries)) < len(entries):
            twice = next(e for k, e in enumerate(entries) if e in entries[:k])
            raise InputError(f"{self.label} has two risks for one move", "duplicate", found=str(twice))

    def check(self, space: Space) -> None:
        for key in ("state", "after"):
            refuse_outside(f"{key} {{}} of {self.label}", getattr(self, key), space.num_states, "state")
        refuse_outside(f"before {{}} of {self.label}", self.before + 1, space.num_states + 1, "state")

    def least(self, space: Space, before: Indices, state: Indices, after: Indices) -> Floats:
        risk = np.zeros(len(after))
        width = space.num_states + 1
        for whole in (True, False):  # a pair of moves may have a risk of its own beside that of its second move
            chosen = (self.before >= 0) == whole
            if not chosen.any():
                continue
            known = ((self.before[chosen] + 1) * width + self.state[chosen] + 1) * width + self.after[chosen]
            asked = ((before + 1 if whole else 0) * width + state + 1) * width + after
            order = np.argsort(known, kind="stable")
            at = np.minimum(np.searchsorted(known[order], asked), len(known) - 1)
            listed = known[order][at] == asked
            risk += np.where(listed, self.risk[chosen][order][at], 0.0) * (1.0 - risk)  # no 1 - (1 - r), which loses small risks
        return risk
