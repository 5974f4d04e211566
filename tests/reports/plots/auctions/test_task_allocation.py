import numpy as np
from task_problems import line, parts

import waybound as wb
from waybound.reports.plots import PLOTS


def test_paths_lead_from_the_robots_through_their_tasks():
    ax = PLOTS["task-allocation"](line([0, 10], [4, 6, 1]), ((0, 2), (1,)))
    assert [drawn.get_xdata().tolist() for drawn in ax.lines] == [[0, 4, 1], [10, 6]]
    assert len([text for text in ax.texts if text.get_text() in ("1", "2", "3")]) == 3


def test_parts_are_drawn_with_the_edges_that_count():
    answer = ((0, 1, 2), (3, 4))
    lines = {
        edges: len(PLOTS["balanced-partition"](parts([0, 1, 2, 6, 7], edges=edges), answer).lines) for edges in ("mst", "clique", "none")
    }
    assert lines == {"mst": 3, "clique": 4, "none": 0}


def test_without_places_there_are_bars():
    team = wb.RobotTasks.of_distances([[1, 2], [2, 1]], [[0, 3], [3, 0]])
    ax = PLOTS["task-allocation"](wb.TaskAllocation(team), ((0, 1), ()))
    assert np.allclose([patch.get_height() for patch in ax.patches], [4, 0])
    ax = PLOTS["balanced-partition"](wb.BalancedPartition(team), ((0, 1), ()))
    assert np.allclose([patch.get_height() for patch in ax.patches], [3, 0])
