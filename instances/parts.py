"""Parts by which an instance declares its fields: the axes along which an array lies, what its entries may be, and where JSON has it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import document, number_arrays as arrays
from .errors import InputError
from .text import an, shown

if TYPE_CHECKING:
    from .declared import Declared

LARGEST = 1e150
"""Largest number in an array: sums and squares stay finite."""


@dataclass(frozen=True)
class Axis:
    """A set of things that arrays have entries for, such as robots or bins; in JSON an object of columns under its plural."""

    name: str  # singular; the field NAME_names holds the names of the entries, where they have names
    plural: str = ""  # with an s by default
    least: int = 1
    most: int | None = None  # in JSON
    table: bool = True  # False: JSON has no object of columns
    counted: bool = True  # False: the object has no key "count", and the length of the first column, which stands first, counts
    positions: str = ""  # attribute that holds places of the entries, in JSON the columns x and y
    dimensions: int = 2  # 3: places may have a z
    named_last: bool = False  # names follow the columns in JSON

    @property
    def key(self) -> str:
        return self.plural or f"{self.name}s"

    @property
    def names(self) -> str:
        return f"{self.name}_names"


class Part(ABC):
    """The rules of one field: its type and shape, its range, its place in JSON.

    ``table`` is the axis among whose columns it stands, by default the only one of an array, "" the document itself; ``stored`` says
    whether it stands there at all, and ``required`` that it must even though the field has a default. An axis that is None has no name.
    """

    def __init__(
        self, axes: tuple[str | None, ...] = (), key: str = "", table: str | None = None, stored: bool = True, required: bool = False
    ) -> None:
        self.axes, self.key, self.stored, self.required = axes, key, stored, required
        self.table = (axes[0] or "" if len(axes) == 1 else "") if table is None else table

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> Any:
        """``value`` as it is held, which sets the ``counts`` of axes not met before; raises InputError for another type or shape."""
        return value

    def refuse(self, key: str, value: Any, instance: Declared) -> None:  # noqa: B027 - names, counts and words have nothing to refuse here
        """Raise InputError where the converted value holds what it must not."""

    @abstractmethod
    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> Any:
        """The value out of JSON."""

    def write(self, value: Any) -> Any:
        """The value as JSON; None where it is left out."""
        return value


class Numbers(Part):
    """Numbers from ``low`` to ``high`` along one or two axes.

    ``absent`` stands for what is not allowed, null in JSON; ``default`` for all entries where nothing is said, and is not written. With
    ``spread`` one entry of the first axis may stand for all. Messages say "the WHAT of robot 1", where {} in it stands for the owner, and
    "one EACH a robot".
    """

    def __init__(
        self, *axes: str | None, low: float = 0.0, high: float = LARGEST, absent: float | None = None, default: float | None = None,
        spread: bool = False, what: str = "", each: str = "", **place: Any,
    ) -> None:  # fmt: skip
        super().__init__(axes, **place)
        self.low, self.high, self.absent, self.default, self.spread = low, high, absent, default, spread
        self.what, self.each = what, each or what

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> NDArray[np.float64] | None:
        shape = tuple(None if axis is None else counts.get(axis) for axis in self.axes)
        if value is None:
            return None if self.default is None else arrays.frozen(np.full([n or 0 for n in shape], self.default))
        array = np.array(arrays.reals(key, value)) if self.spread or len(shape) == 1 else _matrix(key, value)
        if self.spread and (array.ndim == len(shape) - 1 or len(array) == 1):
            array = np.repeat(array.reshape(1, *array.shape[array.ndim - len(shape) + 1 :]), shape[0] or 0, axis=0)
        if not array.size and 0 in shape and None not in shape:
            array = np.zeros([n or 0 for n in shape])
        fit_shape(self.axes, array, counts, key, self.each or key)
        return arrays.frozen(array)

    def refuse(self, key: str, value: Any, instance: Declared) -> None:
        if value is None:
            return
        wrong, absent = ~((value >= self.low) & (value <= self.high)), instance.absent_of(key, self.absent)
        if absent is not None:
            wrong &= value != absent
        if wrong.any():
            at = np.argwhere(wrong)[0].tolist()
            owner = " and ".join(f"{axis} {instance.name_of(axis, k)}" for axis, k in zip(self.axes, at, strict=True) if axis)
            what = instance.noun_of(key, self.what)
            whose = what.format(owner) if "{}" in what else f"{what} of {owner}"
            limits = f"from {self.low:g} to {self.high:g}" if self.low > -self.high else f"a number of at most {self.high:g}"
            raise InputError(
                f"{whose} must be {limits}{', or infinite' if absent == math.inf else ''}", "out-of-range", found=str(value[tuple(at)])
            )

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> NDArray[np.float64]:
        shape = [None if axis is None else counts.get(axis) for axis in self.axes]
        if len(shape) == 2:
            return document.matrix(data, path, *shape, null=self.absent)
        return document.reals(data, path, shape[0], null=self.absent)

    def write(self, value: Any) -> Any:
        left_out = value is None or (self.default is not None and (value == self.default).all())
        return None if left_out else document.json_numbers(value)


class Wholes(Part):
    """Whole numbers along one axis, in 32 bits if ``small``: entries of the axis ``refers``, or from 0 to ``high``, or any."""

    def __init__(self, axis: str, refers: str = "", what: str = "", high: int | None = None, small: bool = False, **place: Any) -> None:
        super().__init__((axis,), **place)
        self.refers, self.what, self.high, self.small = refers, what, high, small

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> NDArray[np.integer[Any]] | None:
        if value is None:
            return None
        array: NDArray[np.integer[Any]] = arrays.indices(key, value) if self.small else arrays.whole_numbers(key, value)
        fit_shape(self.axes, array, counts, key, key)
        return arrays.frozen(array)

    def refuse(self, key: str, value: Any, instance: Declared) -> None:
        if self.refers:
            arrays.refuse_outside(self.what, value, instance.counts[self.refers], self.refers)
        if self.high is not None and (wrong := (value < 0) | (value > self.high)).any():
            raise InputError(f"{key} must be from 0 to {self.high}", "out-of-range", found=str(value[int(np.argmax(wrong))]))

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> NDArray[np.int64]:
        return document.wholes(data, path, counts.get(self.axes[0] or ""))

    def write(self, value: Any) -> list[int] | None:
        return None if value is None else value.tolist()


class Flags(Part):
    """True and false along one axis."""

    def __init__(self, axis: str, **place: Any) -> None:
        super().__init__((axis,), **place)

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> NDArray[np.bool_]:
        array, axis = np.asarray(value), self.axes[0] or ""
        if array.dtype != bool or array.shape != (counts.get(axis, len(array)),):
            raise InputError(f"{key} must have one truth value {an(axis)}", "wrong-shape" if array.dtype == bool else "malformed")
        return arrays.frozen(array)

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> NDArray[np.bool_]:
        return document.flags(data, path, counts[self.axes[0] or ""])

    def write(self, value: Any) -> list[bool]:
        flags: list[bool] = value.tolist()
        return flags


class Whole(Part):
    """A whole number from ``low`` to ``high``, or to the last entry of the axis ``high``."""

    def __init__(self, low: int = 0, high: int | str = arrays.LARGEST_NUMBER, **place: Any) -> None:
        super().__init__((), **place)
        self.low, self.high = low, high

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> int:
        high = counts[self.high] - 1 if isinstance(self.high, str) else self.high
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or not self.low <= value <= high:
            if isinstance(self.high, str):
                raise InputError(
                    f"the {key} must be {an(self.high)}", "unknown-name", expected=f"{self.low} to {high}", found=shown(str(value))
                )
            raise InputError(f"{key} must be a whole number from {self.low} to {high}", "out-of-range", found=str(value)[:40])
        return int(value)

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> int:
        return document.integer(data, path, self.low)


class Count(Whole):
    """The number of entries of an axis as a field of its own; in JSON the key ``count`` of the axis."""

    def __init__(self, axis: str) -> None:
        super().__init__(stored=False)
        self.axis = axis

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> int:
        counts[self.axis] = arrays.size(key, value)
        return counts[self.axis]


class Choice(Part):
    """A field whose value is one of several words."""

    def __init__(self, *choices: str, **place: Any) -> None:
        super().__init__((), **place)
        self.choices = choices

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> str:
        if value not in self.choices:
            raise InputError(f"unknown {key} {value!r}", "unknown-name", expected=", ".join(self.choices))
        return str(value)

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> str:
        if document.string(data, path) not in self.choices:
            raise InputError(f"{path} is unknown", "unknown-name", expected=", ".join(self.choices), found=data)
        return str(data)


def _matrix(key: str, value: Any) -> NDArray[np.float64]:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{key} must be a matrix of numbers, all rows of one length") from None
    if array.ndim != 2:
        raise InputError(f"{key} must be a matrix of numbers, all rows of one length", "wrong-shape", found=f"shape {array.shape}")
    return array


def fit_shape(axes: tuple[str | None, ...], array: NDArray[Any], counts: dict[str, int], key: str, each: str) -> None:
    """Set the ``counts`` of axes not met before; raise InputError where ``array`` has another shape than they say."""
    shape = tuple(None if axis is None else counts.get(axis) for axis in axes)
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape, strict=True)):
        if len(shape) == 1:
            raise InputError(f"there must be one {each} {an(axes[0] or '')}", "wrong-shape", expected=str(shape[0]), found=str(array.shape))
        expected = " x ".join("any" if n is None else str(n) for n in shape)
        raise InputError(f"{key} has another shape", "wrong-shape", expected=expected, found=str(array.shape))
    counts.update({axis: n for axis, n in zip(axes, array.shape, strict=True) if axis is not None})
