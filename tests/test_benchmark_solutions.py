"""Every published solution file is accepted at its value under its row's convention, and rejected once it is spoilt."""

import csv
import functools
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from waybound import Evaluation, Route, Routes, RoutingProblem
from waybound.formulations.answers import read_answer
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.routing.judge import schedule
from waybound.instances.reading import read_instance

CONVENTIONS = {"tsplib-nint": "file", "tsplib": "file", "euclidean-double": "exact", "dimacs-trunc1": "trunc1"}
FAMILIES = (
    "cvrp", "vrptw-solomon", "vrptw-homberger", "tsplib", "op", "top", "minmax-mtsp", "pdptw-lilim", "vrpspd-salhi", "mdvrp-cordeau",
    "toptw",
)  # fmt: skip
OPTIONAL = ("op", "top")
"""Families in which sites may be left out."""


@dataclass(frozen=True)
class Row:
    """One row of bks.csv; ``solution`` is None for an answer without routes, ``lacking`` says why there is none to check."""

    family: str
    instance: Path
    solution: Path | None
    convention: str
    vehicles: str
    value: float
    decimals: int
    objective: str
    settings: tuple[tuple[str, str], ...]
    lacking: str = ""

    @property
    def name(self) -> str:
        return self.solution.name if self.solution else self.instance.name

    def measured(self, judged: Evaluation) -> float:
        """What the row's value is a value of."""
        if self.objective.startswith("score"):
            return judged.quantities["reward"]
        return judged.values[0] if self.objective == "longest route" else judged.quantities["distance"]


