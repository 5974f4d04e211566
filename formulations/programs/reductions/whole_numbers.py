"""Programs in integers, for solvers that count in nothing else.

A continuous variable can be counted in steps where, for any whole values of the others, whole numbers of steps are among the best: where
the continuous columns make up a totally unimodular matrix, so that with whole right sides the vertices are whole. Two kinds are known
here, after scaling to coefficients of 1 and -1. A forest: the z of a linearised product, the w of a max-min program. A network, whose rows
hold one 1 and one -1 at most, or whose columns do where rows of one entry are left out: levels and flows of routing programs. Rows
without continuous variables need no such property.

What fractions of small denominators hold is scaled exactly. All else is scaled finely, and rounded so that rows become no tighter and the
objective is off by at most a stated error: the integer program is then a relaxation, its bound is valid, and its points break a row
by no more than ``ROW_ERROR``.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....instances.number_arrays import Integers
from ..exactness import Exactness
from ..program import Floats, Program, Variables
from .finite_bounds import FINITE_BOUNDS
from .reduction import Irreducible, Reduction, Step

DENOMINATORS = (*range(1, 101), 1000, 10_000, 100_000, 1_000_000)
"""Tried in this order for exact scaling."""

ROW_ERROR = 1e-7
"""Most by which rounding may loosen a row, in the row's own units."""

OBJECTIVE_ERROR = 1e-9
"""Error of the objective that rounding should keep to, in parts of the sum of its terms; ``LARGEST_OBJECTIVE`` comes first."""

LARGEST_OBJECTIVE = 2.0**60

LARGEST = 2.0**55
"""Largest sum along a row or the objective: far enough below the limit of 64 bits for sums of sums."""

FUZZ = 1e-12
"""Relative error that sums of the data may carry. Where they are scaled finely this is loosened too, else a row that holds with equality
could break by one step."""

_WHOLE = 1e-9
_EPS = math.ulp(1.0)


@dataclass(frozen=True, eq=False)
class IntegerProgram:
    """minimise ``cost z + sum of factors z_i z_j`` over rows and bounds, all in integers; ``x = shift + unit * z``.

    ``pairs`` has the shape (products, 2); rows are in CSR form, their sides ``-UNLIMITED`` and ``UNLIMITED`` where there is no limit.
    ``sense`` is 1 for a program to be minimised and -1 for one to be maximised, ``scale`` how many integers make up one unit of the
    objective, ``error`` how far that can be from the program's, ``constant`` that of the program; both in the program's units. ``exact``
    says that nothing was rounded, ``source`` is the program.
    """

    is_integer: ClassVar[bool] = True

    lower: Integers
    upper: Integers
    cost: Integers
    pairs: Integers
    factors: Integers
    indptr: Integers
    indices: Integers
    data: Integers
    row_lower: Integers
    row_upper: Integers
    unit: Floats
    shift: Floats
    sense: float
    scale: float
    error: float
    constant: float
    exact: bool
    source: Program

    @property
    def num_variables(self) -> int:
        return len(self.cost)

    def value(self, z: Any) -> float:
        """Objective, in integers, of integer values."""
        z = np.asarray(z, dtype=np.float64)
        return float(self.cost @ z + self.factors @ z[self.pairs].prod(axis=1))

    def residual(self, z: Any) -> float:
        """Largest violation by integer values, counted in fractions again."""
        return self.source.residual(self.vector(z))

    def vector(self, z: Any) -> Floats:
        """The program's vector for integer values."""
        return np.asarray(self.shift + self.unit * np.asarray(z, dtype=np.float64))

    def nearest(self, x: Floats) -> Integers:
        """Integer values for a vector of the program, within their bounds; those of a NaN are the lower bounds."""
        steps = (x - self.shift) / self.unit
        whole = np.where(np.abs(steps - np.rint(steps)) <= 1e-6, np.rint(steps), np.floor(steps))
        return np.asarray(np.clip(np.where(np.isfinite(whole), whole, self.lower), self.lower, self.upper), dtype=np.int64)

    def bound(self, least: float) -> float:
        """Bound of the program's objective from one of the integer objective: rounded outwards."""
        bound = least / self.scale - self.error
        bound -= 4 * _EPS * (abs(bound) + abs(self.constant))
        return self.sense * bound + self.constant


