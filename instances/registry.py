"""One mechanism for everything that registers itself: formats, generators, forms, bounds, evidence, solvers, heuristics."""

import importlib
import importlib.util
import pkgutil
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import TYPE_CHECKING, Generic, TypeVar

from .errors import UsageError, in_words
from .suggestions import did_you_mean

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")
_OURS = __name__.partition(".")[0]


class Registry(Generic[T]):
    """Things by name, registered by modules that are imported on first use.

    Parameters
    ----------
    what : str
        Singular, for error messages: "solver".
    places : str
        Full names of packages, or of single modules, in which ``*`` stands for any one subpackage: ``waybound.formulations.*.forms``.
        A new public module in one of them is all that a new entry takes; modules whose names begin with ``_`` or end with ``_kernels``
        are left alone.
    group : str
        Group of entry points through which installed packages add entries: each names a module that registers itself, or the entry.

    Warns
    -----
    RuntimeWarning
        For each entry point that cannot be loaded; all others are there all the same.
    """

    def __init__(self, what: str, *places: str, group: str = "") -> None:
        self.what, self.places, self.group = what, places, group
        self._entries: dict[str, T] = {}
        self._foreign: dict[str, str] = {}
        self._complete = False

    def add(self, name: str, entry: T) -> T:
        """Register ``entry``; a second one of the same name is a programming error, but for one from outside, which gives way to ours."""
        ours = _asker().startswith(f"{_OURS}.")
        if name in self._entries:
            if not ours or name not in self._foreign:
                raise ValueError(f"two {self.what}s are named {name!r}")
            owner = self._foreign.pop(name)
            warnings.warn(f"{self.what} {name} of {owner} is left out: waybound has one of that name", RuntimeWarning, stacklevel=2)
        if not ours:
            self._foreign[name] = _asker()
        self._entries[name] = entry
        return entry

    def enter(self, entry: T) -> T:
        """``add`` under the entry's own ``name``."""
        return self.add(entry.name, entry)  # type: ignore[attr-defined]

    def register(self, name: str) -> Callable[[T], T]:
        """``add`` as a decorator."""
        return lambda entry: self.add(name, entry)

    @contextmanager
    def temporary(self, name: str, entry: T) -> Iterator[T]:
        """``entry`` under ``name`` within a ``with`` block, in place of the one that may have it."""
        self._discover()
        before = dict(self._entries)
        self._entries[name] = entry
        try:
            yield entry
        finally:
            self._entries.clear()
            self._entries.update(before)

    def _discover(self) -> None:
        if not self._complete:
            self._complete = True
            for place in self.places:
                for module in _modules_at(place):
                    importlib.import_module(module)
            if self.group:
                from importlib.metadata import entry_points

                for point in entry_points(group=self.group):
                    self._load(point)

    def _load(self, point: "EntryPoint") -> None:
        try:
            entry = point.load()
            if not isinstance(entry, ModuleType):
                own = getattr(entry, "name", point.name)
                if own != point.name:
                    raise UsageError(f"it calls itself {own!r}")
                self.add(point.name, entry)
        except Exception as fault:
            owner = "" if point.dist is None else f" of {point.dist.name}"
            warnings.warn(f"{self.what} {point.name}{owner} cannot be loaded: {in_words(fault)}", RuntimeWarning, stacklevel=2)

    def __getitem__(self, name: str) -> T:
        self._discover()
        if name not in self._entries:
            raise UsageError(
                f"unknown {self.what} {name!r}; choose from {', '.join(self.names())}{did_you_mean(name, self._entries)}", "unknown-name"
            )
        return self._entries[name]

    def __contains__(self, name: object) -> bool:
        self._discover()
        return name in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self.names())

    def names(self) -> list[str]:
        """All names, in alphabetical order: which module was imported first must not matter."""
        self._discover()
        return sorted(self._entries)

    def values(self) -> list[T]:
        """All entries, in the order of their names."""
        return [self._entries[name] for name in self.names()]


def _asker() -> str:
    """Name of the module that calls a method of a registry."""
    frame = sys._getframe()
    while frame.f_back is not None and frame.f_globals["__name__"] == __name__:
        frame = frame.f_back
    return str(frame.f_globals["__name__"])


def _modules_at(place: str) -> Iterator[str]:
    """Names of the modules that a place of a registry stands for, each package's in alphabetical order."""
    above, star, below = place.partition(".*")
    if star:
        for module in _members(above):
            if module.ispkg:
                yield from _modules_at(f"{above}.{module.name}{below}")
        return
    try:
        spec = importlib.util.find_spec(place)
    except ModuleNotFoundError:
        spec = None
    if spec is not None and spec.submodule_search_locations is None:
        yield place
    elif spec is not None:
        yield from (f"{place}.{module.name}" for module in _members(place) if not module.ispkg)


def _members(package: str) -> list[pkgutil.ModuleInfo]:
    modules = pkgutil.iter_modules(importlib.import_module(package).__path__)
    return sorted((m for m in modules if not m.name.startswith("_") and not m.name.endswith("_kernels")), key=lambda m: m.name)
