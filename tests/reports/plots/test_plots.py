import subprocess
import sys

import numpy as np
import pytest
from coded import coded
from outside_family import Jobs, LeastWaiting, register

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.reports.plots import PLOTS, check_drawable, plot_solution, save_plot
from waybound.reports.plots.positions import SCALED_SITES, scaled_positions


@pytest.fixture(scope="module")
def solution():
    return wb.solve(wb.read("demo-c25"), heuristic="savings", bound_time=0.5)


def test_every_family_with_pictures_is_registered():
    assert set(PLOTS.names()) >= {"bin-assignment", "max-min", "risk-allocation", "routing", "selection", "task-allocation"}


def test_the_plot_of_a_new_family_is_taken_with_all_its_options(registered, solution):
    drawn = []

    def plot(problem, answer, **options):
        drawn.append((problem, answer, options))
        return "axes"

    registered(PLOTS, "routing", plot)
    assert solution.plot(ax="mine", grid=True) == "axes"
    assert plot_solution(solution) == "axes"
    assert drawn == [
        (solution.problem, solution.answer, {"solution": solution, "ax": "mine", "title": None, "grid": True}),
        (solution.problem, solution.answer, {"solution": solution}),
    ]


def test_answers_without_pictures_are_refused_by_their_problem(registered, tmp_path):
    register(registered)
    bare = wb.solve(LeastWaiting(Jobs({"a": 4, "b": 1})), heuristic="shortest-first", bound_time=0)
    for draw in (bare.plot, lambda: save_plot(bare, tmp_path / "a.png"), lambda: check_drawable(bare.problem)):
        with pytest.raises(wb.UsageError, match="answers to least-waiting problems", check=coded("unsupported")):
            draw()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.share(2)
@pytest.mark.parametrize(("suffix", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_files_are_whole_and_repeat_themselves(solution, tmp_path, suffix, head):
    for name in "ab":
        save_plot(solution, tmp_path / f"{name}.{suffix}")
    a, b = ((tmp_path / f"{name}.{suffix}").read_bytes() for name in "ab")
    assert a.startswith(head)
    assert a == b
    assert len(list(tmp_path.iterdir())) == 2


def test_more_sites_than_are_placed_are_too_large():
    with pytest.raises(wb.UsageError, check=coded("too-large")):
        scaled_positions(np.zeros((SCALED_SITES + 1, 1)))


def test_an_unknown_suffix_is_refused(solution, tmp_path):
    with pytest.raises(wb.UsageError, match=r"\.png"):
        save_plot(solution, tmp_path / "a.bmp")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_file_needs_no_display_and_no_global_state(tmp_path):
    code = (
        "import sys, waybound as wb\nfrom waybound.reports.plots import save_plot\n"
        "s = wb.solve(wb.read('demo-tiny'), heuristic='savings', bound_time=0)\n"
        f"save_plot(s, {str(tmp_path / 'a.png')!r})\nprint('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"MPLBACKEND": "TkAgg"})
    assert done.stdout.strip() == "False"


@pytest.mark.parametrize(
    ("name", "problem"),
    [("figure-3-3", None), ("figure-3-3", "bottleneck-lp"), ("sata-s3", None), ("figure-3-3", "selection"), ("cover-30", None)],
)
def test_empty_answers_can_be_drawn(name, problem):
    asked = wb.read(name, problem=problem)
    answer = np.zeros(6) if asked.problem == "bottleneck-lp" else Selection()
    ax = PLOTS[asked.family](asked, answer)
    ax.figure.canvas.draw()


@pytest.mark.parametrize("name", ["figure-3-3", "sata-s3", "cover-30"])
def test_files_of_every_family_repeat_themselves(tmp_path, name):
    solution = wb.solve(wb.read(name), "highs", bound_time=0)
    for copy in "ab":
        save_plot(solution, tmp_path / f"{copy}.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
