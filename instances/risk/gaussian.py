"""Gaussian quantities that depend linearly on decisions, stated directly or as the states of a linear system."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .. import number_arrays as arrays
from ..errors import InputError
from ..number_arrays import Floats

SEMIDEFINITE = 1e-9
"""Part of its largest eigenvalue by which the least one of a covariance may lie below 0, as rounding makes it."""


@dataclass(frozen=True, eq=False)
class Dynamics:
    """A linear system with additive Gaussian noise: ``s_t = A s_(t-1) + B u_t + w_t``, ``w_t ~ N(0, W)``, ``s_0 ~ N(start, P)``.

    The decisions are the inputs, step after step.

    ``state``, shape (states, states): A. ``input``, shape (states, inputs): B. ``noise`` and ``start_covariance``, shape (states, states):
    W and P. ``start`` has the shape (states,).
    """

    state: Floats
    input: Floats
    noise: Floats
    start: Floats
    start_covariance: Floats
    steps: int
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]

    def __post_init__(self) -> None:
        n, m = len(self.state_names), len(self.input_names)
        shapes = {"state": (n, n), "input": (n, m), "noise": (n, n), "start_covariance": (n, n), "start": (n,)}
        for key, shape in shapes.items():
            if getattr(self, key).shape != shape:
                raise InputError(
                    f"dynamics: {key} has the wrong shape", "wrong-shape", expected=str(shape), found=str(getattr(self, key).shape)
                )
        if self.steps < 1:
            raise InputError("dynamics: there must be at least one step", "out-of-range", found=str(self.steps))
        check_covariance("dynamics: noise", self.noise)
        check_covariance("dynamics: start_covariance", self.start_covariance)

    def quantities(self) -> "Quantities":
        """The states of steps 1 to ``steps``, step after step."""
        n, m, steps = len(self.state_names), len(self.input_names), self.steps
        powers = [np.eye(n)]
        mean_map, offset = np.zeros((steps, n, steps, m)), np.zeros((steps, n))
        covariance = np.zeros((steps, n, steps, n))
        spread = self.start_covariance
        with np.errstate(over="ignore", invalid="ignore"):  # what is no number is refused below
            for _ in range(steps):
                powers.append(self.state @ powers[-1])
            for t in range(steps):
                for k in range(t + 1):
                    mean_map[t, :, k] = powers[t - k] @ self.input
                offset[t] = powers[t + 1] @ self.start
                spread = self.state @ spread @ self.state.T + self.noise
                for later in range(t, steps):
                    covariance[later, :, t] = powers[later - t] @ spread
                    covariance[t, :, later] = covariance[later, :, t].T
        names = tuple(f"{name}@{t + 1}" for t in range(steps) for name in self.state_names)
        size = steps * n
        return Quantities(
            mean_map.reshape(size, steps * m), offset.reshape(size), covariance.reshape(size, size), names, self, checked=True
        )

    def decision_names(self) -> tuple[str, ...]:
        return tuple(f"{name}@{t + 1}" for t in range(self.steps) for name in self.input_names)


@dataclass(frozen=True, eq=False)
class Quantities:
    """Jointly Gaussian quantities ``y ~ N(map x + offset, covariance)`` of decisions x.

    ``map`` has shape (quantities, decisions); ``covariance`` is positive semidefinite, and ``checked`` says that this is known.
    ``dynamics`` are where they come from.
    """

    map: Floats
    offset: Floats
    covariance: Floats
    names: tuple[str, ...]
    dynamics: Dynamics | None = None
    checked: bool = False

    def __post_init__(self) -> None:
        q = len(self.names)
        for key in ("map", "offset", "covariance"):
            object.__setattr__(self, key, arrays.reals(f"quantities: {key}", getattr(self, key)))
        if self.map.ndim != 2 or len(self.map) != q or self.offset.shape != (q,):
            shapes = f"{self.map.shape} and {self.offset.shape}"
            raise InputError("quantities: map and offset have one row each quantity", "wrong-shape", expected=str(q), found=shapes)
        if not all(np.isfinite(part).all() for part in (self.map, self.offset, self.covariance)):
            raise InputError("quantities: map, offset and covariance must be finite", "out-of-range")
        if self.covariance.shape != (q, q):
            raise InputError(
                "quantities: covariance has the wrong shape", "wrong-shape", expected=str((q, q)), found=str(self.covariance.shape)
            )
        if not self.checked:
            check_covariance("quantities: covariance", self.covariance, self.names)


def check_covariance(what: str, matrix: ArrayLike, names: Sequence[str] | None = None) -> None:
    """Raise InputError unless ``matrix`` is symmetric and positive semidefinite but for rounding; says by how much it is not, and where:
    by ``names`` of the rows, or by their numbers from 1."""
    array = np.asarray(matrix, dtype=np.float64)
    if not np.isfinite(array).all():
        raise InputError(f"{what} must be finite", "out-of-range")
    variance = np.diag(array)
    if (variance < 0).any():
        k = int(np.argmin(variance))
        raise InputError(f"{what} has a negative variance", "out-of-range", expected="0 or more", found=f"{variance[k]:g} {_row(k, names)}")
    largest = float(np.abs(array).max(initial=0.0))
    apart = np.abs(array - array.T)
    if apart.max(initial=0.0) > SEMIDEFINITE * largest:
        i, j = (int(k) for k in np.unravel_index(int(np.argmax(apart)), apart.shape))
        where = f"rows {i + 1} and {j + 1}" if names is None else f"{names[i]} and {names[j]}"
        raise InputError(f"{what} is not symmetric", "contradiction", found=f"entries of {where} that differ by {apart[i, j]:g}")
    if not (array - np.diag(variance)).any():
        return
    values = np.linalg.eigvalsh(array)
    if values[0] < -SEMIDEFINITE * max(float(values[-1]), largest):
        raise InputError(f"{what} is not positive semidefinite", "contradiction", found=f"the least eigenvalue {values[0]:.6g}")


def _row(k: int, names: Sequence[str] | None) -> str:
    return f"in row {k + 1}" if names is None else f"of {names[k]}"
