import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.engines.sata.local_max_min.cleaning import clean


def test_a_graph_with_nothing_to_clean_shares_its_arrays() -> None:
    graph = graph_of_edges([0, 0, 1], [0, 1, 2, 2], [0, 1, 0, 1])
    cleaned = clean(graph)
    assert cleaned.whole
    assert cleaned.layout.targets is graph.indices
    assert cleaned.layout.weights is graph.weights
    assert cleaned.layout.first.tolist() == [0, 2, 3]
    assert cleaned.layout.caps.tolist() == [1.0, 2.0]


def test_idle_actions_lower_delta_r_and_idle_robots_go() -> None:
    graph = graph_of_edges([0, 0, 0, 1, 2, 2], [0, 2, 4, 5], [0, 0, 0, 1], [1.0, 2.0, 3.0, 1.0], robots=4, targets=2)
    cleaned = clean(graph)
    assert cleaned.actions.tolist() == [0, 2, 4, 5]
    assert (cleaned.num_robots, cleaned.delta_r, cleaned.delta_t, cleaned.num_unseen) == (2, 2, 3, 0)
    assert cleaned.spread(np.array([0.1, 0.2, 0.3, 0.4])).tolist() == [0.1, 0.0, 0.2, 0.0, 0.3, 0.4]


def test_targets_of_one_viewer_are_set_apart_and_the_lightest_one_counts() -> None:
    layout = clean(graph_of_edges([0, 1], [0, 0, 0, 1], [0, 1, 2, 2], [5.0, 3.0, 1.0, 1.0])).layout
    assert layout.private.tolist() == [3.0, 0.0]
    assert layout.starts.tolist() == [0, 1, 2]
    assert layout.targets.tolist() == [2, 2]


def test_actions_are_laid_out_robot_after_robot() -> None:
    cleaned = clean(graph_of_edges([1, 0, 1, 0], [0, 1, 2, 3], [0, 0, 1, 1], [1.0, 2.0, 3.0, 4.0]))
    assert cleaned.actions.tolist() == [1, 3, 0, 2]
    assert cleaned.layout.weights.tolist() == [2.0, 4.0, 1.0, 3.0]
    assert cleaned.spread(np.array([1.0, 2.0, 3.0, 4.0])).tolist() == [3.0, 1.0, 4.0, 2.0]


def test_deltas_are_at_least_two_and_targets_that_nobody_sees_are_counted() -> None:
    cleaned = clean(graph_of_edges([0], [0], [1], robots=1, targets=4))
    assert (cleaned.delta_r, cleaned.delta_t, cleaned.num_unseen) == (2, 2, 3)


def test_a_graph_in_which_nobody_sees_anything_is_cleaned_to_nothing() -> None:
    cleaned = clean(graph_of_edges([0, 1], [], [], robots=2, targets=1))
    assert (cleaned.num_robots, cleaned.num_actions, cleaned.num_unseen) == (0, 0, 1)


@pytest.mark.parametrize("weight", [1e-120, 1e120])
def test_weights_out_of_all_proportion_are_refused(weight: float) -> None:
    with pytest.raises(InputError, check=coded("out-of-range")):
        clean(graph_of_edges([0], [0], [0], weight))
