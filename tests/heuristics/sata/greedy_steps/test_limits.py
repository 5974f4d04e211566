import numpy as np
import pytest
from coded import coded
from selection_problems import cover_30, run

from waybound import Coverage, SubmodularSelection, UsageError
from waybound.heuristics.sata.greedy_steps.limits import Limits
from waybound.instances.sata.constraints import Cardinality, Constraint, PartitionMatroid


def problem_of(constraint: Constraint, n: int) -> SubmodularSelection:
    return SubmodularSelection(Coverage.from_sets([[e] for e in range(n)], np.ones(n)), constraint)


def test_room_is_no_larger_than_the_group() -> None:
    assert Limits.of(problem_of(Cardinality(9), 4)).room.tolist() == [4]
    limits = Limits.of(problem_of(PartitionMatroid.of([2, 0, 2, 0], [5, 1, 1]), 4))
    assert limits.room.tolist() == [2, 0, 1] and limits.most == 3
    starts, members = limits.members()
    assert starts.tolist() == [0, 2, 2, 4] and members.tolist() == [1, 3, 0, 2]


def test_what_a_plain_greedy_evaluates() -> None:
    assert Limits.of(cover_30(6)).plain_evaluations([0, 1, 2, 3, 4, 5]) == 165
    assert Limits.of(cover_30(6)).plain_evaluations([5], base=[0, 1]) == 28
    groups = problem_of(PartitionMatroid.of([0, 0, 0, 1, 1], [1, 2]), 5)
    outcome = run("greedy", groups, evaluation="plain")
    assert Limits.of(groups).plain_evaluations(outcome.answer.elements) == outcome.statistics["evaluations"] == 5 + 2 + 1


def test_room_beside_chosen_elements() -> None:
    limits = Limits.of(problem_of(PartitionMatroid.of([0, 0, 1], [2, 1]), 3))
    assert limits.without([0, 2]).tolist() == [1, 0]
    with pytest.raises(UsageError, check=coded("contradiction")):
        Limits.of(problem_of(PartitionMatroid.of([0, 0], [1]), 2)).without([0, 1])
