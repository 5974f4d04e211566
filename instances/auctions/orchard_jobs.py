"""Bins of an orchard that robots bring and fetch: what is known of the rest of a day."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from .. import number_arrays as arrays
from ..declared import CountOf, Declared
from ..document import fields, flags, integer, wholes
from ..errors import InputError
from ..instance import digest
from ..parts import Axis, Flags, Wholes
from .orchard_grid import OrchardGrid
from .orchard_rules import NONE, OrchardRules, OrchardStart

Integers = NDArray[np.int64]

LONGEST = 10**6
"""Steps of a wait: sums stay far below 2**53."""

GRID_KEYS = {"rows": 1, "columns": 3, "repository": 0, "empty_speed": 1, "full_speed": 1}
ROBOT_KEYS = ("row", "column", "free")
BIN_KEYS = ("row", "column", "after", "standing", "work")
"""Keys of JSON, the first with the least that each may be."""


@dataclass(frozen=True, eq=False, repr=False)
class OrchardJobs(Declared):
    """Robots, and bins that come home full: those that stand in the orchard, and those that have to be brought there first.

    A bin is full ``work`` steps after it stands in its cell and the bin ``after`` which it is filled is full.

    Parameters
    ----------
    grid : OrchardGrid
        Cells of the orchard, and the repository.
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
        How long filling each takes.
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

    kind = "orchard-jobs"
    problem_names = ("orchard-day",)
    content = "bins in an orchard"
    axes = (Axis("robot", table=False), Axis("bin", table=False))
    own_keys = ("orchard", "robots", "bins")
    grid: OrchardGrid
    robot_cells: Annotated[Integers, Wholes("robot", stored=False)]
    robot_free: Annotated[Integers, Wholes("robot", high=LONGEST, stored=False)]
    bin_cells: Annotated[Integers, Wholes("bin", stored=False)]
    after: Annotated[Integers, Wholes("bin", stored=False)]
    standing: Annotated[NDArray[np.bool_], Flags("bin", stored=False)]
    work: Annotated[Integers, Wholes("bin", high=LONGEST, stored=False)]
    num_robots, num_bins = CountOf("robot"), CountOf("bin")

    @classmethod
    def of_routes(cls, rules: OrchardRules, start: OrchardStart, name: str = "orchard-jobs") -> "OrchardJobs":
        """A whole day of groups that keep to routes of their own.

        Parameters
        ----------
        rules : OrchardRules
            The grid, and how bins are filled.
        start : OrchardStart
            Its orders share no cell, and name each harvest cell, so that a group's way does not depend on the others.
        name : str
            For tables and files.

        Raises
        ------
        InputError
            If they do not.
        """
        routes = [
            [int(first), *(int(c) for c in order if c not in (NONE, first))] for first, order in zip(start.cells, start.orders, strict=True)
        ]
        if sorted(cell for route in routes for cell in route) != rules.grid.harvested.tolist():
            raise InputError("the routes of groups must share no cell, and name each harvest cell", "contradiction")
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

    def arrange(self) -> None:
        arrays.refuse_outside("the cell of robot {}", self.robot_cells, self.grid.size, "cell")
        harvested = np.isin(self.bin_cells, self.grid.harvested)
        if not harvested.all():
            k = int(np.argmin(harvested))
            raise InputError(f"bin {k + 1} does not stand in a harvest cell", "contradiction", found=f"cell {self.bin_cells[k]}")

    def check_rest(self) -> None:
        wrong = (self.after < NONE) | (self.after >= np.arange(self.num_bins))
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(
                f"bin {k + 1} is filled after one that has no lower number", "contradiction", found=f"{self.after[k]}, counted from 0"
            )
        twice = np.sort(self.after[self.after >= 0])
        if (np.diff(twice) == 0).any():
            raise InputError(f"two bins are filled next after bin {twice[int(np.argmax(np.diff(twice) == 0))] + 1}", "duplicate")

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
        """Mask of the robots that do not begin at the repository."""
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

    def summary(self) -> Iterable[str]:
        return (*super().summary(), f"{self.grid.rows} x {self.grid.columns} cells")

    def write_own(self) -> dict[str, Any]:
        """Cells by row and column; bins are counted from 1."""
        robots, bins = (
            {"row": (cells // self.grid.columns).tolist(), "column": (cells % self.grid.columns).tolist()}
            for cells in (self.robot_cells, self.bin_cells)
        )
        bins.update(after=(self.after + 1).tolist(), standing=self.standing.tolist(), work=self.work.tolist())
        grid = {key: getattr(self.grid, key) for key in GRID_KEYS}
        return {"orchard": grid, "robots": {**robots, "free": self.robot_free.tolist()}, "bins": bins}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        orchard = fields(data["orchard"], "orchard", GRID_KEYS, GRID_KEYS)
        grid = OrchardGrid(**{key: integer(orchard[key], f"orchard.{key}", least) for key, least in GRID_KEYS.items()})
        robots, bins = (fields(data[key], key, known, known) for key, known in (("robots", ROBOT_KEYS), ("bins", BIN_KEYS)))
        robot_cells, bin_cells = _cells(grid, robots, "robots"), _cells(grid, bins, "bins")
        count = len(bin_cells)
        return {
            "grid": grid, "robot_cells": robot_cells, "robot_free": wholes(robots["free"], "robots.free", len(robot_cells)),
            "bin_cells": bin_cells, "after": wholes(bins["after"], "bins.after", count) - 1,
            "standing": flags(bins["standing"], "bins.standing", count), "work": wholes(bins["work"], "bins.work", count),
        }  # fmt: skip


def _cells(grid: OrchardGrid, data: Mapping[str, Any], path: str) -> Integers:
    rows = wholes(data["row"], f"{path}.row")
    return grid.cells(list(zip(rows.tolist(), wholes(data["column"], f"{path}.column", len(rows)).tolist(), strict=True)))
