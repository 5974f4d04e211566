"""Instances that declare their axes and arrays once: checks, names, sizes, digest and JSON follow from the declaration.

A field of an instance is declared as ``Annotated[type, part]``: the part says along which axes an array lies, what its entries may be, and
where it stands in JSON. Whatever only one kind has, it checks, reads and writes itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache, partial
from typing import Any, ClassVar, Self, get_type_hints

import numpy as np
from numpy.typing import NDArray

from . import document
from . import number_arrays as arrays
from .errors import InputError
from .instance import digest
from .text import an, label, shown

LARGEST = 1e150
"""Largest number in an array: sums and squares stay finite."""

Names = tuple[str, ...] | None
"""One name an entry; None stands for "1", "2", ..."""


@dataclass(frozen=True)
class Axis:
    """What the entries of arrays stand for: robots, bins. In JSON an axis is an object of columns under its plural.

    Parameters
    ----------
    name : str
        Singular. The field ``NAME_names`` holds the names of the entries, where they have names.
    plural : str
        By default with an s.
    least : int
        How many entries there must be.
    table : bool
        Whether JSON has an object of columns; else the axis is the length of an array alone.
    counted : bool
        Whether that object has the key ``count``; else its first column says how many entries there are, and stands first.
    most : int, optional
        How many there may be in JSON.
    positions : str
        Attribute that holds the places of the entries, which JSON has as columns x and y.
    dimensions : int
        Most coordinates of a place: 3 allows for z.
    named_last : bool
        Whether names follow the columns in JSON.
    """

    name: str
    plural: str = ""
    least: int = 1
    table: bool = True
    counted: bool = True
    most: int | None = None
    positions: str = ""
    dimensions: int = 2
    named_last: bool = False

    @property
    def key(self) -> str:
        return self.plural or f"{self.name}s"

    @property
    def names(self) -> str:
        return f"{self.name}_names"


class Part:
    """How the value of one field is checked, and how it stands in JSON.

    Parameters
    ----------
    axes : tuple of str or None
        Names of the axes that an array lies along; None for one that has no name.
    key : str
        In JSON; by default the name of the field.
    table : str, optional
        The axis among whose columns it stands, "" for the document itself; by default the only axis of an array.
    stored : bool
        Whether JSON has it where the declaration says; else the kind reads and writes it itself.
    required : bool
        Whether JSON must have it even though the field has a default.
    """

    def __init__(
        self, axes: tuple[str | None, ...] = (), key: str = "", table: str | None = None, stored: bool = True, required: bool = False
    ) -> None:
        self.axes, self.key, self.stored, self.required = axes, key, stored, required
        self.table = (axes[0] or "" if len(axes) == 1 else "") if table is None else table

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> Any:
        """``value`` as it is held, which sets the ``counts`` of axes not met before; raises InputError for another type or shape."""
        return value

    def refuse(self, key: str, value: Any, instance: Declared) -> None:
        """Raise InputError where the converted value holds what it must not."""

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> Any:
        """The value out of JSON."""
        raise NotImplementedError

    def write(self, value: Any) -> Any:
        """The value as JSON; None where it is left out."""
        return value


class Numbers(Part):
    """Numbers from ``low`` to ``high``, along one or two axes.

    Parameters
    ----------
    axes, place
        See ``Part``.
    absent : float, optional
        Stands for what is not allowed: null in JSON.
    default : float, optional
        All entries where nothing is said; JSON then leaves the array out.
    spread : bool
        Whether one entry of the first axis may stand for all.
    what, each : str
        One number in messages, by default the name of the field: "the WHAT of robot 1", where ``{}`` may stand for the owner; "one EACH a
        robot", by default the same.
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
            raise InputError(f"{whose} must be {limits}{', or infinite' if absent == math.inf else ''}", found=str(value[tuple(at)]))

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> NDArray[np.float64]:
        shape = [None if axis is None else counts.get(axis) for axis in self.axes]
        if len(shape) == 2:
            return document.matrix(data, path, *shape, null=self.absent)
        return document.reals(data, path, shape[0], null=self.absent)

    def write(self, value: Any) -> Any:
        left_out = value is None or (self.default is not None and (value == self.default).all())
        return None if left_out else document.json_numbers(value)


