"""Answers out of arrays, what is left where an auction was cut short, and rules by name."""

from __future__ import annotations

import numpy as np
import pytest
from task_problems import line

from waybound.heuristics.auctions.auction_steps.paths import arrays_of, completed, paths_of, rule_of
from waybound.instances.errors import UsageError


def test_the_first_stops_of_each_row_are_its_path():
    assert paths_of(np.array([[2, 0, -1], [-1, -1, -1], [1, -1, -1]]), np.array([2, 0, 1])) == ((2, 0), (), (1,))


def test_what_nobody_got_the_first_robot_does_last():
    assert completed(line([0, 1], [1, 2, 3]), ((2,), ())) == ((2, 0, 1), ())


def test_arrays_are_copies():
    problem = line([0], [1, 2])
    starts, _ = arrays_of(problem)
    starts[0, 0] = 9
    assert problem.instance.starts[0, 0] == 1


def test_the_rule_is_by_default_that_of_the_objective():
    assert [rule_of(line([0], [1], f"mini-{rule}"), None) for rule in ("sum", "max", "ave")] == ["sum", "max", "ave"]
    assert rule_of(line([0], [1]), "ave") == "ave"
    with pytest.raises(UsageError, match="bids must be sum, max, ave"):
        rule_of(line([0], [1]), "mini-sum")
