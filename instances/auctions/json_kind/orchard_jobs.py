"""Bins of an orchard in waybound's JSON, numbered from 1; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

from ...document import fields, flags, integer, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..orchard_grid import OrchardGrid
from ..orchard_jobs import PROBLEMS, OrchardJobs

KEYS = ("name", "problem", "orchard", "robots", "bins", "notes")
ORCHARD_KEYS = {"rows": 1, "columns": 3, "repository": 0, "empty_speed": 1, "full_speed": 1}
ROBOT_KEYS = ("row", "column", "free")
BIN_KEYS = ("row", "column", "after", "standing", "work")


def encode(jobs: OrchardJobs) -> dict[str, Any]:
    """The keys of an instance."""
    grid = jobs.grid
    data = {
        "name": jobs.name,
        "problem": jobs.problem,
        "orchard": {key: getattr(grid, key) for key in ORCHARD_KEYS},
        "robots": {**_places(grid, jobs.robot_cells), "free": jobs.robot_free.tolist()},
        "bins": {
            **_places(grid, jobs.bin_cells), "after": (jobs.after + 1).tolist(), "standing": jobs.standing.tolist(),
            "work": jobs.work.tolist(),
        },
    }  # fmt: skip
    return {**data, "notes": list(jobs.notes)} if jobs.notes else data


def _places(grid: OrchardGrid, cells: Any) -> dict[str, list[int]]:
    return {"row": (cells // grid.columns).tolist(), "column": (cells % grid.columns).tolist()}


def decode(data: dict[str, Any]) -> OrchardJobs:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, KEYS[:-1])
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of bins in an orchard", expected=", ".join(PROBLEMS), found=problem)
    orchard = fields(data["orchard"], "orchard", tuple(ORCHARD_KEYS), tuple(ORCHARD_KEYS))
    grid = OrchardGrid(**{key: integer(orchard[key], f"orchard.{key}", least) for key, least in ORCHARD_KEYS.items()})
    robots, bins = fields(data["robots"], "robots", ROBOT_KEYS, ROBOT_KEYS), fields(data["bins"], "bins", BIN_KEYS, BIN_KEYS)
    robot_cells, bin_cells = _cells(grid, robots, "robots"), _cells(grid, bins, "bins")
    count = len(bin_cells)
    return OrchardJobs(
        grid, robot_cells, wholes(robots["free"], "robots.free", len(robot_cells)), bin_cells,
        wholes(bins["after"], "bins.after", count) - 1, flags(bins["standing"], "bins.standing", count),
        wholes(bins["work"], "bins.work", count), name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _cells(grid: OrchardGrid, data: Any, path: str) -> Any:
    rows = wholes(data["row"], f"{path}.row")
    return grid.cells(list(zip(rows.tolist(), wholes(data["column"], f"{path}.column", len(rows)).tolist(), strict=True)))


KINDS.add("orchard-jobs", Kind("orchard-jobs", encode, decode))
