"""Theorems on exploring plumes, after Sung (2019), chapter 4: their formulas, and shapes on which some of them fail."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ....instances.routing.worlds.plume_exploration import Cell, PlumeWorld, serpentine
from ...missions.routing.plume_exploration import PlumeExploration, lawn_mower
from ...plots.drawing import COLOURS, bare, plain
from ..findings import NOT, Finding
from ..frames import frame_table
from ..study import Fault, Report, StudySetting, figure, study

SERPENTINES = ((9, 4), (15, 2), (21, 4), (41, 8))
"""Width, and robots."""

U_SHAPE = ((0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0))

FAT = 20.0
"""Length of the stadium."""


def longest_time(cells: int, depth: int, robots: int, speed: float, wind: float) -> float:
    """Bound on the time of a depth-first exploration, by cells and depth of its tree: Sung (2019), (4.5), the tight form of lemma 3."""
    halvings = math.floor(math.log2(robots))
    return 2.0 * (cells - 1 + depth * halvings) / ((speed - wind) * (1 + halvings))


def shortest_time(cells: int, robots: int, speed: float, wind: float) -> float:
    """Bound on the time of any exploration that visits all cells: Sung (2019), lemma 4, (4.8)."""
    return (cells - 1) / ((speed + wind) * robots)


def proved_ratio(robots: int, speed: float, wind: float) -> float:
    """The largest ratio of a depth-first exploration to the shortest: what follows from ``longest_time`` with a depth of all cells, and
    ``shortest_time``."""
    return 2.0 * robots * (speed + wind) / (speed - wind)


def claimed_times(robots: int, speed: float, wind: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Factor and summand of the shortest exploration in theorem 4, (4.9), and theorem 5, (4.14), of Sung (2019). The first is false,
    and the second rests on two lemmas that are: docs/missions/plume-exploration.md#errata."""
    halvings = math.floor(math.log2(robots))
    per, ratio = (speed - wind) * (1 + halvings), (speed + wind) / (speed - wind) / (1 + halvings)
    return (2.0 * ratio * (robots + halvings), 2.0 / per), (2.0 * ratio * (18 * robots + halvings), 48.0 / per)


def straight_tours(path: Sequence[Cell], robots: int) -> list[tuple[int, int]]:
    """Pieces of a path of cells, one a robot, such that the longest tour from its first cell straight to a piece, along it and straight
    back is short; speed 1, no drift. By bisection: an upper bound on the shortest exploration."""
    walked = np.concatenate([[0.0], np.cumsum([math.dist(a, b) for a, b in pairwise(path)])])
    away = np.array([math.dist(path[0], cell) for cell in path])

    def pieces(limit: float) -> list[tuple[int, int]]:
        found: list[tuple[int, int]] = []
        first = 0
        while first < len(path) and len(found) <= robots:
            tours = away[first] + walked[first:] - walked[first] + away[first:]
            inside = np.nonzero(tours <= limit)[0]
            if not len(inside):
                return []
            found.append((first, first + int(inside[-1])))
            first = found[-1][1] + 1
        return found if first == len(path) and len(found) <= robots else []

    low, high = 0.0, float(2 * walked[-1] + 1)
    while high - low > 1e-9 * high:
        middle = (low + high) / 2.0
        low, high = (low, middle) if pieces(middle) else (middle, high)
    return pieces(high)


def tour_time(path: Sequence[Cell], piece: tuple[int, int]) -> float:
    """Length of a tour of ``straight_tours``."""
    own = [path[0], *path[piece[0] : piece[1] + 1], path[0]]
    return math.fsum(math.dist(a, b) for a, b in pairwise(own))


def counterexample(width: int, robots: int) -> dict[str, Any]:
    """A serpentine explored depth first, beside straight tours and what theorem 4 claims of them."""
    path = serpentine(width)
    world = depth_first(path, path[0], robots).played
    shortest = max(tour_time(path, piece) for piece in straight_tours(path, robots))
    factor, summand = claimed_times(robots, 1.0, 0.0)[0]
    return {
        "width": width, "cells": len(path), "robots": robots, "depth_first": world.clock, "straight_tours": shortest,
        "claimed_at_most": factor * shortest + summand, "ratio": world.clock / shortest, "proved_ratio": proved_ratio(robots, 1.0, 0.0),
    }  # fmt: skip


def depth_first(cells: Sequence[Cell], start: Cell, robots: int, speed: float = 1.0, drift: tuple[float, float] = (0.0, 0.0)) -> Any:
    """A mission after a depth-first exploration: its ``played`` world, and the ``tree``."""
    mission = PlumeExploration()
    world = mission.begin(PlumeWorld(cells, start, robots, speed, drift))
    while not world.over:
        world.step(mission.tree.go(world.observe()))
    return mission


def stadium_cells(length: float, shift: float, raised: float) -> tuple[int, int]:
    """Unit cells inside a horizontal stadium of width sqrt(2), and cells that meet its inside. Its left end is at ``shift``, its lower
    edge at ``raised``: a fat plume by definition 1 of Sung (2019), on which lemmas 5 and 6 fail."""
    radius = math.sqrt(0.5)
    first, last, middle = shift + radius, shift + length - radius, raised + radius
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(-2, math.ceil(shift + length) + 2), np.arange(-2, 5)))
    near = np.hypot(np.maximum(0, np.maximum(first - x - 1, x - last)), np.maximum(0, np.maximum(middle - y - 1, y - middle)))
    far = np.hypot(np.maximum(0, np.maximum(first - x, x + 1 - last)), np.maximum(np.abs(middle - y), np.abs(middle - y - 1)))
    return int((far <= radius + 1e-12).sum()), int((near < radius - 1e-12).sum())


