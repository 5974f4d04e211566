"""File formats: each module registers one, with its reader and, where it has one, its writer."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..instance import Instance
from ..registry import Registry


@dataclass(frozen=True)
class Format:
    """A file format.

    Parameters
    ----------
    name : str
        Used with ``--format``.
    summary : str
        One line.
    recognises : callable
        Tells if a text is meant as this format; cheap, and never raises.
    read : callable
        From the text and the path, and a mapping of ``settings`` where there are any, to the instance. Raises InputError with the line,
        without the file.
    write : callable, optional
        From an instance to the text. Raises UsageError for what the format cannot express.
    suffixes : tuple of str
        File names that are written in this format when none is named.
    problem : str
        The problem that is meant when nothing else is said; "" where the file says it.
    problems : tuple of str
        Problems that may be asked of its instances; empty where the file says them.
    convention : str
        Default distance convention.
    sense, answer : str
        For the documentation: the sense of the problems' objectives, and the kind of answer.
    solutions : tuple of str
        Suffixes of solution files.
    kinds : tuple of str
        Kinds of instances that it can hold; empty for every kind.
    lacks : callable, optional
        From a text that no format recognises to the beginning that it lacks to be this one; None where it is nothing like it.
    settings : tuple of str
        Keys of ``--set`` that are the reader's, because the text cannot be understood without them.
    """

    name: str
    summary: str
    recognises: Callable[[str], bool]
    read: Callable[..., Instance]
    write: Callable[[Any], str] | None = None
    suffixes: tuple[str, ...] = ()
    problem: str = ""
    problems: tuple[str, ...] = ()
    convention: str = "exact"
    sense: str = "min"
    answer: str = "routes"
    solutions: tuple[str, ...] = (".json", ".sol", ".tour")
    kinds: tuple[str, ...] = ("routing",)
    lacks: Callable[[str], str | None] | None = None
    settings: tuple[str, ...] = ()


FORMATS: Registry[Format] = Registry("format", "waybound.instances.formats", "waybound.instances.*.formats", group="waybound.formats")
