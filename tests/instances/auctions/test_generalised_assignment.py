import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import coded

from waybound.instances.auctions.generalised_assignment import GeneralisedAssignmentInstance
from waybound.instances.errors import InputError


def test_one_row_of_consumption_and_one_capacity_are_those_of_all_agents() -> None:
    made = GeneralisedAssignmentInstance([[1.0, 2.0], [3.0, math.inf]], [4.0, 5.0], 6.0)
    assert made.consumption.tolist() == [[4.0, 5.0], [4.0, 0.0]] and made.capacity.tolist() == [6.0, 6.0]
    assert (made.num_agents, made.num_jobs) == (2, 2) and made.listed.tolist() == [[True, True], [True, False]]
    assert made.facts()["forbidden"] == 1 and not made.values.flags.writeable


def test_a_frame_gives_pairs_by_name_and_a_series_the_capacities() -> None:
    pairs = pd.DataFrame({"agent": ["a", "b", "b"], "job": ["x", "x", "y"], "cost": [1, 2, 3], "consumption": [4, 5, 6]})
    made = GeneralisedAssignmentInstance.from_frame(pairs, pd.Series({"a": 7.0, "b": 8.0}))
    assert made.agent_names == ("a", "b") and made.job_names == ("x", "y")
    assert made.values.tolist() == [[1.0, math.inf], [2.0, 3.0]] and made.consumption.tolist() == [[4.0, 0.0], [5.0, 6.0]]
    with pytest.raises(InputError, match="agent b has no capacity", check=coded("missing")):
        GeneralisedAssignmentInstance.from_frame(pairs, {"a": 7.0})
    with pytest.raises(InputError, check=coded("malformed")):
        GeneralisedAssignmentInstance.from_frame(pairs, {"a": 7.0}, "profit")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (([[1.0], [2.0, 3.0]], [1.0], 1.0), "all rows of one length"),
        (([[math.nan]], [[1.0]], [1.0]), "the cost of agent 1 and job 1 must be a number"),
        (([[-math.inf]], [[1.0]], [1.0]), "the cost of agent 1 and job 1"),
        (([[1.0, 2.0]], [[1.0, -1.0]], [1.0]), "the consumption of agent 1 and job 2 must be from 0"),
        (([[1.0, 2.0]], [[1.0]], [1.0]), "consumption has another shape; expected 1 x 2"),
        (([[1.0]], [[1.0]], [-1.0]), "the capacity of agent 1 must be from 0"),
        (([[1.0]], [[1.0]], [1.0, 2.0]), "one capacity an agent"),
        ((np.zeros((0, 3)), np.zeros((0, 3)), []), "there are no agents"),
        ((np.zeros((2, 0)), np.zeros((2, 0)), [1.0, 1.0]), "there are no jobs"),
        (([1.0], [1.0], [1.0]), "values must be a matrix"),
    ],
)
def test_what_is_wrong_is_named(given: tuple[Any, Any, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        GeneralisedAssignmentInstance(*given)


def test_names_are_no_part_of_the_digest_and_the_objective_is() -> None:
    made = [GeneralisedAssignmentInstance([[1.0]], [[1.0]], [1.0], "profit", agent_names=names) for names in (None, ("a",))]
    assert made[0].digest() == made[1].digest() != GeneralisedAssignmentInstance([[1.0]], [[1.0]], [1.0]).digest()
    with pytest.raises(InputError, match="unknown objective"):
        GeneralisedAssignmentInstance([[1.0]], [[1.0]], [1.0], "sum")