UNLIMITED = 2**62


def integer_program(source: Program, bounded: Program | None = None) -> IntegerProgram:
    """The program in integers; raises Irreducible where numbers, bounds or continuous variables do not allow it.

    Its rows hold each column once. ``bounded`` is the same program with bounds derived where it has none, which need not be met exactly.
    """
    program = bounded or source
    sense = 1.0 if program.sense == "min" else -1.0
    endless = ~(np.isfinite(program.lower) & np.isfinite(program.upper))
    if endless.any():
        name = program.variable_name(int(np.argmax(endless)))
        raise Irreducible(f"variables without bounds ({name})")
    fixed = program.lower == program.upper
    shift = np.where(fixed, program.lower, 0.0)
    cost, constant, pairs, products = _objective(program, shift, fixed)
    whole = program.integer | fixed
    if (~whole[pairs]).all(axis=1).any():
        raise Irreducible("products of continuous variables")

    m, (row, column, value) = program.num_rows, _entries(program, fixed)
    moved = program.matrix @ shift
    sides = np.stack([program.row_lower - moved, program.row_upper - moved])
    row_scale, unit, group = _unimodular(program, row, column, value, whole)
    bounds = np.stack([np.where(fixed, 0.0, program.lower), np.where(fixed, 0.0, program.upper)])
    met = np.where(np.isfinite([source.lower, source.upper]), bounds, 0.0)
    factor, exact = _group_factors(row, column, value, sides, bounds, np.where(whole, 0.0, met / unit), whole, row_scale, unit, group)
    row_factor, unit = row_scale * factor[group[:m]], np.where(whole, 1.0, unit / factor[group[m:]])
    indptr, indices, data, row_lower, row_upper = _rounded_rows(
        program, row, column, value, sides, bounds, whole, row_factor, exact[group[:m]]
    )
    steps = bounds / unit
    fuzz = np.where(exact[group[m:]], 0.0, FUZZ * np.abs(steps))
    low = np.where(whole, np.ceil(_snapped(steps[0])), np.floor(_snapped(steps[0] - fuzz[0])))
    high = np.where(whole, np.floor(_snapped(steps[1])), np.ceil(_snapped(steps[1] + fuzz[1])))
    scale, weights, error = _scaled_objective(cost * unit, products * unit[pairs].prod(axis=1), pairs, low, high)
    if not (np.abs([low, high]).max(initial=0.0) <= LARGEST):
        raise Irreducible("values that are too large to count in integers")
    n = len(unit)
    return IntegerProgram(
        lower=low.astype(np.int64), upper=high.astype(np.int64), cost=weights[:n].astype(np.int64), pairs=pairs,
        factors=weights[n:].astype(np.int64), indptr=indptr, indices=indices, data=data, row_lower=row_lower, row_upper=row_upper,
        unit=unit, shift=shift, sense=sense, scale=scale, error=error, constant=constant, exact=bool(exact.all()) and error == 0.0,
        source=source,
    )  # fmt: skip


def _objective(program: Program, shift: Floats, fixed: NDArray[np.bool_]) -> tuple[Floats, float, Integers, Floats]:
    """Costs to be minimised, constant, pairs of columns and the factor of each product, with fixed columns put in."""
    sense = 1.0 if program.sense == "min" else -1.0
    cost, none = program.cost.copy(), np.zeros((0, 2), dtype=np.int64)
    if program.quadratic is None:
        return np.where(fixed, 0.0, sense * cost), program.value(shift), none, np.zeros(0)
    import scipy.sparse as sp

    upper = sp.coo_matrix(sp.triu(program.quadratic))
    cost += np.asarray(program.quadratic @ shift)
    keep = ~fixed[upper.row] & ~fixed[upper.col] & (upper.data != 0)
    i, j, q = upper.row[keep].astype(np.int64), upper.col[keep].astype(np.int64), upper.data[keep]
    q = np.where(i == j, q / 2.0, q)
    binary = (i == j) & program.integer[i] & (program.lower[i] >= 0) & (program.upper[i] <= 1)
    np.add.at(cost, i[binary], q[binary])  # a binary is its own square
    i, j, q = i[~binary], j[~binary], q[~binary]
    return np.where(fixed, 0.0, sense * cost), program.value(shift), np.stack([i, j], axis=1), sense * q


