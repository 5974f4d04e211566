"""The verdict on an answer: objective recomputed from the data, and every violation by name and amount."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..instances.errors import InputError, WayboundError, in_words
from ..instances.printable import printable
from ..instances.text import an
from .tolerance import EQUAL, same


@dataclass(frozen=True)
class Violation:
    """One constraint that an answer breaks.

    Parameters
    ----------
    check : str
        Name of the constraint ("load", "time-window", ...).
    message : str
        One line in the problem's words.
    amount : float
        By how much, in the constraint's units.
    vehicle, site : str, optional
        Where, by the names of the answer and of the file.
    """

    check: str
    message: str
    amount: float
    vehicle: str | None = None
    site: str | None = None

    def to_json(self) -> dict[str, Any]:
        amount = self.amount if math.isfinite(self.amount) else None  # JSON has no infinity
        data: dict[str, Any] = {"check": self.check, "message": self.message, "amount": amount}
        data.update({k: v for k, v in (("vehicle", self.vehicle), ("site", self.site)) if v is not None})
        return data


@dataclass(frozen=True)
class Check:
    """Outcome of one kind of check over the whole answer.

    Parameters
    ----------
    name : str
        What was checked, such as ``capacity``.
    passed : bool
        Whether nothing was above the tolerance.
    residual : float
        The largest amount found, 0 if none.
    tested : int
        Conditions looked at.
    confidence : float
        With which it passed; below 1 where samples say so.
    """

    name: str
    passed: bool
    residual: float
    tested: int
    confidence: float = 1.0

    def to_json(self) -> dict[str, Any]:
        residual = self.residual if math.isfinite(self.residual) else None
        data = {"name": self.name, "passed": self.passed, "residual": residual, "tested": self.tested}
        return data if self.confidence == 1.0 else {**data, "confidence": self.confidence}


@dataclass(frozen=True)
class Evaluation:
    """Verdict on an answer, as ``problem.evaluate(answer)`` returns it.

    Parameters
    ----------
    values : tuple of float
        One value per level of the objective, recomputed from the data.
    checks : tuple of Check
        One a kind of condition.
    violations : tuple of Violation
        Residuals above what ``tolerance`` allows; empty for a feasible answer.
    quantities : dict
        Further totals worth showing (distance, vehicles, waiting, ...).
    sizes : tuple of float
        One a level: the sum of the absolute values of what was added up; without it that of the value itself.
    precision : float
        Relative: how closely a value of this kind can be known, ``tolerance.EQUAL`` or, for a solver's vector, ``tolerance.VECTOR``.
    """

    values: tuple[float, ...]
    checks: tuple[Check, ...]
    violations: tuple[Violation, ...]
    quantities: dict[str, float]
    sizes: tuple[float, ...] = ()
    precision: float = EQUAL

    @property
    def size(self) -> float:
        """Size of the numbers that were added up to the first value."""
        return self.sizes[0] if self.sizes else abs(self.values[0])

    def same_at(self, level: int, value: float, precision: float = 0.0) -> bool:
        """Whether the value of a level is ``value``, as closely as it can be known, or as ``precision`` asks where that is coarser."""
        return same(self.values[level], value, self.sizes[level] if self.sizes else 0.0, max(precision, self.precision))

    @property
    def feasible(self) -> bool:
        return not self.violations

    @property
    def objective(self) -> float | list[float]:
        """The value, or the list of values of an objective in order of priority."""
        return self.values[0] + 0.0 if len(self.values) == 1 else [value + 0.0 for value in self.values]  # -0.0 is 0


class Checklist:
    """Collects residuals while an answer is evaluated."""

    def __init__(self) -> None:
        self._residual: dict[str, float] = {}
        self._tested: dict[str, int] = {}
        self.violations: list[Violation] = []

    def test(
        self, check: str, excess: float, message: str, *, allowed: float = 0.0, vehicle: str | None = None, site: str | None = None
    ) -> None:
        """Record that ``check`` was tested and exceeded by ``excess`` (at most 0 when it holds; NaN never holds), ``allowed`` being let
        pass."""
        self._tested[check] = self._tested.get(check, 0) + 1
        amount = math.inf if math.isnan(excess) else max(0.0, excess)
        self._residual[check] = max(self._residual.get(check, 0.0), amount)
        if amount > allowed:
            self.violations.append(Violation(check, message, amount, vehicle, site))

    def checks(self, names: Sequence[str]) -> tuple[Check, ...]:
        """All checks in the given order, including those that had nothing to test."""
        broken = {v.check for v in self.violations}
        return tuple(Check(n, n not in broken, self._residual.get(n, 0.0), self._tested.get(n, 0)) for n in names)


def judge(
    check: str, excess: NDArray[np.floating[Any]], message: Callable[[int], str], allowed: ArrayLike = 0.0
) -> tuple[Check, list[Violation]]:
    """One check of many things at once: ``excess`` is at most 0 where it holds (NaN never holds), ``allowed`` is let pass, ``message``
    tells the k-th fault."""
    residual = np.where(np.isnan(excess), math.inf, np.maximum(excess, 0.0))
    wrong = np.nonzero(residual > allowed)[0].tolist()
    worst = float(residual.max(initial=0.0))
    return Check(check, not wrong, worst, len(residual)), [Violation(check, message(k), float(residual[k])) for k in wrong]


@contextmanager
def input_errors(problem: str) -> Iterator[None]:
    """Turn any other exception in the block into an InputError: what a user gives as an answer may be anything."""
    try:
        yield
    except (WayboundError, MemoryError):
        raise
    except Exception as fault:
        why = printable(in_words(fault), 120)
        raise InputError(f"it fails as an answer to {an(problem)} problem", found=why) from fault
