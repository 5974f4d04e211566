"""A selection as a file gives it: a ground set, a set function, and a constraint on what may be chosen together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from .. import number_arrays as arrays
from ..instance import digest
from ..text import label
from .constraints import Constraint
from .set_functions import SetFunction


@dataclass(frozen=True, eq=False)
class SelectionInstance:
    """A set function and a constraint as a file gives them.

    Parameters
    ----------
    name, format, problem, problems, notes
        See ``Instance``.
    function : SetFunction
    constraint : Constraint
    element_names : tuple of str, optional
        None stands for "1", "2", ...
    """

    kind: ClassVar[str] = "selection"
    function: SetFunction
    constraint: Constraint
    element_names: tuple[str, ...] | None = None
    name: str = "selection"
    format: str = "arrays"
    problem: str = "selection"
    problems: tuple[str, ...] = ("selection",)
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", label(self.name))
        self.constraint.check(self.function.num_elements)
        arrays.names("element", self.element_names, self.function.num_elements)

    def __repr__(self) -> str:
        return f"<SelectionInstance {self.name}: {self.function!r}, {self.constraint!r}>"

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        return digest("selection", *self.function.parts(), *self.constraint.parts())
