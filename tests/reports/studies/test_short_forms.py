from pathlib import Path

import pytest
from short_forms import short_form

from waybound.reports.studies import processes
from waybound.reports.studies.study import STUDIES, Study


def has_tests_of_its_own(study: Study) -> bool:
    """The tests of the study's own module run its short form, and look at what it found as well."""
    room, module = study.run.__module__.split(".")[-2:]
    tests = Path(__file__).parent / room / f"test_{module}.py"
    return tests.exists() and f"short_form(study.{study.name.replace('-', '_')})" in tests.read_text(encoding="utf-8")


EXPERIMENTS = [study.name for study in STUDIES.values() if study.source and not has_tests_of_its_own(study)]

SLOW = {
    "local", "sequential-greedy", "tracking-force-vectors", "tracking-weights", "tracking-bottleneck", "bottleneck", "layers",
    "winner-takes-all", "information-gathering", "mixed-objective", "orchard-look-ahead", "risky-planners", "uncertain-rasters",
    "uncertain-roadmaps", "plume-bounds", "observation-allocation",
}  # fmt: skip

EACH = [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in EXPERIMENTS]

SPREAD = ["communication-rounds", "lazy-evaluations", "non-dominated-paths", "orchard", "reward-stages"]


@pytest.mark.parametrize("name", EACH)
def test_short_forms_have_rows_and_findings_and_the_same_ones_again(name):
    short_form(STUDIES[name])


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
