"""The attributes that all instances share, and the digest of data."""

import hashlib
from collections.abc import Mapping
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np


@runtime_checkable
class Instance(Protocol):
    """The attributes that all instances share: every reader returns an object that has them.

    ``kind`` names the kind of data (``routing``, ``risky-graph``, ...), ``problem`` the default problem, and ``problems`` all problems
    that can be posed on it.
    """

    kind: ClassVar[str]

    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def problem(self) -> str: ...
    @property
    def problems(self) -> tuple[str, ...]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...


def with_settings(instance: Any, settings: Mapping[str, Any]) -> Any:
    """``instance``, an immutable one, with the ``--set`` values that its file says the problem was made with."""
    object.__setattr__(instance, "_settings", dict(settings))
    return instance


def settings_of(instance: Any) -> dict[str, Any]:
    """The settings stored by ``with_settings``."""
    return dict(getattr(instance, "_settings", {}))


def digest(*parts: Any) -> str:
    """SHA-256 over arrays and plain values, the same on every platform (little-endian IEEE doubles)."""
    h = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            h.update(f"{part.dtype.kind}{part.shape}".encode())
            little = part.astype(part.dtype.newbyteorder("<"), copy=False)
            h.update(np.ascontiguousarray(little).reshape(-1).view(np.uint8).data)
        else:
            h.update(repr(part).encode())
        h.update(b"\0")
    return "sha256:" + h.hexdigest()
