"""Writing of instances, by name of the format or by the file's suffix."""

from os import PathLike
from pathlib import Path

from .atomic import atomic_write
from .errors import UsageError
from .formats import FORMATS, Format
from .instance import Instance
from .suggestions import did_you_mean
from .text import an


def write_instance(instance: Instance, path: str | PathLike[str], format: str | None = None) -> None:  # noqa: A002
    """Write ``instance`` to ``path``, whole or not at all, in the named format or in that of the suffix.

    Raises UsageError where the suffix stands for no format, or naming what has no place in the format, and InputError where the file cannot
    be written.
    """
    chosen = FORMATS[format] if format is not None else format_of_suffix(path, instance.kind)
    if chosen.write is None:
        raise UsageError(f"{chosen.name} files are read only; write one of {', '.join(_writable())}", "unsupported")
    atomic_write(path, chosen.write(instance))


def format_of_suffix(path: str | PathLike[str], kind: str = "routing") -> Format:
    """The format in which an instance of ``kind`` is written under the suffix of ``path``."""
    suffix = Path(path).suffix.lower()
    able = [entry for entry in FORMATS.values() if entry.write is not None and (not entry.kinds or kind in entry.kinds)]
    for entry in able:
        if suffix in entry.suffixes:
            return entry
    known = ", ".join(sorted({s for entry in able for s in entry.suffixes}))
    names = ", ".join(entry.name for entry in able)
    hint = did_you_mean(suffix, {s for entry in able for s in entry.suffixes})
    none = f"the suffix stands for no format of {an(kind)} instance"
    raise UsageError(f"{path}: {none}; use one of {known}, or name a format of {names}{hint}", "unknown-name")


def _writable() -> list[str]:
    return [entry.name for entry in FORMATS.values() if entry.write is not None]
