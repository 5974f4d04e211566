"""Weights of targets: the bound that they prove, by hand and against every selection; nonsense proves nothing."""

import math
from typing import Any

import numpy as np
import pytest
from coded import coded
from sata_cases import CASES, random_graph, selections

from waybound import BottleneckSATA, InputError, MaxMinLP
from waybound.formulations.sata.checking.target_weights import check_target_weights


def bound(case: str, targets: list[int], weights: list[float], *, fractional: bool = True) -> float:
    return check_target_weights(BottleneckSATA(CASES[case].graph, fractional=fractional), {"targets": targets, "weights": weights})


def test_the_bound_is_the_weighted_mean_of_what_each_robot_gives_best() -> None:
    """S7, targets 1 and 3 with weights 2 and 1: robot 1 gives max(2, 7) = 7, robot 2 max(6, 0) = 6, so 13 / 3."""
    assert bound("S7", [0, 2], [2.0, 1.0]) == pytest.approx(13 / 3, rel=1e-12)
    assert bound("S7", [0, 2], [2.0, 1.0]) >= 13 / 3


def test_a_single_target_bounds_by_all_that_see_it() -> None:
    """S10: the robots give target 1 at most 4, 4 and 3; target 2 at most 2, 3 and 5."""
    assert bound("S10", [0], [1.0]) == pytest.approx(11.0)
    assert bound("S10", [1], [7.0]) == pytest.approx(10.0)


def test_whole_actions_lower_the_bound_to_a_multiple_of_their_weights() -> None:
    assert bound("S7", [0, 2], [2.0, 1.0], fractional=False) == 4.0


def test_weights_count_in_proportion_and_negative_ones_not_at_all() -> None:
    known = bound("S7", [0, 2], [2.0, 1.0])
    assert bound("S7", [2, 0], [1e-290, 2e-290]) == pytest.approx(known, rel=1e-9)
    assert bound("S7", [0, 1, 2], [2e300, -5.0, 1e300]) == pytest.approx(known, rel=1e-12)


def test_no_positive_weight_proves_nothing() -> None:
    assert bound("S7", [], []) == math.inf
    assert bound("S7", [0, 1], [0.0, -1.0]) == math.inf


@pytest.mark.parametrize("fractional", [False, True])
def test_no_weights_whatever_prove_less_than_a_selection_reaches(fractional: bool) -> None:
    rng = np.random.default_rng(3)
    for _ in range(60):
        graph = random_graph(rng)
        problem = BottleneckSATA(graph, fractional=fractional)
        best = max(BottleneckSATA(graph).evaluate(s).values[0] for s in selections(graph))
        for _ in range(5):
            targets = np.nonzero(rng.random(graph.num_targets) < 0.7)[0].tolist()
            weights = rng.choice([0.0, 1.0, 1e-12, 3.7, -2.0], len(targets)).tolist()
            assert check_target_weights(problem, {"targets": targets, "weights": weights}) >= best * (1 - 1e-12)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"targets": [0, 0], "weights": [1.0, 1.0]}, "twice"),
        ({"targets": [3], "weights": [1.0]}, "0 to 2"),
        ({"targets": [-1], "weights": [1.0]}, "0 to 2"),
        ({"targets": [0], "weights": [1.0, 2.0]}, "one length"),
        ({"targets": [[0]], "weights": [[1.0]]}, "one length"),
        ({"targets": [0.5], "weights": [1.0]}, "whole numbers"),
        ({"targets": ["a"], "weights": [1.0]}, "whole numbers"),
        ({"targets": [0], "weights": [math.nan]}, "finite"),
        ({"targets": [0], "weights": [math.inf]}, "finite"),
    ],
)
def test_what_is_no_evidence_is_refused(data: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_target_weights(BottleneckSATA(CASES["S7"].graph), data)


def test_matrices_have_no_targets() -> None:
    with pytest.raises(InputError, check=coded("foreign")):
        check_target_weights(MaxMinLP(np.eye(2), np.eye(2)), {"targets": [0], "weights": [1.0]})
