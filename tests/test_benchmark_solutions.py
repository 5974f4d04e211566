"""Every published CVRP and VRPTW solution file is accepted at its value, and rejected once it is spoilt."""

from __future__ import annotations

import csv
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from waybound.formulations.answers import read_answer
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.routing.judge import schedule
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.reading import read_instance

FAMILIES = ("cvrp", "vrptw-solomon", "vrptw-homberger")
CONVENTIONS = {"tsplib-nint": "file", "euclidean-double": "exact", "dimacs-trunc1": "trunc1"}


@dataclass(frozen=True)
class Row:
    """One row of bks.csv that has a solution file."""

    instance: Path
    solution: Path
    convention: str
    vehicles: str
    value: float
    decimals: int
    settings: tuple[tuple[str, str], ...]


def rows(folder: Path) -> Iterator[Row]:
    with (folder / "bks.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            family = row["family"].split("/")[0]
            if family not in FAMILIES or not row["solution_file"]:
                continue
            places = [p.parent for p in (folder / family).rglob(row["solution_file"])]
            assert len(places) == 1, row["solution_file"]
            suffix = ".vrp" if family == "cvrp" else ".txt"
            settings: dict[str, str] = {}
            if "unlimited" in row["objective"]:
                settings["vehicles"] = "unlimited"
            if "exactly" in row["objective"]:
                settings["vehicles-exactly"] = row["vehicles"]
            if ".25." in row["solution_file"]:
                settings["customers"] = "25"
            yield Row(
                places[0] / (row["instance"].removesuffix(".25") + suffix),
                places[0] / row["solution_file"],
                CONVENTIONS[row["convention"]],
                row["vehicles"],
                float(row["value"]),
                len(row["value"].partition(".")[2]),
                tuple(settings.items()),
            )


@functools.cache
def problem_of(instance: Path, convention: str, settings: tuple[tuple[str, str], ...]) -> RoutingProblem:
    problem = problem_from_instance(read_instance(instance), convention=convention, **dict(settings))
    assert isinstance(problem, RoutingProblem)
    return problem


def load(row: Row) -> tuple[RoutingProblem, Routes]:
    problem = problem_of(row.instance, row.convention, row.settings)
    answer = read_answer(problem, row.solution).answer
    assert isinstance(answer, Routes)
    return problem, answer


def without_first_visit(answer: Routes) -> Routes:
    first = answer.routes[0]
    return Routes.of([Route(first.visits[1:], first.vehicle), *answer.routes[1:]])


def with_first_visit_twice(answer: Routes) -> Routes:
    first = answer.routes[0]
    return Routes.of([Route((first.visits[0], *first.visits), first.vehicle), *answer.routes[1:]])


def past_its_window(problem: RoutingProblem, answer: Routes) -> Routes | None:
    """The answer with one visit moved to the end of its route, where the vehicle comes after its due time."""
    for number, route in enumerate(answer):
        for k in range(len(route.visits) - 1):
            moved = Route(route.visits[:k] + route.visits[k + 1 :] + (route.visits[k],), route.vehicle)
            if schedule(problem, moved).arrival[-1] > problem.sites.due[route.visits[k]] + 1:
                return Routes((*answer.routes[:number], moved, *answer.routes[number + 1 :]))
    return None


def test_every_solution_file_is_accepted_at_its_value(benchmarks: Path) -> None:
    seen = 0
    for row in rows(benchmarks):
        problem, answer = load(row)
        judged = problem.evaluate(answer)
        assert judged.feasible, (row.solution.name, judged.violations[:3])
        assert abs(judged.values[0] - row.value) <= 0.5000001 * 10.0**-row.decimals, (row.solution.name, judged.values, row.value)
        assert not row.vehicles or len(answer) <= int(row.vehicles), row.solution.name
        seen += 1
    assert seen == len(list(rows(benchmarks))) > 200


def test_every_solution_file_is_rejected_without_a_visit_and_with_one_doubled(benchmarks: Path) -> None:
    for row in rows(benchmarks):
        problem, answer = load(row)
        site = problem.sites.ids[answer.routes[0].visits[0]]
        for spoilt in (without_first_visit(answer), with_first_visit_twice(answer)):
            found = [v for v in problem.evaluate(spoilt).violations if v.check == "visits"]
            assert [v.site for v in found] == [site], row.solution.name


def test_every_windowed_solution_file_is_rejected_with_a_visit_past_its_window(benchmarks: Path) -> None:
    spoilt_files = 0
    for row in rows(benchmarks):
        problem, answer = load(row)
        if "time-windows" not in problem.features():
            continue
        spoilt = past_its_window(problem, answer)
        assert spoilt is not None, row.solution.name
        assert "time-windows" in {v.check for v in problem.evaluate(spoilt).violations}, row.solution.name
        spoilt_files += 1
    assert spoilt_files > 100