def every_row(folder: Path) -> Iterator[Row]:
    with (folder / "bks.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            place = folder / row["family"]
            family, name = place.relative_to(folder).parts[0], row["instance"].removesuffix(".25")
            if not place.is_dir():
                place = folder / family
            instances = [p for p in place.rglob(f"{name}.*") if p.stem == name and p.suffix not in (".sol", ".tour")]
            assert len(instances) == 1, row["instance"]
            settings: dict[str, str] = {}
            if "unlimited" in row["objective"] or family == "vrpspd-salhi":
                settings["vehicles"] = "unlimited"
            if "exactly" in row["objective"]:
                settings["vehicles-exactly"] = row["vehicles"]
            if ".25." in row["solution_file"]:
                settings["customers"] = "25"
            found = row["solution_file"]
            empty = not found and row["value"] == "0" and row["status"] == "optimal"
            yield Row(
                family, instances[0], instances[0].parent / found if found else None, CONVENTIONS.get(row["convention"], ""),
                row["vehicles"], float(row["value"]), len(row["value"].partition(".")[2]), row["objective"], tuple(settings.items()),
                "no solution file" if not (found or empty) else "" if family in FAMILIES else "its format is not read",
            )  # fmt: skip


def rows(folder: Path) -> Iterator[Row]:
    """Those that can be checked."""
    return (row for row in every_row(folder) if not row.lacking)


@functools.cache
def problem_of(instance: Path, convention: str, settings: tuple[tuple[str, str], ...]) -> RoutingProblem:
    problem = problem_from_instance(read_instance(instance), convention=convention, **dict(settings))
    assert isinstance(problem, RoutingProblem)
    return problem


def load(row: Row) -> tuple[RoutingProblem, Routes]:
    problem = problem_of(row.instance, row.convention, row.settings)
    answer = read_answer(problem, row.solution).answer if row.solution else Routes.of([])
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


def with_everything_left_out(problem: RoutingProblem, answer: Routes) -> Routes | None:
    """The answer with all sites that it leaves out at the end of its first route."""
    visited = {site for route in answer for site in route.visits}
    left = tuple(k for k in problem.customers.tolist() if k not in visited)
    first = answer.routes[0]
    return Routes((Route(first.visits + left, first.vehicle), *answer.routes[1:])) if left else None


@pytest.mark.slow
def test_every_solution_file_is_accepted_at_its_value(benchmarks: Path, capsys: pytest.CaptureFixture[str]) -> None:
    accepted: Counter[str] = Counter()
    lacking: dict[str, Counter[str]] = defaultdict(Counter)
    for row in every_row(benchmarks):
        if row.lacking:
            lacking[row.family][row.lacking] += 1
            continue
        problem, answer = load(row)
        judged = problem.evaluate(answer)
        assert judged.feasible, (row.name, judged.violations[:3])
        assert abs(row.measured(judged) - row.value) <= 0.5000001 * 10.0**-row.decimals, (row.name, judged.values, row.value)
        assert not row.vehicles or len(answer) <= int(row.vehicles), row.name
        accepted[row.family] += 1
    with capsys.disabled():
        print(*(f"\n{family:<16} {accepted[family]:>4} rows accepted" for family in FAMILIES), sep="")
        for family, reasons in lacking.items():
            print(*(f"{family:<16} {count:>4} rows not checked: {reason}" for reason, count in reasons.items()), sep="\n")
    assert {family for family, count in accepted.items() if count} == set(FAMILIES) - {"mdvrp-cordeau", "toptw"}
    assert sum(accepted.values()) == sum(not row.lacking for row in every_row(benchmarks)) > 600


@pytest.mark.slow
def test_every_solution_file_is_rejected_without_a_visit_that_is_asked_for_and_with_one_doubled(benchmarks: Path) -> None:
    for row in rows(benchmarks):
        problem, answer = load(row)
        if not len(answer):
            continue
        site = problem.sites.ids[answer.routes[0].visits[0]]
        shorter = () if row.family in OPTIONAL else (without_first_visit(answer),)
        for spoilt in (*shorter, with_first_visit_twice(answer)):
            found = [v for v in problem.evaluate(spoilt).violations if v.check == "visits"]
            assert [v.site for v in found] == [site], row.name


@pytest.mark.slow
def test_every_file_of_orienteering_is_worth_less_without_a_visit_and_rejected_beyond_its_limit(benchmarks: Path) -> None:
    beyond = 0
    for row in rows(benchmarks):
        if row.family not in OPTIONAL or row.solution is None:
            continue
        problem, answer = load(row)
        richest = max(answer.routes[0].visits, key=lambda k: problem.sites.reward[k])
        poorer = Routes.of([[k for k in route.visits if k != richest] for route in answer])
        assert problem.evaluate(poorer).quantities["reward"] < row.value, row.name
        full = with_everything_left_out(problem, answer)
        if full is not None:
            assert {v.check for v in problem.evaluate(full).violations} & {"duration", "distance"}, row.name
            beyond += 1
    assert beyond > 300


@pytest.mark.slow
def test_every_pair_that_is_turned_round_and_every_load_beyond_the_capacity_is_rejected(benchmarks: Path) -> None:
    turned = loaded = 0
    for row in rows(benchmarks):
        if row.family not in ("pdptw-lilim", "vrpspd-salhi"):
            continue
        problem, answer = load(row)
        first = next(route for route in answer if len(route.visits) > 1)
        rest = tuple(route for route in answer if route is not first)
        if row.family == "pdptw-lilim":
            backwards = Routes((Route(first.visits[::-1], first.vehicle), *rest))
            assert "shipments" in {v.check for v in problem.evaluate(backwards).violations}, row.name
            turned += 1
        else:
            joined = Routes((Route(first.visits + rest[0].visits, first.vehicle), *rest[1:]))
            assert "load" in {v.check for v in problem.evaluate(joined).violations}, row.name
            loaded += 1
    assert (turned, loaded) == (66, 9)


@pytest.mark.slow
def test_every_windowed_solution_file_is_rejected_with_a_visit_past_its_window(benchmarks: Path) -> None:
    spoilt_files = 0
    for row in rows(benchmarks):
        problem, answer = load(row)
        if "time-windows" not in problem.features():
            continue
        spoilt = past_its_window(problem, answer)
        assert spoilt is not None, row.name
        assert "time-windows" in {v.check for v in problem.evaluate(spoilt).violations}, row.name
        spoilt_files += 1
    assert spoilt_files > 100
