"""Column generation at the root by each way to stabilise prices, and whole proofs with it.

For each file: how often routes were looked for at the root, without cuts, how many routes that gave, CPU seconds, and the bound, which must
be the same; then CPU seconds of ``branch-price-cut`` to a proof, or the gap that is left after ``--seconds``.

Exits with 1 if two roots differ.
"""

import math
from pathlib import Path
from typing import Annotated, Any

from waybound import RoutingProblem, read, solve
from waybound.formulations.stop import Stop
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration, Part
from waybound.solvers.bounds.routing.set_partition import set_partition
from waybound.solvers.bounds.routing.stabilisation import KINDS

from ._harness import Folder, Option, command, markdown, timed

SECONDS = 600.0
"""For a root, at most."""

SAME = 1e-6
"""Part by which bounds may differ."""


class Counted(ColumnGeneration):
    """Column generation that counts how often routes were looked for."""

    searches = 0

    def _priced(self, *given: Any) -> Any:
        self.searches += 1
        return super()._priced(*given)


def root(problem: RoutingProblem, kind: str) -> tuple[Counted, float]:
    """Column generation at its end without cuts, and its bound."""
    partition = set_partition(problem)
    assert partition is not None
    columns = Counted(problem, partition, Stop(SECONDS), lambda bound: False, 1, {"stabilisation": kind})
    solved = columns.solve(Part(columns.cost, partition.fewest, partition.most, partition.optional), None)
    return columns, solved.bound * columns.unit if solved.status == "done" else math.nan


def proof(problem: RoutingProblem, kind: str, seconds: float) -> str:
    """CPU seconds of a whole run, or the gap that it leaves."""
    cpu, solution = timed(lambda: solve(problem, "branch-price-cut", time_limit=seconds, bound_time=0, stabilisation=kind))
    if solution.status == "optimal":
        return f"{cpu:.1f}"
    value, bound = solution.objective, solution.bound
    if not isinstance(value, float) or not isinstance(bound, float):
        return "open"
    return f"{100.0 * (value - bound) / value:.2f} % open"


def found(folder: Path, name: str) -> RoutingProblem:
    """A file of Solomon's, in truncated distances, or of capacitated routing."""
    solomon = folder / "vrptw-solomon" / f"{name}.txt"
    problem = read(solomon, convention="dimacs") if solomon.exists() else read(next(folder.glob(f"cvrp/*/{name}.vrp")))
    assert isinstance(problem, RoutingProblem)
    return problem


@command
def main(
    folder: Folder,
    file: tuple[str, ...] = ("R101", "R106", "RC101", "C101", "A-n45-k7", "P-n50-k7"),
    kind: Annotated[tuple[str, ...], Option(choices=KINDS)] = KINDS,
    seconds: Annotated[float, Option(help="for a whole run; 0 for none")] = 60.0,
) -> bool:
    print(*markdown(["file", "prices", "searches", "routes", "CPU s", "bound", "proof, CPU s"]), sep="\n", flush=True)
    same = True
    for name in file:
        problem, first = found(folder, name), math.nan
        for way in kind:
            cpu, (columns, bound) = timed(lambda problem=problem, way=way: root(problem, way))  # type: ignore[misc]
            whole = proof(problem, way, seconds) if seconds else "-"
            row = [name, way, columns.searches, len(columns.pool), f"{cpu:.2f}", f"{bound:.2f}", whole]
            print(markdown([], [row])[-1], flush=True)
            first = bound if math.isnan(first) else first
            same = same and math.isclose(bound, first, rel_tol=SAME)
    return same