class Wholes(Part):
    """Whole numbers along one axis, ``small`` ones in 32 bits: entries of the axis ``refers``, or from 0 to ``high``, or any."""

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
            raise InputError(f"{key} must be from 0 to {self.high}", found=str(value[int(np.argmax(wrong))]))

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
            raise InputError(f"{key} must have one truth value {an(axis)}")
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
                raise InputError(f"the {key} must be {an(self.high)}", expected=f"{self.low} to {high}", found=shown(str(value)))
            raise InputError(f"{key} must be a whole number from {self.low} to {high}", found=str(value)[:40])
        return int(value)

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> int:
        return document.integer(data, path, self.low)


class Count(Whole):
    """How many entries an axis has, as a field of its own; JSON has it as the axis's ``count``."""

    def __init__(self, axis: str, plural: str = "") -> None:
        super().__init__(stored=False)
        self.axis, self.plural = axis, plural or f"{axis}s"

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> int:
        counts[self.axis] = arrays.size(key, value)
        return counts[self.axis]


class Choice(Part):
    """One of several words."""

    def __init__(self, *choices: str, **place: Any) -> None:
        super().__init__((), **place)
        self.choices = choices

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> str:
        if value not in self.choices:
            raise InputError(f"unknown {key} {value!r}", expected=", ".join(self.choices))
        return str(value)

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> str:
        if document.string(data, path) not in self.choices:
            raise InputError(f"{path} is unknown", expected=", ".join(self.choices), found=data)
        return str(data)


def _matrix(key: str, value: Any) -> NDArray[np.float64]:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{key} must be a matrix of numbers, all rows of one length") from None
    if array.ndim != 2:
        raise InputError(f"{key} must be a matrix of numbers, all rows of one length", found=f"shape {array.shape}")
    return array


def fit_shape(axes: tuple[str | None, ...], array: NDArray[Any], counts: dict[str, int], key: str, each: str) -> None:
    """Set the ``counts`` of axes not met before; raise InputError where ``array`` has another shape than they say."""
    shape = tuple(None if axis is None else counts.get(axis) for axis in axes)
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape, strict=True)):
        if len(shape) == 1:
            raise InputError(f"there must be one {each} {an(axes[0] or '')}", expected=str(shape[0]), found=str(array.shape))
        expected = " x ".join("any" if n is None else str(n) for n in shape)
        raise InputError(f"{key} has another shape", expected=expected, found=str(array.shape))
    counts.update({axis: n for axis, n in zip(axes, array.shape, strict=True) if axis is not None})


def extent(values: NDArray[np.float64]) -> list[float]:
    """Least and largest of some numbers; empty where there are none."""
    return [float(values.min()), float(values.max())] if values.size else []


class CountOf:
    """The number of entries of an axis, as an attribute: ``num_robots = CountOf("robot")``."""

    def __init__(self, axis: str) -> None:
        self.axis = axis

    def __get__(self, instance: Any, owner: Any = None) -> int:
        count: int = instance.counts[self.axis]
        return count


