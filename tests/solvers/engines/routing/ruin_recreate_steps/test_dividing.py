import numpy as np
import pytest

from waybound.solvers.engines.routing.ruin_recreate_steps.dividing import divided, positions


@pytest.mark.parametrize("many", [1, 2, 3, 7, 12])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_each_point_is_in_one_part_and_parts_weigh_about_the_same(many: int, dimensions: int) -> None:
    rng = np.random.default_rng(1)
    points, weights = rng.uniform(0, 9, (300, dimensions)), rng.integers(1, 12, 300)
    parts = divided(points, weights, many, np.random.default_rng(2))
    assert len(parts) == many
    assert sorted(np.concatenate(parts).tolist()) == list(range(300))
    heavy = [int(weights[part].sum()) for part in parts]
    assert max(heavy) - min(heavy) <= 24 * many


def test_a_seed_makes_the_same_parts_and_another_one_others() -> None:
    points, weights = np.random.default_rng(1).uniform(0, 9, (60, 2)), np.ones(60, dtype=np.int64)

    def labels(seed: int) -> list[list[int]]:
        return [part.tolist() for part in divided(points, weights, 4, np.random.default_rng(seed))]

    assert labels(1) == labels(1) != labels(2)


def test_points_far_apart_are_not_in_one_part() -> None:
    points = np.concatenate([np.zeros((5, 2)), np.full((5, 2), 100.0)]) + np.random.default_rng(1).uniform(0, 1, (10, 2))
    parts = divided(points, np.ones(10, dtype=np.int64), 2, np.random.default_rng(3))
    assert sorted(part.tolist() for part in parts) == [[0, 1, 2, 3, 4], [5, 6, 7, 8, 9]]


def test_fewer_points_than_parts_and_points_in_one_place_are_divided_too() -> None:
    assert len(divided(np.zeros((3, 2)), np.ones(3, dtype=np.int64), 8, np.random.default_rng(1))) == 3
    assert len(divided(np.zeros((0, 2)), np.ones(0, dtype=np.int64), 4, np.random.default_rng(1))) == 1


def test_sites_on_a_globe_have_places_in_space() -> None:
    places = positions(None, np.array([[0.0, 0.0], [180.0, 0.0], [-180.0, 0.0], [77.0, 90.0]]), True)
    assert np.allclose(places, [[1, 0, 0], [-1, 0, 0], [-1, 0, 0], [0, 0, 1]])
    assert np.array_equal(positions(np.eye(3), None, False), np.eye(3))
