from dataclasses import replace

import pytest
from coded import check_coded, coded

import waybound as wb
from waybound.formulations.search_history import Event
from waybound.reports.plots import save_plot, views


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    made = wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0.0)
    value = made.objective
    events = (
        Event(0.1, "solve", (3 * value,), None, None, "savings"),
        Event(0.2, "solve", (1.2 * value,), (0.5 * value,), "claimed", "savings"),
        Event(0.9, "solve", (value,), (0.5 * value,), "claimed", "savings"),
        Event(1.0, "check", (value,), (0.9 * value,), "verified", "savings"),
    )
    return replace(made, events=events, bound=0.9 * value, bound_kind="verified", gap=0.1)


def lines(ax, prefix: str):
    return [line for line in ax.lines if str(line.get_label()).startswith(prefix)]


def test_answers_and_bounds_are_steps_that_end_with_the_run(solution: wb.Solution) -> None:
    ax = wb.plot_history(solution)
    (answer,) = lines(ax, "answer")
    assert answer.get_xdata().tolist() == [0.1, 0.2, 0.9, 1.0, 1.0]
    assert answer.get_ydata()[-1] == solution.objective
    (bound,) = lines(ax, "bound, verified in the end")
    assert bound.get_ydata()[-1] == solution.bound


def test_a_bad_first_answer_does_not_hide_the_rest(solution: wb.Solution) -> None:
    low, high = wb.plot_history(solution).get_ylim()
    assert low < solution.bound < solution.objective < high < 3 * solution.objective


def test_a_method_that_ends_far_away_is_told_in_words(solution: wb.Solution) -> None:
    value = solution.objective
    far = replace(solution, solver="far", events=(Event(0.5, "check", (10 * value,), None, None, "far"),), bound=None, bound_kind=None)
    ax = wb.plot_history([solution, far])
    assert any("far ends above the picture" in text.get_text() for text in ax.texts)


def test_several_runs_have_a_line_each_and_names_of_their_own(solution: wb.Solution) -> None:
    ax = wb.plot_history([solution, solution])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["savings", "savings (2)"]


def test_it_is_a_view_of_every_solution(solution: wb.Solution, tmp_path) -> None:
    assert "history" in views(solution.problem)
    assert solution.plot(view="history").get_xlabel() == "seconds since the call"
    save_plot(solution, tmp_path / "a.png", "history")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_an_unknown_view_or_level_is_refused(solution: wb.Solution) -> None:
    with pytest.raises(wb.UsageError, match="no view 'x'; there are", check=coded("unknown-name")):
        solution.plot(view="x")
    check_coded(wb.UsageError, "out-of-range", wb.plot_history, solution, level=2)
    check_coded(wb.UsageError, "missing", wb.plot_history, [])
