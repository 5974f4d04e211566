"""Robots, bins, and what it costs to send the one to the other."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import InitVar, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]

PROBLEMS = ("bin-assignment", "bottleneck-assignment")
"""What may be asked of such data."""

LARGEST = 1e150
"""Of a cost: sums and squares stay finite."""


@dataclass(frozen=True, eq=False)
class AssignmentInstance:
    """Which robot may be sent to which bin, and at what cost: complete or sparse.

    ``from_matrix``, ``from_pairs`` and ``from_frame`` make one from the user's own data; the constructor takes a CSR matrix.

    Parameters
    ----------
    num_robots, num_bins : int
        At least 1 each.
    indptr : array of shape (robots + 1,)
        The pairs of robot i are ``indptr[i]`` to ``indptr[i + 1]``.
    bins : array of shape (pairs,)
        Bin of each pair, ascending within a robot's. Pairs that are not listed are forbidden. None where none is: the costs are those of
        all pairs then, robot by robot.
    cost : array of shape (pairs,)
        Of each pair: the time to reach the bin, or any other cost.
    filled : array of shape (bins,), optional
        When each bin is full, counted from now in the unit of the costs; 0 where it is, infinite where nobody fills it. By default
        nobody has to wait.
    robot_names, bin_names : tuple of str, optional
        None stands for "1", "2", ...
    robot_positions, bin_positions : array of shape (robots or bins, 2), optional
        For maps.
    name, format, problem, problems, notes
        See ``Instance``.
    known : Spread, optional
        ``spread(cost)``, where it is known.

    Raises
    ------
    InputError
        If an array has the wrong length or holds what it must not.

    Notes
    -----
    Source: Zhang (2015), Multi-robot coordination, section 3.4.2; docs/formulations/bin-assignment.md#model.
    """

    kind: ClassVar[str] = "assignment"
    num_robots: int
    num_bins: int
    indptr: Indices
    bins: Indices
    cost: Floats
    filled: Floats | None = None
    robot_names: tuple[str, ...] | None = None
    bin_names: tuple[str, ...] | None = None
    robot_positions: Floats | None = None
    bin_positions: Floats | None = None
    name: str = "assignment"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())
    known: InitVar[arrays.Spread | None] = None

    @classmethod
    def from_matrix(cls, costs: Any, **further: Any) -> AssignmentInstance:
        """From a matrix, one row a robot and one column a bin.

        Parameters
        ----------
        costs : array of shape (robots, bins), or a sparse matrix of scipy
            Infinity forbids a pair; of a sparse matrix what is not stored is forbidden, a stored 0 is a cost.
        **further
            ``filled``, names, positions and the like, see the class.

        Raises
        ------
        InputError
            For rows of different lengths, NaN, minus infinity, and no robots or bins; names row and column.
        """
        if hasattr(costs, "tocsr"):
            matrix = costs.tocsr(copy=True)
            stored = matrix.nnz
            matrix.sum_duplicates()
            if matrix.nnz != stored:
                raise InputError("a pair of robot and bin stands twice in the sparse matrix")
            n, m = matrix.shape
            return cls(n, m, matrix.indptr, matrix.indices, matrix.data, **further)
        try:
            made = np.asarray(costs, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise _not_rectangular(costs) from None
        if made.shape == (0,):
            raise InputError("there are no robots", expected="one at least")
        if made.ndim != 2:
            raise InputError("costs must be a matrix, one row a robot and one column a bin", found=f"shape {made.shape}")
        n, m = made.shape
        own, found = arrays.copied(made)
        if made.size and found.largest < math.inf:  # every pair is allowed, and none is NaN
            return cls(n, m, np.arange(n + 1) * m, None, own, **further, known=found)  # type: ignore[arg-type]
        bad = np.isnan(made)
        if bad.any():
            robot, column = np.argwhere(bad)[0].tolist()
            raise InputError(
                f"the cost in row {robot + 1}, column {column + 1} is not a number",
                expected="a number, or infinity for a forbidden pair",
            )
        kept = made < math.inf
        pairs = np.concatenate([[0], np.cumsum(kept.sum(axis=1))]), np.nonzero(kept)[1].astype(np.int32), made[kept]
        return cls(n, m, *pairs, **further)

    @classmethod
    def from_pairs(
        cls, num_robots: int, num_bins: int, robots: ArrayLike, bins: ArrayLike, costs: ArrayLike, **further: Any
    ) -> AssignmentInstance:
        """From lists of one entry a pair, in any order, robots and bins as numbers from 0."""
        n, m = arrays.size("num_robots", num_robots), arrays.size("num_bins", num_bins)
        i, j = arrays.whole_numbers("robots", robots), arrays.whole_numbers("bins", bins)
        c = arrays.reals("costs", costs)
        if not i.shape == j.shape == c.shape:
            raise InputError("robots, bins and costs must have one entry a pair", found=f"{len(i)}, {len(j)} and {c.size}")
        arrays.refuse_outside("the robot of pair {}", i, n, "robot")
        arrays.refuse_outside("the bin of pair {}", j, m, "bin")
        order = np.lexsort((j, i))
        twice = (np.diff(i[order]) == 0) & (np.diff(j[order]) == 0)
        if twice.any():
            k = order[int(np.argmax(twice))]
            ends = (("robot", i, n), ("bin", j, m))
            named = [(what, int(at[k]), arrays.names(what, further.get(f"{what}_names"), count)) for what, at, count in ends]
            told = " and ".join(f"{what} {number + 1 if names is None else names[number]}" for what, number, names in named)
            raise InputError(f"the pair of {told} stands twice")
        kept = order[~(c[order] == math.inf)]
        indptr = np.zeros(n + 1, dtype=np.int64)
        np.cumsum(np.bincount(i[kept], minlength=n), out=indptr[1:])
        return cls(n, m, indptr, j[kept], c[kept], **further)  # type: ignore[arg-type]

    @classmethod
    def from_frame(cls, costs: pd.DataFrame, **further: Any) -> AssignmentInstance:
        """From a pandas frame: one row a pair, or one row a robot and one column a bin.

        Parameters
        ----------
        costs : DataFrame
            Pairs have the columns ``robot``, ``bin`` and ``cost``, in any order and case, and perhaps those of the CSV format: ``filled``,
            ``robot-x``, ``robot-y``, ``bin-x``, ``bin-y``. A row with a robot or a bin alone tells that there is one. Of a matrix a
            column ``robot``, or else a first column of text, names the robots, or else the index does. Infinity, and in a matrix a cell
            without a number, forbids a pair.
        **further
            As of ``from_matrix``; it goes before what the frame says.

        Raises
        ------
        InputError
            For other columns beside pairs, and cells that hold no number; names column and row, counted from 1.
        """
        from .assignment_frame import arguments_of

        pairs, found = arguments_of(costs)
        return (cls.from_pairs if pairs else cls.from_matrix)(**{**found, **further})

    def __post_init__(self, known: arrays.Spread | None) -> None:
        n, m = arrays.size("num_robots", self.num_robots), arrays.size("num_bins", self.num_bins)
        if not n or not m:
            raise InputError(f"there are no {'robots' if not n else 'bins'}", expected="one at least")
        indptr, cost = arrays.indices("indptr", self.indptr), arrays.reals("cost", self.cost)
        listed: Any = self.bins
        bins = None if listed is None else arrays.indices("bins", listed)
        many = n * m if bins is None else len(bins)
        for what, count in (("robots", n), ("bins", m)):
            arrays.refuse_unused(what, count, many, "pairs")
        if len(indptr) != n + 1 or cost.shape != (many,):
            raise InputError(
                "indptr must have one entry more than robots, bins and cost one a pair", found=f"{len(indptr)}, {many}, {cost.size}"
            )
        if bins is not None:
            arrays.check_csr(indptr, bins, m, "robot", "bin", "pairs")
            object.__setattr__(self, "bins", arrays.frozen(bins))
        elif (np.diff(indptr) != m).any() or indptr[0]:
            raise InputError("where every pair is allowed, each robot has as many as there are bins", expected=str(m))
        else:
            object.__delattr__(self, "bins")  # they are made when they are asked for
        for key, values in (("indptr", indptr), ("cost", cost)):
            object.__setattr__(self, key, arrays.frozen(values))
        for what, count in (("robot", n), ("bin", m)):
            names = arrays.names(what, getattr(self, f"{what}_names"), count)
            object.__setattr__(self, f"{what}_names", names)
            object.__setattr__(self, f"{what}_positions", arrays.positions(what, getattr(self, f"{what}_positions"), count, names))
        object.__setattr__(self, "name", label(self.name))
        if known is not None:
            object.__setattr__(self, "spread", known)
        if not (self.spread.least >= -LARGEST and self.spread.largest <= LARGEST):  # NaN is neither
            k = int(np.argmax(~(np.abs(cost) <= LARGEST)))
            robot = self.robot_name(int(np.searchsorted(indptr, k, side="right")) - 1)
            pair = f"robot {robot} and bin {self.bin_name(int(self.bins[k]))}"
            raise InputError(f"the cost of {pair} must be a number of at most {LARGEST:g}", found=str(cost[k]))
        if self.filled is not None:
            filled = arrays.reals("filled", self.filled)
            if filled.shape != (m,):
                raise InputError("there must be one time of being filled a bin", expected=str(m), found=str(filled.shape))
            late = ~((filled >= 0) & ((filled <= LARGEST) | (filled == math.inf)))
            if late.any():
                k = int(np.argmax(late))
                raise InputError(
                    f"the time until bin {self.bin_name(k)} is full must be from 0 to {LARGEST:g}, or infinite", found=str(filled[k])
                )
            object.__setattr__(self, "filled", arrays.frozen(filled))

    # -- lookups -----------------------------------------------------------------------------------------------------

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """The bins of a complete matrix."""
            if name != "bins" or "cost" not in self.__dict__:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            made = np.tile(np.arange(self.num_bins, dtype=np.int32), self.num_robots)
            made.setflags(write=False)
            object.__setattr__(self, "bins", made)
            return made

    @cached_property
    def spread(self) -> arrays.Spread:
        """The least and the largest cost, and whether all are whole numbers."""
        return arrays.spread(self.cost)

    @property
    def num_pairs(self) -> int:
        return len(self.cost)

    @property
    def complete(self) -> bool:
        """Whether every robot may be sent to every bin."""
        return self.num_pairs == self.num_robots * self.num_bins

    @property
    def robots(self) -> NDArray[np.int64]:
        """Robot of each pair."""
        return np.repeat(np.arange(self.num_robots), np.diff(self.indptr))

    def matrix(self) -> Floats:
        """The costs as a matrix of shape (robots, bins), infinite where a pair is forbidden; a view where all are allowed."""
        if self.complete:
            return self.cost.reshape(self.num_robots, self.num_bins)
        made = np.full((self.num_robots, self.num_bins), math.inf)
        made[self.robots, self.bins] = self.cost
        return made

    def robot_name(self, robot: int) -> str:
        return str(robot + 1) if self.robot_names is None else self.robot_names[robot]

    def bin_name(self, number: int) -> str:
        return str(number + 1) if self.bin_names is None else self.bin_names[number]

    def to_frame(self) -> pd.DataFrame:
        """One row a pair: robot, bin, cost."""
        import pandas as pd

        names = [self.robot_name(k) for k in self.robots.tolist()], [self.bin_name(k) for k in self.bins.tolist()]
        return pd.DataFrame({"robot": names[0], "bin": names[1], "cost": self.cost})

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        filled = np.zeros(0) if self.filled is None else self.filled
        return digest("assignment", self.num_robots, self.num_bins, self.indptr, self.bins, self.cost, filled)

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        degree, used = np.diff(self.indptr), np.bincount(self.bins, minlength=self.num_bins)
        return {
            "robots": self.num_robots,
            "bins": self.num_bins,
            "pairs": self.num_pairs,
            "forbidden": self.num_robots * self.num_bins - self.num_pairs,
            "bins_a_robot": [int(degree.min()), int(degree.max())],
            "robots_a_bin": [int(used.min()), int(used.max())],
            "costs": [self.spread.least, self.spread.largest] if self.num_pairs else [],
            "whole_costs": self.spread.whole,
            "not_yet_full": 0 if self.filled is None else int((self.filled > 0).sum()),
            "positions": self.robot_positions is not None and self.bin_positions is not None,
        }

    def __repr__(self) -> str:
        return f"<AssignmentInstance {self.name}: {self.num_robots} robots, {self.num_bins} bins, {self.num_pairs} pairs>"


def _not_rectangular(costs: Iterable[Any]) -> InputError:
    """What is wrong with rows of which numpy makes no matrix."""
    try:
        lengths = [len(row) for row in costs]
    except TypeError:
        return InputError("costs must be a matrix of numbers, one row a robot and one column a bin", found=repr(costs)[:40])
    odd = next((k for k, length in enumerate(lengths) if length != lengths[0]), None)
    if odd is not None:
        return InputError(f"row {odd + 1} of the costs has a wrong length", expected=str(lengths[0]), found=str(lengths[odd]))
    return InputError("costs must hold numbers", found=repr(costs)[:40])