def _entries(program: Program, fixed: NDArray[np.bool_]) -> tuple[Integers, Integers, Floats]:
    row = np.repeat(np.arange(program.num_rows), np.diff(program.indptr))
    keep = (program.data != 0) & ~fixed[program.indices]
    return row[keep], program.indices[keep].astype(np.int64), program.data[keep]


def _unimodular(
    program: Program, row: Integers, column: Integers, value: Floats, whole: NDArray[np.bool_]
) -> tuple[Floats, Floats, Integers]:
    """Scales of rows and steps of continuous columns that make all coefficients of the latter 1 or -1, up to a factor per group.

    Nodes are the rows and, after them, the columns. Returns the scale of each row, the step of each column, and the group of each node.
    """
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    m, n = program.num_rows, program.num_variables
    tied = np.nonzero(~whole[column])[0]
    i, j, entry = row[tied], column[tied], value[tied]
    graph = sp.coo_matrix((np.ones(len(tied)), (i, m + j)), shape=(m + n, m + n))
    groups, group = connected_components(graph, directed=False)
    scale, step = _scales(i, j, np.abs(entry), group, groups, m, n)
    if len(tied) != m + n - groups:
        alike = (np.abs(scale[i] * np.abs(entry) * step[j] - 1.0) <= _WHOLE).all()
        if not alike or not _is_network(i, j, np.sign(entry), m, n):
            raise Irreducible(f"continuous variables that cannot be counted in steps (such as {program.variable_name(int(j[0]))})")
    return scale, step, group.astype(np.int64)


def _is_network(i: Integers, j: Integers, sign: Floats, m: int, n: int) -> bool:
    """True if rows hold at most one 1 and one -1, or columns do where rows of one entry do not count."""
    inner = np.bincount(i, minlength=m)[i] > 1
    i, j, sign = i[inner], j[inner], sign[inner]

    def one_each(line: Integers, size: int) -> bool:
        return all(np.bincount(line[sign == which], minlength=size).max(initial=0) <= 1 for which in (1.0, -1.0))

    return one_each(i, m) or one_each(j, n)


def _scales(i: Integers, j: Integers, size: Floats, group: NDArray[np.integer[Any]], groups: int, m: int, n: int) -> tuple[Floats, Floats]:
    """Scales and steps along shortest ways from the first column of each group, which make all coefficients 1 if any do."""
    step, scale = np.full(n, np.nan), np.full(m, np.nan)
    first = np.full(groups, n, dtype=np.int64)
    np.minimum.at(first, group[m:], np.arange(n))
    step[first[first < n]] = 1.0
    scale[np.bincount(i, minlength=m) == 0] = 1.0
    while True:  # one step further from the roots
        known = np.isfinite(step[j]) & ~np.isfinite(scale[i])
        scale[i[known]] = 1.0 / (size[known] * step[j[known]])
        back = np.isfinite(scale[i]) & ~np.isfinite(step[j])
        step[j[back]] = 1.0 / (size[back] * scale[i[back]])
        if not known.any() and not back.any():
            return scale, step


