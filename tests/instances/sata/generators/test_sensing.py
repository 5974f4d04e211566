from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

from waybound.instances.generating import generate

FAMILIES = ("sensing-regular", "sensing-ring", "sensing-geometric")


def lp_value(g: Any) -> float:
    """Optimum of the max-min LP, written down here alone."""
    import scipy.sparse as sp

    seen = sp.coo_matrix((g.weights, (g.indices, g.action_of_edge)), shape=(g.num_targets, g.num_actions))
    own = sp.coo_matrix((np.ones(g.num_actions), (g.robot_of_action, np.arange(g.num_actions))), shape=(g.num_robots, g.num_actions))
    rows = sp.vstack([sp.hstack([own, sp.coo_matrix((g.num_robots, 1))]), sp.hstack([-seen, np.ones((g.num_targets, 1))])])
    cost = np.append(np.zeros(g.num_actions), -1.0)
    found = linprog(cost, rows.tocsr(), np.append(np.ones(g.num_robots), np.zeros(g.num_targets)), method="highs")
    return float(-found.fun)


@pytest.mark.parametrize(
    ("family", "robots", "pairs", "best"),
    [
        ("sensing-regular", 1000, 3.9e3, 1.7818),
        pytest.param("sensing-regular", 10_000, 3.9e4, 1.4834, marks=pytest.mark.long),
        pytest.param("sensing-ring", 100_000, 3.9e5, 0.5, marks=pytest.mark.long),
        pytest.param("sensing-geometric", 10_000, 8.0e4, 0.5, marks=pytest.mark.long),
    ],
)
def test_published_sizes_and_optima_come_out_with_the_number_of_robots_as_seed(
    family: str, robots: int, pairs: float, best: float
) -> None:  # fmt: skip
    g: Any = generate(family, robots, robots=robots)
    assert float(f"{g.num_edges:.1e}") == pairs
    assert lp_value(g) == pytest.approx(best, abs=5e-5)


def test_the_regular_graph_has_two_actions_a_robot_and_four_stubs_a_target() -> None:
    g: Any = generate("sensing-regular", 3, robots=500)
    assert (g.num_actions, g.num_targets) == (1000, 500)
    assert (np.bincount(g.robot_of_action) == 2).all()
    degree = np.diff(g.by_target.indptr)
    assert degree.max() == 4 and degree.min() >= 1
    assert np.diff(g.indptr).max() == 2
    single = g.weights[np.diff(g.indptr)[g.action_of_edge] == 2]
    assert single.min() >= 0.5 and single.max() <= 1.5
    reach = np.abs(4 * g.indices - 2 * g.action_of_edge)  # a stub moves by at most 48 places
    assert reach.max() <= 48 + 4


def test_on_the_ring_actions_see_what_is_near_their_robot() -> None:
    g: Any = generate("sensing-ring", 3, robots=200)
    assert np.diff(g.indptr).max() <= 2 and np.diff(g.indptr).min() >= 1
    assert (g.weights == 1).all() and len(g.unseen_targets) == 0
    assert g.num_targets <= 200


def test_in_the_plane_actions_see_exactly_what_is_within_the_range() -> None:
    g: Any = generate("sensing-geometric", 3, robots=150)
    lengths = np.linalg.norm(g.action_positions[:, None] - g.target_positions[None], axis=2)
    dense = np.zeros(lengths.shape, dtype=bool)
    dense[g.action_of_edge, g.indices] = True
    assert (dense == (lengths <= 0.8)).all()
    assert dense.any(axis=0).all()
    assert (np.bincount(g.robot_of_action) == 4).all()
    centre = g.action_positions.reshape(150, 4, 2)
    spans = np.linalg.norm(centre[:, :, None] - centre[:, None], axis=3)
    assert spans.max() <= 2 + 1e-12  # all four lie on a circle of radius 1


@pytest.mark.parametrize("family", FAMILIES)
def test_the_linear_program_is_meant_and_the_name_tells_size_and_seed(family: str) -> None:
    g: Any = generate(family, 4, robots=30)
    assert (g.problem, g.name, g.num_robots) == ("bottleneck-lp", f"{family}-r30-s4", 30)
    assert generate(family, 4, robots=30, name="mine").name == "mine"


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("robots", [1, 2])
def test_the_smallest_sizes_are_graphs_too(family: str, robots: int) -> None:
    for seed in range(5):
        g: Any = generate(family, seed, robots=robots)
        assert g.num_robots == robots
