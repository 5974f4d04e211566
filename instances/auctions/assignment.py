"""Robots, bins, and what it costs to send the one to the other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import InitVar, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..declared import Declared, NameOf, Names
from ..document import fields, json_numbers, matrix, reals, wholes
from ..errors import InputError
from ..number_arrays import Floats
from ..parts import LARGEST, Axis, Count, Numbers

if TYPE_CHECKING:
    import pandas as pd

Indices = NDArray[np.int32]

PROBLEMS = ("bin-assignment", "bottleneck-assignment")
"""Problems that such data allow; the first is the default."""

PAIR_KEYS = ("robot", "bin", "cost")
"""Lists of JSON, one entry per pair."""


@dataclass(frozen=True, eq=False, repr=False)
class AssignmentInstance(Declared):
    """Costs of sending robots to bins, for all pairs or for those that are allowed.

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

    kind = "assignment"
    problem_names = PROBLEMS
    content = "assignments"
    axes = (Axis("robot", positions="robot_positions"), Axis("bin", positions="bin_positions"))
    keys = ("robots", "bins", "cost", "pairs")
    hashed = ("num_robots", "num_bins", "indptr", "bins", "cost", "waits")
    num_robots: Annotated[int, Count("robot")]
    num_bins: Annotated[int, Count("bin")]
    indptr: Indices
    bins: Indices
    cost: Floats
    filled: Annotated[Floats | None, Numbers("bin", absent=math.inf, what="time until {} is full", each="time of being filled")] = None
    robot_names: Names = None
    bin_names: Names = None
    robot_positions: Floats | None = None
    bin_positions: Floats | None = None
    known: InitVar[arrays.Spread | None] = None
    robot_name, bin_name = NameOf("robot"), NameOf("bin")

    @classmethod
    def from_matrix(cls, costs: Any, **further: Any) -> AssignmentInstance:
        """An instance from a matrix, one row per robot and one column per bin.

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
                raise InputError("a pair of robot and bin stands twice in the sparse matrix", "duplicate")
            n, m = matrix.shape
            return cls(n, m, matrix.indptr, matrix.indices, matrix.data, **further)
        try:
            table = np.asarray(costs, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise _not_rectangular(costs) from None
        if table.shape == (0,):
            raise InputError("there are no robots", "missing", expected="one at least")
        if table.ndim != 2:
            raise InputError("costs must be a matrix, one row a robot and one column a bin", "wrong-shape", found=f"shape {table.shape}")
        n, m = table.shape
        own, spread = arrays.copied(table)
        if table.size and spread.largest < math.inf:  # every pair is allowed, and none is NaN
            return cls(n, m, np.arange(n + 1) * m, None, own, **further, known=spread)  # type: ignore[arg-type]
        bad = np.isnan(table)
        if bad.any():
            robot, column = np.argwhere(bad)[0].tolist()
            raise InputError(
                f"the cost in row {robot + 1}, column {column + 1} is not a number", "out-of-range",
                expected="a number, or infinity for a forbidden pair",
            )  # fmt: skip
        kept = table < math.inf
        pairs = np.concatenate([[0], np.cumsum(kept.sum(axis=1))]), np.nonzero(kept)[1].astype(np.int32), table[kept]
        return cls(n, m, *pairs, **further)

    @classmethod
    def from_pairs(
        cls, num_robots: int, num_bins: int, robots: ArrayLike, bins: ArrayLike, costs: ArrayLike, **further: Any
    ) -> AssignmentInstance:
        """An instance from lists of one entry per pair, in any order, robots and bins as numbers from 0.

        Parameters
        ----------
        num_robots, num_bins : int
            Those included that no pair names.
        robots, bins : array-like, shape (pairs,)
            The ends of each pair.
        costs : array-like, shape (pairs,)
            Infinity forbids a pair, as leaving it out does.
        **further
            As of ``from_matrix``.
        """
        n, m = arrays.size("num_robots", num_robots), arrays.size("num_bins", num_bins)
        i, j = arrays.whole_numbers("robots", robots), arrays.whole_numbers("bins", bins)
        c = arrays.reals("costs", costs)
        if not i.shape == j.shape == c.shape:
            raise InputError("robots, bins and costs must have one entry a pair", "wrong-shape", found=f"{len(i)}, {len(j)} and {c.size}")
        arrays.refuse_outside("the robot of pair {}", i, n, "robot")
        arrays.refuse_outside("the bin of pair {}", j, m, "bin")
        order = np.lexsort((j, i))
        twice = (np.diff(i[order]) == 0) & (np.diff(j[order]) == 0)
        if twice.any():
            k = order[int(np.argmax(twice))]
            ends = (("robot", i, n), ("bin", j, m))
            named = [(what, int(at[k]), arrays.names(what, further.get(f"{what}_names"), count)) for what, at, count in ends]
            pair = " and ".join(f"{what} {number + 1 if names is None else names[number]}" for what, number, names in named)
            raise InputError(f"the pair of {pair} stands twice", "duplicate")
        kept = order[~(c[order] == math.inf)]
        return cls(n, m, arrays.row_starts(i[kept], n), j[kept], c[kept], **further)  # type: ignore[arg-type]

    @classmethod
    def from_frame(cls, costs: pd.DataFrame, **further: Any) -> AssignmentInstance:
        """An instance from a pandas frame: one row per pair, or one row per robot and one column per bin.

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

        pairs, arguments = arguments_of(costs)
        return (cls.from_pairs if pairs else cls.from_matrix)(**{**arguments, **further})

    def refuse_counts(self) -> None:
        super().refuse_counts()
        if len(self.counts) == 2:
            for what, count in self.sizes().items():
                arrays.refuse_unused(what, count, self._listed(), "pairs")

    def _listed(self) -> int:
        """Number of pairs, by the bins."""
        bins: Any = self.bins
        return self.num_robots * self.num_bins if bins is None else len(bins)

    def __post_init__(self, known: arrays.Spread | None) -> None:
        if known is not None:
            self.put(spread=known)
        super().__post_init__()

    def arrange(self) -> None:
        indptr, cost, many = arrays.indices("indptr", self.indptr), arrays.reals("cost", self.cost), self._listed()
        bins: Any = self.bins
        if len(indptr) != self.num_robots + 1 or cost.shape != (many,):
            raise InputError(
                "indptr must have one entry more than robots, bins and cost one a pair", "wrong-shape",
                found=f"{len(indptr)}, {many}, {cost.size}",
            )  # fmt: skip
        if bins is not None:
            bins = arrays.indices("bins", bins)
            arrays.check_csr(indptr, bins, self.num_bins, "robot", "bin", "pairs")
            self.put(bins=arrays.frozen(bins))
        elif (np.diff(indptr) != self.num_bins).any() or indptr[0]:
            raise InputError(
                "where every pair is allowed, each robot has as many as there are bins", "wrong-shape", expected=str(self.num_bins)
            )
        else:
            del self.__dict__["bins"]  # they are made when they are asked for
            indptr = indptr.copy()
            indptr.setflags(write=False)
        self.put(indptr=arrays.frozen(indptr), cost=arrays.frozen(cost))

    def check_rest(self) -> None:
        cost = self.cost
        if not (self.spread.least >= -LARGEST and self.spread.largest <= LARGEST):  # NaN is neither
            k = int(np.argmax(~(np.abs(cost) <= LARGEST)))
            robot = self.robot_name(int(np.searchsorted(self.indptr, k, side="right")) - 1)
            pair = f"robot {robot} and bin {self.bin_name(int(self.bins[k]))}"
            raise InputError(f"the cost of {pair} must be a number of at most {LARGEST:g}", "out-of-range", found=str(cost[k]))

    # -- lookups -----------------------------------------------------------------------------------------------------

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """The bins of a complete matrix."""
            if name != "bins" or "cost" not in self.__dict__:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            bins = np.tile(np.arange(self.num_bins, dtype=np.int32), self.num_robots)
            bins.setflags(write=False)
            self.put(bins=bins)
            return bins

    @cached_property
    def spread(self) -> arrays.Spread:
        """The least and the largest cost, and whether all are whole numbers."""
        return arrays.spread(self.cost)

    @property
    def num_pairs(self) -> int:
        return len(self.cost)

    @property
    def complete(self) -> bool:
        """True if every robot may be sent to every bin."""
        return self.num_pairs == self.num_robots * self.num_bins

    @property
    def robots(self) -> NDArray[np.int64]:
        """Robot of each pair."""
        return np.repeat(np.arange(self.num_robots), np.diff(self.indptr))

    def matrix(self) -> Floats:
        """The costs as a matrix of shape (robots, bins), infinite where a pair is forbidden; a view where all are allowed."""
        if self.complete:
            return self.cost.reshape(self.num_robots, self.num_bins)
        costs = np.full((self.num_robots, self.num_bins), math.inf)
        costs[self.robots, self.bins] = self.cost
        return costs

    @property
    def waits(self) -> Floats:
        """``filled``, empty where nobody has to wait."""
        return np.zeros(0) if self.filled is None else self.filled

    def to_frame(self) -> pd.DataFrame:
        """One row per pair: robot, bin, cost."""
        import pandas as pd

        names = [self.robot_name(k) for k in self.robots.tolist()], [self.bin_name(k) for k in self.bins.tolist()]
        return pd.DataFrame({"robot": names[0], "bin": names[1], "cost": self.cost})

    def facts(self) -> dict[str, Any]:
        """Sizes and ranges, as plain JSON values."""
        degree, used = np.diff(self.indptr), np.bincount(self.bins, minlength=self.num_bins)
        return {
            **self.sizes(),
            "pairs": self.num_pairs,
            "forbidden": self.num_robots * self.num_bins - self.num_pairs,
            "bins_a_robot": [int(degree.min()), int(degree.max())],
            "robots_a_bin": [int(used.min()), int(used.max())],
            "costs": [self.spread.least, self.spread.largest] if self.num_pairs else [],
            "whole_costs": self.spread.whole,
            "not_yet_full": int((self.waits > 0).sum()),
            "positions": self.robot_positions is not None and self.bin_positions is not None,
        }

    def summary(self) -> Iterable[str]:
        return (*super().summary(), f"{self.num_pairs} pairs")

    def write_own(self) -> dict[str, Any]:
        """A matrix where at least half of all pairs are allowed, else lists of pairs."""
        if 2 * self.num_pairs >= self.num_robots * self.num_bins:
            return {"cost": json_numbers(self.matrix())}
        return {"pairs": {"robot": self.robots.tolist(), "bin": self.bins.tolist(), "cost": json_numbers(self.cost)}}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        if ("cost" in data) == ("pairs" in data):
            raise InputError("costs stand in one of two ways", "contradiction", expected="the key 'cost', a matrix, or the key 'pairs'")
        if "cost" in data:
            return {"costs": matrix(data["cost"], "cost", counts["robot"], counts["bin"], null=math.inf)}
        pairs = fields(data["pairs"], "pairs", PAIR_KEYS, PAIR_KEYS)
        robots = wholes(pairs["robot"], "pairs.robot")
        bins, costs = wholes(pairs["bin"], "pairs.bin", len(robots)), reals(pairs["cost"], "pairs.cost", len(robots))
        return {"robots": robots, "bins": bins, "costs": costs}

    @classmethod
    def from_values(cls, **values: Any) -> AssignmentInstance:
        if "robots" in values:
            return cls.from_pairs(**values)
        return cls.from_matrix(**{key: value for key, value in values.items() if key not in ("num_robots", "num_bins")})


def _not_rectangular(costs: Iterable[Any]) -> InputError:
    """The error for costs of which numpy makes no matrix."""
    try:
        lengths = [len(row) for row in costs]
    except TypeError:
        return InputError("costs must be a matrix of numbers, one row a robot and one column a bin", found=repr(costs)[:40])
    odd = next((k for k, length in enumerate(lengths) if length != lengths[0]), None)
    if odd is not None:
        return InputError(
            f"row {odd + 1} of the costs has a wrong length", "wrong-shape", expected=str(lengths[0]), found=str(lengths[odd])
        )
    return InputError("costs must hold numbers", found=repr(costs)[:40])
