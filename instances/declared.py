"""Instances that declare their axes and arrays once: checks, names, sizes, digest and JSON follow from the declaration.

A field of an instance is declared as ``Annotated[type, part]``. Whatever only one kind has, it checks, reads and writes itself.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache, partial
from typing import Any, ClassVar, Self, get_type_hints

import numpy as np
from numpy.typing import NDArray

from . import document, number_arrays as arrays
from .errors import InputError
from .instance import digest
from .parts import Axis, Count, Part
from .text import label

Names = tuple[str, ...] | None
"""One name per entry; None stands for "1", "2", ..."""


def extent(values: NDArray[np.float64]) -> list[float]:
    """Least and largest of some numbers; empty where there are none."""
    return [float(values.min()), float(values.max())] if values.size else []


class CountOf:
    """The number of entries of an axis, as an attribute: ``num_robots = CountOf("robot")``."""

    def __init__(self, axis: str) -> None:
        self.axis = axis

    def __get__(self, instance: Any, owner: Any = None) -> int:
        if instance is None:
            return self  # type: ignore[return-value]
        count: int = instance.counts[self.axis]
        return count


class NameOf:
    """The name of an entry by its number, as a method: ``robot_name = NameOf("robot")``."""

    def __init__(self, axis: str) -> None:
        self.axis = axis

    def __get__(self, instance: Any, owner: Any = None) -> Callable[[int], str]:
        if instance is None:
            return self  # type: ignore[return-value]
        return partial(instance.name_of, self.axis)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Declared:
    """Base of instances. A subclass is a frozen dataclass whose fields are declared by parts.

    Parameters
    ----------
    name, format, problem, problems, notes
        See ``Instance``; by default what the kind says.
    """

    kind: ClassVar[str]
    problem_names: ClassVar[tuple[str, ...]]  # what may be asked; the first is meant when nothing else is said
    content: ClassVar[str]  # what a file holds, in messages
    default_name: ClassVar[str] = ""  # the kind
    axes: ClassVar[tuple[Axis, ...]] = ()  # in the order of JSON
    keys: ClassVar[tuple[str, ...]] = ()  # of JSON in their order, where it is not axes, fields, own keys
    own_keys: ClassVar[tuple[str, ...]] = ()  # that JSON must have, and the kind reads and writes itself
    hashed: ClassVar[tuple[str, ...]] = ()  # attributes that the digest covers; by default all declared fields
    lists_problems: ClassVar[bool] = False  # JSON says what may be asked where that is not all
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
            known = len(self.counts)
            self.put(**{key: part.converted(key, getattr(self, key), self.counts)})
            if len(self.counts) > known:
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
                raise InputError(f"there are no {axis.key}", "missing", expected="one at least")

    def arrange(self) -> None:
        """Change fields before they are checked."""

    def check_rest(self) -> None:
        """Check what no part declares, and set what follows from the fields."""

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
        """The noun for one entry of the field ``key`` in messages."""
        return f"the {what}" if what else key

    def absent_of(self, key: str, absent: float | None) -> float | None:
        """The number of the field ``key`` that stands for what is not allowed."""
        return absent

    def sizes(self) -> dict[str, int]:
        """Number of entries of each axis, by its plural."""
        return {axis.key: self.counts[axis.name] for axis in self.axes if axis.name in self.counts}

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        return digest(self.kind, *(getattr(self, key) for key in self.hashed or self.parts()))

    def summary(self) -> Iterable[str]:
        """The parts of ``repr`` that follow the name."""
        return (f"{count} {key}" for key, count in self.sizes().items())

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {', '.join(self.summary())}>"

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
        if self.lists_problems and self.problems != self.problem_names:
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
        """Keys, in JSON, of fields that are not declared."""
        return {}

    @classmethod
    def from_document(cls, data: dict[str, Any]) -> Self:
        """The instance out of JSON; see ``Kind.decode``."""
        tables, top = [axis for axis in cls.axes if axis.table], cls._stored("")
        needed = (*(axis.key for axis in tables), *(key for key, field in top.items() if cls._needed(*field)), *cls.own_keys)
        known = ("name", "problem", *(["problems"] * cls.lists_problems), *(cls.keys or (*needed, *top)), "notes")
        document.fields(data, "the document", tuple(dict.fromkeys(known)), ("name", "problem", *needed))
        values: dict[str, Any] = dict(zip(("problem", "problems"), cls._asked(data), strict=True))
        counts: dict[str, int] = {}
        for axis in tables:
            values.update(cls._read_table(axis, data[axis.key], counts))
        values.update({name: counts[part.axis] for name, part in cls.parts().items() if isinstance(part, Count)})
        values.update({name: part.read(data[key], key, counts) for key, (name, part) in top.items() if key in data})
        values.update(cls.read_own(data, counts))
        name, notes = document.string(data["name"], "name"), document.strings(data.get("notes", []), "notes")
        return cls.from_values(**values, name=name, format="json", notes=notes)

    @classmethod
    def _needed(cls, name: str, part: Part) -> bool:
        return part.required or not hasattr(cls, name)  # a dataclass keeps defaults as attributes of the class

    @classmethod
    def _asked(cls, data: Mapping[str, Any]) -> tuple[str, tuple[str, ...]]:
        """The problem that a document asks, and all that it allows."""
        problem = document.string(data["problem"], "problem")
        problems = document.strings(data.get("problems", list(cls.problem_names)), "problems")
        known = ", ".join(cls.problem_names)
        if cls.lists_problems and len(cls.problem_names) == 1 and {problem, *problems} != set(cls.problem_names):
            found = ", ".join(dict.fromkeys((problem, *data.get("problems", ()))))
            raise InputError(f"{cls.content} allow one problem", "unknown-name", expected=known, found=found)
        for k, name in enumerate(problems):
            if name not in cls.problem_names:
                raise InputError(f"problems[{k}] is no problem of {cls.content}", "unknown-name", expected=known, found=name)
        if problem not in problems:
            fault = "problem must be one of problems" if cls.lists_problems else f"problem is none of {cls.content}"
            raise InputError(fault, "unknown-name", expected=", ".join(problems), found=problem)
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
        """Values, from JSON, of fields that are not declared."""
        return {}

    @classmethod
    def from_values(cls, **values: Any) -> Self:
        """The instance with the values that a document holds."""
        return cls(**values)
