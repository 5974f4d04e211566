"""Every study that repeats an experiment, in its short form: findings, rows that the seed decides, interrupts, pages."""

from __future__ import annotations

import pytest

from waybound.reports.studies import processes
from waybound.reports.studies.findings import LOST, NOT, REPRODUCED, SIGN, UNDECIDED
from waybound.reports.studies.page import page_of
from waybound.reports.studies.study import STUDIES

EXPERIMENTS = [study.name for study in STUDIES.values() if study.source]

SLOW = {
    "local", "sequential-greedy", "tracking-force-vectors", "tracking-weights", "tracking-bottleneck", "bottleneck", "layers",
    "winner-takes-all", "information-gathering", "mixed-objective", "orchard-look-ahead", "risky-planners", "uncertain-rasters",
    "uncertain-roadmaps", "plume-bounds", "plume-exploration", "fleet-energy", "search-and-track", "hotspot-identification",
    "persistent-exploration", "observation-allocation", "unreliable-communication", "explore-map-search", "fire-monitoring",
}  # fmt: skip

EACH = [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in EXPERIMENTS]

SPREAD = ["communication-rounds", "lazy-evaluations", "non-dominated-paths", "orchard", "reward-stages"]


@pytest.mark.parametrize("name", EACH)
def test_short_forms_have_rows_and_findings_and_the_same_ones_again(name):
    study = STUDIES[name]
    setting = study.setting(full=False)
    made, again = study(setting), study(setting)
    assert made.rows and made.table.rows and made.num_faults == 0
    assert made.done == made.asked > 0 and not made.interrupted
    assert (made.rows, made.observations) == (again.rows, again.observations) or repr(made.rows) == repr(again.rows)  # NaN is no equal
    assert made.findings or study.claim.startswith("none")
    for finding in made.findings:
        assert finding.verdict in (REPRODUCED, SIGN, NOT, UNDECIDED, LOST)
        assert finding.what and finding.published and finding.ours
        assert (finding.why == "") == (finding.verdict in (REPRODUCED, SIGN)), finding
    assert study.source in page_of(study, setting, made).html()  # with all figures
    assert all("second" not in key for row in (*made.rows, *made.observations) for key in row), "a row is what the seed gives"


@pytest.mark.parametrize("name", ["orchard", "reward-stages"])
def test_another_seed_gives_other_rows(name):
    assert STUDIES[name](full=False).rows != STUDIES[name](full=False, seed=77).rows


@pytest.mark.slow
def test_processes_change_nothing():
    study = STUDIES["reward-stages"]
    assert study(full=False, jobs=2).rows == study(full=False).rows


@pytest.mark.parametrize("name", SPREAD)
def test_an_interrupt_keeps_what_was_done(name, monkeypatch):
    """After the first part; those of one world or graph are compared in whole."""
    study = STUDIES[name]
    whole, spread = study(full=False, instances=2), processes.spread

    def interrupted(function, tasks, jobs, progress, what):
        def some(k, total, now):
            if k == 1:
                raise KeyboardInterrupt

        return spread(function, tasks, jobs, some, what)

    monkeypatch.setattr(f"{study.run.__module__}.spread", interrupted)
    made = study(full=False, instances=2)
    assert made.interrupted and (made.done, made.asked) == (1, whole.asked)
    assert made.rows and list(made.observations) == list(whole.observations[: len(made.observations)])


def test_an_interrupt_before_anything_is_done_is_passed_on(monkeypatch):
    monkeypatch.setattr("waybound.reports.studies.auctions.orchard.days_of", _interrupt)
    with pytest.raises(KeyboardInterrupt):
        STUDIES["orchard"](full=False)


def _interrupt(*given):
    raise KeyboardInterrupt
