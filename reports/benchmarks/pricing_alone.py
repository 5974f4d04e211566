"""Searching for routes alone: our labels beside RoutePricer (PathWyse), at prices from column generation at the root.

A file's root is solved without cuts and without memories that grow. Of all prices at which it looked for routes ``--prices`` are taken,
evenly spread, the last of them the end. Both search without any shortcut, over the same whole numbers, with the same customers remembered
at each, and the least reduced costs must be equal. Ours finds the 300 cheapest routes of negative reduced cost, RoutePricer the best one.
CPU seconds, the least of ``--repeats`` searches; setting up is part of neither.

RoutePricer (GPL-3) is no part of waybound: ``--peer`` names a Python that has ``routepricer`` and ``numpy``. Without one, ours is measured.
Exits with 1 if two costs differ.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound import RoutingProblem, read
from waybound.formulations.stop import Stop
from waybound.instances.number_arrays import Flags, Floats, Integers
from waybound.solvers.bounds.routing.column_generation import FOUND, ColumnGeneration, Part
from waybound.solvers.bounds.routing.pricing import Pricer
from waybound.solvers.bounds.routing.route_levels import EXACT
from waybound.solvers.bounds.routing.set_partition import set_partition

from ._harness import Folder, Option, best_of, command, in_a_fresh_process, markdown

FINE = 1000.0
"""Whole numbers in a unit of column generation, of which the dearest move costs some thousand."""

TENTHS = 10
"""Whole numbers in a unit of the files' times, which are truncated to tenths."""

SECONDS = 600.0
"""For the root, at most."""


@dataclass(frozen=True, eq=False)
class Searches:
    """Searches: ``costs``, reduced costs of moves in whole numbers, shape (searches, nodes, nodes), and all that searches take."""

    costs: Integers
    usable: Flags
    near: Flags
    pricer: Pricer
    levels: tuple[Any, ...]

    @classmethod
    def of(cls, problem: RoutingProblem, memory: int, prices: int) -> "Searches":
        """Prices on the way to the linear relaxation of a problem with one type of vehicle, windows and loads."""
        stop = Stop(SECONDS)
        partition = set_partition(problem, stop)
        assert partition is not None and len(partition.types) == 1 and len(partition.types[0].levels) == 2
        columns = Watched(problem, partition, stop, lambda bound: False, 1, {"memory": memory})
        part = Part(columns.cost, partition.fewest, partition.most, partition.optional)
        near = columns.near.copy()
        columns.most_memory = 0
        solved = columns.solve(part, None)
        assert solved.status == "done"
        usable = np.isfinite(columns.cost[0])
        taken = np.unique(np.linspace(0, len(columns.seen) - 1, prices + 1).round().astype(int)[1:])
        costs = np.array([np.rint(np.where(usable, columns.seen[k], 0.0) * FINE) for k in taken]).astype(np.int64)
        return cls(costs, usable, near, columns.pricers[0], partition.types[0].levels)

    def own(self, repeats: int) -> list[tuple[float, int]]:
        """CPU seconds and the least cost of each search of ours."""
        self.pricer.restrict(self.usable, self.near, [])
        rows = []
        for cost in self.costs:
            reduced = np.where(self.usable, cost / FINE, np.inf)
            found: list[Any] = []

            def search(reduced: Floats = reduced, found: list[Any] = found) -> None:
                found[:] = self.pricer.search(Stop(SECONDS), reduced, np.zeros(0), EXACT, FOUND, 0.0)

            seconds = best_of(repeats, search)[0]
            rows.append((seconds, round(found[1] * FINE)))
        return rows

    def peers(self, python: str, repeats: int) -> tuple[str, list[tuple[float, int]]]:
        """Version of RoutePricer, and CPU seconds and the least cost of each of its searches."""
        clock, load = self.levels
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "searches.npz"
            np.savez(
                path, costs=self.costs, usable=self.usable, near=self.near, time=np.rint(clock.weight * TENTHS).astype(int),
                ready=np.ceil(clock.lower * TENTHS - 1e-6).astype(int), due=np.floor(clock.upper * TENTHS + 1e-6).astype(int),
                demand=np.rint(load.weight[0]).astype(int), capacity=int(load.upper[0]),
            )  # fmt: skip
            told = in_a_fresh_process(Path(__file__).with_name("_bare_routepricer.py"), path, repeats, python=python)
        return told["version"], [(seconds, round(cost)) for seconds, _, cost in told["rows"]]


class Watched(ColumnGeneration):
    """Column generation that keeps the reduced costs of all its searches."""

    def __init__(self, *given: Any) -> None:
        self.seen: list[Floats] = []
        super().__init__(*given)

    def reduced_costs(self, *given: Any) -> Floats:
        reduced = super().reduced_costs(*given)
        self.seen.append(reduced[0])
        return reduced


@command
def main(
    folder: Folder,
    file: Annotated[tuple[str, ...], Option(help="Solomon's files")] = ("R112", "RC201", "C104"),
    memory: Annotated[int, Option(help="how many neighbours are remembered at a customer, beside himself")] = 8,
    prices: int = 5,
    repeats: int = 3,
    peer: Annotated[str, Option(help="a Python that has routepricer")] = "",
) -> bool:
    heads = ["file", "search", "least cost", "CPU s"]
    print(*markdown([*heads, "RoutePricer CPU s", "ratio"] if peer else heads), sep="\n", flush=True)
    same = True
    for name in file:
        problem = read(folder / "vrptw-solomon" / f"{name}.txt", convention="dimacs")
        assert isinstance(problem, RoutingProblem)
        searches = Searches.of(problem, memory, prices)
        own = searches.own(repeats)
        version, others = searches.peers(peer, repeats) if peer else ("", [])
        rows: list[list[str]] = [[name, str(k + 1), f"{cost / FINE:.3f}", f"{seconds:.3f}"] for k, (seconds, cost) in enumerate(own)]
        for row, (seconds, cost), (theirs, least) in zip(rows, own, others, strict=False):
            row += [f"{theirs:.3f}", f"{theirs / seconds:.1f}" if cost == least else f"DIFFERS: {least / FINE:.3f}"]
            same = same and cost == least
        print(*markdown(heads, rows)[2:], sep="\n", flush=True)
    if peer:
        print(f"RoutePricer {version}")
    return same
