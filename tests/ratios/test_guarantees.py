"""Every heuristic that states a guarantee, on seeded random instances and on all adversarial families: no violation.

Short here; in full by ``waybound ratio all --instances 10000`` or ``pytest -m long tests/ratios``.
"""

import pytest

from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.ratios.guarantees import GuaranteePlan
from waybound.reports.studies.study import STUDIES, Report, StudySetting
from waybound.reports.studies.violations import write_faults

FULL = {"stochastic-greedy": 1000, "local": 10_000}

GUARANTEES = [study.name for study in STUDIES.values() if isinstance(study.plan, GuaranteePlan)]


def states(heuristic: str) -> bool:
    """Whether a heuristic has a guarantee to state."""
    return not HEURISTICS[heuristic].stated.startswith("no guarantee")


def complaint(report: Report, folder: object) -> str:
    """What a failing test prints: the faults, and their instances as files."""
    files = write_faults(report, folder)
    return "\n".join(f"{fault.kind}: {fault.message} ({file})" for fault, file in zip(report.faults, files, strict=True))


def test_there_is_a_study_for_every_heuristic_of_routes_or_with_a_guarantee():
    tested = {configuration.heuristic for name in GUARANTEES for configuration in STUDIES[name].plan.configurations}
    assert tested >= {name for name in HEURISTICS if states(name)}
    assert tested >= {name for name in HEURISTICS if "routing" in HEURISTICS[name].families}


@pytest.mark.share(4)
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n == "local" else n for n in GUARANTEES])
def test_no_stated_guarantee_is_broken(name, tmp_path):
    report = STUDIES[name](StudySetting(2, seed=11))
    assert not report.num_faults, complaint(report, tmp_path)
    plan = STUDIES[name].plan
    assert {row["heuristic"] for row in report.rows} == {c.label for c in plan.configurations}
    assert {row["family"] for row in report.rows} == {family.name for family in plan.families}
    configurations, families = {c.label: c for c in plan.configurations}, {family.name: family for family in plan.families}
    for row in report.rows:
        owed = configurations[row["heuristic"]].expected(families[row["family"]].case(0, 11).problem)
        assert (row["stated_min"] is not None) == (owed is not None), "one on every instance of a family, or none"


@pytest.mark.long
@pytest.mark.parametrize("name", GUARANTEES)
def test_no_stated_guarantee_is_broken_on_thousands_of_instances(name, tmp_path):
    report = STUDIES[name](StudySetting(FULL.get(name, 5000), seed=12))
    assert not report.num_faults, complaint(report, tmp_path)


def test_table_3_1_of_the_thesis_comes_out_in_all_18_entries(tmp_path):
    report = STUDIES["table-3-1"]()
    assert not report.num_faults, complaint(report, tmp_path)
    assert len(report.rows) == 18
    for row in report.rows:
        assert row["steps"] == pytest.approx(row["printed"], abs=5e-5)
        assert row["fine"] == pytest.approx(row["exact"], abs=5e-5)
