"""The start-up benchmark measures what it says; its times are not tested."""

import pytest

from waybound.reports.benchmarks import startup


def test_a_heavy_module_would_be_noticed():
    assert startup.heavy_modules("import scipy") == ["scipy"]


def test_help_and_import_load_nothing_heavy():
    for action in startup._ACTIONS.values():
        assert startup.heavy_modules(action) == []


@pytest.mark.slow
def test_every_case_is_measured():
    assert set(startup.measure(repeats=1)) == set(startup.CASES)
