import pytest
from short_forms import short_form

from waybound.reports.studies.routing import unreliable_communication as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.unreliable_communication)
    sweeps = [row for row in report.observations if "floor" in row]
    assert [row["method"] for row in sweeps[: len(study.METHODS)]] == [*study.METHODS]
    assert all(row["returned"] <= row["explored"] * (1 + 1e-12) for row in sweeps)
    loops = [row for row in report.observations if "loop" in row]
    assert [row["method"] for row in loops] == [*study.LOOPS] * 2
    assert all(0 < row["cells"] <= row["most"] for row in loops)
    assert "four robots among rooms" in html


@pytest.mark.parametrize(("rule", "share"), [("home", 0.5), ("sacrifice", 0.75), ("printed", 0.5)])
def test_corridors_tell_the_rules_apart(rule, share):
    assert study.corridor(rule, 2) == share


def test_what_must_not_be_is_a_fault():
    row = {"seed": 1, "method": "home", "returned": 5.0, "explored": 6.0, "energy": 0.0, "share": 90.0, "cells": 9.0, "most": 10.0}
    kinds = [study.broken([{**row, **change}]) for change in ({}, {"returned": 7.0}, {"energy": -1.0}, {"share": 101.0})]
    assert [[fault.kind for fault in faults] for faults in kinds] == [[], ["answer"], ["answer"], ["bound"]]