def _group_factors(
    row: Integers, column: Integers, value: Floats, sides: Floats, bounds: Floats, steps: Floats, whole: NDArray[np.bool_],
    row_scale: Floats, unit: Floats, group: Integers,
) -> tuple[Floats, NDArray[np.bool_]]:  # fmt: skip
    """Factor that makes coefficients, sides and steps of each group whole, or fine enough for its rows; and which are whole."""
    m = len(row_scale)
    mine = whole[column]
    others, at = value[mine] * row_scale[row[mine]], group[row[mine]]
    side = np.where(np.isfinite(sides), sides, 0.0) * row_scale
    values = np.abs(np.concatenate([others, *side, *steps]))
    where = np.concatenate([at, group[:m], group[:m], group[m:], group[m:]])
    distinct, of = np.unique(values, return_inverse=True)
    denominator = _denominators(distinct)[of]
    denominator[: len(others)][(values[: len(others)] != 0) & (np.rint(values * denominator)[: len(others)] == 0)] = 0
    factor = np.ones(int(group.max(initial=-1)) + 1, dtype=np.int64)
    exact = np.ones(len(factor), dtype=bool)
    exact[where[denominator == 0]] = False
    for k in np.unique(denominator[denominator > 1]).tolist():
        has = np.unique(where[denominator == k])
        factor[has] = np.lcm(factor[has], k)
        exact[has[factor[has] > DENOMINATORS[-1]]] = False
        factor[~exact] = 1
    # A coefficient is off by half a step, times the largest value of its variable.
    reach = np.bincount(row[mine], 0.5 * np.abs(bounds).max(axis=0)[column[mine]], minlength=m) + 1.0
    fine = np.zeros(len(factor))
    np.maximum.at(fine, group[:m], reach / (ROW_ERROR * row_scale))
    np.maximum.at(fine, group[m:], unit / ROW_ERROR)  # and a bound by a step
    return np.where(exact, factor.astype(np.float64), np.exp2(np.ceil(np.log2(np.maximum(fine, 1.0))))), exact


def _denominators(values: Floats) -> Integers:
    """Smallest denominator of each value, 0 where there is none among ``DENOMINATORS``."""
    smallest = np.zeros(len(values), dtype=np.int64)
    unsettled = np.arange(len(values))
    for d in DENOMINATORS:
        if len(unsettled) == 0:
            break
        scaled = values[unsettled] * d
        good = _is_whole(scaled)
        smallest[unsettled[good]] = d
        unsettled = unsettled[~good]
    return smallest


def _rounded_rows(
    program: Program, row: Integers, column: Integers, value: Floats, sides: Floats, bounds: Floats, whole: NDArray[np.bool_],
    row_factor: Floats, exact: NDArray[np.bool_],
) -> tuple[Integers, Integers, Integers, Integers, Integers]:  # fmt: skip
    """Rows in integers; rows that are not exact are loosened by the largest error that rounding their coefficients can make."""
    m = program.num_rows
    scaled, top = value * row_factor[row], np.abs(bounds).max(axis=0)[column]
    rounded = np.where(whole[column], np.rint(scaled), np.sign(scaled))
    reach = np.bincount(row, np.abs(scaled) * top, minlength=m)
    if reach.max(initial=0.0) > LARGEST:
        raise Irreducible(f"numbers as far apart as those of row {program.row_name(int(np.argmax(reach)))}")
    off = np.where(whole[column], np.abs(scaled - rounded), 0.0)
    side = sides * row_factor
    fuzz = FUZZ * (reach + np.where(np.isfinite(side), np.abs(side), 0.0))
    loose = np.where(exact, 0.0, np.bincount(row, off * top, minlength=m) + fuzz)
    low, high = _snapped(side[0] - loose[0]), _snapped(side[1] + loose[1])
    # Whole numbers alone: the next one inside. With continuous variables: the next one outside, for their sums are not whole.
    mixed = np.bincount(row, ~whole[column], minlength=m) > 0
    low, high = np.where(mixed, np.floor(low), np.ceil(low)), np.where(mixed, np.ceil(high), np.floor(high))
    low, high = np.where(low <= -reach - 1.0, -UNLIMITED, low), np.where(high >= reach + 1.0, UNLIMITED, high)
    keep = rounded != 0
    indptr = np.zeros(m + 1, dtype=np.int64)
    np.cumsum(np.bincount(row[keep], minlength=m), out=indptr[1:])
    # A side that no value of the row comes near is cut to what 64 bits hold: such a row is infeasible either way.
    low, high = np.clip(low, -float(UNLIMITED), float(UNLIMITED)), np.clip(high, -float(UNLIMITED), float(UNLIMITED))
    return indptr, column[keep], rounded[keep].astype(np.int64), low.astype(np.int64), high.astype(np.int64)


