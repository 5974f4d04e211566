import math
from dataclasses import replace
from typing import Any

import pytest
from coded import coded

import waybound as wb
from waybound import Evidence, Problem
from waybound.formulations.levels import LevelBound
from waybound.instances.errors import Code
from waybound.reports.comparison import Compared, Comparison, _contradictions
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult


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
    assert Compared("a", None, "broke\n\x1b[31mhere").remark.isprintable()
    assert "claims the bound 3" in Compared("a", replace(solved["good"], bound=3.0, bound_kind="claimed")).remark


@pytest.fixture(scope="module")
def problem() -> wb.Problem:
    return wb.read("demo-tiny")


@pytest.fixture(scope="module")
def made(problem: wb.Problem) -> Comparison:
    return wb.compare(problem, ["savings", "highs", "local", "cpsat"], time_limit=60, bound_time=0.0)


class Says(Engine):
    """Says what it is told to say."""

    name, family, package, modules, summary, features = "says", "routing", "waybound", ("json",), "for tests", frozenset()
    result: Any = None

    def missing(self, problem: Problem) -> frozenset[str]:
        return frozenset()

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        if isinstance(self.result, Exception):
            raise self.result
        return self.result


def test_one_row_a_method_in_the_order_asked_for(made: Comparison) -> None:
    assert made.to_frame()["method"].tolist() == ["savings", "highs", "local", "cpsat"]
    assert len(made) == 4 and made.best is not None


def test_a_method_that_cannot_take_the_problem_is_a_row_that_says_why(made: Comparison) -> None:
    row = made.to_frame().set_index("method").loc["local"]
    assert row["status"] == "error" and "cannot take this problem" in row["remark"]
    assert math.isnan(row["objective"]) and made["local"] is None


def test_a_crash_is_a_row_and_not_the_end(problem: wb.Problem, registered: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    registered(BACKENDS, "says", Says)
    monkeypatch.setattr(Says, "result", RuntimeError("it broke"))
    rows = wb.compare(problem, ["says", "savings"], bound_time=0.0).to_frame().set_index("method")
    assert rows.loc["says", "status"] in ("error", "no answer")
    assert rows.loc["savings", "objective"] > 0


def test_gaps_are_to_the_best_verified_bound_of_all(problem: wb.Problem) -> None:
    both = wb.compare(
        problem, {"with": {"heuristic": "savings", "bound_time": 2.0}, "without": {"heuristic": "savings", "bound_time": 0.0}}
    )
    frame = both.to_frame().set_index("method")
    assert frame.loc["with", "verified_bound"] == both.bound and math.isnan(frame.loc["without", "verified_bound"])
    assert frame.loc["with", "gap"] == frame.loc["without", "gap"] > 0
    assert "from the run of with" in str(both.bound_source)


def test_what_a_search_claims_is_told_as_its_own_word(made: Comparison) -> None:
    row = made.to_frame().set_index("method").loc["highs"]
    assert row["status"] == "optimal, by its own word" and "claims the bound" in row["remark"]


def test_claims_that_another_answer_refutes_are_faults(made: Comparison, problem: wb.Problem) -> None:
    good, worse = made["highs"], made["savings"]
    assert good is not None and worse is not None and not made.faults
    lies = replace(worse, bound=0.5 * (good.objective + worse.objective), bound_kind="claimed", status="optimal")
    none = replace(worse, answer=None, evaluation=None, objective=None, bound=None, status="infeasible")
    (lie,) = _contradictions(problem, [Compared("a", good), Compared("b", lies)])
    assert "the claimed bound" in lie and "of b is refuted: a has an answer" in lie
    (gone,) = _contradictions(problem, [Compared("a", good), Compared("b", none)])
    assert "b says infeasible, but a has an answer" in gone


def test_text_and_html_say_what_is_checked_and_what_is_verified(made: Comparison) -> None:
    text = str(made)
    assert "every answer in the table was checked from the data" in text
    assert "none was verified, so that no gap is known" in text
    assert "<table" in made._repr_html_() and "&lt;" not in made._repr_html_()


def test_the_log_holds_all_runs(problem: wb.Problem, tmp_path: Any) -> None:
    wb.compare(problem, ["savings", "insertion"], bound_time=0.0, log=tmp_path / "all.log")
    text = (tmp_path / "all.log").read_text()
    assert "search by savings" in text and "search by insertion" in text


@pytest.mark.parametrize(
    ("methods", "code"), [("pyvrp", "malformed"), ([], "missing"), (["savings", "savings"], "duplicate"), (["no-such"], "unknown-name")]
)
def test_what_cannot_be_compared_is_refused_before_anything_runs(problem: wb.Problem, methods: Any, code: Code) -> None:
    with pytest.raises(wb.UsageError, check=coded(code)):
        wb.compare(problem, methods)


@pytest.mark.parametrize(
    ("methods", "told"),
    [
        (["no-such"], "no solver and no heuristic is named 'no-such'"),
        ({"a": {"solver": "no-such"}}, "unknown solver 'no-such'"),
        ({"a": {"heuristic": "no-such"}}, "unknown heuristic 'no-such'"),
    ],
)
def test_a_name_that_does_not_exist_is_told(problem: wb.Problem, methods: Any, told: str) -> None:
    with pytest.raises(wb.UsageError, match=told):
        wb.compare(problem, methods)


def test_an_interrupt_leaves_out_the_rest(problem: wb.Problem, registered: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    registered(BACKENDS, "says", Says)
    monkeypatch.setattr(Says, "result", RawResult("unknown", "interrupt"))
    frame = wb.compare(problem, ["says", "savings"], bound_time=0.0).to_frame().set_index("method")
    assert frame.loc["savings", "remark"] == "not run: interrupted"


def test_plain_data_are_finite_and_whole(made: Comparison) -> None:
    data = made.to_json()
    assert [run["method"] for run in data["runs"]] == ["savings", "highs", "local", "cpsat"]
    assert data["runs"][2]["solution"] is None


def test_a_bare_program_is_compared_and_what_is_no_problem_is_told() -> None:
    tiny: Any = wb.read("demo-tiny")
    compared = wb.compare(tiny.compile().program, ["highs"], time_limit=20, bound_time=0)
    assert compared.runs[0].objective == pytest.approx(384.7341400722)
    wrong: Any = 5
    assert "takes a problem or a program, not int" in wb.compare(wrong, ["highs"]).runs[0].remark
    assert "those of compare" in wb.compare(tiny, {"one": {"solver": "highs", "log": True}}).runs[0].remark
