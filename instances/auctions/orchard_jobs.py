"""Bins of an orchard that robots bring and fetch: what is known of the rest of a day."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import an, label
from .orchard_grid import OrchardGrid
from .orchard_rules import NONE, OrchardRules, OrchardStart

Integers = NDArray[np.int64]

PROBLEMS = ("orchard-day",)
"""What may be asked of such data."""

LONGEST = 10**6
"""Steps of a wait: sums stay far below 2**53."""


@dataclass(frozen=True, eq=False)
class OrchardJobs:
    """Robots, and bins that come home full: those that stand in the orchard, and those that have to be brought there first.

    A bin is full ``work`` steps after it stands in its cell and the bin ``after`` which it is filled is full.

    Parameters
    ----------
    grid : OrchardGrid
    robot_cells : array of shape (robots,)
        Where each robot can begin.
    robot_free : array of shape (robots,), steps
        When.
    bin_cells : array of shape (bins,)
        Harvest cells.
    after : array of shape (bins,)
        The bin that is filled before each, of a lower number and by the same group; -1 for none.
    standing : bool array of shape (bins,)
        Whether each stands in its cell at step 0; the others robots bring from the repository.
    work : array of shape (bins,), steps
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If an array has the wrong length or holds what it must not.

    Notes
    -----
    Source: Zhang (2015), chapter 3; docs/formulations/orchard-day.md#model.
    """

    kind: ClassVar[str] = "orchard-jobs"
    grid: OrchardGrid
    robot_cells: Integers
    robot_free: Integers
    bin_cells: Integers
    after: Integers
    standing: NDArray[np.bool_]
    work: Integers
    name: str = "orchard-jobs"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    @classmethod
    def of_routes(cls, rules: OrchardRules, start: OrchardStart, name: str = "orchard-jobs") -> OrchardJobs:
        """A whole day of groups that keep to routes of their own.

        Parameters
        ----------
        rules : OrchardRules
        start : OrchardStart
            Its orders share no cell, and name each harvest cell, so that a group's way does not depend on the others.

        Raises
        ------
        InputError
            If they do not.
        """
        routes = [
            [int(first), *(int(c) for c in order if c not in (NONE, first))] for first, order in zip(start.cells, start.orders, strict=True)
        ]
        if sorted(cell for route in routes for cell in route) != rules.grid.harvested.tolist():
            raise InputError("the routes of groups must share no cell, and name each harvest cell")
        cells: list[int] = []
        after: list[int] = []
        standing: list[bool] = []
        for route in routes:
            for k, cell in enumerate(cell for cell in route for _ in range(rules.bins_per_cell)):
                after.append(len(cells) - 1 if k else NONE)
                standing.append(k == 0)
                cells.append(cell)
        robots = np.full(rules.robots, rules.grid.home)
        return cls(
            rules.grid, robots, np.zeros_like(robots), np.array(cells), np.array(after), np.array(standing),
            np.full(len(cells), rules.fill), name=name,
        )  # fmt: skip

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", label(self.name))
        for key in ("robot_cells", "robot_free", "bin_cells", "after", "work"):
            object.__setattr__(self, key, arrays.whole_numbers(key, getattr(self, key)))
        flags = np.asarray(self.standing)
        if flags.dtype != bool or flags.shape != self.bin_cells.shape:
            raise InputError("standing must have one truth value a bin")
        object.__setattr__(self, "standing", flags)
        for what, cells in (("robot", self.robot_cells), ("bin", self.bin_cells)):
            if not len(cells):
                raise InputError(f"there must be {an(what)}")
        for key, like in (("robot_free", "robot_cells"), ("after", "bin_cells"), ("work", "bin_cells")):
            if len(getattr(self, key)) != len(getattr(self, like)):
                raise InputError(
                    f"{key} and {like} must be of one length", expected=str(len(getattr(self, like))), found=str(len(getattr(self, key)))
                )
        arrays.refuse_outside("the cell of robot {}", self.robot_cells, self.grid.size, "cell")
        harvested = np.isin(self.bin_cells, self.grid.harvested)
        if not harvested.all():
            k = int(np.argmin(harvested))
            raise InputError(f"bin {k + 1} does not stand in a harvest cell", found=f"cell {self.bin_cells[k]}")
        for key in ("robot_free", "work"):
            wrong = (getattr(self, key) < 0) | (getattr(self, key) > LONGEST)
            if wrong.any():
                raise InputError(f"{key} must be from 0 to {LONGEST}", found=str(getattr(self, key)[int(np.argmax(wrong))]))
        wrong = (self.after < NONE) | (self.after >= np.arange(len(self.after)))
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(f"bin {k + 1} is filled after one that has no lower number", found=f"{self.after[k]}, counted from 0")
        twice = np.sort(self.after[self.after >= 0])
        if (np.diff(twice) == 0).any():
            raise InputError(f"two bins are filled next after bin {twice[int(np.argmax(np.diff(twice) == 0))] + 1}")
        for key in ("robot_cells", "robot_free", "bin_cells", "after", "standing", "work"):
            object.__setattr__(self, key, arrays.frozen(getattr(self, key)))

    # -- lookups -----------------------------------------------------------------------------------------------------

    @property
    def num_robots(self) -> int:
        return len(self.robot_cells)

    @property
    def num_bins(self) -> int:
        return len(self.bin_cells)

    @cached_property
    def out(self) -> Integers:
        """Steps from the repository to each bin's cell."""
        return np.asarray(self.grid.empty_times[self.grid.home, self.bin_cells])

    @cached_property
    def home(self) -> Integers:
        """Steps from each bin's cell to the repository with the full bin."""
        return np.asarray(self.grid.full_times[self.bin_cells, self.grid.home])

    @property
    def away(self) -> NDArray[np.bool_]:
        """Which robots do not begin at the repository."""
        return np.asarray(self.robot_cells != self.grid.home)

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        g = self.grid
        return digest(
            "orchard-jobs", g.rows, g.columns, g.repository, g.empty_speed, g.full_speed, self.robot_cells, self.robot_free, self.bin_cells,
            self.after, self.standing, self.work,
        )  # fmt: skip

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        return {
            "rows": self.grid.rows, "columns": self.grid.columns, "robots": self.num_robots, "robots_away": int(self.away.sum()),
            "bins": self.num_bins, "bins_standing": int(self.standing.sum()), "work": int(self.work.sum()),
        }  # fmt: skip

    def __repr__(self) -> str:
        return f"<OrchardJobs {self.name}: {self.num_robots} robots, {self.num_bins} bins, {self.grid.rows} x {self.grid.columns} cells>"
