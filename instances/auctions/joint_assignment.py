"""Robots that bring something to a request on the way to the bin that they fetch."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label
from .assignment import LARGEST

Floats = NDArray[np.float64]

PROBLEMS = ("joint-assignment",)
"""What may be asked of such data."""

MOST_TRIPLES = 50_000_000


@dataclass(frozen=True, eq=False)
class JointAssignmentInstance:
    """Times of travel between robots, requests and bins, and when bins are full.

    Parameters
    ----------
    to_bin : array of shape (robots, bins)
        From each robot to each bin, by no request; infinite where it may not fetch it.
    to_request : array of shape (robots, requests)
        From each robot to each request; infinite where it has nothing to bring.
    between : array of shape (requests, bins)
        From each request to each bin.
    filled : array of shape (bins,), optional
        When each bin is full, counted from now; infinite where nobody fills it. By default all are.
    robot_names, bin_names, request_names : tuple of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If an array has the wrong shape or holds what it must not.

    Notes
    -----
    Source: Zhang (2015), section 3.4.2, both decisions as one; docs/formulations/joint-assignment.md#model.
    """

    kind: ClassVar[str] = "joint-assignment"
    to_bin: Floats
    to_request: Floats
    between: Floats
    filled: Floats | None = None
    robot_names: tuple[str, ...] | None = None
    bin_names: tuple[str, ...] | None = None
    request_names: tuple[str, ...] | None = None
    name: str = "joint-assignment"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", label(self.name))
        to_bin = _matrix("to_bin", self.to_bin, None)
        n, m = to_bin.shape
        for what, count in (("robots", n), ("bins", m)):
            if not count:
                raise InputError(f"there are no {what}", expected="one at least")
        to_request = _matrix("to_request", self.to_request, (n, None))
        q = to_request.shape[1]
        if n * (m + 1) * (q + 1) > MOST_TRIPLES:
            raise InputError(f"{n} robots, {m} bins and {q} requests make more than {MOST_TRIPLES:,} triples")
        between = _matrix("between", np.zeros((0, m)) if q == 0 else self.between, (q, m))
        filled = np.zeros(m) if self.filled is None else arrays.reals("filled", self.filled)
        if filled.shape != (m,):
            raise InputError("there must be one time of being filled a bin", expected=str(m), found=str(filled.shape))
        for what, count in (("robot", n), ("bin", m), ("request", q)):
            put(self, f"{what}_names", arrays.names(what, getattr(self, f"{what}_names"), count))
        self._refuse("to_bin", to_bin, ("robot", "bin"), True)
        self._refuse("to_request", to_request, ("robot", "request"), True)
        self._refuse("between", between, ("request", "bin"), False)
        self._refuse("filled", filled, ("bin",), True)
        for key, values in (("to_bin", to_bin), ("to_request", to_request), ("between", between), ("filled", filled)):
            put(self, key, arrays.frozen(values))

    def _refuse(self, key: str, times: Floats, ends: tuple[str, ...], endless: bool) -> None:
        """Raise InputError for the first of ``times`` that is none, by the names of what it belongs to."""
        wrong = ~((times >= 0) & ((times <= LARGEST) | (endless & (times == math.inf))))
        if wrong.any():
            at = np.argwhere(wrong)[0].tolist()
            owner = " and ".join(f"{what} {self.name_of(what, k)}" for what, k in zip(ends, at, strict=True))
            told = ", or infinite" if endless else ""
            raise InputError(f"{key} of {owner} must be from 0 to {LARGEST:g}{told}", found=str(times[tuple(at)]))

    # -- lookups -----------------------------------------------------------------------------------------------------

    @property
    def num_robots(self) -> int:
        return int(self.to_bin.shape[0])

    @property
    def num_bins(self) -> int:
        return int(self.to_bin.shape[1])

    @property
    def num_requests(self) -> int:
        return int(self.to_request.shape[1])

    def name_of(self, what: str, number: int) -> str:
        """Of a ``robot``, ``bin`` or ``request``."""
        names = getattr(self, f"{what}_names")
        return str(number + 1) if names is None else str(names[number])

    def digest(self) -> str:
        """Hash of everything that values depend on; names are not part of it."""
        return digest("joint-assignment", self.to_bin, self.to_request, self.between, self.filled)

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        assert self.filled is not None
        return {
            "robots": self.num_robots, "bins": self.num_bins, "requests": self.num_requests,
            "bringing": int(np.isfinite(self.to_request).any(axis=1).sum()), "not_yet_full": int((self.filled > 0).sum()),
        }  # fmt: skip

    def __repr__(self) -> str:
        return f"<JointAssignmentInstance {self.name}: {self.num_robots} robots, {self.num_bins} bins, {self.num_requests} requests>"


def _matrix(what: str, given: ArrayLike, shape: tuple[int | None, int | None] | None) -> Floats:
    try:
        made = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must be a matrix of numbers, all rows of one length") from None
    if made.ndim != 2 or (shape is not None and any(s is not None and s != k for s, k in zip(shape, made.shape, strict=True))):
        told = "a matrix" if shape is None else " x ".join("any" if s is None else str(s) for s in shape)
        raise InputError(f"{what} has another shape", expected=told, found=str(made.shape))
    return made
