import numpy as np

from waybound.instances.routing.terrain import Terrain, middle_of
from waybound.instances.worlds import make_world


def test_cells_are_free_for_half_of_a_period():
    none = np.zeros((1, 3), dtype=bool)
    terrain = Terrain(np.array([[False, False, True]]), none, np.array([[100.0, 100.0, np.inf]]), np.array([[0.0, 75.0, 0.0]]))
    shown = [terrain.at(clock)[0].tolist() for clock in (0.0, 49.0, 50.0, 100.0, 125.0)]
    assert shown == [[False, True, True], [False, False, True], [True, False, True], [False, True, True], [False, False, True]]


def test_lanes_stay_free_and_blocks_change_together_or_each_cell_by_itself():
    for phases, alike in (("clustered", True), ("independent", False)):
        terrain = make_world("persistent-exploration", 2, phases=phases, dynamic=0.8).terrain
        assert terrain.known[::4].all() and terrain.known[:, ::4].all() and not terrain.occupied[terrain.known].any()
        blocks = [terrain.period[r : r + 3, c : c + 3] for r in range(1, 30, 4) for c in range(1, 30, 4)]
        change = [block for block in blocks if np.isfinite(block).all()]
        assert len(change) > 30 and all((len(np.unique(block)) == 1) == alike for block in change)


def test_the_middle_is_on_a_crossing():
    assert middle_of({"rows": 25, "columns": 33, "lanes": 4}) == (12, 16)
    assert middle_of({"rows": 26, "columns": 31, "lanes": 5}) == (10, 15)
    assert middle_of({"rows": 7, "columns": 9, "lanes": 0}) == (3, 4)
