import pickle
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sp
from coded import coded

from waybound.instances.auctions.assignment import AssignmentInstance
from waybound.instances.errors import InputError

INF = np.inf


def test_matrix_pairs_sparse_matrix_and_frames_give_the_same_data() -> None:
    matrix = np.array([[1.0, INF, 0.0], [INF, 3.0, 4.0]])
    pairs = AssignmentInstance.from_pairs(2, 3, [1, 0, 1, 0], [2, 0, 1, 2], [4.0, 1.0, 3.0, 0.0])
    sparse = sp.csr_matrix(([1.0, 0.0, 3.0, 4.0], [0, 2, 1, 2], [0, 2, 4]), shape=(2, 3))
    made = [AssignmentInstance.from_matrix(matrix), pairs, AssignmentInstance.from_matrix(sparse)]
    made.append(AssignmentInstance.from_frame(pd.DataFrame(matrix, index=["r", "s"], columns=["x", "y", "z"])))
    made.append(AssignmentInstance.from_frame(made[-1].to_frame()))
    assert len({instance.digest() for instance in made[:-1]}) == 1
    assert made[-1].bin_names == ("x", "z", "y")
    assert made[3].robot_names == ("r", "s") and not made[0].complete
    np.testing.assert_array_equal(made[1].matrix(), matrix)


def test_a_complete_matrix_is_a_view() -> None:
    made = AssignmentInstance.from_matrix(np.arange(6.0).reshape(2, 3))
    assert made.complete and np.shares_memory(made.matrix(), made.cost)


def test_bins_of_a_complete_matrix_are_made_when_they_are_asked_for() -> None:
    matrix = np.arange(6.0).reshape(2, 3)
    made, listed = AssignmentInstance.from_matrix(matrix), AssignmentInstance(2, 3, [0, 3, 6], [0, 1, 2] * 2, matrix.ravel())  # type: ignore[arg-type]
    assert "bins" not in vars(made) and made.complete and made.num_pairs == 6 and made.spread == (0.0, 5.0, True)
    for same in (made, replace(made, name="x"), pickle.loads(pickle.dumps(made))):
        assert same.digest() == listed.digest() and same.bins.tolist() == [0, 1, 2, 0, 1, 2]
    matrix[0, 0] = 9.0
    assert made.cost[0] == 0.0 and not made.bins.flags.writeable
    with pytest.raises(InputError, check=coded("wrong-shape")):
        AssignmentInstance(2, 3, [0, 2, 6], None, np.arange(6.0))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("costs", "message"),
    [
        ([[1, 2], [3]], "row 2 of the costs has a wrong length; expected 2; found 1"),
        ([[1, float("nan")]], "the cost in row 1, column 2 is not a number"),
        ([[1, -INF]], "the cost of robot 1 and bin 2 must be a number of at most 1e"),
        ([["a", 1]], "costs must hold numbers"),
        (3.0, "costs must be a matrix"),
        (np.zeros((0, 2)), "there are no robots; expected one at least"),
        (np.zeros((2, 0)), "there are no bins"),
        ([], "there are no robots"),
        ([1.0, 2.0], "costs must be a matrix"),
    ],
)  # fmt: skip
def test_what_is_no_matrix_is_refused_in_one_line(costs: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        AssignmentInstance.from_matrix(costs)


def test_wrong_pairs_are_refused() -> None:
    for robots, bins, costs, message in (
        ([0, 0], [1, 1], [1, 2], "robot 1 and bin 2 stands twice"),
        ([0], [5], [1], "the bin of pair 1 does not exist"),
        ([3], [0], [1], "the robot of pair 1 does not exist"),
        ([0], [0, 1], [1], "one entry a pair"),
        ([0], [0], [float("nan")], "must be a number"),
    ):
        with pytest.raises(InputError, match=message):
            AssignmentInstance.from_pairs(2, 2, robots, bins, costs)
    with pytest.raises(InputError, match="the pair of robot r1 and bin b stands twice"):
        AssignmentInstance.from_pairs(2, 2, [0, 0], [1, 1], [1, 2], robot_names=("r1", "r2"), bin_names=("a", "b"))
    with pytest.raises(InputError, check=coded("duplicate")):
        AssignmentInstance.from_matrix(sp.csr_matrix(([1.0, 2.0], [0, 0], [0, 2]), shape=(1, 1)))
    with pytest.raises(InputError, check=coded("malformed")):
        AssignmentInstance.from_frame([[1]])  # type: ignore[arg-type]


def test_times_of_being_filled_are_one_a_bin_and_not_negative() -> None:
    for filled, message in (([1.0], "one time of being filled a bin"), ([1.0, -1.0], "the time until bin 2 is full")):
        with pytest.raises(InputError, match=message):
            AssignmentInstance.from_matrix([[1.0, 2.0]], filled=np.array(filled))


def test_facts_tell_sizes_and_ranges() -> None:
    facts = AssignmentInstance.from_matrix([[1.0, INF], [2.0, 3.5]], filled=np.array([0.0, 2.0])).facts()
    assert facts["pairs"] == 3 and facts["forbidden"] == 1 and facts["bins_a_robot"] == [1, 2] and facts["costs"] == [1.0, 3.5]
    assert not facts["whole_costs"] and facts["not_yet_full"] == 1