def staircase(steps: int) -> list[Cell]:
    """Cells that go up a diagonal."""
    return [(k // 2, (k + 1) // 2) for k in range(2 * steps + 1)]


@study(
    "plume-bounds",
    "shapes on which theorems about exploring plumes fail, and the ratio that holds instead",
    1,
    source="Sung (2019), lemmas 5 and 6, theorems 4 and 5, section 4.6",
    claim="depth-first exploration by R robots takes O(R / log R) times the shortest exploration",
)
def plume_bounds(setting: StudySetting) -> Report:
    rows = [counterexample(*one) for one in SERPENTINES]
    faults = tuple(Fault("bound", f"{row} exceeds the proved ratio") for row in rows if row["ratio"] > row["proved_ratio"])
    return Report(
        "plume-bounds", plume_bounds.summary, frame_table("Serpentines: depth first, straight tours, and what theorem 4 claims", rows),
        tuple(rows), faults=faults, num_faults=len(faults), figures=(serpentine_figure(*SERPENTINES[0]), ratio_figure()),
        findings=tuple(findings(rows)), done=1, asked=1,
    )  # fmt: skip


def findings(rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """The theorems and steps of proofs that fail, and what follows without them."""
    mission = depth_first(U_SHAPE, U_SHAPE[0], 3)
    broken = [row for row in rows if row["depth_first"] > row["claimed_at_most"]]
    tours = max(tour_time(U_SHAPE, piece) for piece in straight_tours(U_SHAPE, 3))
    depth = mission.tree.depth
    inside, met = stadium_cells(FAT, 0.0, 0.5)
    stairs = staircase(20)
    time, mown = depth_first(stairs, stairs[0], 1).played.clock, lawn_mower((0, 0, 20, 20), 1, 1.0, (0.0, 0.0))[1]
    return [
        Finding(
            "theorem 4, (4.9): depth first against the shortest", "at most 2 (R + floor(log R)) / (1 + floor(log R)) times, and a summand",
            f"exceeded on {len(broken)} of {len(rows)} serpentines", NOT,
            "a path is walked by all robots together; straight flights over cells that are no plume divide it",
        ),
        Finding.of_fact(
            "its step: depth of the tree / (speed + wind)", "no more than the shortest exploration",
            f"depth {depth} of a U of 7 cells, explored in {tours:.4g}", depth <= tours, "flights cut across the U",
        ),
        Finding.of_fact(
            "lemma 5: cells that meet a fat plume", "at most 3 times those inside, and 6", f"{met} and {inside} inside",
            met <= 3 * inside + 6, "a stadium of width sqrt(2) between two grid lines holds no cell",
        ),
        Finding.of_fact(
            "lemma 6: cells inside, by how the grid lies", "at most 6 times those of the best grid",
            f"{stadium_cells(FAT, 0.0, 0.0)[0]} and {inside}", stadium_cells(FAT, 0.0, 0.0)[0] <= 6 * inside, "the same stadium",
        ),
        Finding.of_fact(
            "the lawn mower of section 4.6", "a lower bound", f"{mown:.4g} around a staircase explored in {time:.4g}", mown <= time,
            "it sweeps the rectangle around the plume",
        ),
    ]  # fmt: skip


@figure("plume-serpentine", 6.4, 5.4)
def serpentine_figure(figure: Any, width: int, robots: int) -> None:
    """The cells of a serpentine, and straight tours of pieces of it."""
    ax, path = figure.subplots(), serpentine(width)
    ax.scatter(*np.array(path).T, marker="s", s=120, color="#DDDDDD")
    for k, piece in enumerate(straight_tours(path, robots)):
        tour = np.array([path[0], *path[piece[0] : piece[1] + 1], path[0]])
        ax.plot(*tour.T, color=COLOURS[k % len(COLOURS)], linewidth=1.6, label=f"robot {k + 1}: {tour_time(path, piece):.1f}")
    bare(ax)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=9)
    together = 2 * (len(path) - 1)
    ax.set_title(f"{len(path)} cells, {robots} robots: depth first takes {together}, straight tours", loc="left", fontsize=10)


@figure("plume-ratio", 6.4, 4.0)
def ratio_figure(figure: Any, robots: int = 4) -> None:
    """Depth first against straight tours on growing serpentines, beside what is claimed and what is proved."""
    ax = figure.subplots()
    rows = [counterexample(width, robots) for width in range(3, 42, 2)]
    cells = [row["cells"] for row in rows]
    ax.plot(cells, [row["ratio"] for row in rows], color=COLOURS[0], marker="o", markersize=3, label="depth first / straight tours")
    claimed = [row["claimed_at_most"] / row["straight_tours"] for row in rows]
    ax.plot(cells, claimed, color=COLOURS[3], linestyle="--", label="theorem 4")
    ax.plot(cells, [row["proved_ratio"] for row in rows], color=COLOURS[8], linestyle=":", label="2R, proved")
    ax.set_xscale("log")
    ax.set_xlabel(f"cells of the serpentine, {robots} robots", fontsize=9)
    ax.legend(frameon=False, fontsize=9)
    plain(ax, "times the shortest exploration")
