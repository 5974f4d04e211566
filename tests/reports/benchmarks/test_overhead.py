from __future__ import annotations

import pytest

from waybound import read
from waybound.reports.benchmarks.overhead import BUNDLED, cases, compare, integers


@pytest.mark.parametrize(("engine", "work"), [("pyvrp", 30), ("ortools", 30), ("vroom", 1)])
@pytest.mark.parametrize("name", list(BUNDLED))
def test_the_wrapped_library_returns_the_bare_librarys_routes(name: str, engine: str, work: int) -> None:
    row = compare(name, name, BUNDLED[name], engine, work, 1)
    assert row["same"]
    assert row["bare"] > 0


def test_the_bare_library_gets_integers_that_are_the_data() -> None:
    problem = read("demo-rc50", convention="trunc1")
    made = integers(problem)  # type: ignore[arg-type]
    assert made["distance"].dtype.kind == "i"
    assert abs(made["distance"] / 10 - problem.travel.distances).max() < 1e-9  # type: ignore[attr-defined]


def test_instances_can_be_chosen() -> None:
    assert [case[0] for case in cases(["demo-x40"])] == ["demo-x40"]
