"""Data of risk allocation from numpy arrays and pandas frames, whose labels are names: frames are put in order by them."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .. import number_arrays as arrays
from ..errors import InputError
from ..number_arrays import Floats
from ..printable import printable
from ..text import an
from .allocation import MOST_RISK, Affine, Budget, ChanceConstraints, Risk, RiskAllocationInstance
from .gaussian import Quantities

DECISION, QUANTITY, ROW, CONSTRAINT = "decision", "quantity", "chance constraint", "constraint"


def allocation_from_arrays(
    quantities: Any, covariance: Any, limits: Any, cost: Any, *, total: float | None = None, each: Any = None,
    budgets: Mapping[str, tuple[Sequence[Any], float]] | None = None, risk: str = "allocated", chance: Any = None,
    constraint: Sequence[Any] | None = None, offset: Any = None, lower: Any = None, upper: Any = None, rows: Any = None,
    row_lower: Any = None, row_upper: Any = None, sense: str = "min", name: str = "risk-allocation",
) -> RiskAllocationInstance:  # fmt: skip
    """See ``RiskAllocation.from_arrays``."""
    names = _Names()
    mean_map = names.take("quantities", quantities, (QUANTITY, DECISION))
    q, n = mean_map.shape
    spread = np.asarray(covariance)
    spread = np.diag(names.take("covariance", covariance, (QUANTITY,), (q,))) if spread.ndim == 1 else names.take(
        "covariance", covariance, (QUANTITY, QUANTITY), (q, q)
    )  # fmt: skip
    over = np.eye(q) if chance is None else names.take("chance", chance, (ROW, QUANTITY), (None, q))
    many = len(over)
    row_names = names.of(QUANTITY) if chance is None else names.of(ROW)
    if chance is None:
        names.known[ROW] = row_names
    sides = names.take("limits", limits, (ROW,), (many,), one=True)
    row_names = names.of(ROW) or row_names or tuple(str(k + 1) for k in range(many))
    owner, constraint_names = np.arange(many), row_names
    if constraint is not None:
        labels = [str(label) for label in constraint]
        if len(labels) != many:
            raise InputError(
                "constraint must say for each chance row which constraint it belongs to",
                "wrong-shape",
                expected=str(many),
                found=str(len(labels)),
            )
        constraint_names = tuple(dict.fromkeys(labels))
        owner = np.array([constraint_names.index(label) for label in labels])
    most = MOST_RISK if total is None else min(float(arrays.reals("total", total)), MOST_RISK)
    names.known[ROW] = constraint_names
    caps = names.take("each", most if each is None else each, (ROW,), (len(constraint_names),), one=True)
    if total is None and each is None and not budgets:
        raise InputError("risk says no limit", "missing", expected="total, each or budgets")
    shares = tuple(_budget(str(key), value, constraint_names) for key, value in (budgets or {}).items())
    fixed = np.zeros((0, n)) if rows is None else names.take("rows", rows, (CONSTRAINT, DECISION), (None, n))
    below = names.take("row_lower", -math.inf if row_lower is None else row_lower, (CONSTRAINT,), (len(fixed),), one=True)
    above = names.take("row_upper", math.inf if row_upper is None else row_upper, (CONSTRAINT,), (len(fixed),), one=True)
    linear = names.take("cost", cost, (DECISION,), (n,))
    shift = names.take("offset", 0.0 if offset is None else offset, (QUANTITY,), (q,), one=True)
    least = names.take("lower", -math.inf if lower is None else lower, (DECISION,), (n,), one=True)
    largest = names.take("upper", math.inf if upper is None else upper, (DECISION,), (n,), one=True)
    return RiskAllocationInstance(
        least, largest, names.of(DECISION) or numbered("x", n),
        Quantities(mean_map, shift, spread, names.of(QUANTITY) or numbered("y", q)),
        Affine(linear[None], np.zeros((1, q)), np.zeros(1)),
        ChanceConstraints(Affine(np.zeros((many, n)), over, np.zeros(many)), sides, constraint_names, owner),
        Risk(risk, None if total is None else float(total), caps, shares),
        Affine(fixed, np.zeros((len(fixed), q)), np.zeros(len(fixed))), below, above, names.of(CONSTRAINT) or numbered("", len(fixed)),
        sense=sense, name=name,
    )  # fmt: skip


def numbered(letter: str, count: int) -> tuple[str, ...]:
    """The letter with 1, 2, ... behind it."""
    return tuple(f"{letter}{k + 1}" for k in range(count))


def _budget(name: str, entry: Any, known: tuple[str, ...]) -> Budget:
    """``(constraints, risk)``, the constraints by name, or by number from 0."""
    if not isinstance(entry, Sequence) or isinstance(entry, str) or len(entry) != 2:
        raise InputError(f"budget {name} must be a pair", expected="(constraints, risk)", found=printable(str(entry), 40))
    index = {label: k for k, label in enumerate(known)}
    members = []
    for one in entry[0]:
        number = int(one) if isinstance(one, int | np.integer) and not isinstance(one, bool) else None
        k = index.get(one) if isinstance(one, str) else number
        if k is None or not 0 <= k < len(known):
            raise InputError(f"budget {name} names an unknown chance constraint", "unknown-name", found=printable(str(one), 40))
        members.append(k)
    return Budget(name, np.array(members, dtype=np.int64), float(arrays.reals(f"the risk of budget {name}", entry[1])))


class _Names:
    """The names of decisions, quantities and constraints as the first frame has them that says; the others are put in their order."""

    def __init__(self) -> None:
        self.known: dict[str, tuple[str, ...] | None] = {}

    def of(self, kind: str) -> tuple[str, ...] | None:
        return self.known.get(kind)

    def take(
        self, what: str, data: Any, kinds: tuple[str, ...], shape: tuple[int | None, ...] | None = None, *, one: bool = False
    ) -> Floats:
        """``data`` as an array of that shape, one entry of each kind along its axes; ``one`` allows a single number for all."""
        values = arrays.reals(what, data)
        if one and values.ndim == 0 and shape is not None:
            return np.full([size or 0 for size in shape], float(values))
        expected = tuple("any" if size is None else size for size in shape) if shape is not None else kinds
        if values.ndim != len(kinds) or (
            shape is not None and any(s is not None and s != t for s, t in zip(shape, values.shape, strict=True))
        ):
            raise InputError(
                f"{what} must have one entry {an(' and '.join(dict.fromkeys(kinds)))}",
                "wrong-shape",
                expected=_shape(expected),
                found=_shape(values.shape),
            )
        for axis, (kind, labels) in enumerate(zip(kinds, _labels(data, len(kinds)), strict=True)):
            if labels is not None:
                values = np.take(values, self._order(what, kind, labels), axis=axis)
        return np.ascontiguousarray(values)

    def _order(self, what: str, kind: str, labels: tuple[str, ...]) -> list[int]:
        """Places of the known names among ``labels``, which become known if none were."""
        arrays.names(kind, labels, len(labels))
        known = self.known.get(kind)
        if known is None:
            self.known[kind] = known = labels
        place = {label: k for k, label in enumerate(labels)}
        lacking = [label for label in known if label not in place]
        if lacking:
            other = [label for label in labels if label not in known]
            found = printable(other[0], 40) if other else "no label for it"
            raise InputError(
                f"{what} lacks the {kind} {printable(lacking[0], 40)}", "missing", expected="the labels of the frames before", found=found
            )
        return [place[label] for label in known]


def _shape(sizes: Sequence[Any]) -> str:
    return " x ".join(map(str, sizes)) or "one number"


def _labels(values: Any, dimensions: int) -> list[tuple[str, ...] | None]:
    """The labels of a frame or series along its axes; None where there are none but numbers from 0."""
    if not hasattr(values, "iloc"):
        return [None] * dimensions
    axes = [values.index, *([values.columns] if dimensions == 2 else [])]
    return [None if type(axis).__name__ == "RangeIndex" else tuple(map(str, axis)) for axis in axes]
