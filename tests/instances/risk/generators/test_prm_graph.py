import numpy as np
import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate
from waybound.instances.generators import Draw
from waybound.instances.risk.generators.prm_graph import SCENES, intensities, near_pairs, raster


def test_a_roadmap_is_as_the_source_describes_it():
    g = generate("prm-graph", 1)
    length = np.linalg.norm(g.positions[g.tails] - g.positions[g.heads], axis=1)
    assert (g.num_vertices, g.positions[g.start].tolist(), g.positions[g.goal].tolist()) == (100, [0, 0], [100, 100])
    assert np.allclose(g.least, length)
    assert length.max() <= 29.657 + 1e-3
    assert ((g.mean - length >= -1e-12) & (g.mean - length < 100)).all()
    assert (g.variance.min() >= 0) & (19 < g.variance.max() < 20)
    assert 1700 < g.num_edges < 2300  # about 2030 in the mean


def test_the_two_directions_cost_differently_or_alike():
    own, shared = (generate("prm-graph", 2, vertices=20, directed=directed) for directed in (True, False))
    back = [g.edges_of_pairs(g.heads, g.tails) for g in (own, shared)]
    assert (own.mean[back[0]] != own.mean).all()
    assert (shared.mean[back[1]] == shared.mean).all()
    assert (shared.variable[back[1]] == shared.variable).all()


def test_graphs_without_a_path_are_drawn_again_or_refused():
    assert all(np.isfinite(g.costs_to(g.goal, g.mean)[0]) for g in (generate("prm-graph", seed, vertices=4) for seed in range(20)))
    check_refused(UsageError, "none of 100 random graphs of 2 vertices has a path", generate, "prm-graph", 1, vertices=2)


def test_near_pairs_are_those_within_the_radius():
    points = np.random.default_rng(1).random((30, 2))
    a, b = near_pairs(points, 0.3)
    near = {(i, j) for i in range(30) for j in range(i + 1, 30) if np.linalg.norm(points[i] - points[j]) <= 0.3}
    assert set(zip(a.tolist(), b.tolist(), strict=True)) == near


@pytest.mark.parametrize("scene", SCENES)
def test_a_raster_graph_is_dearer_where_the_image_is_bright(scene):
    g = generate("raster-graph", 1, scene=scene, vertices=60, pixels=64)
    length = np.linalg.norm(g.positions[g.tails] - g.positions[g.heads], axis=1)
    extra = g.mean - length
    assert (extra.min() >= 0) & (extra.max() <= 255)
    assert (extra.max() > 40) == (scene != "empty")


def test_intensities_are_moments_of_the_pixels_on_the_way():
    image = np.zeros((10, 10))
    image[:, 5:] = 100.0
    mean, variance = intensities(image, np.array([[0.05, 0.5], [0.55, 0.05]]), np.array([[0.95, 0.5], [0.55, 0.95]]))
    assert mean.tolist() == [50.0, 100.0]
    assert variance.tolist() == [2500.0, 0.0]


def test_a_blur_keeps_the_mean_of_an_even_image_and_evens_out():
    sharp, soft = (raster(Draw(np.random.default_rng(1)), "trees", 64, blur) for blur in (0, 3))
    assert soft.std() < sharp.std()
    assert abs(soft.mean() - sharp.mean()) < 3.0
