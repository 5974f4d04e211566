"""The suite catches what it is there to catch."""

import math
from dataclasses import replace

import pytest

import waybound as wb
from waybound.formulations.evidence import CHECKERS
from waybound.reports.ratios import judged_runs
from waybound.reports.ratios.guarantees import FALSE_ALARM, GuaranteePlan, hoeffding_margin, run_plan
from waybound.reports.ratios.judged_runs import Configuration, judge, run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families.selection import random_families
from waybound.reports.studies.study import STUDIES, StudySetting
from waybound.reports.studies.violations import write_faults
from waybound.solving import solve as solving

SUBMODULAR = (1.0, 1 / (1 - math.exp(-1)))


def kinds(report):
    return {fault.kind for fault in report.faults}


def test_a_heuristic_that_breaks_its_guarantee_is_caught_and_its_instance_is_read_back(measured, tmp_path):
    report = measured("bad-worst")
    assert kinds(report) >= {"ratio"}
    assert report.num_faults == sum(row["violations"] for row in report.rows)
    files = write_faults(report, tmp_path)
    found = [(fault, file) for fault, file in zip(report.faults, files, strict=True) if fault.kind == "ratio" and file]
    assert found
    for fault, file in found:
        problem = wb.read(file)
        assert fault.message in problem.notes
        again = judge(problem, optimum(problem), run_heuristic(problem, "bad-worst", {}, 1), 2.0)
        assert "ratio" in {kind for kind, _ in again.faults}


def test_a_sound_heuristic_passes(measured):
    report = measured("greedy", expected=SUBMODULAR)
    assert report.num_faults == 0
    assert len(report.observations) == 40


def test_a_guarantee_that_is_withheld_is_a_fault(measured):
    report = measured("bad-shy")
    assert kinds(report) >= {"guarantee"}
    assert all(row["stated_min"] is None for row in report.rows)


@pytest.mark.parametrize(
    ("heuristic", "expected", "fault"),
    [
        pytest.param("greedy", None, "guarantee", id="stated where none is known"),
        pytest.param("greedy", 1.01, "guarantee", id="weaker than the literature"),
        pytest.param("bad-garbled", SUBMODULAR, "bound", id="evidence that cannot be read"),
        pytest.param("bad-greedy-for-more", 2.0, "answer", id="an answer that fails its check"),
    ],
)
def test_each_fault_is_told_by_its_kind(measured, heuristic, expected, fault):
    assert kinds(measured(heuristic, expected=expected)) >= {fault}


def test_a_bound_is_derived_by_the_checker_whatever_the_heuristic_says_of_it(measured):
    """Evidence of another value is still evidence: the checker derives its own bound from it."""
    report = measured("bad-boastful", expected=SUBMODULAR)
    assert report.num_faults == 0
    assert all(one["bound"] is None or one["bound"] >= one["optimum"] - 1e-9 for one in report.observations)


def test_a_checker_that_proves_too_much_is_caught(measured, registered):
    honest = CHECKERS["marginal-gains"]
    registered(CHECKERS, "marginal-gains", lambda problem, data: 0.5 * honest(problem, data))
    assert "bound" in kinds(measured("greedy", expected=SUBMODULAR))


def test_a_crash_is_a_fault_with_its_instance_and_not_the_end_of_the_study(measured, tmp_path):
    report = measured("bad-crash")
    assert kinds(report) == {"error"}
    assert report.num_faults == 40
    assert "IndexError" in report.faults[0].message
    assert any(write_faults(report, tmp_path))


@pytest.mark.slow
def test_a_guarantee_in_expectation_is_tested_on_the_mean(measured):
    low = measured("bad-unlucky", repeats=60, instances=10)
    assert kinds(low) >= {"ratio"}
    assert "mean" in next(fault.message for fault in low.faults if fault.kind == "ratio")


def test_single_runs_below_a_guarantee_in_expectation_are_no_fault(measured):
    report = measured("lucky", repeats=60, instances=10)
    assert report.num_faults == 0
    assert any(math.isclose(row["mean_ratio"], 4 / 3, rel_tol=0.1) for row in report.rows)
    assert "Hoeffding" in " ".join(report.notes)


@pytest.mark.slow
def test_many_instances_show_what_single_ones_cannot(measured):
    """Three runs an instance prove nothing about it; the mean over all of them does."""
    report = measured("bad-unlucky", repeats=3, instances=200)
    pooled = [fault for fault in report.faults if "instances" in fault.message]
    assert pooled
    assert not [fault for fault in report.faults if fault not in pooled]


def test_hoeffding_margins():
    count = 1000
    assert math.exp(-2 * count * hoeffding_margin(count) ** 2) == pytest.approx(FALSE_ALARM)
    assert hoeffding_margin(4 * count) == pytest.approx(hoeffding_margin(count) / 2)


def test_certificates_of_some_runs_go_through_solve(measured):
    assert "4 runs went through solve" in " ".join(measured("greedy", expected=SUBMODULAR).notes)


def test_an_audit_sees_a_certificate_that_differs_from_the_run(measured, monkeypatch):
    honest = solving.solve
    monkeypatch.setattr(solving, "solve", lambda problem, request: honest(problem, replace(request, heuristic="random", options={})))
    assert kinds(measured("greedy", expected=SUBMODULAR)) >= {"certificate"}


def test_the_same_seed_gives_the_same_report_and_another_one_another():
    study = STUDIES["greedy-cardinality"]
    first, again, other = (study(StudySetting(30, seed=seed)) for seed in (4, 4, 5))
    assert first.observations == again.observations
    assert first.observations != other.observations


def test_more_instances_begin_with_the_same_ones():
    study = STUDIES["greedy-partition"]
    few, many = study(StudySetting(12)), study(StudySetting(60))
    assert [o for o in few.observations if o["family"] == "coverage"] == [
        o for o in many.observations if o["family"] == "coverage" and o["instance"] < 2
    ]


def test_an_interrupt_keeps_what_was_done():
    done = []

    def told(count, total, what):
        done.append(count)
        if count == 3:
            raise KeyboardInterrupt

    plan = GuaranteePlan((Configuration("greedy", "greedy", lambda problem: 2.0),), random_families("cardinality", 5))
    report = run_plan("interrupted", "for tests", plan, StudySetting(400, told=told))
    assert report.interrupted
    assert (report.done, report.asked) == (3, 8)
    assert 0 < len(report.observations) == sum(row["instances"] for row in report.rows) < 400


def test_an_optimum_that_does_not_hold_up_is_a_fault(measured, monkeypatch):
    from waybound.instances.errors import CheckFailedError

    def fail(problem):
        raise CheckFailedError("the two sides differ")

    monkeypatch.setattr(judged_runs, "optimum", fail)
    report = measured("greedy")
    assert kinds(report) == {"optimum"}
    assert report.num_faults == 40
