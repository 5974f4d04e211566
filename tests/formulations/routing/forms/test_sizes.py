"""Sizes of routing forms, from lists of sites; every form is held against what is built in ``tests/conformance/test_form_sizes.py``."""

from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane

import waybound as wb
from waybound import Travel, VehicleType
from waybound.formulations.forms import FORMS
from waybound.formulations.routing.forms._sizes import moves, resources
from waybound.formulations.routing.preparation import prepare


def test_windows_and_loads_leave_fewer_moves_and_never_fewer_than_there_are() -> None:
    free = plane(1, 30, np.inf)
    assert moves(free) == len(prepare(free).tail) == 30 * 29 + 60
    heavy = plane(1, 30, 10.0)
    assert len(prepare(heavy).tail) <= moves(heavy) < 30 * 29
    timed = wb.generate("solomon", seed=1, customers=80)
    assert len(prepare(timed).tail) <= moves(timed) <= 1.5 * len(prepare(timed).tail)


def test_limits_are_named() -> None:
    problem = plane(1, 5, 20.0)
    assert resources(problem) == ["load"]
    fleet = (VehicleType(capacity=20.0, max_distance=100.0, max_duration=90.0, shift=(0.0, 80.0)),)
    assert resources(replace(problem, fleet=fleet)) == ["time", "load", "distance", "duration"]


@pytest.mark.parametrize("customers", [5_000, 30_000])
def test_the_size_of_many_sites_takes_no_matrix(customers: int, monkeypatch: pytest.MonkeyPatch) -> None:

    problem = plane(1, customers, 100.0)
    monkeypatch.setattr(Travel, "distances", property(lambda travel: pytest.fail("all distances were asked for")))
    for name in problem.forms():
        size = FORMS[name].size(problem)
        assert size is not None and size.columns >= 0.9 * customers**2, name
