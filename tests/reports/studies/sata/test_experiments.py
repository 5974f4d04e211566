from dataclasses import replace

import pytest

import waybound as wb
from waybound import CheckFailedError, UsageError, WinnerTakesAllSATA
from waybound.reports.studies.sata.experiments import ExperimentPlan, Sweep, run_experiment, sensing_graph, solved
from waybound.reports.studies.sata.families.optima import best_selection
from waybound.reports.studies.study import STUDIES, Study, StudySetting
from waybound.reports.studies.violations import write_faults
from waybound.reports.studies.writing import png
from waybound.solving import solve as solving

POINT = {"robots": 6, "targets": 20, "phi": 20.0, "actions": 2}


@pytest.fixture
def tried():
    """``tried(measure, orders)``: a small experiment that is registered while it runs."""

    def run(measure, orders=(), methods=("a", "b"), told=lambda *what: None):
        plan = ExperimentPlan(
            (Sweep("robots", (4, 6), {"targets": 12, "phi": 25.0}),), methods, measure, orders, "something", (("a", "b"),)
        )
        study = Study("tried", "for tests", 7, lambda setting: run_experiment("tried", "for tests", plan, setting), False, plan)
        with STUDIES.temporary("tried", study):
            return STUDIES["tried"](StudySetting(7, told=told))

    return run


def test_a_graph_has_the_density_that_is_asked_for():
    graph, _ = sensing_graph(POINT, 1, 0)
    assert (graph.num_robots, graph.num_actions, graph.num_targets) == (6, 12, 20)
    assert graph.density == pytest.approx(20.0)
    assert not len(graph.unseen_targets) and not len(graph.idle_robots)


def test_graphs_depend_on_seed_trial_and_parameters_alone():
    digests = {(seed, trial): sensing_graph(POINT, seed, trial)[0].digest() for seed in (1, 2) for trial in range(4)}
    assert len(set(digests.values())) == 8
    assert sensing_graph(dict(reversed(POINT.items())), 2, 3)[0].digest() == digests[2, 3]


def test_graphs_that_cannot_be_are_refused():
    with pytest.raises(UsageError, match="phi"):
        sensing_graph({**POINT, "phi": 1.0}, 1, 0)


def test_the_optimum_of_highs_is_that_of_enumeration():
    for trial in range(5):
        problem = WinnerTakesAllSATA(sensing_graph({"robots": 5, "targets": 12, "phi": 25.0, "actions": 2}, 1, trial)[0])
        assert solved(problem).value == pytest.approx(best_selection(problem).value)


def test_an_optimum_that_is_not_proved_is_refused(monkeypatch):
    honest = solving.solve
    monkeypatch.setattr(solving, "solve", lambda *given, **options: replace(honest(*given, **options), status="feasible"))
    with pytest.raises(CheckFailedError, match="optimum"):
        solved(WinnerTakesAllSATA(sensing_graph(POINT, 1, 0)[0]))


def test_rows_summarise_the_trials(tried):
    report = tried(lambda graph, seed: ({"a": 1.0, "b": float(graph.num_robots)}, []))
    assert report.num_faults == 0
    assert [(row["x"], row["method"], row["mean"], row["trials"]) for row in report.rows] == [
        (4, "a", 1.0, 7), (4, "b", 4.0, 7), (6, "a", 1.0, 7), (6, "b", 6.0, 7),
    ]  # fmt: skip
    assert len(report.observations) == 14
    assert report.table.rows[0][-1] == "0.250 (0.250)"


def test_values_that_contradict_each_other_are_faults_with_their_graph(tried, tmp_path):
    report = tried(lambda graph, seed: ({"a": 2.0, "b": 1.0}, []), orders=(("a", "b"),))
    assert report.num_faults == 14
    assert {fault.kind for fault in report.faults} == {"order"}
    assert all(wb.read(file).graph.num_targets == 12 for file in write_faults(report, tmp_path))


def test_an_interrupt_keeps_what_was_done(tried):
    def told(done, total, what):
        if done == 2:
            raise KeyboardInterrupt

    report = tried(lambda graph, seed: ({"a": 1.0, "b": 1.0}, []), told=told)
    assert report.interrupted
    assert (report.done, report.asked) == (2, 4)
    assert [row["trials"] for row in report.rows] == [5, 5, 5, 5], "five of the seven trials at both points"


def test_the_figure_of_an_experiment_is_drawn(tried):
    report = tried(lambda graph, seed: ({"a": 1.0, "b": float(seed % 7)}, []))
    assert png(report.figures[0]).startswith(b"\x89PNG")
