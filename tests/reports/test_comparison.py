"""What is made of the runs of a comparison: the best answer, the best bound, and gaps to it, level by level."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import waybound as wb
from waybound.formulations.evidence import Evidence
from waybound.formulations.levels import LevelBound
from waybound.reports.comparison import Compared, Comparison, remark_of


@pytest.fixture(scope="module")
def solved() -> dict[str, Any]:
    """One problem of two levels, by two methods."""
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    return {
        "problem": problem,
        "good": wb.solve(problem, "cpsat", bound_time=0.0),
        "first": wb.solve(problem, heuristic="insertion", bound_time=0.0),
    }


def bounded(solution: Any, first: float, *second: float) -> Any:
    levels = tuple(LevelBound(solution.evaluation.values[:1], b, Evidence("x", "x", b, {})) for b in second)
    return replace(solution, certificate=replace(solution.certificate, bound=first, bound_source="loads", levels=levels))


def test_the_best_answer_is_best_level_by_level(solved: Any) -> None:
    made = Comparison(solved["problem"], (Compared("b", solved["first"]), Compared("a", solved["good"])))
    assert made.best is min(solved["first"], solved["good"], key=lambda s: s.evaluation.values)
    assert made["a"] is solved["good"] and len(made) == 2
    with pytest.raises(wb.UsageError, match="there are b, a"):
        made["c"]


def test_bounds_of_all_runs_count_for_all_answers_as_good_before(solved: Any) -> None:
    good = solved["good"]
    assert good.evaluation.values[0] == 2.0
    runs = (Compared("a", bounded(good, 1.0)), Compared("b", bounded(good, 2.0, 300.0)), Compared("c", bounded(good, 2.0, 350.0)))
    made = Comparison(solved["problem"], runs)
    assert made.bound == 2.0 and "from the run of b" in str(made.bound_source)
    assert made.bounds(good.evaluation.values) == [2.0, 350.0]
    assert made.bounds((3.0, 10.0)) == [2.0]
    assert made.gap(runs[0]) == pytest.approx((good.evaluation.values[1] - 350.0) / good.evaluation.values[1])


def test_where_the_open_level_has_no_bound_there_is_no_gap(solved: Any) -> None:
    run = Compared("a", bounded(solved["good"], 2.0))
    assert Comparison(solved["problem"], (run,)).gap(run) is None
    none = Compared("b", None, "it broke")
    assert Comparison(solved["problem"], (none,)).gap(none) is None and Comparison(solved["problem"], (none,)).best is None


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"status": "optimal", "bound_kind": "verified", "gap": 0.0}, "optimal, verified"),
        ({"status": "optimal", "bound_kind": "claimed", "gap": 0.0}, "optimal, by its own word"),
        ({"status": "feasible", "limit": "time"}, "feasible, stopped by time"),
        ({"status": "feasible", "limit": "none"}, "feasible"),
        ({"status": "infeasible"}, "infeasible, by its own word"),
        ({"status": "unknown"}, "no answer"),
    ],
)
def test_the_status_says_on_whose_word(solved: Any, change: dict[str, Any], status: str) -> None:
    assert Compared("a", replace(solved["good"], **change)).status == status


def test_remarks_are_one_printable_line(solved: Any) -> None:
    assert remark_of(Compared("a", None, "broke\n\x1b[31mhere")).isprintable()
    assert "claims the bound 3" in remark_of(Compared("a", replace(solved["good"], bound=3.0, bound_kind="claimed")))