def _scaled_objective(cost: Floats, products: Floats, pairs: Integers, low: Floats, high: Floats) -> tuple[float, Floats, float]:
    """Scale, whole weights of variables and products, and how far their sum can be from the true objective."""
    weights = np.concatenate([cost, products])
    top = np.maximum(np.abs(low), np.abs(high))
    reach = np.concatenate([top, top[pairs].prod(axis=1)])
    used = weights != 0
    if not used.any():
        return 1.0, weights, 0.0
    total = float(np.abs(weights[used]) @ reach[used])
    for base in (1.0, float(np.abs(weights[used]).min())):
        values = np.unique(np.abs(weights[used]) / base)
        denominators = np.unique(_denominators(values)).tolist()
        scale = math.lcm(*denominators) / base
        vanishes = values[0] * scale * base < 0.5  # a weight that is no multiple of anything tried, but nearly 0
        if denominators[0] > 0 and not vanishes and scale * base <= DENOMINATORS[-1] and scale * total <= LARGEST_OBJECTIVE:
            return scale, np.rint(weights * scale), 0.0
    finest, needed = LARGEST_OBJECTIVE / total, 0.5 * float(reach[used].sum()) / (OBJECTIVE_ERROR * total)
    scale = float(np.exp2(min(np.floor(np.log2(finest)), np.ceil(np.log2(needed)))))
    rounded = np.rint(weights * scale)
    error = float((np.abs(weights * scale - rounded) * reach).sum()) / scale
    return scale, rounded, error * (1.0 + 1e-12)


def _is_whole(values: Floats) -> NDArray[np.bool_]:
    """Which values are integers but for the rounding of floats."""
    with np.errstate(invalid="ignore"):  # infinity less infinity
        return np.asarray(np.abs(values - np.rint(values)) <= _WHOLE + 4 * _EPS * np.abs(values))


def _snapped(values: Floats) -> Floats:
    """Values that are whole but for the rounding of floats, made whole."""
    return np.where(_is_whole(values), np.rint(values), values)


@dataclass(frozen=True, eq=False, kw_only=True)
class Counted(Step):
    """An ``IntegerProgram`` in place of the program."""

    name = "whole-numbers"

    def vector(self, x: Any) -> Floats:
        return self.program.vector(x)  # type: ignore[no-any-return]

    def encoded(self, x: Floats) -> Floats:
        return np.where(np.isfinite(x), self.program.nearest(x), np.nan)

    def value(self, value: float) -> float:
        return float(self.program.sense * value / self.program.scale + self.program.constant)

    def bound(self, bound: float) -> float:
        return self.program.bound(bound)  # type: ignore[no-any-return]


class WholeNumbers(Reduction):
    """Counts all variables in whole steps, with finite bounds: for solvers that know nothing else."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``; the rows hold each column once."""
        bounded = FINITE_BOUNDS.apply(program)
        counted = integer_program(program, bounded[-1].program if bounded else None)
        note = f"objective in steps of {1.0 / counted.scale:g}"
        if not counted.exact:
            note += f", rounded by {counted.error:g} at most, rows loosened by {ROW_ERROR:g} at most"
        return (*bounded, Counted(program=counted, exactness=Exactness.EXACT if counted.exact else Exactness.RELAXATION, told=note))


class Whole(Step):
    """The same with integer variables in place of continuous ones that have whole values anyway."""

    name = "whole-variables"


class WholeVariables(Reduction):
    """Makes all variables integer and gives them finite bounds, where that does not change their values."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``; the rows hold each column once."""
        bounded = FINITE_BOUNDS.apply(program)
        counted = integer_program(program, bounded[-1].program if bounded else None)
        if not ((counted.unit == 1.0).all() and (counted.shift == np.round(counted.shift)).all()):
            raise Irreducible("continuous variables")
        if program.integer.all():
            return bounded
        low, high = counted.vector(counted.lower), counted.vector(counted.upper)
        whole = replace(program, variables=(Variables("x", lower=low, upper=high, cost=program.cost, integer=True),))
        return (*bounded, Whole(program=whole, told=f"{int((~program.integer).sum())} continuous variables made integer"))


WHOLE_NUMBERS, WHOLE_VARIABLES = WholeNumbers(), WholeVariables()
