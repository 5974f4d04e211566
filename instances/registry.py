"""One mechanism for everything that registers itself: formats, generators, forms, bounds, evidence, solvers, heuristics."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from .errors import UsageError

T = TypeVar("T")


class Registry(Generic[T]):
    """Things by name, registered by the modules of one package, which are imported on first use.

    Parameters
    ----------
    what : str
        Singular, for error messages: "solver".
    package : str
        Full name of the package whose modules register entries; a new module is all that a new entry takes.
    """

    def __init__(self, what: str, package: str) -> None:
        self.what, self.package = what, package
        self._entries: dict[str, T] = {}
        self._complete = False

    def add(self, name: str, entry: T) -> T:
        """Register ``entry``; a second one of the same name is a programming error."""
        if name in self._entries:
            raise ValueError(f"two {self.what}s are named {name!r}")
        self._entries[name] = entry
        return entry

    def register(self, name: str) -> Callable[[T], T]:
        """``add`` as a decorator."""
        return lambda entry: self.add(name, entry)

    def _discover(self) -> None:
        if not self._complete:
            self._complete = True
            package = importlib.import_module(self.package)
            for module in sorted(pkgutil.iter_modules(package.__path__), key=lambda m: m.name):
                if not module.name.startswith("_"):
                    importlib.import_module(f"{self.package}.{module.name}")

    def __getitem__(self, name: str) -> T:
        self._discover()
        if name not in self._entries:
            raise UsageError(f"unknown {self.what} {name!r}; choose from {', '.join(self.names())}")
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
