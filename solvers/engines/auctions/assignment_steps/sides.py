"""A bin assignment as one or two in which every row can have a column, and the prices of the whole from theirs."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .....formulations.auctions.bin_assignment import BinAssignment
from .....formulations.auctions.matching import surplus_rows
from .....formulations.evidence import Evidence
from .....formulations.stop import Stop
from .....formulations.tolerance import same
from .....instances.number_arrays import BLOCK, Spread, spread

Floats = NDArray[np.float64]
Wholes = NDArray[np.int64]


@dataclass(frozen=True)
class Side:
    """Rows that each get a column, of which there may be more.

    Allowed pairs are a CSR matrix; ``listed`` is None where each row has all columns. Rows are robots, or bins where columns are robots;
    their numbers are those of the problem. ``known`` is the spread of the costs, where it is known.
    """

    indptr: Wholes
    listed: NDArray[np.int32] | None
    cost: Floats
    num_columns: int
    rows_are_robots: bool
    row_numbers: Wholes
    column_numbers: Wholes
    known: Spread | None = None

    @property
    def num_rows(self) -> int:
        return len(self.indptr) - 1

    @property
    def complete(self) -> bool:
        return len(self.cost) == self.num_rows * self.num_columns

    @cached_property
    def columns(self) -> NDArray[np.int32]:
        """Column of each pair."""
        return np.tile(np.arange(self.num_columns, dtype=np.int32), self.num_rows) if self.listed is None else self.listed

    @cached_property
    def spread(self) -> Spread:
        """The least and the largest cost, and whether all are whole numbers."""
        return spread(self.cost) if self.known is None else self.known


def sides(problem: BinAssignment) -> list[Side]:
    """The whole problem, whichever are fewer bidding; or two halves, where neither robots nor bins can all be matched.

    Every assignment of the most pairs matches all robots of the first half with bins of it, and all bins of the second with robots of it
    (Dulmage and Mendelsohn 1958): pairs between the halves are of no use.
    """
    n, m = problem.num_robots, problem.num_bins
    whole = problem.indptr.astype(np.int64), None if problem.complete else problem.bins, problem.cost
    most = n if problem.complete and n <= m else m if problem.complete else int((problem.largest >= 0).sum())
    if most == n:
        return [Side(*whole, m, True, np.arange(n), np.arange(m), problem.spread)]
    if most == m and problem.complete:
        return [Side(np.arange(m + 1) * n, None, problem.matrix().T.flatten(), n, False, np.arange(m), np.arange(n), problem.spread)]
    if most == m:
        return [_turned(problem.indptr.astype(np.int64), problem.bins, problem.cost, m)]
    rows, columns = surplus_rows(problem.indptr, problem.bins, m, problem.largest)
    halves = []
    for own_rows, own_columns, robots in ((~rows, ~columns, True), (rows, columns, False)):
        if not own_rows.any() or not own_columns.any():
            continue
        kept = own_rows[problem.robots] & own_columns[problem.bins]
        at_row, at_column = (np.cumsum(marks) - 1 for marks in (own_rows, own_columns))
        robot, column = at_row[problem.robots[kept]], at_column[problem.bins[kept]].astype(np.int32)
        indptr = np.concatenate([[0], np.cumsum(np.bincount(robot, minlength=int(own_rows.sum())))])
        numbers = np.nonzero(own_rows)[0], np.nonzero(own_columns)[0]
        half = Side(indptr, column, problem.cost[kept], len(numbers[1]), True, *numbers)
        halves.append(half if robots else _turned(indptr, column, half.cost, half.num_columns, numbers))
    return halves


def _turned(indptr: Wholes, columns: Any, cost: Floats, m: int, numbers: tuple[Wholes, Wholes] | None = None) -> Side:
    n = len(indptr) - 1
    rows = np.repeat(np.arange(n, dtype=np.int32), np.diff(indptr))
    order = np.argsort(columns, kind="stable")
    turned = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=m))])
    robots, bins = (np.arange(n), np.arange(m)) if numbers is None else numbers
    return Side(turned, rows[order], cost[order], n, False, bins, robots)


def joined(problem: BinAssignment, parts: list[Side], columns_of_rows: list[Wholes]) -> tuple[int, ...]:
    """The answer of the whole from the columns of the rows of each part."""
    bins = np.full(problem.num_robots, -1, dtype=np.int64)
    for part, column in zip(parts, columns_of_rows, strict=True):
        has = np.nonzero(column >= 0)[0]
        rows, columns = part.row_numbers[has], part.column_numbers[column[has]]
        if part.rows_are_robots:
            bins[rows] = columns
        else:
            bins[columns] = rows
    return tuple(bins.tolist())


def split(problem: BinAssignment, parts: list[Side], answer: tuple[int, ...]) -> list[Wholes]:
    """Inverse of ``joined``."""
    bins = np.array(answer, dtype=np.int64)
    holder = np.full(problem.num_bins, -1, dtype=np.int64)
    holder[bins[bins >= 0]] = np.nonzero(bins >= 0)[0]
    parted = []
    for part in parts:
        number = np.full(problem.num_bins if part.rows_are_robots else problem.num_robots, -1, dtype=np.int64)
        number[part.column_numbers] = np.arange(part.num_columns)
        partner = (bins if part.rows_are_robots else holder)[part.row_numbers]
        parted.append(np.where(partner >= 0, number[partner], -1))
    return parted


def least_paid(part: Side, prices: Floats) -> Floats:
    """min over its columns of cost and price, one a row; every row has a column."""
    if not part.complete:
        return np.asarray(np.minimum.reduceat(part.cost + prices[part.columns], part.indptr[:-1]))
    n, m = part.num_rows, part.num_columns
    matrix, some = part.cost.reshape(n, m), max(1, BLOCK // m)
    return np.concatenate([(matrix[begin : begin + some] + prices).min(axis=1) for begin in range(0, n, some)])


POLISHING = 200
"""Sweeps that take the rounding of costs to whole numbers out of prices, if only that is missing for a proof."""


def proof(
    problem: BinAssignment, parts: list[Side], prices: list[Floats], answer: tuple[int, ...], source: str, stop: Stop, exact: bool = False
) -> Evidence:
    """Evidence of prices; where they nearly prove ``answer`` optimal, their last digits are corrected.

    ``exact`` prices prove its costs to the last digit, so that the value is not multiplied out here.
    """
    costs = problem.costs_of(answer)
    value, size = math.fsum(costs), math.fsum(np.abs(costs))
    if exact:
        return price_evidence(problem, parts, prices, source, value)
    evidence = price_evidence(problem, parts, prices, source)
    if same(value, evidence.value, size) or not same(value, evidence.value, float(np.abs(problem.cost).max(initial=0.0)) * len(costs)):
        return evidence
    from .price_kernels import lower_labels, raise_labels

    proofs = [evidence]
    for labels, scale in ((lower_labels, 1.0), (raise_labels, 0.0)):  # the least prices lose fewest digits beside tiny costs
        polished = []
        for part, column, own in zip(parts, split(problem, parts, answer), prices, strict=True):
            price = own * scale
            labels(stop.flag, part.indptr, part.columns, part.cost, column.astype(np.int64), price, POLISHING)
            polished.append(np.maximum(price, 0.0))
        proofs.append(price_evidence(problem, parts, polished, source))
    return max(proofs, key=lambda evidence: evidence.value)


def price_evidence(problem: BinAssignment, parts: list[Side], prices: list[Floats], source: str, known: float | None = None) -> Evidence:
    """Evidence ``assignment-prices`` of prices >= 0 of the columns of each part, 0 for free columns; its value may be known."""
    from .....formulations.verified_bounds import verified_bound

    of_bins, level = np.zeros(problem.num_bins), 0.0
    if len(parts) == 1 and (parts[0].num_rows == problem.num_robots) and parts[0].rows_are_robots:
        of_bins[:] = prices[0]
    elif len(parts) == 1 and parts[0].num_rows == problem.num_bins and not parts[0].rows_are_robots:
        of_bins[:] = -least_paid(parts[0], prices[0])
    else:
        level = _level(problem, parts, prices, of_bins)
    data = {"prices": of_bins.tolist(), "level": level}
    if known is not None:
        return Evidence("assignment-prices", source, known, data)
    evidence = Evidence("assignment-prices", source, 0.0, data)
    return Evidence("assignment-prices", source, verified_bound(problem, evidence), data)


def _level(problem: BinAssignment, parts: list[Side], prices: list[Floats], of_bins: Floats) -> float:
    """Fill in the prices of bins, and return a level so high that no pair between the halves pays."""
    robots, bins = np.full(problem.num_robots, np.nan), np.full(problem.num_bins, np.nan)
    for part, own in zip(parts, prices, strict=True):
        least = least_paid(part, own)
        if part.rows_are_robots:
            of_bins[part.column_numbers], robots[part.row_numbers] = own, least
        else:
            bins[part.row_numbers] = least
    across = robots[problem.robots] + bins[problem.bins] - problem.cost
    level = float(np.nanmax(np.concatenate([robots, bins, across, [0.0]])))
    held = ~np.isnan(bins)
    of_bins[held] = level - bins[held]
    return level