class NameOf:
    """The name of an entry by its number, as a method: ``robot_name = NameOf("robot")``."""

    def __init__(self, axis: str) -> None:
        self.axis = axis

    def __get__(self, instance: Any, owner: Any = None) -> Callable[[int], str]:
        return partial(instance.name_of, self.axis)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Declared:
    """Base of instances. A subclass is a frozen dataclass whose fields are declared by parts.

    Parameters
    ----------
    name, format, problem, problems, notes
        See ``Instance``; by default what the kind says.

    Attributes
    ----------
    axes : tuple of Axis
        In the order of JSON.
    problem_names : tuple of str
        What may be asked of such data; the first is meant when nothing else is said.
    content : str
        What such a file holds, in messages.
    default_name : str
        By default the kind.
    keys : tuple of str
        The keys of JSON in their order, where it is not axes, then fields, then ``own_keys``.
    own_keys : tuple of str
        Keys that the kind reads and writes itself, and that JSON must have.
    hashed : tuple of str
        Attributes that the digest covers, in their order; by default all arrays.
    says_problems : bool
        Whether JSON says all that may be asked where that is not ``problem_names``.
    """

    kind: ClassVar[str]
    axes: ClassVar[tuple[Axis, ...]] = ()
    problem_names: ClassVar[tuple[str, ...]]
    content: ClassVar[str]
    default_name: ClassVar[str] = ""
    keys: ClassVar[tuple[str, ...]] = ()
    own_keys: ClassVar[tuple[str, ...]] = ()
    hashed: ClassVar[tuple[str, ...]] = ()
    says_problems: ClassVar[bool] = False
    name: str = ""
    format: str = "arrays"
    problem: str = ""
    problems: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    counts: dict[str, int] = field(init=False)

    def __post_init__(self) -> None:
        self.put(
            name=label(self.name or self.default_name or self.kind), problem=self.problem or self.problem_names[0],
            problems=self.problems or self.problem_names, counts={},
        )  # fmt: skip
        parts = self.parts()
        for key, part in parts.items():
            self.put(**{key: part.converted(key, getattr(self, key), self.counts)})
            self.refuse_counts()
        self.arrange()
        for axis in self.axes:
            count = self.counts.get(axis.name, 0)
            if hasattr(self, axis.names):
                self.put(**{axis.names: arrays.names(axis.name, getattr(self, axis.names), count)})
            if axis.positions in self.__dataclass_fields__:
                points = arrays.positions(axis.name, getattr(self, axis.positions), count, getattr(self, axis.names), axis.dimensions)
                self.put(**{axis.positions: points})
        for key, part in parts.items():
            part.refuse(key, getattr(self, key), self)
        self.check_rest()

    def refuse_counts(self) -> None:
        """Raise InputError where there are too few or too many entries: before anything of their size is allocated."""
        for axis in self.axes:
            if self.counts.get(axis.name, axis.least) < axis.least:
                raise InputError(f"there are no {axis.key}", expected="one at least")

    def arrange(self) -> None:
        """Change fields before they are checked."""

    def check_rest(self) -> None:
        """Check what the declaration does not say, and set what follows from the fields."""

    def put(self, **values: Any) -> None:
        """Set attributes while the instance is made."""
        self.__dict__.update(values)

    # -- names and sizes ---------------------------------------------------------------------------------------------

    @classmethod
    @cache
    def parts(cls) -> dict[str, Part]:
        """The declared fields and their parts."""
        hints = get_type_hints(cls, include_extras=True)
        declared = {entry.name: getattr(hints[entry.name], "__metadata__", ()) for entry in fields(cls)}
        return {key: part for key, metadata in declared.items() for part in metadata if isinstance(part, Part)}

    def name_of(self, axis: str, number: int) -> str:
        """The name of an entry of an axis."""
        names = getattr(self, f"{axis}_names", None)
        return str(number + 1) if names is None else str(names[number])

    def noun_of(self, key: str, what: str) -> str:
        """What messages call one entry of the field ``key``."""
        return f"the {what}" if what else key

    def absent_of(self, key: str, absent: float | None) -> float | None:
        """The number of the field ``key`` that stands for what is not allowed."""
        return absent

    def sizes(self) -> dict[str, int]:
        """How many entries each axis has, by its plural."""
        return {axis.key: self.counts[axis.name] for axis in self.axes if axis.name in self.counts}

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        return digest(self.kind, *(getattr(self, key) for key in self.hashed or self.parts()))

    def told(self) -> Iterable[str]:
        """What the text that stands for the instance says of it, behind its name."""
        return (f"{count} {key}" for key, count in self.sizes().items())

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {', '.join(self.told())}>"

    # -- JSON --------------------------------------------------------------------------------------------------------

    @classmethod
    def _stored(cls, table: str) -> dict[str, tuple[str, Part]]:
        """Fields and their parts by their keys in JSON, among the columns of an axis, or ("") in the document itself."""
        return {part.key or key: (key, part) for key, part in cls.parts().items() if part.stored and part.table == table}

    def to_document(self) -> dict[str, Any]:
        """The instance in JSON, without version and kind; what holds nothing but defaults is left out."""
        data = {axis.key: self._written_table(axis) for axis in self.axes if axis.table}
        data.update(self._written(""))
        data.update(self.write_own())
        head: dict[str, Any] = {"name": self.name, "problem": self.problem}
        if self.says_problems and self.problems != self.problem_names:
            head["problems"] = list(self.problems)
        notes = self.own_notes()
        ordered = {key: data[key] for key in self.keys or data if key in data}
        return {**head, **ordered, **({"notes": notes} if notes else {})}

    def own_notes(self) -> list[str]:
        """Notes that a file holds."""
        return list(self.notes)

    def _written(self, table: str) -> dict[str, Any]:
        values = {key: part.write(getattr(self, name)) for key, (name, part) in self._stored(table).items()}
        return {key: value for key, value in values.items() if value is not None}

    def _written_table(self, axis: Axis) -> dict[str, Any]:
        columns = self._written(axis.name)
        names, points = getattr(self, axis.names, None), getattr(self, axis.positions, None) if axis.positions else None
        named: dict[str, Any] = {} if names is None else {"name": list(names)}
        if points is not None:
            named.update(zip("xyz", (document.json_numbers(column) for column in points.T), strict=False))
        if not axis.counted or axis.named_last:
            columns, named = named, columns
        return {**({"count": self.counts[axis.name]} if axis.counted else {}), **named, **columns}

    def write_own(self) -> dict[str, Any]:
        """Keys that the declaration does not say."""
        return {}

    @classmethod
    def from_document(cls, data: dict[str, Any]) -> Self:
        """The instance out of JSON; see ``Kind.decode``."""
        tables, top = [axis for axis in cls.axes if axis.table], cls._stored("")
        needed = (*(axis.key for axis in tables), *(key for key, field in top.items() if cls._needed(*field)), *cls.own_keys)
        known = ("name", "problem", *(["problems"] * cls.says_problems), *(cls.keys or (*needed, *top)), "notes")
        document.fields(data, "the document", tuple(dict.fromkeys(known)), ("name", "problem", *needed))
        values: dict[str, Any] = dict(zip(("problem", "problems"), cls._asked(data), strict=True))
        counts: dict[str, int] = {}
        for axis in tables:
            values.update(cls._read_table(axis, data[axis.key], counts))
        values.update({name: counts[part.axis] for name, part in cls.parts().items() if isinstance(part, Count)})
        values.update({name: part.read(data[key], key, counts) for key, (name, part) in top.items() if key in data})
        values.update(cls.read_own(data, counts))
        name, notes = document.string(data["name"], "name"), document.strings(data.get("notes", []), "notes")
        return cls.of_parts(**values, name=name, format="json", notes=notes)

    @classmethod
    def _needed(cls, name: str, part: Part) -> bool:
        return part.required or not hasattr(cls, name)  # a dataclass keeps defaults as attributes of the class

    @classmethod
    def _asked(cls, data: Mapping[str, Any]) -> tuple[str, tuple[str, ...]]:
        """What is asked, and what may be asked, of the instance of a document."""
        problem = document.string(data["problem"], "problem")
        problems = document.strings(data.get("problems", list(cls.problem_names)), "problems")
        known = ", ".join(cls.problem_names)
        if cls.says_problems and len(cls.problem_names) == 1 and {problem, *problems} != set(cls.problem_names):
            raise InputError(f"{cls.content} allow one problem", expected=known, found=", ".join(dict.fromkeys((problem, *problems))))
        for k, name in enumerate(problems):
            if name not in cls.problem_names:
                raise InputError(f"problems[{k}] is no problem of {cls.content}", expected=known, found=name)
        if problem not in problems:
            fault = "problem must be one of problems" if cls.says_problems else f"problem is none of {cls.content}"
            raise InputError(fault, expected=", ".join(problems), found=problem)
        return problem, problems

    @classmethod
    def _read_table(cls, axis: Axis, data: Any, counts: dict[str, int]) -> dict[str, Any]:
        columns, path = cls._stored(axis.name), axis.key
        needed = [key for key, field in columns.items() if cls._needed(*field)]
        counted, named, places = ["count"] * axis.counted, ["name"] * hasattr(cls, axis.names), axis.dimensions * bool(axis.positions)
        document.fields(data, path, (*counted, *named, *"xyz"[:places], *columns), (*counted, *needed))
        if axis.counted:
            counts[axis.name] = document.integer(data["count"], f"{path}.count", axis.least, axis.most)
        values: dict[str, Any] = {}
        for key, (name, part) in columns.items():
            if key in data:
                values[name] = part.read(data[key], f"{path}.{key}", counts)
                counts.setdefault(axis.name, len(values[name]))
        if "name" in data:
            names = document.array(data["name"], f"{path}.name", counts[axis.name] if axis.counted else None)
            values[axis.names] = document.strings(names, f"{path}.name")
        if axis.positions:
            values[axis.positions] = document.positions(data, path, counts[axis.name], "xyz"[: axis.dimensions])
        return values

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        """Values of fields that the declaration does not say, out of JSON."""
        return {}

    @classmethod
    def of_parts(cls, **values: Any) -> Self:
        """The instance of what a document holds."""
        return cls(**values)
