"""The bound of retrievals through ``bound``."""

from __future__ import annotations

from orchard_cases import retrievals

import waybound as wb


def test_it_bounds_days_and_is_verified():
    found = wb.bound(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)))
    assert (found.bound, found.bound_source) == (6.0, "steps of all retrievals, and of each bin")
