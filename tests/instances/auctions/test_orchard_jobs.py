import numpy as np
import pytest
from coded import coded
from orchard_cases import LANE, ONE_ROUTE, TWO_ROUTES, lane, retrievals

from waybound.instances.auctions.orchard_jobs import OrchardJobs
from waybound.instances.auctions.orchard_rules import OrchardRules, OrchardStart
from waybound.instances.errors import InputError

GOOD = {
    "grid": LANE, "robot_cells": [0, 3], "robot_free": [0, 2], "bin_cells": [1, 1, 4], "after": [-1, 0, -1],
    "standing": np.array([True, False, True]), "work": [2, 2, 0],
}  # fmt: skip


def test_a_whole_day_of_routes():
    jobs = OrchardJobs.of_routes(lane(TWO_ROUTES, 2), TWO_ROUTES)
    assert jobs.bin_cells.tolist() == [1, 1, 2, 2, 4, 4, 3, 3]
    assert jobs.after.tolist() == [-1, 0, 1, 2, -1, 4, 5, 6]
    assert np.nonzero(jobs.standing)[0].tolist() == [0, 4]
    assert set(jobs.work.tolist()) == {2}
    assert jobs.facts()["bins"] == 8


@pytest.mark.parametrize("orders", [[[1, 2, 3]], [[1, 2, 2, 3]]])
def test_routes_that_leave_out_cells_are_refused(orders):
    with pytest.raises(InputError, check=coded("contradiction")):
        OrchardJobs.of_routes(lane(ONE_ROUTE, 1), OrchardStart(np.array([1]), np.array(orders)))
    with pytest.raises(InputError, check=coded("contradiction")):
        OrchardJobs.of_routes(OrchardRules(LANE, 1, 2), OrchardStart(np.array([1, 2]), np.empty((2, 0), int)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"robot_cells": [], "robot_free": []}, "there are no robots"),
        ({"bin_cells": [], "after": [], "standing": np.zeros(0, bool), "work": []}, "there are no bins"),
        ({"robot_cells": [0, 6]}, "the cell of robot 2 does not exist"),
        ({"bin_cells": [1, 1, 5]}, "bin 3 does not stand in a harvest cell"),
        ({"after": [-1, 1, -1]}, "bin 2 is filled after one that has no lower number"),
        ({"after": [-1, 0, 0]}, "two bins are filled next after bin 1"),
        ({"standing": [1, 0, 1]}, "standing must have one truth value a bin"),
        ({"work": [2, -1, 0]}, "work must be from 0"),
        ({"work": [2, 2]}, "there must be one work a bin; expected 3"),
        ({"robot_free": [0, 10**7]}, "robot_free must be from 0"),
    ],
)
def test_what_does_not_fit_is_refused(change, message):
    with pytest.raises(InputError, match=message):
        OrchardJobs(**{**GOOD, **change})


def test_the_digest_knows_what_values_depend_on():
    first = OrchardJobs(**GOOD)
    assert first.digest() == OrchardJobs(**GOOD, name="other").digest()
    assert first.digest() != OrchardJobs(**{**GOOD, "work": [2, 2, 1]}).digest()
    assert retrievals(((0, 2),), (0,)).digest() != retrievals(((0, 2),), (0,), objective="completion").digest()
